"""Latest-sample hold: inputs that arrive one by one become the `Sample` that belongs to a speed measurement.

The rule is by stamps, not by arrival: a sample at time t takes from every channel the newest value stamped no later
than t, and NaN when that value is older than the channel's maximum age. So a node and a replay of its bag see the same
samples although the messages of different topics never arrive in exactly the same order twice.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from math import isfinite

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GROUP_CHANNELS, NAN, SAMPLE_SCALARS, GroupSample, Sample

DEFAULT_MAX_AGE = 0.1  # s
# slowly varying channels may be older; DESIGN section 4 leaves them optional
SLOW_MAX_AGES = {"hook_load": 2.0, "oil_temperature": 60.0, "wire_layer": 10.0, "wire_out": 2.0}
_DEPTH = 64  # values kept per channel: 0.3 s at 200 Hz, more than any skew between channels
_HELD_SCALARS = tuple(name for name in SAMPLE_SCALARS if name != "motor_speed")


class InputHold:
    """The newest value of every channel, by its stamp.

    `groups` names the motor groups; `max_ages` overrides the maximum age in s by channel (a run's column name, e.g.
    `active.pressure_a`) or, for a channel of any group, by its short name; `default_max_age` holds for the rest.
    Raises `InputError` for unknown channels and ages that are not above zero.
    """

    def __init__(
        self,
        groups: Sequence[str] = (),
        max_ages: Mapping[str, float] | None = None,
        default_max_age: float = DEFAULT_MAX_AGE,
    ) -> None:
        self.groups = tuple(groups)
        self.channels = _HELD_SCALARS + tuple(f"{g}.{channel}" for g in self.groups for channel in GROUP_CHANNELS)
        self._held = {channel: _Held() for channel in self.channels}
        self._max_ages = self._ages_by_channel(max_ages or {}, default_max_age)

    def _ages_by_channel(self, given: Mapping[str, float], default: float) -> dict[str, float]:
        known = {*self.channels, *GROUP_CHANNELS}
        for name, age in (*given.items(), ("default", default)):
            if name not in known and name != "default":
                raise InputError(f"max_age: channel '{name}' is not known; known are {', '.join(sorted(known))}")
            if not age > 0.0:
                raise InputError(f"max_age: {name} must be above 0 s, found {age}")
        ages = {**SLOW_MAX_AGES, **given}
        return {each: ages.get(each, ages.get(each.rpartition(".")[2], default)) for each in self.channels}

    def put(self, channel: str, stamp: float, value: float) -> bool:
        """Take one value stamped in s; False when it is not finite and was therefore left out."""
        if not (isfinite(value) and isfinite(stamp)):
            return False
        self._held[channel].put(stamp, value)
        return True

    def sample(self, time: float, motor_speed: float) -> Sample:
        """The sample that belongs to a speed measured at `time`; absent and too old channels are NaN."""
        held, ages = self._held, self._max_ages
        values = {name: held[name].at(time, ages[name]) for name in _HELD_SCALARS}
        groups = {g: GroupSample(*(held[name].at(time, ages[name]) for name in _group_columns(g))) for g in self.groups}
        return Sample(time=time, motor_speed=motor_speed, groups=groups, **values)

    def ages(self, time: float) -> dict[str, float]:
        """Age in s at `time` of every channel that was ever received; infinite when it was received only later."""
        return {name: held.age(time) for name, held in self._held.items() if held.stamps}

    def max_age(self, channel: str) -> float:
        """The channel's maximum age in s."""
        return self._max_ages[channel]

    def reset(self) -> None:
        """Forget everything, as after a jump of the clock."""
        for held in self._held.values():
            held.stamps.clear()
            held.values.clear()


def _group_columns(group: str) -> tuple[str, ...]:
    return tuple(f"{group}.{channel}" for channel in GROUP_CHANNELS)


class _Held:
    """The last few values of one channel, ordered by stamp."""

    __slots__ = ("stamps", "values")

    def __init__(self) -> None:
        self.stamps: list[float] = []
        self.values: list[float] = []

    def put(self, stamp: float, value: float) -> None:
        at = len(self.stamps) if not self.stamps or stamp >= self.stamps[-1] else bisect_right(self.stamps, stamp)
        self.stamps.insert(at, stamp)
        self.values.insert(at, value)
        if len(self.stamps) > _DEPTH:
            del self.stamps[0], self.values[0]

    def at(self, time: float, max_age: float) -> float:
        index = self._index(time)
        return self.values[index] if index >= 0 and time - self.stamps[index] <= max_age else NAN

    def age(self, time: float) -> float:
        index = self._index(time)
        return time - self.stamps[index] if index >= 0 else float("inf")

    def _index(self, time: float) -> int:
        if self.stamps and self.stamps[-1] <= time:
            return len(self.stamps) - 1
        return bisect_right(self.stamps, time) - 1
