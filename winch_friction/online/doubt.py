"""How long a contradiction must last before it counts, and how long an agreement before it is over; and whether the
readings live.

A controller that hangs may go on sending what it read last, with new stamps, for ever. One sensor that stands still may
have nothing to say; all that tell of the drive together, to the last digit, cannot while the winch turns: pumps
pulsate, pistons pass, transducers and encoders have noise and steps.
"""

import math
from dataclasses import dataclass, field

from winch_friction.physics.signals import Sample

LONGEST_SPAN = 0.1  # s between two samples that count: a gap shows nothing
FORGOTTEN = 30.0  # s that show nothing, longer than half of any wave: what was wrong before, and did not count, is over
CALM = 1.0  # s of agreement, where something is to be seen, before a doubt ends


@dataclass
class Doubt:
    """A contradiction that counts after `patience` s and is over after `calm` s of agreement.

    What was wrong before counts on until it was right for `forgiven` s.
    """

    patience: float
    calm: float = CALM
    forgiven: float = 0.0
    _wrong: float = field(default=0.0, init=False)
    _right: float = field(default=0.0, init=False)
    _unseen: float = field(default=0.0, init=False)  # s that showed nothing since it was wrong
    stands: bool = field(default=False, init=False)

    @property
    def pending(self) -> bool:
        """Whether something was wrong last, though it may not count yet."""
        return self.stands or self._wrong > 0.0

    def step(self, wrong: bool | None, dt: float) -> bool:
        """Whether it counts, after `dt` s more that were wrong, right, or (None) showed nothing."""
        if wrong:
            self._wrong, self._right, self._unseen = self._wrong + dt, 0.0, 0.0
        elif wrong is None:
            self._unseen += dt
            if self._unseen > FORGOTTEN:
                self._wrong = self._wrong if self.stands else 0.0
        else:
            self._right += dt
            self._wrong = self._wrong if self._right < self.forgiven else 0.0
        self.stands = self._wrong >= self.patience or (self.stands and self._right < self.calm)
        return self.stands


def span(last: float, time: float) -> float:
    """The seconds between two stamps that count for a doubt: none after a jump back, a tenth at most of a gap."""
    return min(max(time - last, 0.0), LONGEST_SPAN) if math.isfinite(time - last) else 0.0


# -- readings that stand still
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
