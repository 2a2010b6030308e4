"""Whether the drive's pressures can be a winch's at all, whatever hangs on it: no load and no model is asked.

Where a load is shown, `doubt.LoadAgainstDrive` puts it beside them. A crane without a load cell takes its load from
them: in bar where Pa are meant, of transducers without supply, or with their ports exchanged, they show none, and the
friction of an empty hook went out for that of the load, marked valid.
"""

import math

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.online.doubt import (
    LEAST_KNOWN,
    TORQUE_TIME,
    Doubt,
    StandingReadings,
    Way,
    WireAgainstSpeed,
)
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque
from winch_friction.physics.winch.operating_point import ChannelRanges

# Pa; friction alone asks for some bar to hoist an empty hook, and loops are boosted by ten and more. 1000 bar in kPa
# are less, and so is a dead sensor of which the atmosphere was taken off
LEAST_PRESSURE = 1.5e5
# of what the rated load asks for; zeros of transducers are a sixth of it, and so is what an acceleration that has only
# begun leaves of an empty hook's inertia in the middle of both ways
LEAST_PULL = 0.05
NONE_SAID = f"no pressure above {LEAST_PRESSURE / 1e5:g} bar while it hoists: not in Pa, or sensors without supply?"
EXCHANGED_SAID = "the drive torque pulls the load down, hoisting and lowering: are pressure_a and pressure_b exchanged?"


class DriveByItself:
    """Whether a winch hoists at no pressure, or its motors pull the load down whichever way it turns."""

    def __init__(self, crane: Crane, ranges: ChannelRanges) -> None:
        self._crane, self._moving = crane, AGAINST_SPEED * crane.speed_scale  # rad/s
        self._least = LEAST_PULL * 0.5 * ranges.load  # kg; the ranges leave twice the rated load
        self._none, self._exchanged = Doubt(TORQUE_TIME), Doubt(TORQUE_TIME)
        self._hoisting, self._lowering = Way(), Way()

    @property
    def pending(self) -> bool:
        """Whether something is wrong, though it may not be said yet: one way may tell before both were seen."""
        return self._none.pending or self._exchanged.pending or self._hoisting.drive < 0.0

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What cannot be after `dt` s more, in words, '' for nothing."""
        none = self._none.step(self._without_pressure(sample), dt)
        exchanged = self._exchanged.step(self._pulls_down(sample, dt), dt)
        if none:
            return NONE_SAID
        return EXCHANGED_SAID if exchanged else ""

    def _without_pressure(self, sample: Sample) -> bool | None:
        """None where it does not hoist: lowering, a pressure drop alone passes through nothing."""
        shown = [p for each in sample.groups.values() for p in (each.pressure_a, each.pressure_b)]
        if not shown or not sample.motor_speed > self._moving or any(map(math.isnan, shown)):
            return None
        return max(map(abs, shown)) < LEAST_PRESSURE

    def _pulls_down(self, sample: Sample, dt: float) -> bool | None:
        """Whether the middle of both ways, without friction and inertia, is plainly no load's; None of some motors:
        those that are not shown may hold it."""
        groups, crane = sample.groups, self._crane
        torque = sample_drive_torque(sample, crane) if groups and self._all(sample) else math.nan
        if not abs(sample.motor_speed) > self._moving or not math.isfinite(torque):
            return None
        (self._hoisting if sample.motor_speed > 0.0 else self._lowering).step(0.0, torque, dt)
        if min(self._hoisting.known, self._lowering.known) < LEAST_KNOWN or not crane.drum.has(sample.wire_layer):
            return None
        least = crane.drum_torque(self._least, sample.wire_layer) / crane.gear_ratio  # N m
        return 0.5 * (self._hoisting.drive + self._lowering.drive) < -least

    def _all(self, sample: Sample) -> bool:
        return self._crane.motor_total(tuple(sample.groups)) >= max(self._crane.groups.values())


def watches(crane: Crane, ranges: ChannelRanges) -> tuple[StandingReadings, WireAgainstSpeed, DriveByItself]:
    """What both services ask of every sample beside its load."""
    moving = AGAINST_SPEED * crane.speed_scale
    return StandingReadings(moving), WireAgainstSpeed(crane, ranges), DriveByItself(crane, ranges)
