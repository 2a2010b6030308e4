"""What whoever uses the torque must do: hold it no longer than said, and then let it go (docs/safety.md)."""

import math
from dataclasses import dataclass, field

from winch_friction.online.compensator import read_mark

HOLD_TIME = 0.1  # s that a torque may be held without another one
FADE_TIME = 0.5  # s in which it is then let go
RETURN_TIME = 0.2  # s in which it comes back after a silence


@dataclass
class HeldTorque:
    """The torque that is applied, N m: the last one that came, held, let go, and taken up again without a step.

    One that stands already when the consumer begins is taken up the same way.

    An `invalid` torque is a ramp to zero: it is followed, but not held beyond the next that is due. A torque that is
    not a number, larger than `largest` N m (what the crane's compensator may say at all), or that came before (by its
    number), is no message at all.
    """

    hold_time: float = HOLD_TIME
    fade_time: float = FADE_TIME
    largest: float = math.inf
    torque: float = field(default=0.0, init=False)  # the last one that came
    _came: float = field(default=-math.inf, init=False)  # s
    _number: int = field(default=-1, init=False)
    _gain: float = field(default=1.0, init=False)
    _gained: float = field(default=-math.inf, init=False)

    def take(self, torque: float, now: float, text: str = "") -> bool:
        """A torque that came at `now` s with the text of its header; False when it is ignored."""
        valid, number = read_mark(text)
        silent = now - self._came > self.hold_time
        if not abs(torque) <= self.largest or not math.isfinite(torque) or (0 <= number <= self._number and not silent):
            return False
        if self._came == -math.inf:
            self._gain = 0.0 if torque else 1.0
        self._update(now)
        self.torque, self._came, self._number = torque, now, number
        return True

    def value(self, now: float) -> float:
        """What is applied at `now` s."""
        self._update(now)
        return self.torque * self._gain

    def _update(self, now: float) -> None:
        """The share of the last torque that is applied: less with its age, more while torques come."""
        passed = max(0.0, now - self._gained) if math.isfinite(self._gained) else 0.0
        age = now - self._came
        self._gained = now
        if age > self.hold_time:
            self._gain = max(0.0, self._gain - min(passed, age - self.hold_time) / self.fade_time)
        else:
            self._gain = min(1.0, self._gain + passed / RETURN_TIME)

    def clear(self) -> None:
        """Nothing came yet."""
        self.torque, self._came, self._number = 0.0, -math.inf, -1
        self._gain, self._gained = 1.0, -math.inf
