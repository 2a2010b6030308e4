"""Readings beyond what the crane can show, again and again: then those within its range are not believed either.

A speed in revolutions a minute, or pressures that count double, are refused at the crest of a wave and looked like
readings in its flanks: a torque of five times the friction came and went with each wave.
"""

import math
from dataclasses import dataclass, field

# s beyond the range at a stretch, which no spike lasts (nine steps at 50 Hz, one at 5 Hz); s within which a second
# stretch tells, and until all of it is over: longer than any wave
STRETCH, AGAIN = 0.19, 30.0
# channels whose range leaves a quarter and more beside what the crane can do. A feedback or a load cell may be some per
# cent off and pass its end with each wave, and is refused there alone
WIDE = frozenset(("motor_speed", "speed_reference", "pressure_a", "pressure_b"))
WORDS = "beyond the crane's range again and again: another unit? Not believed until it was within for 30 s"


@dataclass
class _Way:
    """Of one column, by its stamps in s: the first and the last of the stretch at hand, where the last long one ended,
    and until when nothing is believed."""

    begin: float = math.nan
    last: float = math.nan
    ended: float = -math.inf
    until: float = -math.inf

    @property
    def long(self) -> bool:
        """Whether the stretch at hand is no spike."""
        return self.last - self.begin >= STRETCH  # false for NaN


@dataclass
class BeyondRange:
    """What went beyond its range, by column; empty for a sound machine."""

    ways: dict[str, _Way] = field(default_factory=dict)

    def note(self, column: str, stamp: float) -> None:
        """A reading beyond the range, stamped in s."""
        if column.rpartition(".")[2] not in WIDE:
            return
        way = self.ways.setdefault(column, _Way())
        way.begin, way.last = way.begin if way.begin <= stamp else stamp, stamp  # NaN: the first of a stretch
        if (way.long and way.begin - way.ended < AGAIN) or stamp < way.until:
            way.until = stamp + AGAIN

    def refusal(self, column: str, stamp: float) -> str:
        """Why a reading within the range, stamped in s, is not believed; '' for one that is."""
        way = self.ways.get(column)
        if way is None:
            return ""
        way.ended, way.begin = way.last if way.long else way.ended, math.nan
        return WORDS if stamp < way.until else ""
