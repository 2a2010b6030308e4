"""Locate, name, add, prove: the whole workflow on runs in memory."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy import adequacy
from winch_friction.discrepancy.answer import GapResult
from winch_friction.discrepancy.assembly import Trial, assemble, insufficient, tried
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.detectors import flow_balance
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.omnibus import dependences
from winch_friction.discrepancy.expansion import Expansion, expand_around, meet
from winch_friction.discrepancy.holdout import Split, lock_holdout
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.preparation.grid import thinned
from winch_friction.discrepancy.preparation.own_simulation import against_simulations
from winch_friction.discrepancy.proof import adds, at_the_floor, prove, worse_runs
from winch_friction.discrepancy.proposals import propose
from winch_friction.discrepancy.search import Search, search_runs
from winch_friction.discrepancy.seed_claim import try_seed, widened
from winch_friction.discrepancy.verdict import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, Verdict
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
    every = against_simulations([thinned(run) for run in runs], model, crane)
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
    trial = _proven(split, crane, options, _replicated(search, split, rng), rng)
    options.told("planning")
    result = assemble(split, options, trial)
    result = replace(
        result, seed_model=model, seed_refuted=() if seed.refuted is None else (seed.refuted,), adequacy=tuple(checks),
        notes=(*notes, *result.notes),
    )  # fmt: skip
    if not options.proposals:
        return result

    def expand(own: Search, candidate: Candidate) -> Expansion:
        return expand_around(own.given, own.expansion, own.cross.explain(()), [candidate])

    def evaluate(own: Search) -> Trial:
        return tried(split, crane, options, own, rng)

    return replace(result, proposals=propose(trial, split.train, expand, evaluate, rng))


def _replicated(search: Search, split: Split, rng: np.random.Generator) -> Search:
    """The search with only those findings beside the moving samples that show in the locked runs as well."""
    given = search.given
    locked = [(run, p) for run, p in zip(given.runs, given.prepared, strict=True) if run.name in split.holdout]
    runs, prepared = [run for run, _ in locked], [p for _, p in locked]
    ripple, leakage, reversal = search.ripple, search.leakage, search.reversal
    if ripple and not angle.holds_on(ripple, runs, prepared, given.crane, given.model):
        ripple = None
    if leakage and not flow_balance.holds_on(leakage, runs, prepared):
        leakage = None
    if reversal and not reversal.holds_on(split.holdout, rng):
        reversal = None
    return replace(search, ripple=ripple, leakage=leakage, reversal=reversal)


def _proven(split: Split, crane: Crane, options: GapOptions, search: Search, rng: np.random.Generator) -> Trial:
    """The trial that the locked runs bear out: with all names, with those beside the moving samples, or with none."""
    refit = tried(split, crane, options, _nameless(search), rng)
    why = search.verdict.refused
    if search.explanation.slots or search.reversal:
        full = tried(split, crane, options, search, rng)
        names = ", ".join([*search.explanation.names, *([search.reversal.slot.name] if search.reversal else [])])
        # just after reversals a gap of its own has shrunk already; the moving samples need only stay as they are
        proof = prove(names, refit.holdout, full.holdout, rng) if search.explanation.slots else None
        why = proof.why if proof else "".join(worse_runs(full.holdout, rng))
        if not why:
            return _each_proven(full, partial(tried, split, crane, options, rng=rng), rng)
    beside = replace(_nameless(search), ripple=search.ripple, leakage=search.leakage)
    if search.ripple or search.leakage:
        trial = tried(split, crane, options, beside, rng)
        if not worse_runs(trial.holdout, rng):
            refit = trial
    return replace(refit, search=_judged(refit, why, rng))


def _each_proven(full: Trial, trial_of: Callable[[Search], Trial], rng: np.random.Generator) -> Trial:
    """The trial without those names, the last found first, that the locked runs do not need beside the others."""
    for slot in reversed(full.search.selection.final.slots):
        search, final = full.search, full.search.selection.final
        brought = any(slot.name in each.brings for each in final.slots)
        if len(final.slots) == 1 or brought or slot.plain:
            continue
        fewer = trial_of(_without(search, slot))
        if not adds(fewer.holdout, full.holdout, rng):
            full = fewer
    return full


def _without(search: Search, slot: Slot) -> Search:
    """The search without one of its names."""
    rest = tuple(each for each in search.selection.final.slots if each is not slot)
    found = tuple(each for each in search.selection.found if each.slot is not slot)
    verdict = search.verdict
    if verdict.kind in (MISSING, AMBIGUOUS):
        verdict = replace(verdict, kind=AMBIGUOUS if any(each.rivals for each in found) else MISSING)
    selection = replace(search.selection, final=search.cross.explain(rest), found=found)
    return replace(search, selection=selection, verdict=verdict)


def _nameless(search: Search) -> Search:
    """The search without any name."""
    selection = replace(search.selection, final=search.selection.base, found=())
    return replace(search, selection=selection, reversal=None, ripple=None, leakage=None)


def _judged(trial: Trial, why: str, rng: np.random.Generator) -> Search:
    """Without a name for the moving samples: nothing is missing only where the locked runs are at their noise."""
    search = trial.search
    if search.verdict.kind != UNEXPLAINED and at_the_floor(trial.holdout):
        found = search.ripple or search.leakage
        return replace(search, verdict=Verdict(MISSING if found else NOTHING, why))
    left = dependences(search.cross, search.cross.remainder(search.selection.base), rng)
    after, noise = trial.holdout.size_after.value, trial.holdout.noise_floor
    kept = f"the locked runs keep {after:.3g} where their noise is {noise:.3g}"
    return replace(search, verdict=Verdict(UNEXPLAINED, "; ".join(filter(None, (why, kept)))), left=tuple(left))


def _check(runs: Sequence[Run], options: GapOptions) -> None:
    if not runs:
        raise InputError("no run given; name at least one run file")
    names = [run.name for run in runs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two runs are called '{twice[0]}'; a run's identity is its file name")
    if not 0.05 <= options.holdout <= 0.6:
        raise InputError(f"--holdout {options.holdout:g} is outside 0.05 ... 0.6")
