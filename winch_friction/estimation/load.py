"""The hanging load as the estimator sees it: the measured mass, or the one that the load torque means."""

import math

from winch_friction.physics.signals import Sample
from winch_friction.physics.units import GRAVITY
from winch_friction.physics.winch.crane import Crane

PICKED_UP = 0.1  # a relative change of the measured mass beyond this is another load, not noise


class HangingLoad:
    """Low-passed hook load and what follows from it."""

    def __init__(self, crane: Crane, time_constant: float) -> None:
        self._crane = crane
        self._time_constant = time_constant
        self.mass = math.nan  # kg; NaN: not measured

    def following(self, sample: Sample, dt: float) -> float:
        """The mass after `dt` s more of a measured one in kg; one that is not finite leaves it."""
        measured = sample.hook_load
        if not math.isfinite(measured) or measured < 0.0:
            return self.mass
        if not abs(measured - self.mass) <= PICKED_UP * self.mass:
            return measured
        return self.mass + (measured - self.mass) * dt / (dt + self._time_constant)

    @property
    def measured(self) -> bool:
        """Whether a mass is known from a load cell."""
        return math.isfinite(self.mass)

    def shaft_torque(self, layer: float) -> float:
        """T_d / i of the measured mass, N m; 0 without one."""
        return self._crane.drum_torque(self.mass, layer) / self._crane.gear_ratio if self.measured else 0.0

    def mass_by(self, shaft_torque: float, layer: float) -> float:
        """The measured mass, else the one that a load torque at the shaft means; kg."""
        if self.measured:
            return self.mass
        return max(0.0, shaft_torque * self._crane.gear_ratio / (GRAVITY * self._crane.drum.radius(layer)))
