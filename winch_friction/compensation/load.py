"""The drum torque that the friction terms read: from the measured load, a configured one, or the torque balance."""

import math

from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.torque_balance import sample_drive_torque


class DrumTorque:
    """T_d in N m for the compensator.

    `hook_load` comes first, then the measured `rope_force`, then a configured load. Without any of them it is
    i (drive torque - J omega' - friction), low-passed over `time_constant` s: slow against the sea, so that an error
    of the friction at reversal cannot feed back through the load.
    """

    def __init__(self, crane: Crane, load: float, time_constant: float) -> None:
        self.crane = crane
        self._load = load
        self._time_constant = time_constant
        self.reset()

    def configure(self, load: float, time_constant: float) -> None:
        """Other settings, the estimate kept."""
        self._load, self._time_constant = load, time_constant

    def reset(self) -> None:
        """Forget the estimate from the pressures."""
        self._estimate = math.nan

    def value(self, sample: Sample) -> float:
        """T_d in N m; NaN while nothing is known."""
        load = sample.hook_load
        if not math.isfinite(load):
            if math.isfinite(sample.rope_force):
                return sample.rope_force * self.crane.drum.radius(sample.wire_layer)
            load = self._load
        if math.isfinite(load):
            return self.crane.drum_torque(load, sample.wire_layer)
        if not math.isfinite(self._estimate):
            return self._from_balance(sample, 0.0, 0.0)
        return self._estimate

    def learn(self, sample: Sample, friction: float, acceleration: float, dt: float) -> None:
        """Follow the torque balance of one sample with the friction that the model says, `dt` s after the one
        before."""
        balance = self._from_balance(sample, friction, acceleration)
        if not math.isfinite(balance):
            return
        if not math.isfinite(self._estimate):
            self._estimate = balance
        self._estimate += (balance - self._estimate) * dt / (dt + self._time_constant)

    def _from_balance(self, sample: Sample, friction: float, acceleration: float) -> float:
        crane = self.crane
        torque = sample_drive_torque(sample, crane) - crane.inertia * acceleration - friction
        return max(0.0, crane.gear_ratio * torque) if math.isfinite(torque) else math.nan
