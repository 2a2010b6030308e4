"""How large a residual is, how sure that is, and whether another one is smaller."""

from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS


@dataclass(frozen=True)
class Size:
    """A root mean square with its 95 % interval over redrawn runs and segments."""

    value: float
    interval: tuple[float, float]


def rms_with_interval(residual: FloatArray, segment: np.ndarray, run: np.ndarray, rng: np.random.Generator) -> Size:
    """RMS of block residuals; the interval redraws runs, and in them whole segments, because neighbours are alike."""
    if not len(residual):
        return Size(0.0, (0.0, 0.0))
    sums, counts, of_run = _by_segment(residual**2, segment, run)
    weights = _redrawn(of_run, rng)
    draws = np.sqrt((weights @ sums) / np.maximum(weights @ counts, 1.0))
    low, high = np.quantile(draws, LIMITS.interval)
    value = float(np.sqrt(sums.sum() / counts.sum()))
    return Size(value, (min(float(low), value), max(float(high), value)))


def chance_of_no_gain(
    before: FloatArray, after: FloatArray, segment: np.ndarray, run: np.ndarray, rng: np.random.Generator
) -> float:
    """How often redrawn segments show no reduction of the sum of squares from `before` to `after`; paired, so that what
    both have in common does not blur the difference.
    """
    if not len(before):
        return 1.0
    gains, _, of_run = _by_segment(before**2 - after**2, segment, run)
    weights = _redrawn(of_run, rng)
    return float((1 + np.sum(weights @ gains <= 0.0)) / (1 + len(weights)))


def _by_segment(values: FloatArray, segment: np.ndarray, run: np.ndarray) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Sums and counts per segment, and the run that each belongs to."""
    _, first, index = np.unique(segment, return_index=True, return_inverse=True)
    sums, counts = np.bincount(index, weights=values), np.bincount(index)
    return np.asarray(sums, float), np.asarray(counts, float), run[first]


def _redrawn(of_run: np.ndarray, rng: np.random.Generator) -> FloatArray:
    """How often each segment is drawn, shape (draws, segments).

    Runs with replacement, then segments in each; of a few runs, unlike by plan, each stays in and only its segments are
    redrawn: an interval over three unlike runs would hold anything.
    """
    runs, draws = np.unique(of_run), LIMITS.bootstrap_draws
    times = np.ones((draws, len(runs)), int)
    if len(runs) >= LIMITS.runs_to_redraw:
        times = rng.multinomial(len(runs), np.full(len(runs), 1.0 / len(runs)), size=draws)
    weights = np.zeros((draws, len(of_run)))
    for k, number in enumerate(runs):
        own = np.flatnonzero(of_run == number)
        drawn = rng.multinomial(times[:, k] * len(own), np.full(len(own), 1.0 / len(own)))
        weights[:, own] = drawn
    return weights
