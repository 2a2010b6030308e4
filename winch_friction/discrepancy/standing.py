"""Which names stand: those that the locked runs bear out, and no more of them than it takes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, Side, Verdict
from winch_friction.discrepancy.candidates.signals import within_load_cells
from winch_friction.discrepancy.detectors import flow_balance
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import left_of_first_halves, on_their_own, same_columns
from winch_friction.discrepancy.engine.selection import select, with_fewer
from winch_friction.discrepancy.estimates import takes_little, within_a_sample, within_a_step
from winch_friction.discrepancy.expansion import Given, Split, meet
from winch_friction.discrepancy.outdone import no_port, one_law, told_by_chance
from winch_friction.discrepancy.proof import (
    Trial,
    at_the_floor,
    beside,
    compare,
    far_off,
    fits_only_its_own,
    leaves_most,
    leaves_too_much,
    may_be_none,
    nobodys,
    read_back,
    sized,
    slow_shows,
    unproven,
    worse_runs,
)
from winch_friction.discrepancy.regressors import PORT
from winch_friction.discrepancy.repair import Repair, draft, polished
from winch_friction.discrepancy.run_states import EACH_RUN, SINCE, SOME_RUNS
from winch_friction.discrepancy.search import Search, Study, decided, nameless, unexplained
from winch_friction.discrepancy.several import at_reversals, by_reversals, each_proven, several_leave_more_than_noise
from winch_friction.discrepancy.thresholds import LIMITS

_TrialOf = Callable[[Search], Trial]


def standing(study: Study, search: Search) -> Trial:
    """The trial that the locked runs bear out: with the names found, with fewer, with what shows beside the moving
    samples, or with none, as where one law that is none of theirs does by itself what the names do."""
    trial = _borne_out(study, search)
    why = one_law(trial, study.split.train, study.rng) if _needs_a_rival_law(trial) else ""
    if not why:
        return trial
    refit = tried(study, nameless(trial.search))
    return replace(refit, search=unexplained(refit.search, why, study.rng))


def _needs_a_rival_law(trial: Trial) -> bool:
    """Whether names are to be held against the laws of the grammar: several, a curve, and one that leaves more of the
    training runs than noise; none that leaves nothing that is anybody's of any run."""
    search = trial.search
    slots = on_their_own(search.explanation.slots)
    if not slots:
        return False
    if len({slot.name for slot in slots}) > 1:
        return True
    inexact = any(slot.free for slot in slots) or search.cross.excess(search.explanation) > LIMITS.least_excess
    return inexact and not (nobodys(trial.train) and nobodys(trial.holdout))


def _borne_out(study: Study, search: Search) -> Trial:
    """The same by the locked runs alone."""
    rng = study.rng
    search = _replicated(search, study.split, rng)
    trial_of = partial(tried, study)
    refit = trial_of(nameless(search))
    aside = bool(search.ripple or search.flow)  # of what is in every file no name takes anything off the locked gap
    beside = trial_of(replace(nameless(search), ripple=search.ripple, flow=search.flow)) if aside else refit
    whys = []
    turns = any(slot.origin[0].reversal_gain for slot in search.selection.final.slots)
    for each in chain(_sets(search, rng), at_reversals(study, search) if turns else ()):
        full, why = _stands(each, beside, trial_of, rng)
        if full is not None:
            if several := len(full.search.selection.final.slots) > 1:
                full = each_proven(full, beside, trial_of, rng)
            why = full.search.selection.untold or (several_leave_more_than_noise(full) if several else "")
            if not why:
                shown = full.search.reversal if full.search.explanation.slots else None
                return full if shown is None else by_reversals(study, full, shown, trial_of)
        whys.append(why)
    if aside and not worse_runs(beside.holdout, rng):
        refit = beside
    judged = replace(refit, search=_judged(refit, next(filter(None, whys), ""), rng))
    alone = not search.selection.found and not aside  # beside a ripple or a leak the refit has it, the given model not
    if judged.search.verdict.kind == UNEXPLAINED != search.verdict.kind and alone:
        # little data may lead a refit astray where the model that was given leaves nothing
        given = as_given(study, nameless(search))
        if at_the_floor(given.holdout) and not far_off(given.train):
            return replace(given, search=replace(given.search, verdict=Verdict(NOTHING)))
    # what is fitted to a gap that nothing explains may fit the next runs worse than the model that was given
    harmful = judged.search.verdict.kind == UNEXPLAINED and worse_runs(judged.holdout, rng)
    return as_given(study, judged.search) if harmful else judged


