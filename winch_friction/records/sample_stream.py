"""From messages to samples: what a node does with its inputs, without the node.

The latest value of every input is held, with an age limit each. The speed drives: the node (or the replay of a bag)
puts every value as it arrives and takes a sample at each speed. A value older than its limit is handed out as NaN, so
that whoever needs it sees that it is missing. Stamps decide, not arrival: a sample shows the newest value stamped no
later than itself, so that a node and the replay of its bag see the same although the messages of different topics never
arrive in quite the same order twice.
"""

import math
from bisect import bisect_right
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from operator import itemgetter
from typing import Any

import numpy as np

from winch_friction.physics.channels import GROUP_CHANNELS, SAMPLE_SCALARS, SLOW_INPUTS, in_unit, limits_of, outside
from winch_friction.physics.signals import FloatArray, GroupSample, Run, Sample, shown_columns, without_holes
from winch_friction.physics.winch.operating_point import Change, ChannelRanges
from winch_friction.records.beyond import BeyondRange
from winch_friction.records.topics import Input, TopicMap, stamp_time

# -- holding
SIMULTANEOUS = 1e-6  # s; below it two stamps differ by their rounding alone (a Unix time has 2e-7 s)
DEPTH = 1024  # values kept per input: all that a node which was paused for five seconds at 200 Hz finds waiting
NOTHING = math.nan, math.nan  # stamp and value of an input that shows nothing
NO_GROUP = GroupSample()  # ... of a motor group that a sample does not have
MOST_STROKE = 2.0  # of max_displacement: a feedback in per cent shows more, and no scale that is off so much


@dataclass
class InputHold:
    """Holds the latest value of every input.

    `groups`: the motor groups that a sample must show, present or not. `max_age` s for every input that `max_ages`
    does not name (by column, `active.pressure_a`, or by channel, `pressure_a`).
    """

    groups: tuple[str, ...] = ()
    max_age: float = 0.1
    max_ages: Mapping[str, float] = field(default_factory=lambda: dict(SLOW_INPUTS))

    def __post_init__(self) -> None:
        self._held: dict[str, deque[tuple[float, float]]] = {}
        self._limits: dict[str, float] = {}
        self._limits_of: tuple[float, Mapping[str, float]] = self.max_age, self.max_ages

    def put(self, column: str, time: float, value: float) -> bool:
        """Take a value with its stamp in s; False when it is implausible or older than what is held, and so ignored."""
        held = self._held.get(column)
        lower, upper = limits_of(column)
        if not (lower <= value <= upper and math.isfinite(time)) or (held and time < held[-1][0]):
            return False
        if held is None:
            held = self._held[column] = deque(maxlen=DEPTH)
        held.append((time, value))
        return True

    def sample(self, time: float) -> Sample:
        """The winch at `time` s: every held value that is young enough, NaN elsewhere."""
        scalars = {name: self._value(name, time) for name in SAMPLE_SCALARS}
        members = {
            group: GroupSample(*[self._value(column, time) for column in group_columns(group)]) for group in self.groups
        }
        return Sample(time=time, groups=members, **scalars)

    def fill(self, sample: Sample) -> Sample:
        """`sample` with its holes filled by what is held; what it brings itself is held, and never replaced."""
        for group in sample.groups:
            if group not in self.groups:
                self.groups = (*self.groups, group)
        time, take = sample.time, self._take
        scalars = {name: take(name, time, getattr(sample, name)) for name in SAMPLE_SCALARS}
        members = {}
        for group in self.groups:
            own, columns = sample.groups.get(group, NO_GROUP), group_columns(group)
            members[group] = GroupSample(
                *[take(column, time, getattr(own, name)) for column, name in zip(columns, GROUP_CHANNELS, strict=True)]
            )
        return Sample(time=time, groups=members, **scalars)

    def _take(self, column: str, time: float, value: float) -> float:
        """A value that is held from now on; what is held, where it is one that no sensor can mean."""
        self.put(column, time, value)
        lower, upper = limits_of(column)
        return value if lower <= value <= upper else self._value(column, time)

    def samples(self, run: Run) -> Iterator[Sample]:
        """A run's samples with NaN entries filled the same way."""
        if self.groups in ((), run.groups) and without_holes(run):
            yield from run.samples()
            return
        for sample in run.samples():
            yield self.fill(sample)

    def ages(self, time: float) -> dict[str, float]:
        """Age in s of every input that was ever seen."""
        return {column: max(0.0, time - held[-1][0]) for column, held in self._held.items()}

    def reset(self) -> None:
        """Forget everything, after a jump of the clock."""
        self._held.clear()

    def stamp(self, column: str, time: float) -> float:
        """Stamp in s of what a sample at `time` s shows of a column; NaN for nothing."""
        return self._found(column, time)[0]

    def drop_after(self, time: float) -> None:
        """Forget every input whose latest stamp is later than this, s: nothing newer would ever take its place."""
        for column in [column for column, held in self._held.items() if held[-1][0] > time]:
            del self._held[column]

    def _value(self, column: str, time: float) -> float:
        stamp, value = self._found(column, time)
        return value if time - stamp <= self.limit(column) else math.nan

    def _found(self, column: str, time: float) -> tuple[float, float]:
        held = self._held.get(column)
        if not held:
            return NOTHING
        latest = time + SIMULTANEOUS
        # the last one, unless a node that lags behind finds later ones waiting already
        place = len(held) if held[-1][0] <= latest else bisect_right(held, latest, key=itemgetter(0))
        return held[place - 1] if place else NOTHING

    def limit(self, column: str) -> float:
        """Age in s beyond which a value of this column is lost."""
        max_age, max_ages = self._limits_of
        if max_age != self.max_age or max_ages is not self.max_ages:  # other settings
            self._limits.clear()
            self._limits_of = self.max_age, self.max_ages
        found = self._limits.get(column)
        if found is None:
            by_channel = self.max_ages.get(column.rpartition(".")[2], self.max_age)
            found = self._limits[column] = self.max_ages.get(column, by_channel)
        return found


