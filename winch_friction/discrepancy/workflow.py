"""Locate, name, add, prove: the whole workflow on runs in memory, and its result."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial, reduce

import numpy as np

from winch_friction.discrepancy import adequacy, again
from winch_friction.discrepancy.answer import (
    AMBIGUOUS,
    MISSING,
    NOTHING,
    UNEXPLAINED,
    Effect,
    GapOptions,
    GapResult,
    Side,
    named,
    telling,
    unexplained_share,
)
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.drift import drift_note
from winch_friction.discrepancy.engine.selection import TAKEN, Considered, Finding, Selection
from winch_friction.discrepancy.estimates import try_seed, widened
from winch_friction.discrepancy.expansion import Given, meet, swings
from winch_friction.discrepancy.next_experiment import (
    NextExperiment,
    insufficient,
    of_own_terms,
    of_unexplained,
    plan_experiment,
    with_what_was_seen,
)
from winch_friction.discrepancy.preparation.grid import beside_climbs, thinned
from winch_friction.discrepancy.preparation.own_simulation import SIMULATED, against_simulations
from winch_friction.discrepancy.proof import Trial, far_off, nobodys
from winch_friction.discrepancy.proposals import Proposal, explained, propose
from winch_friction.discrepancy.repair import REFITTED, REPAIRED, Repair
from winch_friction.discrepancy.search import Search, Study, search_runs
from winch_friction.discrepancy.standing import not_borne_out, standing, tried
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.ties import WITH_UNSOUGHT, Company, company, known_combination
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.model import completed
from winch_friction.physics.friction.table import in_windows
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.records.runs import apart, without_broken

CATALOGUES = "catalogue's"  # of two laws, the one without a name of its own
LEFT_AS_GIVEN = "the model is left as it was given: fitted to what nothing explains, it does worse on the locked runs"


# -- the order of the steps
def find_gap(runs: Sequence[Run], crane: Crane, model: FrictionModel, options: GapOptions | None = None) -> GapResult:
    """Where runs and model disagree, which effect is missing, and the proof on locked runs.

    Raises `InputError` for runs that lack what the torque balance needs, for two runs of one name and for no run at
    all.
    """
    options, model = options or GapOptions(), completed(model, crane)
    adequacy.refuse(runs, options.holdout, options.seed)
    # by name: which runs are locked must not hang on the order in which they are given
    parts, holes = apart(sorted(runs, key=lambda run: run.name))
    parts, found = without_broken(parts)
    every = thinned(parts)
    if any(name.endswith(SIMULATED) for run in every for name in run.columns):
        every = against_simulations(every, model, crane)
    runs, notes = adequacy.long_enough(every)
    runs, climbing = beside_climbs(runs, crane)
    notes = [*holes, *(f"{each.sentence}; left out" for each in found), *notes, *climbing]
    checks = adequacy.of_records(every, runs)
    if not all(check.met for check in checks):
        return insufficient(checks, notes, crane, model)
    split = adequacy.lock_holdout(runs, options.holdout, np.random.default_rng(options.seed))
    study = Study(split, crane, options, np.random.default_rng(options.seed + 1))
    options.told("closing the balance")
    given = meet(split.runs, crane, model)
    checks += adequacy.of_prepared(given, split.train, split.holdout)
    if not all(check.met for check in checks):
        return insufficient(checks, notes, crane, model, (given, split))
    options.told("searching")
    search = search_runs(study, given)
    seed = try_seed(search, study.rng)
    if seed.enough:
        search = search_runs(study, widened(given))
    options.told("proving on the locked runs")
    trial = standing(study, search)
    if trial.search.verdict.kind == UNEXPLAINED and search.verdict.untold:
        names = adequacy.of_names(search.verdict.refused)
        lacking = insufficient([*checks, names], notes, crane, model, (given, split))
        return with_what_was_seen(lacking, assemble(study, trial))
    study, trial = _once_more(study, given, trial, search)
    seed = try_seed(trial.search, study.rng) if trial.levels else seed
    options.told("planning")
    proposals: tuple[Proposal, ...] = ()
    if trial.search.verdict.kind == UNEXPLAINED and options.proposals:
        proposals = propose(trial, study.split.train, partial(tried, study), study.rng)
        if not options.candidates and all(each.after > LIMITS.at_the_floor * each.noise_floor for each in proposals):
            trial = again.by_runs(study, trial)
            proposals = proposals if trial.search.verdict.kind == UNEXPLAINED else ()
    result, notes = assemble(study, trial), [*notes, *not_borne_out(search, trial.search)]
    if own := [name for each in result.effects if (name := each.law_name or each.name) in model.term_names]:
        notes += of_own_terms(own, model, result.model)
    if result.verdict == UNEXPLAINED:
        result, said = of_unexplained(result, given, explained(result.verdict, proposals))
        notes += said
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
        lacking = insufficient([*checks, swing], notes, crane, model, (given, study.split))
        return with_what_was_seen(lacking, result)
    return result


def _once_more(study: Study, given: Given, trial: Trial, search: Search) -> tuple[Study, Trial]:
    """What is open, asked again by every way that may say more than what stands."""
    study, trial = again.by_lost_speed(study, trial, search) if search.flow else (study, trial)
    if trial.search.verdict.kind != NOTHING and not study.options.candidates:
        study, trial = again.by_other_runs(study, trial)
        if trial.search.verdict.kind == UNEXPLAINED and search.verdict.kind in (MISSING, AMBIGUOUS):
            study, trial = again.by_beyond(study, trial, search)
        if trial.search.verdict.kind == UNEXPLAINED or len(trial.search.explanation.names) > 1:
            trial = again.by_groups(study, again.without_implausible(study, trial, search))
        if trial.search.verdict.kind != NOTHING:
            study.options.told("drawing surfaces")
            if _surfaces_may_say_more(trial.search):
                study, trial = again.by_surfaces(study, trial)
    if trial.search.verdict.kind == UNEXPLAINED and swings(given):
        study.options.told("searching without a swing of the load")
        trial = again.without_swing(study, given, trial)
    one_way = not all(slot.origin[0].opposing for slot in trial.search.explanation.slots)
    return again.by_levels(study, trial) if one_way or trial.search.verdict.kind == UNEXPLAINED else (study, trial)


def _surfaces_may_say_more(search: Search) -> bool:
    """Where nothing is named, or one name whose law is not exact: several are no inexactness of one law."""
    if search.verdict.kind not in (MISSING, AMBIGUOUS):
        return True
    return len(search.explanation.slots) == 1 and search.cross.excess(search.explanation) > LIMITS.least_excess


# -- what a trial says
def assemble(study: Study, trial: Trial) -> GapResult:
    """The result that a trial stands by."""
    runs, search, repaired = study.split.runs, trial.search, trial.repaired
    cross, selection, verdict, given = search.cross, search.selection, search.verdict, search.given
    for run in given.prepared:  # go with the result, and nobody asks them for columns any more
        run.means.clear()
    found = selection.found if search.explanation is selection.final else ()
    experiment = _experiment(given.crane, search, study.options) if study.options.plan else None
    first = {each.slot.name: each for each in reversed(found)}  # of a cause with two laws, the one found first
    tied = {name: _company(search, each) for name, each in first.items()}
    kind = AMBIGUOUS if verdict.kind == MISSING and any(own.partners for own in tied.values()) else verdict.kind
    left = [LEFT_AS_GIVEN] if kind == UNEXPLAINED and repaired.model.values == given.model.values else []
    goes_with = [each.signal for each in named(telling(cross, search.left))]
    drift = drift_note((trial.train, trial.holdout), search.explanation.names, given.crane.drive.unit)
    return GapResult(
        verdict=kind, refused=verdict.refused, effects=_effects(search, found, repaired, tied),
        unit=given.crane.drive.unit, train=trial.train, holdout=trial.holdout, seed_model=given.model,
        depends=named(search.left) if verdict.kind == UNEXPLAINED else (), levels=trial.levels,
        unexplained_share=unexplained_share(cross, selection, verdict), considered=_in_the_end(selection),
        next_experiment=experiment.content() if experiment else None, untestable=search.untestable,
        next_scenario=experiment.text if experiment else "", model=_concluded(repaired.model, given.model, kind),
        notes=(
            *_notes(runs, {} if trial.levels else given.loads), *filter(None, [trial.levels, drift]),
            *_amounts(repaired.model, runs), *_times(repaired.model, given.model, runs), *repaired.cut,
            *(each.note for own in tied.values() for each in own.partners),
            *(_no_room(name, own.no_room) for name, own in tied.items() if own.no_room), *left,
            *(_inexact(trial.holdout, goes_with, given.crane.drive.unit) if found else []),
        ),
    )  # fmt: skip


def _company(search: Search, found: Finding) -> Company:
    """The other names of a finding: its rivals, and what is tied to one of them by the equations."""
    names = tuple(slot.name for slot in found.rivals)
    return company(search, found) if WITH_UNSOUGHT & {found.slot.name, *names} else Company(names, (), found.no_room)


def _no_room(name: str, others: Sequence[str]) -> str:
    """What is said of the names that have no room beside this one."""
    return f"{name}: as well on these runs, but without room in a set: {', '.join(others)}"


def _in_the_end(selection: Selection) -> tuple[Considered, ...]:
    """What was considered; of what was taken at first and does not stand it says so."""
    stand = {finding.slot.name for finding in selection.found}
    fell = f"{TAKEN} at first, but it does not stand in the end"
    return tuple(
        replace(each, verdict=fell) if each.verdict == TAKEN and each.name not in stand else each
        for each in selection.considered
    )


def _effects(
    search: Search, found: Sequence[Finding], repaired: Repair, tied: Mapping[str, Company]
) -> tuple[Effect, ...]:
    effects = [
        _effect(search, [each for each in found if each.slot.name == name], repaired, tied[name])
        for name in dict.fromkeys(each.slot.name for each in found)
    ]
    if search.reversal is not None:
        effects.append(search.reversal.effect(repaired.parameters[search.reversal.slot.name]))
    side = [search.ripple.effect] if search.ripple else []
    return (*effects, *side, *(each.effect for each in search.flow))


def _experiment(crane: Crane, search: Search, options: GapOptions) -> NextExperiment | None:
    """For the first effect that has rivals; an electric drive has no scenario family."""
    if search.verdict.kind != AMBIGUOUS or not crane.drive.hydraulic:
        return None
    own = next(each for each in search.selection.found if each.rivals)
    fitted = search.selection.final
    return plan_experiment(crane, search.expansion, search.cross, fitted, own.slot, own.rivals, options.seed)


def _effect(search: Search, laws: Sequence[Finding], repaired: Repair, tied: Company) -> Effect:
    """One cause with its law, or with the two that its law is a mixture of."""
    found, candidates = laws[0], [each.slot.origin[0] for each in laws]
    name = candidates[0].name
    estimates = repaired.parameters.get(name, {})
    several = tied.partners or sum(each.name in estimates for each in candidates[0].linear) > 1
    return Effect(
        name, tied.rivals, " and ".join(each.slot.label for each in laws if each.slot.label),
        " + ".join(dict.fromkeys(each.latex for each in candidates)), estimates,
        found.p_value, found.gain, found.selection_frequency,
        law_name=_law_name(candidates),
        free=any(each.free for each in candidates),
        combination=known_combination(search, found, estimates, tied.partners, repaired.model) if several else None,
    )  # fmt: skip


def _law_name(candidates: Sequence[Candidate]) -> str:
    """Of one law or of several; the catalogue's own has no name unless there is another beside it."""
    names = dict.fromkeys(each.law_name for each in candidates)
    return " and ".join(name or CATALOGUES for name in names) if len(names) > 1 else next(iter(names))


