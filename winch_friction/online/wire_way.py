"""Whether the speed and the wire that is paid out are one motion: of one unit, one direction and one way.

A speed and a command that stand with noise, are both off by a zero error or have both lost their sign follow no wire,
and no unit or direction can be told of them: the friction of one way was fed forward through every wave, for good.
"""

import math
from collections import deque
from dataclasses import dataclass, field
from itertools import pairwise

from winch_friction.physics.winch.crane import Crane

# s that are looked at, in thirds: the mean over 13 s moves little with a wave, however slowly the counter follows it
SPAN = 40.0
LEAST_SHOWN = 0.5  # m that a living counter comes and goes; a dead one wanders less, and its noise is told by its steps
LEAST_GONE = 1.0  # m, some steps of any counter
# times that one may be the other: falls, a layer or a gear ratio that is not the crane's. Revolutions a minute are 9.5
MOST_APART = 3.0
# of all the way that the speed goes, either way: what it may go further one way than the wire. A counter slips by some
# per cent, a layer that was just left is a fifteenth, and a filter makes a twentieth of a haul; a zero error goes on
MOST_ASTRAY = 0.125
LEAST_HALF = 0.25  # of that, in each half of the span: what is late goes ahead, and falls back again


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
        if wire < LEAST_SHOWN:
            return ""
        if gone >= max(LEAST_GONE, MOST_APART * wire):
            return f"it goes on for {gone:.2g} m, where the wire comes and goes by {wire:.2g} m"
        return self._astray()

    def _astray(self) -> str:
        """How far the speed goes one way where the wire, which follows it closely both ways, does not, or ''."""
        ways, wires = ([b - a for a, b in pairwise(each[k] for each in self._seen)] for k in (1, 2))
        way, wire, count = sum(ways), sum(wires), len(ways)
        squares = sum(each * each for each in wires)
        of_ways = sum(each * each for each in ways) - way * way / count  # about their means, m2
        of_wires = squares - wire * wire / count
        both = sum(a * b for a, b in zip(ways, wires, strict=True)) - way * wire / count
        hoisted = sum(min(each, 0.0) ** 2 for each in wires)
        if not EACH_WAY * squares <= hoisted <= (1.0 - EACH_WAY) * squares:
            return ""
        if not both > CLOSELY * math.sqrt(max(of_ways * of_wires, 0.0)) > 0.0:
            return ""
        times, half = math.sqrt(of_ways / of_wires), count // 2
        early, late = (sum(ways[part]) - times * sum(wires[part]) for part in (slice(half), slice(half, None)))
        goes_on = early * late > 0.0 and min(abs(early), abs(late)) > LEAST_HALF * abs(early + late)
        if not goes_on or abs(early + late) < max(LEAST_GONE, MOST_ASTRAY * sum(map(abs, ways))):
            return ""
        return f"it goes {abs(early + late):.2g} m further one way than the wire: a zero error?"

    def _shown(self) -> float:
        """m that a living counter came and went by; 0 of one that stands by now, or whose steps are noise."""
        shown = [each[2] for each in self._seen]
        steps = [b - a for a, b in pairwise(shown)]
        follow = sum(a * b for a, b in pairwise(steps))
        return max(shown) - min(shown) if follow > 0.0 else 0.0

    def _goes_on(self, time: float) -> float:
        """m between the middles of the first and the last third: a wave hardly moves them."""
        third = SPAN / 3.0
        first = [gone for t, gone, _ in self._seen if t - self._seen[0][0] < third]
        last = [gone for t, gone, _ in self._seen if time - t < third]
        return abs(sum(last) / len(last) - sum(first) / len(first))


