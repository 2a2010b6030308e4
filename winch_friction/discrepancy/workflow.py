"""Locate, name, add, prove: the whole workflow on runs in memory."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.discrepancy.answer import GapResult
from winch_friction.discrepancy.assembly import assemble
from winch_friction.discrepancy.engine.omnibus import dependences
from winch_friction.discrepancy.expansion import meet
from winch_friction.discrepancy.holdout import lock_holdout
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.preparation.own_simulation import against_simulations
from winch_friction.discrepancy.search import Search, search_runs
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.verdict import NOTHING, UNEXPLAINED, Verdict
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane


def find_gap(runs: Sequence[Run], crane: Crane, model: FrictionModel, options: GapOptions | None = None) -> GapResult:
    """Where runs and model disagree, which effect is missing, and the proof on locked runs.

    Raises `InputError` for runs that lack what the torque balance needs, for two runs of one name and for no run at
    all.
    """
    options = options or GapOptions()
    _check(runs, options)
    runs = against_simulations(runs, model)
    split = lock_holdout(runs, options.holdout, np.random.default_rng(options.seed))
    rng = np.random.default_rng(options.seed + 1)
    search = search_runs(split, meet(split.runs, crane, model), options, rng)
    result = assemble(split, crane, options, search, rng)
    if len(split.train) < LIMITS.fewest_runs and result.effects and not _proved(result):
        return assemble(split, crane, options, _withdrawn(search), rng)
    if search.explanation.slots and _refuted(result):
        return assemble(split, crane, options, _unexplained(search, rng), rng)
    return result


def _proved(result: GapResult) -> bool:
    """Whether the locked runs' gap came down below the interval that it had before."""
    return result.holdout.size_after.value < result.holdout.size_before.interval[0]


def _refuted(result: GapResult) -> bool:
    """Whether the locked runs keep far more than their noise, and not only because there was so much before."""
    before, after, noise = result.holdout.size_before.value, result.holdout.size_after.value, result.holdout.noise_floor
    kept = (after**2 - noise**2) / max(before**2 - noise**2, 1e-9)
    return after > LIMITS.most_kept_noise * noise and kept > LIMITS.most_kept


def _unexplained(search: Search, rng: np.random.Generator) -> Search:
    """The search with what it found refused."""
    names = ", ".join(found.slot.name for found in search.selection.found)
    left = dependences(search.cross, search.cross.remainder(search.selection.base), rng)
    verdict = Verdict(UNEXPLAINED, f"{names} does not hold on the locked runs")
    return replace(search, verdict=verdict, left=tuple(left), reversal=None)


def _withdrawn(search: Search) -> Search:
    """The search without its findings: with a few runs the folds are stretches of one operating point, in which small
    mismatches repeat themselves, so that only the locked part can tell an effect from them.
    """
    selection = replace(search.selection, final=search.selection.base, found=())
    refused = "what seemed to be missing did not shrink the gap on the locked part; bring more runs"
    return replace(
        search, selection=selection, verdict=Verdict(NOTHING, refused), reversal=None, ripple=None, leakage=None
    )


def _check(runs: Sequence[Run], options: GapOptions) -> None:
    if not runs:
        raise InputError("no run given; name at least one run file")
    names = [run.name for run in runs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two runs are called '{twice[0]}'; a run's identity is its file name")
    if not 0.05 <= options.holdout <= 0.6:
        raise InputError(f"--holdout {options.holdout:g} is outside 0.05 ... 0.6")