@lru_cache(maxsize=256)
def group_columns(group: str) -> tuple[str, ...]:
    return tuple(f"{group}.{channel}" for channel in GROUP_CHANNELS)


# -- what of a reading is believed
UNKNOWN_AFTER = 1.0  # s without an accepted value: then the first one in range is believed, however far it is


@dataclass
class Plausibility:
    """Judges single readings; keeps the last accepted one of each column."""

    ranges: ChannelRanges
    _last: dict[str, tuple[float, float]] = field(default_factory=dict, init=False)
    _known: dict[str, tuple[float, float, Change | None]] = field(default_factory=dict, init=False)
    _beyond: BeyondRange = field(default_factory=BeyondRange, init=False)

    def refusal(self, column: str, stamp: float, value: float) -> str:
        """Why a reading is not believed, in a few words; empty when it is."""
        if value != value:
            return "no number"
        if column not in self._known:
            self._known[column] = (*self.ranges.range(column), self.ranges.change(column))
        lower, upper, change = self._known[column]
        if not lower <= value <= upper:
            self._beyond.note(column, stamp)
            return outside(column, value, lower, upper)
        if self._beyond.ways and (again := self._beyond.refusal(column, stamp)):
            return again
        if change is not None:
            last = self._last.get(column)
            if last is not None and self._too_fast(change, stamp - last[0], value - last[1]):
                return f"{in_unit(column, value)} is {abs(value - last[1]):.3g} from the last"
            self._last[column] = (stamp, value)
        return ""

    def believes(self, column: str, time: FloatArray, values: FloatArray) -> bool:
        """Whether `refusal` would say nothing of any of these readings, (samples,), the first being the first."""
        lower, upper = self.ranges.range(column)
        if column in self._last or not ((values >= lower) & (values <= upper)).all():  # false for NaN
            return False
        change, passed = self.ranges.change(column), np.diff(time)
        if change is None:
            return True
        most = change.at_once + change.per_second * np.maximum(passed, 0.0)
        near = (passed > -UNKNOWN_AFTER) & (passed < UNKNOWN_AFTER)
        return not bool((near & (np.abs(np.diff(values)) > most)).any())

    def believes_whole(self, run: Run) -> bool:
        """Whether every channel shows at every row of a run what is believed; those that it lacks it may lack."""
        return without_holes(run) and all(self.believes(each, run.time, run[each]) for each in shown_columns(run))

    def _too_fast(self, change: Change, passed: float, difference: float) -> bool:
        if not -UNKNOWN_AFTER < passed < UNKNOWN_AFTER:
            return False
        return abs(difference) > change.at_once + change.per_second * max(passed, 0.0)

    def forget(self) -> None:
        """Another time begins."""
        self._last.clear()
        self._beyond.ways.clear()


