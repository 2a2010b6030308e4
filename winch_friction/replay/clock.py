"""The clock of a replay: what a steady clock would have said when a recorded message came."""

import math
from dataclasses import dataclass, field

JITTER = 0.5  # s that a recorder on a busy machine may be late


@dataclass
class ReplayClock:
    """Follows the stamps as long as the receipts agree to `JITTER`, else the receipts; never goes back.

    A recorder is late now and then without the nodes having been; but where stamps stand still or jump, only the
    receipts say how much time passed. No recorder makes stamps leap ahead of their receipts, or go back: that is a
    clock that was set. The nodes' own steady one did not see it, and the stamps are followed on from there.
    """

    now: float = field(default=float("-inf"), init=False)
    _set: float = field(default=0.0, init=False)  # s by which the stamps' clock was set back since the beginning
    _last: tuple[float, float] = field(default=(math.nan, math.nan), init=False)  # stamp and receipt

    def read(self, stamp: float, receipt: float) -> float:
        """The time in s at a message with this stamp and receipt (on the stamps' clock)."""
        if stamp != stamp:
            believed = receipt
        else:
            gained, passed = stamp - self._last[0], receipt - self._last[1]  # NaN at first: no leap
            self._last = stamp, receipt
            if gained > max(passed, 0.0) + JITTER or gained < min(passed, 0.0) - JITTER:
                self._set += passed - gained
            believed = min(max(stamp + self._set, receipt - JITTER), receipt + JITTER)
        self.now = max(self.now, believed)
        return self.now