def _sets(search: Search, rng: np.random.Generator) -> Iterator[Search]:
    """The search as it is, and with fewer names; these first where a curve is among several causes, whose own second
    order otherwise passes for another effect."""
    slots = search.selection.final.slots
    counts = range(1, len(slots)) if not any(slot.plain for slot in slots) else range(0)
    if any(slot.free for slot in slots) and len({slot.name for slot in slots}) > 1:
        yield from (_with_at_most(count, search, rng) for count in counts)
        yield search
    else:
        yield search
        if len(search.selection.final.names) < len(slots):  # one cause by two laws, but perhaps it is two
            yield decided(search, select(search.cross, rng, apart=True), rng)
        yield from (_with_at_most(count, search, rng) for count in reversed(counts))
    if len(slots) in (1, 2):  # what the locked runs refuse of one law they may grant a rival that does as well; but
        # what the training runs refuse of it for what it leaves, only one that leaves less
        most = search.cross.excess(search.selection.final) if search.verdict.leaves else np.inf
        for k, rival in [(k, rival) for k, each in enumerate(search.selection.found) for rival in each.rivals]:
            swapped = (*slots[:k], rival, *slots[k + 1 :])
            own = decided(search, with_fewer(search.cross, search.selection, swapped, rng), rng)
            if own.cross.excess(own.selection.final) < most:
                yield own


def _with_at_most(count: int, search: Search, rng: np.random.Generator) -> Search:
    """The best with so many names, judged anew."""
    return decided(search, select(search.cross, rng, count), rng)


def _stands(search: Search, refit: Trial, trial_of: _TrialOf, rng: np.random.Generator) -> tuple[Trial | None, str]:
    """The trial of a set of names where the locked runs bear it out, otherwise why not."""
    slots = search.explanation.slots
    if not slots and not search.reversal:
        return _stands_though_refused(search, refit, trial_of, rng)
    full, cross = trial_of(search), search.cross
    names = ", ".join([*search.explanation.names, *([search.reversal.slot.name] if search.reversal else [])])
    if not slots:  # just after reversals a gap of its own has shrunk; the moving samples need only stay as they are
        worse = ", ".join(worse_runs(full.holdout, rng))
        return (None, f"{names}: the gap of {worse} grows") if worse else (full, "")
    few = nobodys(refit.holdout) and not slow_shows(refit.holdout)
    if few and takes_little(search.cross, search.selection.base, search.explanation):
        why = "the model's own parameters, fitted anew, leave too little of the locked runs for an effect"
        return None, f"{names}: {why}, and of the others this takes hardly more"
    rivals, least = search.selection.found[0].rivals if len(slots) == 1 else (), full.holdout.least_noise
    why = (
        unproven(names, refit.holdout, full.holdout, rng)
        or leaves_too_much(full.holdout)
        or leaves_most(full.train)
        or fits_only_its_own(full.train, full.holdout)
        or within_a_sample(full.repaired.parameters, full.holdout)
        or (no_port(full.repaired.parameters) if PORT in search.explanation.names else "")
        or may_be_none(slots, full, refit)
        or _chosen_not_whole(slots, full.holdout)
        or within_a_step(cross, fitted := [search.explanation, *(cross.explain((each,)) for each in rivals)], least)
        or within_load_cells(cross, fitted, least)
        or ("" if all(slot.origin[0].opposing for slot in slots) else told_by_chance(full))
    )
    return (None, why) if why else (full, "")