# -- from messages to samples
# s; who sent so much later than a speed that came after it goes by another machine's clock: what waits for a node that
# was paused (`DEPTH`) is nearer
OTHER_CLOCK = 10.0
BACKWARD_JUMP = 1.0  # s; stamps that fall behind by more are a new recording, not a late message


class SampleStream:
    """Holds every message's readings and makes one sample at each speed.

    `on_jump` is called when the speed's stamps fall back by more than `BACKWARD_JUMP`, before the sample is made;
    what is held is dropped first. A message without a stamp counts as measured at the next speed sent after it:
    clocks of different processes would place it differently, the order of sending does not. `admit` says of a column,
    its stamp and its value whether it may be held; `on_held` hears of every column whose value was.
    """

    def __init__(
        self, topics: TopicMap, hold: InputHold, on_jump: Callable[[], None] = lambda: None,
        admit: Callable[[str, float, float], bool] = lambda *_: True, on_held: Callable[[str], None] = lambda _: None,
    ) -> None:  # fmt: skip
        self.topics, self.hold = topics, hold
        self._on_jump, self._admit, self._on_held = on_jump, admit, on_held
        self.counts: Counter[str] = Counter()
        self.rejected: Counter[str] = Counter()
        self.last_stamp = float("-inf")
        self._unstamped: dict[str, deque[tuple[float, Input, Any]]] = {}

    def take(self, source: Input, message: Any, receipt: float, sent: float | None = None) -> Sample | None:
        """Hold what a message says; the sample, if it was a speed.

        `receipt` s stamps a speed without a header; `sent` orders messages of all topics (default: `receipt`).
        """
        sent = receipt if sent is None else sent
        if source.topic == self.topics.speed_topic:
            return self.take_speed(source, message, stamp_time(message) if source.stamped else receipt, sent)
        if source.stamped:
            self.put(source, stamp_time(message), message)
        else:
            self.put_off(source, message, sent)
        return None

    def put_off(self, source: Input, message: Any, sent: float) -> None:
        """Keep a message without a stamp until the next speed sent after it; of one topic the latest `DEPTH`."""
        self._unstamped.setdefault(source.topic, deque(maxlen=DEPTH)).append((sent, source, message))

    def take_speed(self, source: Input, message: Any, stamp: float, sent: float) -> Sample | None:
        """The sample at a speed's stamp in s; None where the message shows none."""
        if stamp < self.last_stamp - BACKWARD_JUMP:
            self.forget()
            self._on_jump()
        if not self.put(source, stamp, message):
            return None
        self._date_unstamped(stamp, sent)
        self.last_stamp = stamp
        return self.hold.sample(stamp)

    def _date_unstamped(self, stamp: float, sent: float) -> None:
        for waiting in self._unstamped.values():
            while waiting and not sent < waiting[0][0] <= sent + OTHER_CLOCK:
                self.put(waiting[0][1], stamp, waiting.popleft()[2])

    def forget(self) -> None:
        """Drop what is held, after a jump of time."""
        self.hold.reset()
        self._unstamped = {}
        self.last_stamp = float("-inf")

    def put(self, source: Input, stamp: float, message: Any) -> bool:
        """Hold what a message with this stamp in s says; whether its first channel was believed."""
        taken: bool | None = None
        for channel, value in source.decode(message).items():
            possible = self._admit(channel, stamp, value) and self._within_stroke(channel, value)
            accepted = possible and self.hold.put(channel, stamp, value)
            if accepted:
                self._on_held(channel)
            taken = accepted if taken is None else taken
        self.counts[source.topic] += 1
        if not taken:
            self.rejected[source.topic] += 1
        return bool(taken)

    def _within_stroke(self, column: str, value: float) -> bool:
        """Whether it is no displacement that the motors do not have, as far as those are known."""
        full = self.topics.max_displacement
        return not (full and column.endswith(".displacement")) or abs(value) <= MOST_STROKE * full
