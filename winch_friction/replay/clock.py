"""The clock of a replay: what a steady clock would have said when a recorded message came."""

from dataclasses import dataclass, field

JITTER = 0.5  # s that a recorder on a busy machine may be late


@dataclass
class ReplayClock:
    """Follows the stamps as long as the receipts agree to `JITTER`, else the receipts; never goes back.

    A recorder is late now and then without the nodes having been; but where stamps stand still or jump, only the
    receipts say how much time passed.
    """

    now: float = field(default=float("-inf"), init=False)

    def read(self, stamp: float, receipt: float) -> float:
        """The time in s at a message with this stamp and receipt (on the stamps' clock)."""
        believed = min(max(stamp, receipt - JITTER), receipt + JITTER) if stamp == stamp else receipt
        self.now = max(self.now, believed)
        return self.now
