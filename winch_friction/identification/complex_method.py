"""Box's complex method (Box 1965; Krus et al. 1991), as paper 2 section 2.4 states it.

A population of designs; in every iteration the worst one is mirrored through the centroid of the others with a factor
of 1.3. A mirrored design that is still the worst retracts towards the centroid and, failing that, the best design.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.signals import FloatArray

POPULATION = 36
REFLECTION = 1.3
_RETRACTIONS = 12


@dataclass(frozen=True)
class ComplexResult:
    """Best design (n,), its cost, how many cost evaluations all restarts took, and how many of them converged."""

    x: FloatArray
    cost: float
    evaluations: int
    restarts: int
    converged: int


def complex_method(
    cost: Callable[[Any], float],
    lower: FloatArray,
    upper: FloatArray,
    *,
    seed: int,
    population: int = POPULATION,
    reflection: float = REFLECTION,
    restarts: int = 3,
    max_evaluations: int = 20000,
    tolerance: float = 1e-9,
) -> ComplexResult:
    """Minimise `cost` inside the box; every restart draws a new population, the best of all is kept.

    A restart ends when the population's costs agree to `tolerance` (relative) or after `max_evaluations`.
    """
    generator = np.random.default_rng(seed)
    searches = [
        _Search(cost, lower, upper, population, generator).run(reflection, max_evaluations, tolerance)
        for _ in range(restarts)
    ]
    best = min(searches, key=lambda search: search.costs.min())
    return ComplexResult(
        x=best.designs[best.costs.argmin()].copy(),
        cost=float(best.costs.min()),
        evaluations=sum(search.evaluations for search in searches),
        restarts=restarts,
        converged=sum(search.converged for search in searches),
    )


class _Search:
    """One population and its costs."""

    def __init__(
        self,
        cost: Callable[[Any], float],
        lower: FloatArray,
        upper: FloatArray,
        population: int,
        generator: np.random.Generator,
    ) -> None:
        self.cost, self.lower, self.upper = cost, lower, upper
        self.designs = lower + (upper - lower) * generator.random((population, len(lower)))
        self.costs = np.array([cost(design) for design in self.designs])
        self.evaluations = population
        self.converged = False

    def run(self, reflection: float, max_evaluations: int, tolerance: float) -> "_Search":
        while self.evaluations < max_evaluations and not self.converged:
            self._mirror_worst(reflection)
            spread = self.costs.max() - self.costs.min()
            self.converged = bool(spread <= tolerance * max(abs(self.costs.min()), 1e-300))
        return self

    def _mirror_worst(self, reflection: float) -> None:
        worst = int(self.costs.argmax())
        centroid = (self.designs.sum(axis=0) - self.designs[worst]) / (len(self.designs) - 1)
        second_worst = np.partition(self.costs, -2)[-2]
        trial = np.clip(centroid + reflection * (centroid - self.designs[worst]), self.lower, self.upper)
        for attempt in range(_RETRACTIONS):
            value = self._evaluate(trial)
            if value < second_worst:
                break
            towards = centroid if attempt < _RETRACTIONS // 2 else self.designs[self.costs.argmin()]
            trial = 0.5 * (trial + towards)
        self.designs[worst], self.costs[worst] = trial, value

    def _evaluate(self, design: FloatArray) -> float:
        self.evaluations += 1
        return self.cost(design)
