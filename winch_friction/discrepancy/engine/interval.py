"""How large a residual is, and how sure that is."""

from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS


@dataclass(frozen=True)
class Size:
    """A root mean square with its 95 % interval over redrawn segments."""

    value: float
    interval: tuple[float, float]


def rms_with_interval(residual: FloatArray, segment: np.ndarray, rng: np.random.Generator) -> Size:
    """RMS of block residuals; the interval redraws whole segments, because neighbours are alike."""
    _, index = np.unique(segment, return_inverse=True)
    sums = np.bincount(index, weights=residual**2)
    counts = np.bincount(index).astype(float)
    weights = rng.multinomial(len(sums), np.full(len(sums), 1.0 / len(sums)), size=LIMITS.bootstrap_draws)
    draws = np.sqrt((weights @ sums) / (weights @ counts))
    low, high = np.quantile(draws, LIMITS.bootstrap_quantiles)
    return Size(float(np.sqrt(sums.sum() / counts.sum())), (float(low), float(high)))