def _chosen_not_whole(slots: Sequence[Slot], locked: Side) -> str:
    """Why a name is refused that is there in chosen runs alone, where it leaves plainly more than noise: any law that
    may choose its runs takes a part of what is in some, and true ones left at most 1.5 of the noise in four draws."""
    chosen = [slot.name for slot in on_their_own(slots) if slot.law in (SOME_RUNS, SINCE, EACH_RUN)]
    if not chosen or not far_off(locked):
        return ""
    left = f"{locked.size_after.value:.3g} where the noise is {locked.floor:.3g}"
    return f"{', '.join(chosen)}: a law that chooses its runs has to say all of it, and leaves {left}"


def _stands_though_refused(
    search: Search, refit: Trial, trial_of: _TrialOf, rng: np.random.Generator
) -> tuple[Trial | None, str]:
    """The same for one name which is refused only for what it leaves of the training runs, as noise that a motion
    sensor or a reversal adds there: it stands where it leaves next to nothing of the locked runs and little of the
    others.
    """
    found = search.selection.found
    if search.verdict.kind != UNEXPLAINED or not search.verdict.leaves or len(found) != 1 or found[0].slot.free:
        return None, search.verdict.refused
    kind = AMBIGUOUS if found[0].rivals else MISSING
    full, why = _stands(replace(search, verdict=Verdict(kind)), refit, trial_of, rng)
    if full is None or full.holdout.size_after.value > LIMITS.several_leave * full.holdout.floor or far_off(full.train):
        return None, "; ".join(filter(None, (search.verdict.refused, why)))
    return full, ""


def _replicated(search: Search, split: Split, rng: np.random.Generator) -> Search:
    """The search with only those findings beside the moving samples that show in the locked runs as well."""
    given = search.given
    locked = [(run, p) for run, p in zip(given.runs, given.prepared, strict=True) if run.name in split.holdout]
    runs, prepared = [run for run, _ in locked], [p for _, p in locked]
    ripple, reversal = search.ripple, search.reversal
    if ripple and not angle.holds_on(ripple, runs, prepared, given.crane, given.model):
        ripple = None
    flow = tuple(each for each in search.flow if flow_balance.holds_on(each, runs, prepared))
    if reversal and not reversal.holds_on(split.holdout, rng):
        reversal = None
    return replace(search, ripple=ripple, flow=flow, reversal=reversal)


def not_borne_out(search: Search, stands: Search) -> list[str]:
    """What the training runs show beside the moving samples and does not stand in the end, a sentence each."""
    shown = {each.effect.name: each.effect for each in (*search.flow, search.ripple) if each}
    kept = {each.effect.name for each in (*stands.flow, stands.ripple) if each}
    but = "but by none of its laws does it hold in the locked runs, so it is not named"
    return [f"{n}: the training runs show it ({each.where}), {but}" for n, each in shown.items() if n not in kept]


def _judged(trial: Trial, why: str, rng: np.random.Generator) -> Search:
    """Without a name for the moving samples: nothing is missing only where the locked runs are at their noise, and the
    others, one of which may have met what none of the locked runs did, are not far off it, nor the slowest tenth of
    either (of a slow ripple the blocks' means have some). What the search found to be no effect of a plausible size
    tells of something only where the file leaves more than noise somewhere."""
    search, sides = trial.search, {"locked": trial.holdout, "training": trial.train}
    told = search.verdict.kind == UNEXPLAINED and not all(map(nobodys, sides.values()))
    shows = (which for which, side in sides.items() if slow_shows(side, LIMITS.far_off_the_floor))
    slow = "" if search.ripple else next(shows, "")
    if not told and not slow and at_the_floor(trial.holdout) and not far_off(trial.train):
        found = search.ripple or search.flow
        return replace(search, verdict=Verdict(MISSING if found else NOTHING, why))
    side = sides[which := "training" if at_the_floor(trial.holdout) else "locked"]
    kept = f"a refit without a name leaves the {which} runs {side.size_after.value:.3g}, noise {side.noise_floor:.3g}"
    if slow:
        kept = f"{kept}; the slowest tenth of the {slow} ones keeps {sides[slow].slowest:.3g}"
    return unexplained(search, "; ".join(filter(None, (why, kept))), rng)


