"""What is believed: a stamp, a sender of one voice, a drive, a command beside a speed; loads are in `doubt`."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from winch_friction.compensation.safe_output import AGAINST_SPEED, LONGEST_LAG
from winch_friction.online.doubt import Doubt, LoadAgainstDrive, SlowWave, StandingReadings, Way, WireAgainstSpeed, span
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, sample_drive_torque
from winch_friction.physics.winch.operating_point import SPEED_APART, SPEED_SHARE, ChannelRanges
from winch_friction.records.sample_stream import BACKWARD_JUMP
from winch_friction.records.topics import Input, stamp_time

# -- the stamp of a message
SLOWEST = 0.1  # of the clock's pace; stamps that advance less than this stand still
LONGEST_CATCH_UP = 1.0  # s of a pause that such stamps must make up for
# messages, s by their stamps: then another time is a clock that was set, not a stray stamp. Which message sets it must
# be found again by a replay, so that how late each came counts only against a burst: they came over CAME_OVER s, too
CONFIRMED_BY, CONFIRMED_AFTER, CAME_OVER = 5, 0.08, 0.05
ROUNDING = 1e-6  # s; a Unix time has 2e-7 s
ALIKE = 0.25  # s between offsets that show the same other clock


class Stamp(Enum):
    """What a stamp is worth."""

    GOOD = "good"
    REPEATED = "stamp stands still"
    LATE = "stamp before that of the last message"
    AHEAD = "stamp ahead of the clock"
    BACK = "stamp far behind"
    JUMP = "the clock was set"


@dataclass
class StampWatch:
    """Judges the stamps of one input, s, by the steady clock, s. A stray stamp is refused; a clock that was set is
    believed after `CONFIRMED_BY` messages that agree. `window` s: how far a stamp may run ahead; `paced` False: stamps
    only need to advance, for time is simulated."""

    window: float = 0.5
    paced: bool = True
    _stamp: float = field(default=float("nan"), init=False)
    _now: float = field(default=float("nan"), init=False)
    _other: list[tuple[float, float]] = field(default_factory=list, init=False)

    def judge(self, stamp: float, now: float) -> Stamp:
        """What this stamp, arriving at `now`, is worth; only GOOD and JUMP are believed."""
        if self._stamp != self._stamp:
            return self._believe(stamp, now, Stamp.GOOD)
        passed, gained = now - self._now, stamp - self._stamp
        if gained < -BACKWARD_JUMP:
            return self._doubt(stamp, now, Stamp.BACK)
        if gained > passed + self.window:
            return self._doubt(stamp, now, Stamp.AHEAD)
        slowest = SLOWEST * min(max(passed, 0.0), LONGEST_CATCH_UP) if self.paced else 0.0
        if gained <= 0.0 or gained < slowest:
            return Stamp.LATE if gained < 0.0 else Stamp.REPEATED
        return self._believe(stamp, now, Stamp.GOOD)

    def forget(self) -> None:
        """Believe the next stamp."""
        self._stamp = self._now = float("nan")
        self._other.clear()

    def _believe(self, stamp: float, now: float, worth: Stamp) -> Stamp:
        self._stamp, self._now = stamp, now
        self._other.clear()
        return worth

    def _doubt(self, stamp: float, now: float, worth: Stamp) -> Stamp:
        others = self._other
        if others and not (stamp > others[-1][0] and abs((now - stamp) - (others[0][1] - others[0][0])) < ALIKE):
            others.clear()
        others.append((stamp, now))
        advanced, came = stamp - others[0][0], now - others[0][1]
        if len(others) >= CONFIRMED_BY and advanced >= CONFIRMED_AFTER - ROUNDING and came >= CAME_OVER:
            return self._believe(stamp, now, Stamp.JUMP)
        return worth


# -- one sender
TOGETHER = 0.005  # s between copies: a sender whose stamps stand still comes a period apart, and is another matter
APART = 0.2  # of the larger value: what a coarse clock gives one stamp is nearer
NEAR = 0.02  # of a channel's reach: about zero, shares mean nothing
DOUBTED = 0.5  # s: neither is believed again before the torque has gone


class Voices:
    """Remembers the latest message of each topic; who contradicts himself is not believed for a while."""

    def __init__(self, ranges: ChannelRanges) -> None:
        self._ranges = ranges
        self._latest: dict[str, tuple[float, float, Any]] = {}
        self._doubted: dict[str, float] = {}

    def contradict(self, source: Input, message: Any, now: float) -> bool:
        """Whether a message, arriving at `now` s, contradicts the one before, or one a short while ago did."""
        stamp = stamp_time(message)
        last = self._latest.get(source.topic)
        self._latest[source.topic] = (stamp, now, message)
        copy = last is not None and last[0] == stamp and now - last[1] <= TOGETHER
        if copy and last is not None and self._differ(source.decode(last[2]), source.decode(message)):
            self._doubted[source.topic] = now
        return now - self._doubted.get(source.topic, -math.inf) < DOUBTED

    def forget(self) -> None:
        """Begin anew."""
        self._latest.clear()
        self._doubted.clear()

    def _differ(self, one: Mapping[str, float], other: Mapping[str, float]) -> bool:
        shared = one.keys() & other.keys()
        return any(
            abs(one[name] - other[name]) > max(APART * max(abs(one[name]), abs(other[name])), NEAR * self._reach(name))
            for name in shared
        )

    def _reach(self, name: str) -> float:
        return max(map(abs, self._ranges.range(name)))


# -- two senders
TURNS, TURNING = 4, 1.0  # to and fro, so many within so many s: a fifth of a second of a recording at 10 Hz is one
USUAL = 0.2  # of the largest speed, a second: what heave asks for (130 rad/s^2)
LATENESS = 0.1  # s that a network may let a message be late by


class Motions:
    """Whether speed and command tell of two motions in turn: a recording or a simulator beside the machine. Its stamps
    may be of the same clock or of another; nobody knows which of the two is the machine. The speed of a coarse encoder
    turns to and fro as well, but its command is smooth and its stamps are good."""

    def __init__(self, ranges: ChannelRanges) -> None:
        self._reach, self._usual = ranges.speed, USUAL * ranges.speed
        self._last: dict[str, tuple[float, float, float]] = {}  # stamp, value, the last jump
        self._turns: dict[str, list[float]] = {}
        self._seen = -math.inf

    def hear(self, column: str, stamp: float, value: float, now: float) -> None:
        """One reading, believed or not, arriving at `now` s."""
        before, last, jump = self._last.get(column, (stamp, value, 0.0))
        step, apart = value - last, abs(stamp - before)
        late = self._usual * min(apart, LATENESS) if apart < BACKWARD_JUMP else 0.0
        if abs(step) > max(APART * max(abs(value), abs(last)), NEAR * self._reach) + late:
            if step * jump < 0.0:
                self.note(now, column)
            jump = step
        if value == value:
            self._last[column] = stamp, value, jump

    def note(self, now: float, what: str = "stamps") -> None:
        """One more turn of a column, or a stamp that was refused."""
        self._turns[what] = [each for each in self._turns.get(what, ()) if 0.0 <= now - each < TURNING] + [now]

    def two(self, now: float) -> bool:
        """Whether there are two, or were a short while ago."""
        often = [what for what, times in self._turns.items() if sum(0.0 <= now - t < TURNING for t in times) >= TURNS]
        self._seen = now if "motor_speed" in often and len(often) > 1 else self._seen
        return 0.0 <= now - self._seen < DOUBTED


# -- the drive by itself
# Pa; loops are boosted by ten bar and more. 1000 bar in kPa are less, and so is a dead sensor less the atmosphere
LEAST_PRESSURE = 1.5e5
# of what the rated load asks for; zeros of transducers are a sixth of it, and so is what an acceleration that has only
# begun leaves of an empty hook's inertia in the middle of both ways
LEAST_PULL = 0.05
PULL_TIME, PULL_KNOWN = 1.0, 5.0  # s until either counts; s of motion each way, half a wave of 10 s
LEAST_STROKE = 0.005  # of the largest: half of what the motors' own bearings take at the rated pressure (K4 of 14 N m)
NONE_SAID = f"no pressure above {LEAST_PRESSURE / 1e5:g} bar while it hoists: not in Pa, or sensors without supply?"
SWUNG_SAID = f"no displacement above {LEAST_STROKE:.1%} while it hoists: a feedback without supply, or another unit?"
EXCHANGED_SAID = "the drive torque pulls the load down, hoisting and lowering: are pressure_a and pressure_b exchanged?"


class DriveByItself:
    """Whether a winch hoists at no pressure or no stroke, or its motors pull the load down whichever way it turns; no
    load and no model is asked. A crane without a load cell fed forward the friction of an empty hook then, `valid`."""

    def __init__(self, crane: Crane, ranges: ChannelRanges) -> None:
        self._crane, self._motors = crane, max(crane.groups.values(), default=0)
        self._moving, self._stroke = AGAINST_SPEED * crane.speed_scale, LEAST_STROKE * crane.max_displacement
        self._least = LEAST_PULL * 0.5 * ranges.load  # kg; the ranges leave twice the rated load
        # a stroke that sets the torque passes through zero with every wave, for 1.3 s at most
        self._nearly, self._swung = Doubt(0.5 * PULL_KNOWN), Doubt(PULL_KNOWN)
        self._hoisting, self._lowering, self._none, self._exchanged = Way(), Way(), Doubt(PULL_TIME), Doubt(PULL_TIME)

    @property
    def pending(self) -> bool:
        """Whether something is wrong, though it may not be said yet: one way may tell before both were seen."""
        return self._none.pending or self._exchanged.pending or self._hoisting.drive < 0.0 or self._nearly.stands

    def contradiction(self, sample: Sample, dt: float) -> str:
        """What cannot be after `dt` s more, in words, '' for nothing."""
        pressures = [p for each in sample.groups.values() for p in (each.pressure_a, each.pressure_b)]
        strokes = [each.displacement for each in sample.groups.values()] if self._whole(sample) else []
        none = self._none.step(self._hoists_below(sample, pressures, LEAST_PRESSURE), dt)
        still = self._hoists_below(sample, strokes, self._stroke)
        swung = [each.step(still, dt) for each in (self._nearly, self._swung)]
        exchanged = self._exchanged.step(self._pulls_down(sample, dt), dt)
        return NONE_SAID if none else SWUNG_SAID if swung[1] else EXCHANGED_SAID if exchanged else ""

    def _whole(self, sample: Sample) -> bool:
        """Whether all motors are shown: others may hold the load."""
        return bool(sample.groups) and self._crane.motor_total(tuple(sample.groups)) >= self._motors

    def _hoists_below(self, sample: Sample, shown: Sequence[float], least: float) -> bool | None:
        """None where it does not hoist: lowering, a pressure drop alone passes through nothing."""
        if not shown or not sample.motor_speed > self._moving or any(map(math.isnan, shown)):
            return None
        return max(map(abs, shown)) < least

    def _pulls_down(self, sample: Sample, dt: float) -> bool | None:
        """Whether the middle of both ways, without friction and inertia, is plainly no load's; None of some motors."""
        crane = self._crane
        torque = sample_drive_torque(sample, crane) if self._whole(sample) else math.nan
        if not abs(sample.motor_speed) > self._moving or not math.isfinite(torque):
            return None
        (self._hoisting if sample.motor_speed > 0.0 else self._lowering).step(0.0, torque, dt)
        if min(self._hoisting.known, self._lowering.known) < PULL_KNOWN or not crane.drum.has(sample.wire_layer):
            return None
        least = crane.drum_torque(self._least, sample.wire_layer) / crane.gear_ratio  # N m
        return 0.5 * (self._hoisting.drive + self._lowering.drive) < -least


