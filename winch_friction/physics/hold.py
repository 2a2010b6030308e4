"""Latest-sample hold with an age limit per input: what turns topics of their own rates into one `Sample`.

The speed drives: the node (or the replay of a bag) puts every value as it arrives and takes a sample at each speed. A
value older than its limit is handed out as NaN, so that whoever needs it sees that it is missing. Stamps decide, not
arrival: a sample shows the newest value stamped no later than itself, so that a node and the replay of its bag see the
same although the messages of different topics never arrive in quite the same order twice.
"""

import math
from bisect import bisect_right
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from winch_friction.physics.channels import GROUP_CHANNELS, SAMPLE_SCALARS, SLOW_INPUTS
from winch_friction.physics.plausible import limits, plausible
from winch_friction.physics.signals import GroupSample, Run, Sample

SIMULTANEOUS = 1e-6  # s; below it two stamps differ by their rounding alone (a Unix time has 2e-7 s)
DEPTH = 1024  # values kept per input: all that a node which was paused for five seconds at 200 Hz finds waiting


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
        lower, upper = limits(column)
        if not (lower <= value <= upper and math.isfinite(time)) or (held and time < held[-1][0]):
            return False
        if held is None:
            held = self._held[column] = deque(maxlen=DEPTH)
        held.append((time, value))
        return True

    def put_sample(self, sample: Sample) -> None:
        """Take every finite value of a sample at the sample's own time."""
        for name in SAMPLE_SCALARS:
            self.put(name, sample.time, getattr(sample, name))
        for group, member in sample.groups.items():
            if group not in self.groups:
                self.groups = (*self.groups, group)
            for channel in GROUP_CHANNELS:
                self.put(f"{group}.{channel}", sample.time, getattr(member, channel))

    def sample(self, time: float) -> Sample:
        """The winch at `time` s: every held value that is young enough, NaN elsewhere."""
        scalars = {name: self._value(name, time) for name in SAMPLE_SCALARS}
        members = {
            group: GroupSample(*[self._value(column, time) for column in group_columns(group)]) for group in self.groups
        }
        return Sample(time=time, groups=members, **scalars)

    def fill(self, sample: Sample) -> Sample:
        """`sample` with its holes filled by what is held; what it brings itself is never replaced."""
        self.put_sample(sample)
        held = self.sample(sample.time)
        for name in SAMPLE_SCALARS:
            _keep(sample, held, name)
        for group, member in sample.groups.items():
            for channel in GROUP_CHANNELS:
                _keep(member, held.groups[group], channel)
        return held

    def samples(self, run: Run) -> Iterator[Sample]:
        """A run's samples with NaN entries filled the same way."""
        if self.groups in ((), run.groups) and _without_holes(run):
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

    def _value(self, column: str, time: float) -> float:
        held = self._held.get(column)
        if not held:
            return math.nan
        latest = time + SIMULTANEOUS
        # the last one, unless a node that lags behind finds later ones waiting already
        place = len(held) if held[-1][0] <= latest else bisect_right(held, latest, key=_stamp)
        if not place:
            return math.nan
        stamp, value = held[place - 1]
        return value if time - stamp <= self.limit(column) else math.nan

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


def _without_holes(run: Run) -> bool:
    """Whether every channel of a run that is there says something plausible at every row: nothing is held then."""
    names = [name for name in SAMPLE_SCALARS if name in run] + [c for g in run.groups for c in group_columns(g)]
    return all(
        name in run and bool(((run[name] >= limits(name)[0]) & (run[name] <= limits(name)[1])).all()) for name in names
    )


def _stamp(held: tuple[float, float]) -> float:
    return held[0]


def _keep(own: Any, held: Any, name: str) -> None:
    value = getattr(own, name)
    if plausible(name, value):
        setattr(held, name, value)
