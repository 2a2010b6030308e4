"""What was learned before the inputs were doubted: published while they are, kept, and gone back to."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from winch_friction.estimation import FrictionEstimator
from winch_friction.physics.friction import FrictionModel

# s. A load that is off is blamed on the friction first: until the filter's load has followed, nothing seems wrong
UNSEEN = 5.0


@dataclass(frozen=True)
class Learned:
    """What an estimator knew at `time` s: its snapshot and its model."""

    time: float
    content: Mapping[str, Any]
    model: FrictionModel


class BeforeDoubt:
    """Looks at an estimator every `UNSEEN` s; what it knew is believed once as much time has passed without a doubt."""

    def __init__(self, law: FrictionEstimator) -> None:
        self._law = law
        self.begin()

    def begin(self) -> None:
        """Believe what the estimator knows now: the seed, or what a checkpoint held."""
        self.believed = self._begun = self._look(math.nan)
        self._next: Learned | None = None

    def go_back(self) -> None:
        """Believe what was known at the beginning, and nothing since."""
        self.believed, self._next = self._begun, None

    def step(self, time: float, doubted: bool) -> None:
        """One sample, stamped `time` s."""
        if doubted:
            self._next = None
        elif self._next is None or time < self._next.time:
            self._next = self._look(time)
        elif time - self._next.time >= UNSEEN:
            self.believed, self._next = self._next, self._look(time)

    def _look(self, time: float) -> Learned:
        return Learned(time, self._law.snapshot(), self._law.model())
