"""Do the readings live: a controller that hangs may go on sending what it read last, with new stamps, for ever.

One sensor that stands still may have nothing to say; all that tell of the drive together, to the last digit, cannot
while the winch turns: pumps pulsate, pistons pass, transducers and encoders have noise and steps.
"""

import math

from winch_friction.online.doubt import Doubt
from winch_friction.physics.signals import Sample

# s; what comes is at most half a second old (`compensation.config.OLDEST_INPUT`): twice that is no slow sender
PATIENCE = 1.0
SAID = "all readings of the drive stand still while it turns: a sender that hangs?"


class StandingReadings:
    """Whether everything that was measured stands still although the winch turns, or is told to, faster than `moving`
    rad/s."""

    def __init__(self, moving: float) -> None:
        self._moving, self._last = moving, Sample(math.nan, math.nan)
        self._doubt = Doubt(PATIENCE)

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        last, self._last = self._last, sample
        stand = sample.motor_speed == last.motor_speed and _readings(sample) == _readings(last)
        return SAID if self._doubt.step(self._tells(sample) if stand else False, dt) else ""

    def _tells(self, sample: Sample) -> bool | None:
        """Whether readings that stand still are wrong; None of a winch at rest, or of one without a torque."""
        turns = max(abs(sample.motor_speed), abs(sample.speed_reference)) > self._moving
        return True if turns and _has_torque(sample) else None


def _has_torque(sample: Sample) -> bool:
    known = (sample.motor_torque, sample.mechanical_power, sample.motor_current)
    return bool(sample.groups) or any(math.isfinite(each) for each in known)


def _readings(sample: Sample) -> tuple[object, ...]:
    """All that was measured, so that equal ones compare equal where some are missing."""
    scalars = (
        sample.motor_torque, sample.mechanical_power, sample.motor_current, sample.hook_load, sample.rope_force,
        sample.heave_velocity, sample.wire_out, sample.shaft_angle, sample.load_torque,
    )  # fmt: skip
    groups = [(each.pressure_a, each.pressure_b, each.displacement) for each in sample.groups.values()]
    return tuple(None if each != each else each for values in (scalars, *groups) for each in values)
