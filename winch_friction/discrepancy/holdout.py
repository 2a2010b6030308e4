"""Runs that are locked away before anything else is looked at, and the proof on them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.signals import Run


@dataclass(frozen=True)
class Split:
    """Names of the runs to learn from and of the locked ones, and all runs (divided ones renamed)."""

    runs: tuple[Run, ...]
    train: tuple[str, ...]
    holdout: tuple[str, ...]


def lock_holdout(runs: Sequence[Run], fraction: float, rng: np.random.Generator) -> Split:
    """Choose the locked runs by kind (their motor groups), so that each kind is on both sides where there are two of
    it."""
    if len(runs) < LIMITS.fewest_to_lock_whole:
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
        for label, keep in (("first part", time < border - LIMITS.guard_time), ("last part", time >= border)):
            columns = {name: values[keep] for name, values in run.columns.items()}
            parts.append(Run(f"{run.name} ({label})", columns, {}, run.warnings, run.metadata))
        train.append(parts[-2].name)
        locked.append(parts[-1].name)
    return Split(tuple(parts), tuple(train), tuple(locked))
