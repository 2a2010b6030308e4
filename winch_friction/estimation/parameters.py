"""The friction parameters in the filter: scaled by the seed's sigma, around the seed, inside their range."""

import math
from collections.abc import Iterable
from operator import le

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.seed_range import seed_range
from winch_friction.physics.signals import FloatArray

# of a direction, in squared sigmas of the seed: where a fit saw nothing, or a file's digits end, it is zero or below
LEAST_VARIANCE = 1e-9
# a deviation as wide as its range says already that nothing is known; with a thousand times as much a filter of ten
# parameters loses the digits that keep its covariance one (replayed: sound with 100, refused with 1000)
WIDEST_STD = 10.0  # ranges


class ScaledParameters:
    """theta = seed + sigma * phi; the filter carries phi of the parameters whose seed has a sigma.

    The seed's covariance becomes the prior of phi, so that directions that the data do not excite stay at the seed; of
    a sigma far beyond the parameter's range it takes as much as says that nothing is known, with the correlations.
    """

    def __init__(self, seed: FrictionModel, config: EstimatorConfig) -> None:
        self.seed = seed
        self.center = np.array(seed.values)
        std = seed.std if seed.covariance is not None else config.default_std * np.abs(self.center)
        self.free = np.flatnonzero(std > 0.0)
        ranges = np.array([seed.bounds_of(name) for name in seed.parameter_names]).reshape(-1, 2)
        self.scale = np.minimum(std, WIDEST_STD * (ranges[:, 1] - ranges[:, 0]))[self.free]
        self._centers, self._free, self._scales = self.center.tolist(), self.free.tolist(), self.scale.tolist()
        self._forgetting_time = config.forgetting_time
        self.seed_prior = self._prior(seed)
        self.prior = self.seed_prior
        self.widened: tuple[int, ...] = ()
        limits = seed_range(seed, config.seed_range)
        span = np.array([limits[name] for name in seed.parameter_names]).reshape(-1, 2)
        self._limits = span
        self.lower = (span[self.free, 0] - self.center[self.free]) / self.scale
        self.upper = (span[self.free, 1] - self.center[self.free]) / self.scale
        # the sigma of equal belief within the range, in sigmas of the seed and no less than one
        self.range_factor = np.maximum(1.0, (self.upper - self.lower) / math.sqrt(12.0))
        self._lows, self._highs = self.lower.tolist(), self.upper.tolist()

    @property
    def size(self) -> int:
        """Number of parameters in the filter."""
        return len(self.free)

    def _prior(self, seed: FrictionModel) -> FloatArray:
        if seed.covariance is None:
            return np.eye(self.size)
        own = seed.std[self.free]
        scaled = seed.covariance[np.ix_(self.free, self.free)] / np.outer(own, own)
        scaled = 0.5 * (scaled + scaled.T)
        values, directions = np.linalg.eigh(scaled)
        if values.min(initial=LEAST_VARIANCE) >= LEAST_VARIANCE:
            return scaled
        return np.asarray((directions * np.maximum(values, LEAST_VARIANCE)) @ directions.T)

    def widen(self, reached: Iterable[int]) -> None:
        """Take the seed's sigma back for these (by their place in phi), besides those taken back before.

        A refuted sigma says nothing; what is left is the range around the seed, and equal belief within it has a sigma
        of its half width over sqrt(3). Correlations stay.
        """
        self.widened = tuple(sorted({*self.widened, *reached}))
        factor, chosen = np.ones(self.size), list(self.widened)
        factor[chosen] = self.range_factor[chosen]
        self.prior = self.seed_prior * np.outer(factor, factor)

    def widen_named(self, names: Iterable[str]) -> None:
        """The same by name."""
        places = {self.seed.parameter_names[free]: place for place, free in enumerate(self.free.tolist())}
        self.widen([places[name] for name in names if name in places])

    def widen_only(self, names: Iterable[str]) -> None:
        """The same, the seed's sigma of all others believed again."""
        self.widened = ()
        self.widen_named(names)

    @property
    def widened_names(self) -> tuple[str, ...]:
        """Names of the parameters whose sigma was taken back."""
        return tuple(self.seed.parameter_names[self.free[k]] for k in self.widened)

    def values(self, phi: FloatArray) -> FloatArray:
        """Parameter values, SI, all of them in the seed's order."""
        theta = self.center.copy()
        theta[self.free] += self.scale * phi
        return np.clip(theta, self._limits[:, 0], self._limits[:, 1])

    def theta(self, phi: FloatArray) -> list[float]:
        """`values` as plain floats for parameters inside their range: what every step evaluates."""
        theta = self._centers.copy()
        for k, scale, value in zip(self._free, self._scales, phi.tolist(), strict=True):
            theta[k] += scale * value
        return theta

    def covariance(self, scaled: FloatArray) -> FloatArray:
        """Covariance of all parameters, SI, from the filter's."""
        full = np.zeros((len(self.center), len(self.center)))
        full[np.ix_(self.free, self.free)] = np.outer(self.scale, self.scale) * 0.5 * (scaled + scaled.T)
        return full

    def std(self, scaled: FloatArray) -> list[float]:
        """Standard deviations of all parameters, SI, from the filter's covariance; zero where it has none."""
        full = np.zeros(len(self.center))
        full[self.free] = self.scale * np.sqrt(scaled.diagonal())
        return full.tolist()

    def contains(self, phi: FloatArray) -> bool:
        """Whether every scaled parameter is inside its range."""
        values = phi.tolist()
        return all(map(le, self._lows, values)) and all(map(le, values, self._highs))

    def faded(self, covariance: FloatArray, duration: float) -> FloatArray:
        """What takes a covariance (m, m) towards the seed's in `duration` s, and never beyond it.

        (1 - share) P + share P_seed: a direction that was not learned has P = P_seed and gets nothing.
        """
        return min(1.0, duration / self._forgetting_time) * (self.prior - covariance)

    def projected(self, x: FloatArray, covariance: FloatArray, first: int) -> FloatArray:
        """The state (n,) with phi, from `first` on, moved inside its range, the others along by their correlation.

        Simon, Optimal State Estimation, section 7.5: the constrained estimate of least distance in the filter's metric.
        """
        last = first + self.size
        for _ in range(self.size):
            phi = x[first:last]
            excess = np.where(phi > self.upper, phi - self.upper, np.where(phi < self.lower, phi - self.lower, 0.0))
            worst = int(np.argmax(np.abs(excess)))
            variance = covariance[first + worst, first + worst]
            if excess[worst] == 0.0 or variance <= 0.0:
                break
            x = x - covariance[:, first + worst] * (excess[worst] / variance)
        x = x.copy()
        x[first:last] = np.clip(x[first:last], self.lower, self.upper)
        return x

    def at_limit(self, phi: FloatArray) -> FloatArray:
        """Which parameters stand at the edge of their range."""
        return (phi <= self.lower + 1e-9) | (phi >= self.upper - 1e-9)
