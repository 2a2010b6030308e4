"""What the first search leaves open, once more in another way; what stands is what the locked runs bear out again.

Whether a way may say more than what stands already is asked by the workflow.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.special import fdtrc

from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, UNEXPLAINED
from winch_friction.discrepancy.candidates.families import SURFACES, free_members
from winch_friction.discrepancy.catalogue import another_in_each_run, of_one_group
from winch_friction.discrepancy.detectors.flow_balance import stretches
from winch_friction.discrepancy.detectors.lost_flow import PLAINLY, Leakage
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.chance import chance_of_order, chance_of_zero_mean, levels_of_runs, rms
from winch_friction.discrepancy.expansion import Given, Split, as_rigid, loads_by_balance, meet, swings
from winch_friction.discrepancy.preparation.own_simulation import REFERENCE
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.suspended_load import COURSE
from winch_friction.discrepancy.proof import (
    Trial,
    adds,
    at_the_floor,
    far_off,
    nobodys,
    read_back,
    share_left,
    worse_runs,
)
from winch_friction.discrepancy.run_states import EACH_RUN
from winch_friction.discrepancy.search import LastResort, Search, Study, every_candidate, search_runs
from winch_friction.discrepancy.standing import standing, tried
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.signals import Run

LEAST_LOAD = 1.0  # kg, of which a share is told
SMALL_LEVELS = 0.5  # noises: less raises what is left by an eighth at most, and is not what keeps runs off their floor
MOSTLY_LEVELS = 0.7  # of what is left above the noise, that is levels where a name may stand for them: half its square
LEAST_EACH_WAY = 0.05  # of a run's samples, hoisting and lowering: of one way alone nobody tells a load from friction


def by_surfaces(study: Study, trial: Trial) -> tuple[Study, Trial]:
    """What no known law explains, or one name's law not well, once more with laws that only the data know; study and
    trial as they are where that does not end in a proven name that leaves surely less, with others locked either."""
    given, drawn = trial.search, partial(free_members, rows=SURFACES)
    named = given.verdict.kind in (MISSING, AMBIGUOUS)
    search = search_runs(study, given.given, drawn)
    if not search.selection.found:
        return study, trial
    left = given.cross.excess(given.explanation)
    if named and search.cross.excess(search.selection.final) > LIMITS.outdone * left:
        return study, trial
    other = standing(study, search)
    if other.search.verdict.kind not in (MISSING, AMBIGUOUS):
        return (study, trial) if named else by_other_runs(study, trial, drawn)
    return study, other if not named or adds(trial.holdout, other.holdout, study.rng) else trial


def by_groups(study: Study, trial: Trial) -> Trial:
    """What nothing explains, or several names do together, once more with an error of one driving group alone, and what
    nothing explains with one beside everything else; the trial as it is unless that brings the locked runs to their
    floor, and the others near theirs, with fewer names than stand and no more left of either."""
    given, stands = trial.search.given, trial.search.explanation.names
    named = trial.search.verdict.kind in (MISSING, AMBIGUOUS)
    own = () if named and len(stands) < 2 else tuple(of_one_group(given.prepared))
    if not own:
        return trial
    for beside in ((),) if named else ((), every_candidate(study, given)):
        search = search_runs(replace(study, options=replace(study.options, candidates=(*beside, *own))), given)
        if not search.selection.found:  # what does not show at all shows beside nothing either
            return trial
        other = _closing(study, search, trial)
        if other is not trial and (not named or _simpler(trial, other)):
            return other
    return trial


def _simpler(trial: Trial, other: Trial) -> bool:
    """Whether another trial needs fewer names than one that stands, and leaves no more of the locked and other runs."""
    fewer = len(other.search.explanation.names) < len(trial.search.explanation.names)
    pairs = ((other.train, trial.train), (other.holdout, trial.holdout))
    return fewer and all(new.size_after.value <= old.size_after.value for new, old in pairs)


def without_implausible(study: Study, trial: Trial, search: Search) -> Trial:
    """What nothing explains because the law that does it best would need an implausible size, once more without that
    law; the trial as it is unless this brings the locked runs to their floor, and the others near theirs.

    `search`: what the training runs gave.
    """
    given, final = trial.search.given, search.selection.final
    beyond = {(slot.name, slot.law) for slot in final.slots if search.cross.at_bound(final, slot)}
    if not beyond or trial.search.verdict.kind != UNEXPLAINED:
        return trial
    kept = tuple(each for each in every_candidate(study, given) if (each.name, each.law_name) not in beyond)
    other = search_runs(replace(study, options=replace(study.options, candidates=kept)), given)
    return _closing(study, other, trial) if other.selection.found else trial


def by_runs(study: Study, trial: Trial) -> Trial:
    """What no name explains and no equation brings to the floor, once more with a brake that drags by another amount in
    every run; the trial as it is unless that alone brings the locked runs to their floor, and the others near theirs.
    """
    search = search_runs(study, trial.search.given, partial(another_in_each_run, study.split.train))
    if [each.slot.law for each in search.selection.found] != [EACH_RUN]:
        return trial
    return _closing(study, search, trial)


def by_other_runs(study: Study, trial: Trial, also: LastResort | None = None) -> tuple[Study, Trial]:
    """What two training runs or more show and the locked ones show nothing of, once more with some of the former
    locked: what is not in a run proves no name, and one run alone is not learned from and proven on. Study and trial as
    they are unless names stand, the former ones among them, that bring these locked runs to their floor and all the
    others, in which the first ones are now, near theirs.
    """
    showing = [name for name, left in trial.train.most_left_first.items() if left > LIMITS.far_off_the_floor]
    if not at_the_floor(trial.holdout) or len(showing) < 2:
        return study, trial
    other = replace(study, split=_locking(study.split, showing, study.split.holdout))
    proven = _closing(other, search_runs(other, trial.search.given, also), trial)
    named, before = (set(each.search.explanation.names) for each in (proven, trial))
    return (other, proven) if proven is not trial and before < named else (study, trial)


def by_lost_speed(study: Study, trial: Trial, search: Search) -> tuple[Study, Trial]:
    """A leak that the training runs show and locked ones that hardly lose any speed do not bear out, once more with
    some of those that lose most locked: a gap that opens with pressure loses nothing below. Study and trial as they are
    unless it holds in these, and all names stand that stood before.

    `search`: what the training runs gave.
    """
    leaks = [each for each in search.flow if isinstance(each, Leakage) and each not in trial.search.flow]
    if not leaks or study.options.candidates:
        return study, trial
    pairs = zip(study.split.runs, search.given.prepared, strict=True)
    tables = {run.name: stretches([run], [own], leaks[0].change) for run, own in pairs}
    lost = {name: rms(leaks[0].lost(table)) for name, table in tables.items() if len(table)}
    locked, showing = ([lost[name] for name in lost if (name in study.split.holdout) is own] for own in (True, False))
    if not locked or rms(np.array(locked)) > PLAINLY * rms(np.array(showing)):
        return study, trial
    most_first = sorted(lost, key=lambda name: -lost[name])
    other = replace(study, split=_locking(study.split, most_first, study.split.holdout))
    proven = standing(other, search_runs(other, trial.search.given))
    leaks_still = any(isinstance(each, Leakage) for each in proven.search.flow)
    as_many = {*trial.search.explanation.names} <= {*proven.search.explanation.names}
    return (other, proven) if leaks_still and as_many and not far_off(proven.train) else (study, trial)


def by_beyond(study: Study, trial: Trial, search: Search) -> tuple[Study, Trial]:
    """What names bring down to the floor in the training runs, and make worse in locked ones that lie beyond these,
    once more with those among the runs to learn from: an inexact law is right where it was learned. Study and trial as
    they are unless names stand that leave next to nothing of the runs locked in their place, and bring all others near
    their floor.

    `search`: the names that the training runs bear out.
    """
    full = tried(study, search)
    beyond = worse_runs(full.holdout, study.rng)
    if not beyond or not at_the_floor(full.train):
        return study, trial
    kept = [name for name in study.split.holdout if name not in beyond]
    showing = list(trial.train.most_left_first)[: 2 * len(beyond)]
    other = replace(study, split=_locking(study.split, showing, kept))
    proven = standing(other, search_runs(other, trial.search.given))
    stands = proven.search.verdict.kind in (MISSING, AMBIGUOUS) and not far_off(proven.train)
    return (other, proven) if stands and share_left(proven.holdout) <= LIMITS.small_left_over else (study, trial)


def _locking(split: Split, showing: Sequence[str], kept: Sequence[str]) -> Split:
    """Every second of these runs locked in place of as many of the others, of which the first are `kept`."""
    locked = set(showing[1::2][: len(split.holdout)])
    locked |= set(kept[: len(split.holdout) - len(locked)])
    names = [run.name for run in split.runs]
    train, holdout = (tuple(name for name in names if (name in locked) is own) for own in (False, True))
    return replace(split, train=train, holdout=holdout)


def by_levels(study: Study, trial: Trial) -> tuple[Study, Trial]:
    """What nothing explains, or something that acts one way, once more with load cells that tell the course of a load
    but not its level, which is what closes each run's balance (a run of one way does not tell it: there the cell is
    believed). Study and trial as they are unless the locked runs are brought to their floor, and the others near
    theirs, by levels that load cells are off by: small, another in each run, and of no signal; in place of names, with
    fewer of them and no more left of either side.
    """
    given, runs = trial.search.given, study.split.runs
    pairs = [pair for pair in zip(runs, given.prepared, strict=True) if _levels_show(*pair)]
    corrected = any("hook_load" in each.declared.channels for each in given.model.corrections)
    if corrected or REFERENCE in runs[0].metadata or len(pairs) < LIMITS.fewest_levels or not _levels_may_be(trial):
        return study, trial
    cells = {run.name: float(np.nanmedian(run["hook_load"])) for run, _ in pairs}
    courses = tuple(_untold(run) if run.name in cells else run for run in runs)
    other = replace(study, split=replace(study.split, runs=courses))
    proven = standing(other, search_runs(other, meet(courses, study.crane, given.model)))
    if proven.search.verdict.kind == UNEXPLAINED or not at_the_floor(proven.holdout) or far_off(proven.train):
        return study, trial
    if trial.search.verdict.kind != UNEXPLAINED and not _simpler(trial, proven):
        return study, trial
    loads = loads_by_balance(courses, study.crane, read_back(proven.repaired.model))
    off = np.array([cell / max(loads[name], LEAST_LOAD) - 1.0 for name, cell in cells.items()])
    of_cells = _of_load_cells(off, [prepared for _, prepared in pairs])
    return (other, replace(proven, levels=_said(off))) if of_cells else (study, trial)


def _levels_may_be(trial: Trial) -> bool:
    """Whether a trial leaves levels by themselves that matter, or its names that act one way leave something, and stand
    where most of what is left without them is levels."""
    search = trial.search
    slots, cross = search.explanation.slots, search.cross
    opposing = [slot for slot in slots if slot.origin[0].opposing]
    left = cross.remainder(cross.explain(opposing) if slots else search.explanation)
    levels = rms(np.array([*levels_of_runs(left, cross.problem.blocks).values()]))  # of all runs, in noises
    if search.verdict.kind == UNEXPLAINED:
        return levels >= SMALL_LEVELS
    more = float(np.sqrt(max(rms(left) ** 2 - 1.0, 0.0)))  # than noise
    one_way = len(opposing) < len(slots) and not (nobodys(trial.train) and nobodys(trial.holdout))
    return one_way and levels >= max(SMALL_LEVELS, MOSTLY_LEVELS * more)


def _untold(run: Run) -> Run:
    """The same run, whose load cell tells the course of its load alone."""
    return replace(run, columns={COURSE if k == "hook_load" else k: v for k, v in run.columns.items()})


def _said(off: FloatArray) -> str:
    """Of load cells that differ by these shares of the load, by run; zeros of pressures that settle do the same."""
    span = f"{100.0 * off.min():+.2g} to {100.0 * off.max():+.2g} % of the load"
    return (
        f"hook_load differs from the load that closes the balance by another amount in each run, {span}, with no "
        "signal (the load cell, or zeros of the drive's transducers): the balance is believed, so that nothing that "
        "only adds to the load could be told. Weigh each load and read the zeros before each run"
    )


def _levels_show(run: Run, prepared: PreparedRun) -> bool:
    """Whether a run has a load cell, and a balance that tells its level from friction."""
    ways = prepared.direction[prepared.used]
    both = min(np.mean(ways > 0.0), np.mean(ways < 0.0)) >= LEAST_EACH_WAY if len(ways) else False
    return bool(both) and "hook_load" in run and not prepared.tension_measured


def _of_load_cells(off: FloatArray, runs: Sequence[PreparedRun]) -> bool:
    """Whether a share of the load by run is what load cells are off by: of no more than these may be, more than they
    repeat to, about zero, as much in heave compensation as without, and told by no signal that is another in each
    run."""
    if np.abs(off).max() > LIMITS.most_level or rms(off) < LIMITS.at_the_floor * LIMITS.least_share_of_load:
        return False
    names = sorted(set.intersection(*(set(run.channels) for run in runs)))
    told = [
        [run.start for run in runs],
        *([float(np.median(run.channels[n][run.used])) for run in runs] for n in names),
    ]
    ordered = [_chance(np.array(each), off) for each in told]
    kinds = sorted({run.kind for run in runs})
    of_kind = _chance(np.array([float(kinds.index(run.kind)) for run in runs]), off)
    return min(chance_of_zero_mean(off), of_kind, *(len(told) * p for p in ordered)) >= LIMITS.level_p


def _chance(signal: FloatArray, off: FloatArray) -> float:
    """Two-sided p-value that levels have nothing to do with a signal, one value of either by run: neither with its
    order nor, where it stands at one of a few values as the layer in use does, with which of them. Eight runs on two
    layers have no order rarer than once in 200, however far apart and narrow the levels of either layer are."""
    by_order, by_value = chance_of_order(signal, off), _chance_of_values(signal, off)
    return by_order if by_value is None else min(2.0 * min(by_order, by_value), 1.0)


def _chance_of_values(signal: FloatArray, off: FloatArray) -> float | None:
    """p-value of the F test that levels are alike whichever value a signal has (one-way analysis of variance), over
    values of two runs and more; None where fewer than two values have these."""
    groups = [own for own in (off[signal == value] for value in np.unique(signal)) if len(own) > 1]
    if len(groups) < 2:
        return None
    every, within = np.concatenate(groups), sum(float(np.sum((own - own.mean()) ** 2)) for own in groups)
    degrees, free = len(groups) - 1, len(every) - len(groups)
    between = float(np.sum((every - every.mean()) ** 2)) - within
    return float(fdtrc(degrees, free, max(between, 0.0) / degrees / max(within / free, 1e-30)))


def without_swing(study: Study, given: Given, trial: Trial) -> Trial:
    """What nothing explains, once more with a wire that does not give: a late signal rings like a load that swings.

    The trial as it is unless names stand whose file leaves no swing in any run.
    """
    search = search_runs(study, as_rigid(given))
    if search.verdict.kind not in (MISSING, AMBIGUOUS):
        return trial
    other = standing(study, replace(search, given=given))
    named = other.search.verdict.kind in (MISSING, AMBIGUOUS)
    return other if named and not swings(meet(study.split.runs, study.crane, other.repaired.model, ())) else trial


def _closing(study: Study, search: Search, trial: Trial) -> Trial:
    """What a search finds, if it brings the locked runs to their floor and the others near theirs; else the trial."""
    other = standing(study, search)
    named = other.search.verdict.kind in (MISSING, AMBIGUOUS)
    return other if named and at_the_floor(other.holdout) and not far_off(other.train) else trial
