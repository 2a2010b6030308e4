"""Which runs are locked: never learned from, and what every name and file is proven on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run

NOWHERE = np.zeros(0)  # layers of a log that does not tell them


@dataclass(frozen=True)
class Split:
    """Names of the runs to learn from and of the locked ones, and all runs (divided ones renamed)."""

    runs: tuple[Run, ...]
    train: tuple[str, ...]
    holdout: tuple[str, ...]


def refuse(runs: Sequence[Run], fraction: float, seed: int) -> None:
    """Raise `InputError` for what cannot be divided: no run, two of one name, a share or a seed that is none."""
    if not runs:
        raise InputError("no run given; name at least one run file")
    names = [run.name for run in runs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two runs are called '{twice[0]}'; a run's identity is its file name")
    if not 0.05 <= fraction <= 0.6:
        raise InputError(f"--holdout {fraction:g} is outside 0.05 ... 0.6")
    if seed < 0:
        raise InputError(f"seed {seed}: give a whole number, 0 or more")


def lock_holdout(runs: Sequence[Run], fraction: float, rng: np.random.Generator) -> Split:
    """Choose the locked runs by kind (their motor groups), so that each kind is on both sides where there are two of
    it.

    Of a number of draws the one whose locked runs reach least beyond what the others cover: a law that the data draw
    says nothing of loads, pressures, layers or dates that it has not seen, and a proof there would be one of luck. Of
    those that reach as little the one whose locked runs cover most: what is small in all of them proves nothing.
    """
    if len(runs) < LIMITS.fewest_to_lock_whole:
        return _divided(runs, fraction)
    kinds: dict[tuple[str, ...], list[int]] = {}
    for k, run in enumerate(runs):
        kinds.setdefault(run.groups, []).append(k)
    covered = {name: _covered(name, runs) for name in dict.fromkeys(c for run in runs for c in run.columns)}
    draws = [_drawn(list(kinds.values()), fraction, rng) for _ in range(LIMITS.lock_draws)]
    layers = [frozenset(np.rint(v[np.isfinite(v)])) for v in (run.columns.get("wire_layer", NOWHERE) for run in runs)]
    locked = min(draws, key=lambda each: _beyond(each, list(covered.values())) + _unseen(each, layers))
    names = tuple(run.name for k, run in enumerate(runs) if k in locked)
    return Split(tuple(runs), tuple(run.name for run in runs if run.name not in names), names)


def _drawn(kinds: Sequence[Sequence[int]], fraction: float, rng: np.random.Generator) -> frozenset[int]:
    """Runs to lock, of every kind its share."""
    locked: list[int] = []
    for own in kinds:
        count = min(max(round(fraction * len(own)), 1 if len(own) > 1 else 0), len(own) - 1)
        locked += [own[k] for k in rng.permutation(len(own))[:count]]
    return frozenset(locked)


def _covered(name: str, runs: Sequence[Run]) -> FloatArray:
    """The range of a column in each run without its rarest values, shape (runs, 2); nan where a run has none of it."""
    found = np.full((len(runs), 2), np.nan)
    for k, run in enumerate(runs):
        values = run.columns[name][np.isfinite(run.columns[name])] if name in run.columns else np.zeros(0)
        if len(values):
            found[k] = np.quantile(values, LIMITS.lock_range)
    return found


def _beyond(locked: frozenset[int], covered: Sequence[FloatArray]) -> float:
    """How far the locked runs reach beyond the others, in ranges of all runs, summed over the columns; a small part of
    what they cover themselves is taken off."""
    far = 0.0
    own = np.zeros(len(covered[0]) if covered else 0, bool)
    own[list(locked)] = True
    for ranges in covered:
        known = np.isfinite(ranges[:, 0])
        here, there = ranges[own & known], ranges[~own & known]
        if not len(here) or not len(there):
            continue
        whole = max(float(np.nanmax(ranges) - np.nanmin(ranges)), 1e-12)
        low, high = there[:, 0].min() - here[:, 0].min(), here[:, 1].max() - there[:, 1].max()
        covers = float(here[:, 1].max() - here[:, 0].min())
        far += (max(float(low), 0.0) + max(float(high), 0.0) - LIMITS.lock_cover * covers) / whole
    return far


def _unseen(locked: frozenset[int], layers: Sequence[frozenset[float]]) -> int:
    """How many of the drum's layers only the locked runs are on: a radius is learned where it is met."""
    here, there = (set().union(*(layers[k] for k in some)) for some in (locked, set(range(len(layers))) - locked))
    return len(here - there)


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
