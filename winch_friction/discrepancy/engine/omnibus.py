"""Is anything left that no named effect explains, and on which signal does it depend?

A flexible model of one signal at a time, for each direction of motion, predicts the remainder of runs that it was not
fitted to: hat functions, or a straight line for signals of which each run has hardly more than one value. It has no
name to offer, so it only ever leads to 'unexplained'.
"""

from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks
from winch_friction.discrepancy.engine.crossfit import CrossFit, flip_p_values
from winch_friction.discrepancy.thresholds import LIMITS


@dataclass(frozen=True)
class Dependence:
    """How much of the remainder one signal predicts on held-out runs."""

    signal: str
    share: float  # of the remainder's sum of squares
    p_value: float
    size: float = float("inf")  # RMS of what it predicts, in the gap's unit


def dependences(cross: CrossFit, left: FloatArray, rng: np.random.Generator) -> list[Dependence]:
    """Every signal with what it predicts of the remainder on held-out runs, the best first; p-values are
    family-wise."""
    blocks = cross.problem.blocks
    names, gains = [], []
    for name, values in blocks.features.items():
        for design in _designs(values, blocks.direction):
            names.append(name)
            gains.append(_segment_gains(design, left, blocks, cross.fold))
    if not names:
        return []
    table = np.array(gains)
    p = flip_p_values(table, rng)
    total = float((left**2).sum()) + cross.unresolved
    unit = float(np.mean(blocks.weight**-2.0)) / len(left)  # from noises to the gap's unit, squared
    found = [
        Dependence(n, float(row.sum() / total), float(q), float(np.sqrt(max(row.sum(), 0.0) * unit)))
        for n, row, q in zip(names, table, p, strict=True)
    ]
    better: dict[str, Dependence] = {}
    for each in sorted(found, key=lambda each: -each.share):
        better.setdefault(each.signal, each)
    return list(better.values())


def _designs(values: FloatArray, direction: FloatArray) -> list[FloatArray]:
    """Hats over the quantiles of a signal and a straight line, hoisting and lowering apart; where the signal is absent,
    nothing."""
    good = np.isfinite(values)
    if good.sum() < 20 or np.ptp(values[good]) <= 1e-9 * (np.abs(values[good]).max() + 1e-12):
        return []
    line = np.column_stack([np.ones(len(values)), (values - values[good].mean()) / np.std(values[good])])
    knots = np.unique(np.quantile(values[good], np.linspace(0.0, 1.0, LIMITS.knots)))
    hats = [np.interp(np.where(good, values, knots[0]), knots, row) for row in np.eye(len(knots))]
    return [_by_direction(each, good, direction) for each in (line, np.column_stack(hats))]


def _by_direction(columns: FloatArray, good: np.ndarray, direction: FloatArray) -> FloatArray:
    known = np.where(good[:, None], columns, 0.0)
    return np.column_stack([known * (direction > 0)[:, None], known * (direction < 0)[:, None]])


def _segment_gains(design: FloatArray, left: FloatArray, blocks: Blocks, fold_of_segment: np.ndarray) -> FloatArray:
    """Reduction of each segment's sum of squares by a ridge fit to the other folds."""
    weighted = design * blocks.weight[:, None]
    scale = np.sqrt(np.mean(blocks.weight**2))
    numbers, index = np.unique(blocks.segment, return_inverse=True)
    fold = fold_of_segment[index]
    ridge = LIMITS.ridge * scale**2 * np.eye(design.shape[1])
    full_h, full_g = weighted.T @ weighted, weighted.T @ left
    predicted = np.zeros(len(left))
    for k in np.unique(fold):
        own = fold == k
        h = full_h - weighted[own].T @ weighted[own]
        g = full_g - weighted[own].T @ left[own]
        predicted[own] = weighted[own] @ np.linalg.solve(h + ridge, g)
    gain = left**2 - (left - predicted) ** 2
    return np.asarray(np.bincount(index, weights=gain, minlength=len(numbers)), float)