# -- the inputs beside each other
SPEED_TIME = 0.5  # s that the command and the speed may be apart
CHATTER_STEP, CHATTER_COUNT, CHATTER_TIME = 0.1, 4, 0.5  # jumps of this share of the largest speed, so many, within s


class Agreement:
    """Cross-checks one sample after the other; says which inputs contradict each other. `lead` s: how far the command
    may be ahead of the speed; `load` kg: the one that was set, where none is measured; `calm` s of agreement end a
    doubt about the command: the slow part of each wave shows some, whatever is wrong."""

    def __init__(self, crane: Crane, ranges: ChannelRanges, lead: float = 0.0, load: float = math.nan,
                 calm: float = Doubt.calm) -> None:  # fmt: skip
        self._crane, self._ranges, self.lead, self.load, self._calm = crane, ranges, lead, load, calm
        self.forget()

    def forget(self) -> None:
        """Another time begins."""
        self._time = self._now = self._command = self._step = math.nan
        self._jumps: list[float] = []
        crane, ranges = self._crane, self._ranges
        self._slow, standing = (kind(AGAINST_SPEED * crane.speed_scale) for kind in (SlowWave, StandingReadings))
        self._load = LoadAgainstDrive(crane, ranges)
        self._watches = self._load, standing, WireAgainstSpeed(crane, ranges), DriveByItself(crane, ranges)
        # messages in batches: a command that is right in one sample of each is none
        self._speeds, self._turns = Doubt(SPEED_TIME, self._calm), Doubt(LONGEST_LAG, self._calm, LONGEST_LAG)

    def contradictions(self, sample: Sample, now: float = math.nan) -> tuple[str, ...]:
        """What does not fit, in a few words each. `now` s: when it came, by the steady clock; stamps that advance
        slowly must not stretch the patience."""
        passed = (sample.time - self._time, now - self._now)
        dt = max(span(0.0, each) for each in passed) if self._time == self._time else 0.0
        self._time, self._now = sample.time, now
        self._load.assumed = self.load
        watched = [each.contradiction(sample, dt) for each in self._watches]
        jumps = "speed_reference jumps to and fro: two publishers?" if self._chatters(sample) else ""
        return tuple(filter(None, (*self.beside(sample, dt), *watched, jumps)))

    def beside(self, sample: Sample, dt: float) -> tuple[str, ...]:
        """What of command and speed does not fit after `dt` s more, in a few words each."""
        self._turns.patience = self.lead + LONGEST_LAG
        found = {
            "speed_reference turns against motor_speed": self._turns.step(self._turns_against(sample), dt),
            "speed_reference contradicts motor_speed": self._speeds.step(self._speeds_differ(sample), dt),
            self._slow.contradiction(sample, dt): True,
        }
        return tuple(name for name, stands in found.items() if name and stands)

    def _speeds_differ(self, sample: Sample) -> bool | None:
        command, speed = sample.speed_reference, sample.motor_speed
        large = max(abs(command), abs(speed))
        if not large > SPEED_APART * self._ranges.speed:  # true for NaN
            # too slow to contradict each other; but a doubt of before may be over, and no faster sea come for days
            moves = large > AGAINST_SPEED * self._crane.speed_scale
            return False if self._speeds.stands and moves and abs(command - speed) <= SPEED_SHARE * large else None
        return abs(command - speed) > SPEED_SHARE * large + SPEED_APART * self._ranges.speed

    def _chatters(self, sample: Sample) -> bool:
        step = sample.speed_reference - self._command
        if step * self._step < 0.0 and min(abs(step), abs(self._step)) > CHATTER_STEP * self._ranges.speed:
            self._jumps.append(sample.time)
        self._command = sample.speed_reference
        if step != 0.0:  # a command that is held has not turned back
            self._step = step
        self._jumps = [each for each in self._jumps if 0.0 <= sample.time - each < CHATTER_TIME]
        return len(self._jumps) >= CHATTER_COUNT

    def _turns_against(self, sample: Sample) -> bool | None:
        least = AGAINST_SPEED * self._crane.speed_scale
        if not (abs(sample.motor_speed) > least and abs(sample.speed_reference) > 0.0):  # NaN as well
            return None
        return sample.motor_speed * sample.speed_reference < 0.0
