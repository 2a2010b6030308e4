"""How long a contradiction must last before it counts, and how long an agreement before it is over."""

import math
from dataclasses import dataclass, field

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
