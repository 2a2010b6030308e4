"""Runs that are locked away before anything else is looked at, and the proof on them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.physics.signals import FloatArray, Run

FEWEST_RUNS = 4  # with fewer, the end of every run is locked instead
DRAWS = 1000
GUARD_TIME = 0.5  # s between the two parts of a divided run


@dataclass(frozen=True)
class Split:
    """Names of the runs to learn from and of the locked ones, and all runs (divided ones renamed)."""

    runs: tuple[Run, ...]
    train: tuple[str, ...]
    holdout: tuple[str, ...]


def lock_holdout(runs: Sequence[Run], fraction: float, rng: np.random.Generator) -> Split:
    """Choose the locked runs by kind (their motor groups), so that each kind is on both sides where there are two of
    it."""
    if len(runs) < FEWEST_RUNS:
        return _divided(runs, fraction)
    kinds: dict[tuple[str, ...], list[str]] = {}
    for run in runs:
        kinds.setdefault(run.groups, []).append(run.name)
    locked: list[str] = []
    for names in kinds.values():
        count = min(max(round(fraction * len(names)), 1 if len(names) > 1 else 0), len(names) - 1)
        locked += [names[k] for k in rng.permutation(len(names))[:count]]
    train = tuple(run.name for run in runs if run.name not in locked)
    return Split(tuple(runs), train, tuple(run.name for run in runs if run.name in locked))


def _divided(runs: Sequence[Run], fraction: float) -> Split:
    parts, train, locked = [], [], []
    for run in runs:
        time = run.time - run.time[0]
        border = time[-1] * (1.0 - fraction)
        for label, keep in (("first part", time < border - GUARD_TIME), ("last part", time >= border)):
            columns = {name: values[keep] for name, values in run.columns.items()}
            parts.append(Run(f"{run.name} ({label})", columns, {}, run.warnings, run.metadata))
        train.append(parts[-2].name)
        locked.append(parts[-1].name)
    return Split(tuple(parts), tuple(train), tuple(locked))


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
    weights = rng.multinomial(len(sums), np.full(len(sums), 1.0 / len(sums)), size=DRAWS)
    draws = np.sqrt((weights @ sums) / (weights @ counts))
    low, high = np.quantile(draws, (0.025, 0.975))
    return Size(float(np.sqrt(sums.sum() / counts.sum())), (float(low), float(high)))