# -- the ways of both, from one reading to the next
WIRE_MEMORY = 20.0  # s of motion remembered
LEAST_WAY, LEAST_STEPS = 1.0, 8  # m of wire, some steps of any counter, and comparisons: a few always lie on a line
FOLLOWS = 0.8  # correlation from which one moves as the other does: of a wire that is a tenth of a wave late
# correlation from which a filter, or noise, makes one no more than 1.05 times the other: its size goes as its cosine.
# A layer that was said one too far or too late is a tenth; slip, stretch and a drum's radius are some per cent
CLOSELY, NEARLY = 0.95, 1.3
# and where the wire comes and goes, by this share of the motion either way at least: what is late does not follow then,
# as it does while a winch gets going. Finest steps that the wire goes in the mean of the comparisons: each is off by
# one at most, by half of that in the mean
EACH_WAY, COUNTS = 0.1, 2.0
OTHER_FALLS = ", or the hook hangs in other falls"


class WireWays:
    """Remembers how far the speed, at most `largest` rad/s, and the wire went between two readings of the counter.

    `wrong`: whether they cannot be one motion, None where it is not known, and `how`, in words; `last`, the reading in
    m that is compared with, and `finest`, the smallest step that the counter showed, m.
    """

    def __init__(self, crane: Crane, largest: float) -> None:
        self._crane, self._largest, self.way, self.how = crane, largest, WireWay(), ""
        self.begin(math.nan)

    def begin(self, reading: float) -> None:
        """Compare from a reading on, m, without what was summed up before."""
        self.wrong: bool | None = None
        self.last, self.finest, self._steps = reading, math.inf, 0  # comparisons
        self._speeds = self._wires = self._both = self._gone = 0.0  # sums of squares and of products, m2; m
        self._weight = self._hoisted = 0.0  # comparisons that are remembered; m2 of hoisting
        self.way.forget()

    def compare(self, time: float, reading: float, layer: float, turned: float, passed: float) -> None:
        """One step more, in `passed` s: the counter in m, the motor in rad. A counter that was set, or shows nothing,
        begins anew."""
        wire, drum = reading - self.last, self._crane.drum
        lever = drum.radius(layer) / self._crane.gear_ratio if drum.has(layer) else 0.0  # m/rad
        if not abs(wire) <= lever * self._largest * passed:  # NaN as well
            self.begin(reading)
            return
        kept, way = math.exp(-passed / WIRE_MEMORY), -lever * turned
        self._speeds = self._speeds * kept + way * way
        self._wires = self._wires * kept + wire * wire
        self._both = self._both * kept + way * wire
        self._gone, self._steps = self._gone * kept + max(abs(way), abs(wire)), self._steps + 1
        self._weight, self._hoisted = self._weight * kept + 1.0, self._hoisted * kept + min(way, 0.0) ** 2
        goes_on = self.way.step(time, way, reading)
        self.last, self.wrong = reading, bool(goes_on) or self._differ(layer)
        self.how = goes_on or self.how

    def _differ(self, layer: float) -> bool | None:
        """Whether the two are not one motion; None where the wire does not follow, or too little of it is known."""
        size = math.sqrt(self._speeds * self._wires)
        known = self._gone >= LEAST_WAY and self._steps >= LEAST_STEPS
        if not known or size == 0.0 or abs(self._both) < FOLLOWS * size:
            return None
        times, turned = math.sqrt(self._speeds / self._wires), self._both < 0.0
        counts = self._wires >= self._weight * (COUNTS * self.finest) ** 2  # not rounding
        apart = times > MOST_APART or (times < 1.0 / MOST_APART and counts)
        self.how = f"it is {times:.2g} times as large{'' if apart else OTHER_FALLS}"
        self.how = "it turns the wrong way" if turned else self.how
        if turned or apart or 1.0 / NEARLY <= times <= NEARLY * self._inner(layer):
            return turned or apart
        both_ways = EACH_WAY * self._speeds <= self._hoisted <= (1.0 - EACH_WAY) * self._speeds
        return True if both_ways and counts and self._both >= CLOSELY * size else None

    def _inner(self, layer: float) -> float:
        """How many times too large the speed seems where nobody says that the wire lies on an inner layer."""
        radii = self._crane.drum.layer_radii
        return max(radii) / min(radii) if layer != layer else 1.0