# -- the file that a search would write, put to all runs
def tried(study: Study, search: Search) -> Trial:
    """The repaired model of a search and what it leaves of all runs, read back from its file."""
    search, split = placed(search, study.split), study.split
    given, drafted = search.given, draft(search, search.explanation, _provenance(study, search))
    # a set without a name is tried by every way that asks again, and only its provenance is another
    model, covariance = drafted.model, drafted.model.covariance
    key = (
        model.name, model.terms, model.values, None if covariance is None else covariance.tobytes(), model.corrections,
        repr((model.bounds, drafted.parameters, drafted.said, drafted.cut)), split.train, split.holdout,
    )  # fmt: skip
    repaired, gaps = given.once(key, partial(_polished_and_met, study, given, drafted))
    model = replace(repaired.model, provenance=drafted.model.provenance)
    train, holdout = (sized(each, study.rng) for each in gaps)
    return Trial(search, replace(repaired, model=model), train, holdout)


def _polished_and_met(study: Study, given: Given, drafted: Repair) -> tuple[Repair, tuple[Side, Side]]:
    """A draft fitted once more, and what its file leaves of the training and of the locked runs."""
    split = study.split
    repaired = polished(drafted, given.model, split.runs, split.train, study.crane, given)
    after = meet(split.runs, study.crane, read_back(repaired.model), (), given)
    return repaired, (beside(given, after, split.train), beside(given, after, split.holdout))


def as_given(study: Study, search: Search) -> Trial:
    """The given model as it is, where a refit would only make it worse on the locked runs."""
    given, split = search.given, study.split
    model = replace(given.model, provenance={**given.model.provenance, **_provenance(study, search)})
    train, holdout = (compare(given, given, names, study.rng) for names in (split.train, split.holdout))
    return Trial(search, Repair(model, {}), train, holdout)


def _provenance(study: Study, search: Search) -> Mapping[str, Any]:
    return {
        "repaired_by": "winch-friction gap", "verdict": search.verdict.kind, "trained_on": list(study.split.train),
        "seed": study.options.seed,
    }  # fmt: skip


def placed(search: Search, split: Split) -> Search:
    """The search with each effect that has an instant at the one that the locked runs tell by their first halves.

    The training runs say between which two of them a machine changed, and of the instants between these they cannot
    say more: on them the columns are the same. A locked run between was before the change or after it, as it is in a
    state (`run_states`): the first half of its samples says which, and all of it is what the names are proven on.
    """
    for k, slot in enumerate(search.selection.final.slots):
        if others := same_columns(search.cross, slot):
            search = _told(search, k, [slot, *others], split)
    return search


def _told(search: Search, k: int, shapes: list[Slot], split: Split) -> Search:
    """The search with that of the shapes for its effect number `k` that leaves least of the locked runs' first
    halves."""
    selection, final = search.selection, search.selection.final
    sets = [(*final.slots[:k], each, *final.slots[k + 1 :]) for each in shapes]
    locked = search.expansion.cross(split.holdout, final.slots)
    best = min(sets, key=lambda slots: left_of_first_halves(locked, replace(final, slots=slots)))
    found = [replace(each, slot=best[k]) if each.slot is final.slots[k] else each for each in selection.found]
    return replace(search, selection=replace(selection, final=search.cross.explain(best), found=tuple(found)))
