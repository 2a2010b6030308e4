"""What must hold at every published torque, checked as it is published."""

import math
from collections import Counter
from dataclasses import dataclass, field

from winch_friction.compensation import Feedforward

ROUNDING = 1e-6  # N m
# s beside the look-ahead: a held input's age, the doubt's patience, the fade, and two periods (docs/safety.md)
LONGEST_AGAINST = 0.1 + 0.1 + 0.1 + 0.05
# s; a node that published nothing for so long was stopped: what its last message does meanwhile is the consumer's duty
# (it lets go after its hold time), and the node answers for what it says from then on
STOPPED = 0.3
CLEAR = 5.0  # N m and rad/s: below it a torque or a motion has no sign worth speaking of


@dataclass
class Row:
    """What one kind of fault did at worst."""

    draws: int = 0
    largest: float = 0.0  # N m
    steepest: float = 0.0  # share of the slew limit
    to_zero: float = 0.0  # s from the fault's beginning until nothing was published any more, the longest
    unsafe: int = 0  # faults that silence an input and were obeyed for too long
    against: float = 0.0  # s of a torque against the motion, the longest
    said_active: int = 0  # still "active" a second after the beginning of such a fault
    violations: Counter[str] = field(default_factory=Counter)


@dataclass
class OutputWatch:
    """Follows what is published; `bound` N m, `slew` N m/s. Violations count into the row of the fault at hand."""

    bound: float
    slew: float
    torque: float = 0.0
    time: float = math.nan  # of the service's clock, s
    stamp: float = math.nan
    sequence: int = -1
    against_since: float = math.nan
    lead: float = 0.0  # s, the look-ahead
    blind: bool = False  # nothing shows the motion: what began so is timed, and no violation
    _excused: bool = field(default=False, init=False)

    def published(self, said: Feedforward, now: float, speed: float, row: Row) -> None:
        """One published torque at `now` s while the shaft truly turns at `speed` rad/s."""
        torque = said.friction_torque
        if not (math.isfinite(torque) and math.isfinite(said.speed)):
            row.violations["not finite"] += 1
            return
        row.largest = max(row.largest, abs(torque))
        if abs(torque) > self.bound + ROUNDING:
            row.violations["beyond the bound"] += 1
        if self.time == self.time:
            self._slewed(torque, said.time, now, row)
        self._against(torque, now, speed, row)
        self.torque, self.time, self.stamp = torque, now, said.time

    def _slewed(self, torque: float, stamp: float, now: float, row: Row) -> None:
        """A pair of messages lies as far apart as its stamps or its arrivals, whichever is more."""
        passed = max(now - self.time, stamp - self.stamp, 0.0)
        change = abs(torque - self.torque)
        if change > self.slew * passed + ROUNDING:
            row.violations["faster than the slew limit"] += 1
        if passed > 0.0:
            row.steepest = max(row.steepest, change / (self.slew * passed))

    def _against(self, torque: float, now: float, speed: float, row: Row) -> None:
        if now - self.time > STOPPED:
            self.against_since, self._excused = math.nan, self.blind
        if torque * speed < 0.0 and abs(torque) > CLEAR and abs(speed) > CLEAR:
            self.against_since = now if math.isnan(self.against_since) else self.against_since
            row.against = max(row.against, now - self.against_since)
            self._excused = self._excused or self.blind
            if now - self.against_since > self.lead + LONGEST_AGAINST and not self._excused:
                row.violations["against the motion"] += 1
        else:
            self.against_since, self._excused = math.nan, self.blind
