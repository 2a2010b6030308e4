"""Locate, name, add, prove: the whole workflow on runs in memory."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.discrepancy import adequacy
from winch_friction.discrepancy.answer import GapResult
from winch_friction.discrepancy.assembly import Trial, assemble, insufficient, tried
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.expansion import Expansion, Given, as_rigid, expand_around, meet, swings
from winch_friction.discrepancy.holdout import Split, lock_holdout
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.outdone import by_surfaces, not_one_law
from winch_friction.discrepancy.preparation.grid import thinned
from winch_friction.discrepancy.preparation.own_simulation import against_simulations
from winch_friction.discrepancy.proposals import propose
from winch_friction.discrepancy.search import Search, search_runs
from winch_friction.discrepancy.seed_claim import try_seed, widened
from winch_friction.discrepancy.standing import standing
from winch_friction.discrepancy.verdict import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED
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
    # by name: which runs are locked must not hang on the order in which they are given
    every = against_simulations([thinned(run) for run in sorted(runs, key=lambda run: run.name)], model, crane)
    runs, notes = adequacy.long_enough(every)
    checks = adequacy.of_records(every, runs)
    if not all(check.met for check in checks):
        return insufficient(checks, notes, crane, model)
    split = lock_holdout(runs, options.holdout, np.random.default_rng(options.seed))
    rng = np.random.default_rng(options.seed + 1)
    options.told("closing the balance")
    given = meet(split.runs, crane, model)
    checks += adequacy.of_prepared(given, split.train, split.holdout)
    if not all(check.met for check in checks):
        return insufficient(checks, notes, crane, model, (given, split))
    options.told("searching")
    search = search_runs(split, given, options, rng)
    seed = try_seed(search, rng)
    if seed.enough:
        search = search_runs(split, widened(given), options, rng)
    options.told("proving on the locked runs")
    trial = not_one_law(split, crane, options, standing(split, crane, options, search, rng), rng)
    if trial.search.verdict.kind != NOTHING and not options.candidates:
        options.told("drawing surfaces")
        trial = by_surfaces(split, crane, options, trial, rng)
    if trial.search.verdict.kind == UNEXPLAINED and swings(given):
        options.told("searching without a swing of the load")
        trial = _without_swing(split, crane, given, options, trial, rng)
    options.told("planning")
    result = assemble(split, options, trial)
    result = replace(
        result, seed_model=model, seed_refuted=() if seed.refuted is None else (seed.refuted,), adequacy=tuple(checks),
        notes=(*notes, *result.notes),
    )  # fmt: skip
    swing = adequacy.of_swing([*result.train.left_by_run, *result.holdout.left_by_run])
    if result.verdict == UNEXPLAINED and not swing.met:
        return insufficient([*checks, swing], notes, crane, model, (given, split))
    if not options.proposals:
        return result

    def expand(own: Search, candidate: Candidate) -> Expansion:
        return expand_around(own.given, own.expansion, own.cross.explain(()), [candidate])

    def evaluate(own: Search) -> Trial:
        return tried(split, crane, options, own, rng)

    return replace(result, proposals=propose(trial, split.train, expand, evaluate, rng))


def _without_swing(
    split: Split, crane: Crane, given: Given, options: GapOptions, trial: Trial, rng: np.random.Generator
) -> Trial:
    """What nothing explains, once more with a wire that does not give: a late signal rings like a load that swings.

    The trial as it is unless names stand whose file leaves no swing in any run.
    """
    search = search_runs(split, as_rigid(given), options, rng)
    if search.verdict.kind not in (MISSING, AMBIGUOUS):
        return trial
    search = replace(search, given=given)
    other = not_one_law(split, crane, options, standing(split, crane, options, search, rng), rng)
    named = other.search.verdict.kind in (MISSING, AMBIGUOUS)
    return other if named and not swings(meet(split.runs, crane, other.repaired.model, ())) else trial


def _check(runs: Sequence[Run], options: GapOptions) -> None:
    if not runs:
        raise InputError("no run given; name at least one run file")
    names = [run.name for run in runs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two runs are called '{twice[0]}'; a run's identity is its file name")
    if not 0.05 <= options.holdout <= 0.6:
        raise InputError(f"--holdout {options.holdout:g} is outside 0.05 ... 0.6")
