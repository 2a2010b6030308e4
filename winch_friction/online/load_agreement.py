"""Whether the load that is shown, the drive's torque and what the filter finds can be of one machine."""

import math

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.online.doubt import Doubt, span
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque, sample_load
from winch_friction.physics.winch.operating_point import ChannelRanges

# the load and the drive: inertia, friction and waves are a third of it at most
TORQUE_SHARE, TORQUE_TIME = 0.8, 1.0  # of the larger one, s
SMALLEST_TORQUE = 0.1  # of what the rated load asks for; below it nothing is compared
# the load cell's load and the one that the balance of torques gives while it is learned from: a load cell, a
# displacement feedback and a tare of a few per cent each; a sea passes once in this time, a picked-up load settles
BALANCE_SHARE, BALANCE_TIME = 0.1, 10.0


class LoadBalance:
    """Whether the load that the estimator finds is the one that the load cell shows.

    A load cell that drifts and a displacement (or both pressures) that drift look the same here: T = D dp is compared
    with m g r. It is not said which one is wrong, but that nothing may be learned from them.
    """

    def __init__(self) -> None:
        self._doubt, self._time = Doubt(BALANCE_TIME, BALANCE_TIME), math.nan

    def contradiction(self, apart: float, time: float) -> str:
        """What does not fit, in words; `apart`: the share of the measured load that the balance adds, NaN unknown."""
        dt, self._time = span(self._time, time), time
        wrong = abs(apart) > BALANCE_SHARE if apart == apart else None
        if not self._doubt.step(wrong, dt):
            return ""
        return f"hook_load contradicts the balance of torques by {abs(apart):.0%}: load cell, displacement or pressures"


class LoadAgainstDrive:
    """Whether the load that is shown and the drive's torque can be of one machine; it needs no model.

    A load cell that is dead, or stands still while another load hangs there. The load is the hook load, else that of
    the rope's force. A winch that stands still shows nothing: its brake may carry the load.
    """

    def __init__(self, crane: Crane, ranges: ChannelRanges) -> None:
        self._crane, self._doubt = crane, Doubt(TORQUE_TIME)
        self._rated, self._moving = 0.5 * ranges.load, AGAINST_SPEED * crane.speed_scale  # kg, rad/s

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        stands = self._doubt.step(self._differ(sample), dt)
        by_rope = math.isnan(sample.hook_load) and sample.rope_force == sample.rope_force
        return f"{'rope_force' if by_rope else 'hook_load'} contradicts the drive torque" if stands else ""

    def _differ(self, sample: Sample) -> bool | None:
        if not self._crane.drive.hydraulic or not self._crane.drum.has(sample.wire_layer):
            return None
        if not abs(sample.motor_speed) > self._moving:
            return None
        load = self._crane.drum_torque(sample_load(sample), sample.wire_layer) / self._crane.gear_ratio
        drive = sample_drive_torque(sample, self._crane)
        large = max(abs(load), abs(drive))
        rated = self._crane.drum_torque(self._rated, sample.wire_layer) / self._crane.gear_ratio
        if not (large > SMALLEST_TORQUE * rated and math.isfinite(drive - load)):
            return None
        return abs(drive - load) > TORQUE_SHARE * large
