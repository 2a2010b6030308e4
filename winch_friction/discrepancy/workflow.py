"""Locate, name, add, prove: the whole workflow on runs in memory."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy import adequacy
from winch_friction.discrepancy.adequacy import lock_holdout, refuse
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, GapOptions, GapResult
from winch_friction.discrepancy.assembly import Trial, assemble, insufficient, tried
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.candidates.catalogue import of_one_group
from winch_friction.discrepancy.candidates.families import SURFACES, free_members
from winch_friction.discrepancy.estimates import try_seed, widened
from winch_friction.discrepancy.expansion import Expansion, Given, Split, as_rigid, expand_around, meet, swings
from winch_friction.discrepancy.next_experiment import of_wire
from winch_friction.discrepancy.outdone import not_one_law
from winch_friction.discrepancy.preparation.grid import thinned
from winch_friction.discrepancy.preparation.own_simulation import SIMULATED, against_simulations
from winch_friction.discrepancy.proof import adds, at_the_floor, far_off, nobodys, rms
from winch_friction.discrepancy.proposals import Proposal, explained, propose
from winch_friction.discrepancy.run_states import EACH_RUN, another_in_each_run
from winch_friction.discrepancy.search import Search, search_runs
from winch_friction.discrepancy.standing import standing
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.model import completed
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.records.runs import apart, without_broken


# -- once more, where nothing explains it
def by_surfaces(split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator) -> Trial:
    """What no known law explains, or one name's law not well, once more with laws that only the data know; the trial as
    it is where that does not end in a proven name that leaves surely less."""
    given = trial.search
    named = given.verdict.kind in (MISSING, AMBIGUOUS)
    left = given.cross.excess(given.explanation)
    if named and (len(given.explanation.slots) != 1 or left <= LIMITS.least_excess):
        return trial
    search = search_runs(split, given.given, options, rng, partial(free_members, rows=SURFACES))
    if not search.selection.found:
        return trial
    if named and search.cross.excess(search.selection.final) > LIMITS.outdone * left:
        return trial
    other = not_one_law(split, crane, options, standing(split, crane, options, search, rng), rng)
    if other.search.verdict.kind not in (MISSING, AMBIGUOUS):
        return trial
    return other if not named or adds(trial.holdout, other.holdout, rng) else trial


def by_groups(split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator) -> Trial:
    """What nothing explains, once more with an error of one driving group alone; the trial as it is unless that brings
    the locked runs to their floor, and the others near theirs."""
    given = trial.search.given
    own = of_one_group(given.prepared)
    search = search_runs(split, given, replace(options, candidates=tuple(own)), rng) if own else None
    if search is None or not search.selection.found:
        return trial
    return _closing(split, crane, options, search, trial, rng)


def by_runs(split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator) -> Trial:
    """What no name explains and no equation brings to the floor, once more with a brake that drags by another amount in
    every run; the trial as it is unless that alone brings the locked runs to their floor, and the others near theirs.
    """
    by_run = partial(another_in_each_run, split.train)
    search = search_runs(split, trial.search.given, options, rng, by_run)
    if [each.slot.law for each in search.selection.found] != [EACH_RUN]:
        return trial
    return _closing(split, crane, options, search, trial, rng)


def by_other_runs(
    split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator
) -> tuple[Split, Trial]:
    """What the training runs show and the locked ones show nothing of, once more with some of the former locked: what
    is not in a run proves no name. Split and trial as they are unless names stand, the former ones among them, that
    bring these locked runs to their floor and all the others, in which the first ones are now, near theirs.
    """
    other = _locking_what_shows(split, trial) if at_the_floor(trial.holdout) else None
    if other is None:
        return split, trial
    proven = _closing(other, crane, options, search_runs(other, trial.search.given, options, rng), trial, rng)
    named, before = (set(each.search.explanation.names) for each in (proven, trial))
    return (other, proven) if proven is not trial and before < named else (split, trial)


def _locking_what_shows(split: Split, trial: Trial) -> Split | None:
    """Every second of the training runs that show something, most first, locked in place of as many of the others; None
    where fewer than two do."""
    side = trial.train
    left = {run.name: rms(side.after[side.blocks.run == k]) / side.floor for k, run in enumerate(side.runs)}
    most_first = sorted(left, key=lambda name: -left[name])
    showing = [name for name in most_first if left[name] > LIMITS.far_off_the_floor]
    if len(showing) < 2:
        return None
    locked = set(showing[1::2][: len(split.holdout)])
    locked |= set(split.holdout[: len(split.holdout) - len(locked)])
    names = [run.name for run in split.runs]
    train, holdout = (tuple(name for name in names if (name in locked) is own) for own in (False, True))
    return replace(split, train=train, holdout=holdout)


def _closing(
    split: Split, crane: Crane, options: GapOptions, search: Search, trial: Trial, rng: np.random.Generator
) -> Trial:
    """What a search finds, if it brings the locked runs to their floor and the others near theirs; else the trial."""
    other = not_one_law(split, crane, options, standing(split, crane, options, search, rng), rng)
    named = other.search.verdict.kind in (MISSING, AMBIGUOUS)
    return other if named and at_the_floor(other.holdout) and not far_off(other.train) else trial


# -- the order of the steps
def find_gap(runs: Sequence[Run], crane: Crane, model: FrictionModel, options: GapOptions | None = None) -> GapResult:
    """Where runs and model disagree, which effect is missing, and the proof on locked runs.

    Raises `InputError` for runs that lack what the torque balance needs, for two runs of one name and for no run at
    all.
    """
    options, model = options or GapOptions(), completed(model, crane)
    refuse(runs, options.holdout, options.seed)
    # by name: which runs are locked must not hang on the order in which they are given
    parts, holes = apart(sorted(runs, key=lambda run: run.name))
    parts, found = without_broken(parts)
    broken = [f"{each.sentence}; left out" for each in found]
    every = [thinned(run) for run in parts]
    if any(name.endswith(SIMULATED) for run in every for name in run.columns):
        every = against_simulations(every, model, crane)
    runs, notes = adequacy.long_enough(every)
    notes = [*holes, *broken, *notes]
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
    if trial.search.verdict.kind == UNEXPLAINED and search.verdict.untold:
        names = adequacy.of_names(search.verdict.refused)
        lacking = insufficient([*checks, names], notes, crane, model, (given, split))
        return _with_what_was_seen(lacking, assemble(split, options, trial))
    if trial.search.verdict.kind != NOTHING and not options.candidates:
        split, trial = by_other_runs(split, crane, options, trial, rng)
    if trial.search.verdict.kind == UNEXPLAINED and not options.candidates:
        trial = by_groups(split, crane, options, trial, rng)
    if trial.search.verdict.kind != NOTHING and not options.candidates:
        options.told("drawing surfaces")
        trial = by_surfaces(split, crane, options, trial, rng)
    if trial.search.verdict.kind == UNEXPLAINED and swings(given):
        options.told("searching without a swing of the load")
        trial = _without_swing(split, crane, given, options, trial, rng)
    options.told("planning")

    def expand(own: Search, candidate: Candidate) -> Expansion:
        return expand_around(own.given, own.expansion, own.cross.explain(()), [candidate])

    def evaluate(own: Search) -> Trial:
        return tried(split, crane, options, own, rng)

    proposals: tuple[Proposal, ...] = ()
    if trial.search.verdict.kind == UNEXPLAINED and options.proposals:
        proposals = propose(trial, split.train, expand, evaluate, rng)
        if not options.candidates and all(each.after > LIMITS.at_the_floor * each.noise_floor for each in proposals):
            trial = by_runs(split, crane, options, trial, rng)
            proposals = proposals if trial.search.verdict.kind == UNEXPLAINED else ()
    result = assemble(split, options, trial)
    if result.verdict == UNEXPLAINED:
        notes += of_wire(given)
    refuted = () if seed.refuted is None or explained(result.verdict, proposals) else (seed.refuted,)
    if refuted and result.verdict == UNEXPLAINED and far_off(result.holdout):
        refuted = ()  # its freed parameters leave what is plainly more than noise: they imitate something
    result = replace(
        result, seed_model=model, seed_refuted=refuted, adequacy=tuple(checks), notes=(*notes, *result.notes),
        proposals=proposals,
    )  # fmt: skip
    swing = adequacy.of_swing(crane, [*result.train.left_by_run, *result.holdout.left_by_run])
    # a floor that noise alone has raised excuses nothing: then it is not known whether anything is missing
    if not swing.met and (result.verdict == UNEXPLAINED or (result.verdict == NOTHING and not nobodys(result.holdout))):
        return _with_what_was_seen(insufficient([*checks, swing], notes, crane, model, (given, split)), result)
    return result


def _with_what_was_seen(lacking: GapResult, result: GapResult) -> GapResult:
    """The answer of runs that lack something, with what their search showed all the same."""
    left = f"{result.holdout.size_after.value:.3g} {result.unit}"
    said = [] if result.effects else [f"the model's own parameters, fitted anew, leave {left} of the locked runs"]
    return replace(
        lacking, regions=result.regions, considered=result.considered, untestable=result.untestable,
        notes=(*lacking.notes, *said),
    )  # fmt: skip


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
