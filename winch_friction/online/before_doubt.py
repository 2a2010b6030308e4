"""What was learned before the inputs were doubted: published while they are, kept, and gone back to."""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from winch_friction.estimation import FrictionEstimator
from winch_friction.online.doubt import span
from winch_friction.online.wire_way import SPAN, WIRE_MEMORY
from winch_friction.physics.friction import FrictionModel

# s. A load that is off is blamed on the friction first: until the filter's load has followed, nothing seems wrong
UNSEEN = 5.0
# s. A speed is told from the wire by what both remember, of which three memories leave a twentieth, or over its span
WIRE_UNSEEN = max(3.0 * WIRE_MEMORY, SPAN)
MOST_LOOKS = round(WIRE_UNSEEN / UNSEEN) + 2  # the one that is older than that, and what is believed already


@dataclass(frozen=True)
class Learned:
    """What an estimator knew after `at` s of samples: its snapshot and its model."""

    at: float
    content: Mapping[str, Any]
    model: FrictionModel


class BeforeDoubt:
    """Looks at an estimator every `UNSEEN` s; what it knew is believed once as much time has passed without a doubt.

    Its seconds are those of samples that followed each other: a clock that was set, or a gap, shows nothing.
    """

    def __init__(self, law: FrictionEstimator) -> None:
        self._law = law
        self._earlier: deque[Learned] = deque(maxlen=MOST_LOOKS)  # what was believed, the latest last
        self._passed, self._time = 0.0, math.nan  # s of samples, whatever became of their clock; the last stamp
        self.begin()

    def begin(self) -> None:
        """Believe what the estimator knows now: the seed, or what a checkpoint held."""
        self._begun = self._look()
        self._next: Learned | None = None
        self._earlier.clear()

    @property
    def believed(self) -> Learned:
        """What is believed now."""
        return self._earlier[-1] if self._earlier else self._begun

    def go_back(self, seconds: float = math.inf) -> None:
        """Believe what was known `seconds` s of samples ago, or at the beginning, and nothing since."""
        while self._earlier and self._earlier[-1].at > self._passed - seconds:
            self._earlier.pop()
        self._next = None

    def step(self, time: float, doubted: bool) -> None:
        """One sample, stamped `time` s."""
        self._passed, self._time = self._passed + span(self._time, time), time
        if doubted:
            self._next = None
        elif self._next is None:
            self._next = self._look()
        elif self._passed - self._next.at >= UNSEEN:
            self._earlier.append(self._next)
            self._next = self._look()

    def _look(self) -> Learned:
        return Learned(self._passed, self._law.snapshot(), self._law.model())
