"""How long a contradiction must last before it counts, and how long an agreement before it is over; whether readings
live; and whether the speed and the wire can be of one machine (load and drive torque: `load_against_drive`).

A controller that hangs may go on sending what it read last, with new stamps, for ever. One sensor that stands still may
have nothing to say; all that tell of the drive together, to the last digit, cannot while the winch turns: pumps
pulsate, pistons pass, transducers and encoders have noise and steps.
"""

import math
from dataclasses import dataclass, field

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import ChannelRanges

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
# of the largest speed: no drive turns so evenly that its speed is the same to that for a second. Encoder counts and
# whole revolutions are coarser, and may well stand: two of their steps differ by a whole one, or by rounding. So many
# finer differences show that a speed has more digits than they
FINE, ROUNDING, FINE_SEEN = 1e-4, 1e-9, 20
SPEED_SAID = "motor_speed stands still while the winch turns: a sender that hangs?"


class StandingReadings:
    """Whether everything that was measured, or a speed of many digits alone, stands still although the winch turns, or
    is told to, faster than `moving` rad/s."""

    def __init__(self, moving: float) -> None:
        self._moving, self._last = moving, Sample(math.nan, math.nan)
        self._doubt, self._speed = Doubt(PATIENCE), Doubt(PATIENCE)
        # of the speed: the last step and the largest, rad/s; how often its steps told that it has digits
        self._step, self._largest, self._fine = math.nan, 0.0, 0

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        last, self._last = self._last, sample
        stand = sample.motor_speed == last.motor_speed and _readings(sample) == _readings(last)
        speed = self._speed.step(self._hangs(sample.motor_speed, sample.motor_speed - last.motor_speed), dt)
        if self._doubt.step(self._tells(sample) if stand else False, dt):
            return SAID
        return SPEED_SAID if speed else ""

    def _hangs(self, speed: float, step: float) -> bool | None:
        """Whether a speed, so many rad/s from the last, stands that never stood; None of one at rest, or of few
        digits."""
        self._largest = max(self._largest, abs(speed))  # NaN is not larger
        moves = abs(speed) > self._moving
        self._fine += moves and ROUNDING * self._largest < abs(step - self._step) < FINE * self._largest
        self._step = step
        if step != 0.0:  # NaN as well
            return False
        return True if moves and self._fine >= FINE_SEEN else None

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


# -- the speed and the wire that is paid out
# s between two readings that are compared (a counter has steps and comes late), of motion remembered, until it counts
WIRE_STEP, WIRE_MEMORY, WIRE_TIME = 1.0, 20.0, 2.0
LEAST_WAY, LEAST_STEPS = 1.0, 8  # m of wire, some steps of any counter, and comparisons: a few always lie on a line
FOLLOWS = 0.8  # correlation from which one moves as the other does: of a wire that is a tenth of a wave late
# times that one may be the other: falls, a layer or a gear ratio that is not the crane's. Revolutions a minute are 9.5
MOST_APART = 3.0


class WireAgainstSpeed:
    """Whether the speed has the unit and the direction that the wire shows; a command of the same program has both."""

    def __init__(self, crane: Crane, ranges: ChannelRanges) -> None:
        self._crane, self._largest, self._moving = crane, ranges.speed, AGAINST_SPEED * crane.speed_scale  # rad/s
        self._doubt, self._how, self._time = Doubt(WIRE_TIME), "", math.nan
        self._begin(math.nan)

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What does not fit after `dt` s more, in words, '' for nothing."""
        passed, self._time = sample.time - self._time, sample.time
        self._passed += passed
        self._turned += sample.motor_speed * passed
        if not 0.0 <= passed <= LONGEST_SPAN:  # over a gap nobody knows how far it turned
            self._begin(sample.wire_out)
        elif self._passed >= WIRE_STEP and sample.wire_out != self._last:
            self._compare(sample)
        wrong = self._wrong if abs(sample.motor_speed) > self._moving else None
        return f"motor_speed contradicts wire_out: {self._how}" if self._doubt.step(wrong, dt) else ""

    def _begin(self, reading: float) -> None:
        """Compare from a reading on, m, without what was summed up before."""
        self._wrong: bool | None = None
        self._last, self._turned, self._passed = reading, 0.0, 0.0
        self._speeds = self._wires = self._both = 0.0  # sums of squares and of products, m2
        self._gone, self._steps = 0.0, 0  # m, comparisons

    def _compare(self, sample: Sample) -> None:
        """One step more of both ways; a counter that was set, or shows nothing, begins anew."""
        wire, drum = sample.wire_out - self._last, self._crane.drum
        lever = drum.radius(sample.wire_layer) / self._crane.gear_ratio if drum.has(sample.wire_layer) else 0.0  # m/rad
        if not abs(wire) <= lever * self._largest * self._passed:  # NaN as well
            self._begin(sample.wire_out)
            return
        kept, way = math.exp(-self._passed / WIRE_MEMORY), -lever * self._turned
        self._speeds = self._speeds * kept + way * way
        self._wires = self._wires * kept + wire * wire
        self._both = self._both * kept + way * wire
        self._gone, self._steps = self._gone * kept + max(abs(way), abs(wire)), self._steps + 1
        self._last, self._turned, self._passed, self._wrong = sample.wire_out, 0.0, 0.0, self._differ()

    def _differ(self) -> bool | None:
        """Whether the two are not one motion; None where the wire does not follow, or too little of it is known."""
        size = math.sqrt(self._speeds * self._wires)
        known = self._gone >= LEAST_WAY and self._steps >= LEAST_STEPS
        if not known or size == 0.0 or abs(self._both) < FOLLOWS * size:
            return None
        times, turned = math.sqrt(self._speeds / self._wires), self._both < 0.0
        self._how = "it turns the wrong way" if turned else f"it is {times:.2g} times as large"
        return turned or not 1.0 / MOST_APART <= times <= MOST_APART