def _concluded(model: FrictionModel, given: FrictionModel, verdict: str) -> FrictionModel:
    """The model under the verdict that stands; where nothing was put right it is called refitted."""
    changed = model.term_names != given.term_names or model.corrections != given.corrections
    same = not changed and model.values == given.values
    other = given.name if same else model.name.removesuffix(REPAIRED) + REFITTED
    name = model.name if changed else other
    return replace(model, name=name, provenance={**model.provenance, "verdict": verdict})


def _notes(runs: Sequence[Run], loads: Mapping[str, float]) -> tuple[str, ...]:
    notes = [f"{name}: no hook_load; {load / 1e3:.1f} t estimated from the balance" for name, load in loads.items()]
    bare = {reduce(str.removesuffix, adequacy.PARTS, r.name) for r in runs if "wire_layer" not in r and r.groups}
    said = f"no wire_layer in {len(bare)} run{'s' * (len(bare) > 1)}: the outer layer is assumed"
    return (*notes, *([said] if bare else []))


def _amounts(model: FrictionModel, runs: Sequence[Run]) -> list[str]:
    """Which runs have what a table of windows over time says, and how much of it."""
    found = []
    for term in model.terms:
        if term.table is None or not term.table.in_times:
            continue
        level = model.value(term.parameters[0].name)
        own = [(run.name, in_windows(term.table, level, float(run.time[len(run) // 2]))) for run in runs]
        said = ", ".join(f"{name} {amount:.3g}" for name, amount in own if amount)
        found.append(f"{term.name}, N·m at each motor: {said}; to any other run the file gives none")
    return found


def _times(model: FrictionModel, seed: FrictionModel, runs: Sequence[Run]) -> list[str]:
    """Which runs have an error that is not always there, of those that the given model did not know."""
    found = []
    for each in model.corrections:
        if each.during and not each.declared.grows and each.during not in [old.during for old in seed.corrections]:
            there = [run.name for run in runs if each.holds(float(run.time[len(run) // 2]))]
            found.append(f"{each.name} is there in {', '.join(there)}; in no other of these runs")
    return list(dict.fromkeys(found))


def _inexact(side: Side, goes_with: Sequence[str], unit: str) -> list[str]:
    """That more than noise is left beside what is named, and with which signals it goes."""
    left, also = side.size_after.value, f", and what is left goes with {', '.join(goes_with)}" if goes_with else ""
    said = f"keep {left:.3g} {unit} where their noise is {side.noise_floor:.3g}"
    if left <= LIMITS.far_off_the_floor * side.floor:
        return []
    return [f"the locked runs {said}: the cause is named, its law is not exact, or a smaller effect is beside it{also}"]
