"""The friction parameters in the filter: scaled by the seed's sigma, around the seed, inside their range."""

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.seed_range import seed_range
from winch_friction.physics.signals import FloatArray


class ScaledParameters:
    """theta = seed + sigma * phi; the filter carries phi of the parameters whose seed has a sigma.

    The seed's covariance becomes the prior of phi, so that directions that the data do not excite stay at the seed.
    """

    def __init__(self, seed: FrictionModel, config: EstimatorConfig) -> None:
        self.seed = seed
        self.center = np.array(seed.values)
        std = seed.std if seed.covariance is not None else config.default_std * np.abs(self.center)
        self.free = np.flatnonzero(std > 0.0)
        self.scale = std[self.free]
        self.prior = self._prior(seed)
        limits = seed_range(seed, config.seed_range)
        span = np.array([limits[name] for name in seed.parameter_names]).reshape(-1, 2)
        self._limits = span
        self.lower = (span[self.free, 0] - self.center[self.free]) / self.scale
        self.upper = (span[self.free, 1] - self.center[self.free]) / self.scale

    @property
    def size(self) -> int:
        """Number of parameters in the filter."""
        return len(self.free)

    def _prior(self, seed: FrictionModel) -> FloatArray:
        if seed.covariance is None:
            return np.eye(self.size)
        scaled = seed.covariance[np.ix_(self.free, self.free)] / np.outer(self.scale, self.scale)
        return 0.5 * (scaled + scaled.T)

    def values(self, phi: FloatArray) -> FloatArray:
        """Parameter values, SI, all of them in the seed's order."""
        theta = self.center.copy()
        theta[self.free] += self.scale * phi
        return np.clip(theta, self._limits[:, 0], self._limits[:, 1])

    def covariance(self, scaled: FloatArray) -> FloatArray:
        """Covariance of all parameters, SI, from the filter's."""
        full = np.zeros((len(self.center), len(self.center)))
        full[np.ix_(self.free, self.free)] = np.outer(self.scale, self.scale) * 0.5 * (scaled + scaled.T)
        return full

    def projected(self, x: FloatArray, covariance: FloatArray) -> FloatArray:
        """The state (n, 1) with its last entries, phi, moved inside their range, the others along by their correlation.

        Simon, Optimal State Estimation, section 7.5: the constrained estimate of least distance in the filter's metric.
        """
        first = len(x) - self.size
        for _ in range(self.size):
            phi = x[first:, 0]
            excess = np.where(phi > self.upper, phi - self.upper, np.where(phi < self.lower, phi - self.lower, 0.0))
            worst = int(np.argmax(np.abs(excess)))
            variance = covariance[first + worst, first + worst]
            if excess[worst] == 0.0 or variance <= 0.0:
                break
            x = x - covariance[:, first + worst : first + worst + 1] * (excess[worst] / variance)
        x = x.copy()
        x[first:, 0] = np.clip(x[first:, 0], self.lower, self.upper)
        return x

    def at_limit(self, phi: FloatArray) -> FloatArray:
        """Which parameters stand at the edge of their range."""
        return (phi <= self.lower + 1e-9) | (phi >= self.upper - 1e-9)
