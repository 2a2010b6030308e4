"""Whether a sender speaks with two voices: two messages of one instant, together, that say different things."""

import math
from collections.abc import Mapping
from typing import Any

from winch_friction.physics.winch.ranges import ChannelRanges
from winch_friction.records.topics import Input, stamp_time

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
        lower, upper = self._ranges.range(name)
        return max(abs(lower), abs(upper))
