"""Whether a stamp may be believed: it advances, with the clock, and does not lie ahead of it."""

from dataclasses import dataclass, field
from enum import Enum

SLOWEST = 0.1  # of the clock's pace; stamps that advance less than this stand still
LONGEST_CATCH_UP = 1.0  # s of a pause that such stamps must make up for
BACKWARD_JUMP = 1.0  # s; what falls back by less is late or repeated
CONFIRMED_BY, CONFIRMED_AFTER = 5, 0.08  # messages, s: then another time is a clock that was set, not a stray stamp
ALIKE = 0.25  # s between offsets that show the same other clock


class Stamp(Enum):
    """What a stamp is worth."""

    GOOD = "good"
    REPEATED = "stamp stands still"
    AHEAD = "stamp ahead of the clock"
    BACK = "stamp far behind"
    JUMP = "the clock was set"


@dataclass
class StampWatch:
    """Judges the stamps of one input, s, by the steady clock, s.

    A stray stamp is refused; a clock that was set is believed after `CONFIRMED_BY` messages that agree. `window` s: how
    far a stamp may run ahead; `paced` False: stamps only need to advance, for time is simulated.
    """

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
            return Stamp.REPEATED
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
        if len(others) >= CONFIRMED_BY and now - others[0][1] >= CONFIRMED_AFTER:
            return self._believe(stamp, now, Stamp.JUMP)
        return worth
