"""Whether the speed goes on one way while the wire that is paid out comes and goes.

A speed and a command that stand with noise, are both off by a zero error or have both lost their sign follow no wire,
and no unit or direction can be told of them: the friction of one way was fed forward through every wave, for good.
"""

import math
from collections import deque
from dataclasses import dataclass, field

# s that are looked at, in thirds: the mean over 13 s moves little with a wave, however slowly the counter follows it
SPAN = 40.0
LEAST_SHOWN = 0.5  # m that a living counter comes and goes; a dead one wanders less, and its noise is told by its steps
LEAST_GONE = 1.0  # m, some steps of any counter
# times that one may be the other: falls, a layer or a gear ratio that is not the crane's. Revolutions a minute are 9.5
MOST_APART = 3.0


@dataclass
class WireWay:
    """Readings of the counter at about one a second: when, s, how far the speed had gone, and what it showed, m."""

    _seen: deque[tuple[float, float, float]] = field(default_factory=deque, init=False)
    gone: float = field(default=0.0, init=False)  # m, by the speed, since it began

    def forget(self) -> None:
        """The counter was set, or nobody knows how far it went."""
        self._seen.clear()
        self.gone = 0.0

    def step(self, time: float, way: float, shown: float) -> str:
        """What cannot be after `way` m more, by the speed, at which the counter shows `shown` m, in words, or ''."""
        seen = self._seen
        self.gone += way
        seen.append((time, self.gone, shown))
        while time - seen[0][0] > SPAN:
            seen.popleft()
        if time - seen[0][0] < 0.9 * SPAN or not math.isfinite(self.gone):
            return ""
        wire = self._shown()
        gone = self._goes_on(time)
        if wire < LEAST_SHOWN or gone < max(LEAST_GONE, MOST_APART * wire):
            return ""
        return f"it goes on for {gone:.2g} m, where the wire comes and goes by {wire:.2g} m"

    def _shown(self) -> float:
        """m that a living counter came and went by; 0 of one that stands by now, or whose steps are noise."""
        shown = [each[2] for each in self._seen]
        steps = [b - a for a, b in zip(shown, shown[1:], strict=False)]
        follow = sum(a * b for a, b in zip(steps, steps[1:], strict=False))
        return max(shown) - min(shown) if follow > 0.0 else 0.0

    def _goes_on(self, time: float) -> float:
        """m between the middles of the first and the last third: a wave hardly moves them."""
        third = SPAN / 3.0
        first = [gone for t, gone, _ in self._seen if t - self._seen[0][0] < third]
        last = [gone for t, gone, _ in self._seen if time - t < third]
        return abs(sum(last) / len(last) - sum(first) / len(first))
