"""Which names stand: those that the locked runs bear out, and no more of them than it takes."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, GapOptions, Verdict, decide
from winch_friction.discrepancy.assembly import Trial, as_given, tried
from winch_friction.discrepancy.candidates.signals import DELAY
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.engine.blocks import Slot, on_their_own
from winch_friction.discrepancy.engine.chance import dependences, least_part
from winch_friction.discrepancy.engine.selection import Selection, select, with_fewer
from winch_friction.discrepancy.estimates import takes_little, within_a_sample, within_a_step
from winch_friction.discrepancy.expansion import Split
from winch_friction.discrepancy.proof import (
    adds,
    at_the_floor,
    far_off,
    fits_only_its_own,
    is_minor,
    leaves_most,
    leaves_too_much,
    nobodys,
    unproven,
    worse_runs,
)
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.winch import Crane

CONSTANT = {"direction", "count", "gear_ratio", "max_displacement", "density"}  # what every law may read
WHILE_SPEED_CHANGES = (DELAY, "inertia_error")
_TrialOf = Callable[[Search], Trial]


def standing(split: Split, crane: Crane, options: GapOptions, search: Search, rng: np.random.Generator) -> Trial:
    """The trial that the locked runs bear out: with the names found, with fewer, with what shows beside the moving
    samples, or with none."""
    search = _replicated(search, split, rng)
    trial_of = partial(tried, split, crane, options, rng=rng)
    refit = trial_of(nameless(search))
    aside = bool(search.ripple or search.flow)  # of what is in every file no name takes anything off the locked gap
    beside = trial_of(replace(nameless(search), ripple=search.ripple, flow=search.flow)) if aside else refit
    whys = []
    for each in _sets(search, rng):
        full, why = _stands(each, beside, trial_of, rng)
        if full is not None:
            proven = _each_proven(full, beside, trial_of, rng)
            why = proven.search.selection.untold or several_leave_more_than_noise(proven)
            if not why:
                return proven
        whys.append(why)
    if aside and not worse_runs(beside.holdout, rng):
        refit = beside
    judged = replace(refit, search=_judged(refit, next(filter(None, whys), ""), rng))
    if judged.search.verdict.kind == UNEXPLAINED != search.verdict.kind and not search.selection.found:
        # little data may lead a refit astray where the model that was given leaves nothing
        given = as_given(split, options, nameless(search), rng)
        if at_the_floor(given.holdout) and not far_off(given.train):
            return replace(given, search=replace(given.search, verdict=Verdict(NOTHING)))
    # what is fitted to a gap that nothing explains may fit the next runs worse than the model that was given
    harmful = judged.search.verdict.kind == UNEXPLAINED and worse_runs(judged.holdout, rng)
    return as_given(split, options, judged.search, rng) if harmful else judged


def several_leave_more_than_noise(trial: Trial) -> str:
    """Why several names do not stand although each takes its part of the locked gap; empty where they do.

    One name's law may be inexact; of several the second is as likely what the first one's law has wrong, but hardly
    where together they close the many training runs down to their noise, or where each takes a large part.
    """
    search, side, left = trial.search, trial.holdout, trial.holdout.size_after.value
    names = {own.name for own in on_their_own(search.explanation.slots)}
    if len(names) < 2:
        return ""
    closed = search.cross.excess(search.explanation) <= LIMITS.least_excess
    most = LIMITS.at_the_floor * side.excused if closed else LIMITS.several_leave * side.floor
    share = search.cross.excess(search.explanation) / max(search.cross.excess(search.cross.explain(())), 1e-9)
    part = least_part(search.cross, search.explanation, names)
    near = not far_off(side) or share <= LIMITS.left_over * part  # what the smaller could leave of its own, alone
    if left <= most or (near and part >= LIMITS.large_part):
        return ""
    return f"{', '.join(sorted(names))} together leave {left:.3g} where the noise is {side.floor:.3g}"


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
    if len(slots) == 1:  # what the locked runs refuse of one law they may grant a rival that does as well; but what the
        # training runs refuse of it for what it leaves, only one that leaves less
        most = search.cross.excess(search.selection.final) if search.verdict.leaves else np.inf
        for rival in search.selection.found[0].rivals:
            own = decided(search, with_fewer(search.cross, search.selection, (rival,), rng), rng)
            if own.cross.excess(own.selection.final) < most:
                yield own


def _with_at_most(count: int, search: Search, rng: np.random.Generator) -> Search:
    """The best with so many names, judged anew."""
    return decided(search, select(search.cross, rng, count), rng)


def decided(search: Search, selection: Selection, rng: np.random.Generator) -> Search:
    """The search with a selection and the verdict that the training runs give it."""
    left = dependences(search.cross, search.cross.remainder(selection.final), rng)
    verdict = decide(search.cross, selection, left, search.ripple is not None)
    return replace(search, selection=selection, verdict=verdict, left=tuple(left))


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
    if nobodys(refit.holdout) and takes_little(search.cross, search.selection.base, search.explanation):
        why = "the model's own parameters, fitted anew, leave too little of the locked runs for an effect"
        return None, f"{names}: {why}, and of the others this takes hardly more"
    alike = [cross.explain((rival,)) for rival in search.selection.found[0].rivals] if len(slots) == 1 else []
    why = (
        unproven(names, refit.holdout, full.holdout, rng)
        or leaves_too_much(full.holdout)
        or leaves_most(full.train)
        or fits_only_its_own(full.train, full.holdout)
        or within_a_sample(full.repaired.parameters, full.holdout)
        or within_a_step(cross, [search.explanation, *alike], full.holdout.least_noise)
    )
    return (None, why) if why else (full, "")


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
    flow = tuple(each for each in search.flow if each.holds_on(runs, prepared))
    if reversal and not reversal.holds_on(split.holdout, rng):
        reversal = None
    return replace(search, ripple=ripple, flow=flow, reversal=reversal)


def _each_proven(full: Trial, refit: Trial, trial_of: _TrialOf, rng: np.random.Generator) -> Trial:
    """The trial without those names, the one that the training runs miss least first, that the locked runs do not need
    beside the others: which take nothing off them surely, or no more than the others' laws are inexact by, or, beside
    one whose law is not the catalogue's own and may want mending, those without which nothing would be missing.
    """
    every, dropped = full.search, list[Slot]()
    for slot in _least_missed_first(full.search):
        search, final = full.search, full.search.selection.final
        brought = any(slot.name in each.brings for each in final.slots)
        if len(final.slots) == 1 or brought or slot.plain:
            continue
        without = trial_of(_without(search, slot))
        mends = any(each.law for each in without.search.selection.final.slots) and at_the_floor(without.holdout)
        # a second law of a cause is no second name: what it takes may be little beside what the first one does
        same = slot.name in without.search.selection.final.names
        minor = not same and is_minor(refit.holdout, without.holdout, full.holdout)
        minor = minor and not leaves_too_much(without.holdout)
        inexact = (mends or minor) and not _by_another_signal(slot, without, full, rng)
        if inexact or not adds(without.holdout, full.holdout, rng):
            full = without
            dropped.append(slot)
    if dropped:
        full = replace(full, search=_judged_anew(full.search, rng))
        full = _with_those_as_good_alone(full, every, dropped, trial_of, rng)
    return full


def _with_those_as_good_alone(
    one: Trial, every: Search, dropped: Sequence[Slot], trial_of: _TrialOf, rng: np.random.Generator
) -> Trial:
    """The trial of one name with those dropped names as its rivals that leave by themselves no more of the locked runs:
    these do not say which of the two it is, and that one came first says nothing.
    """
    (finding, *more), search = one.search.selection.found, one.search
    known = {finding.slot.name, *(slot.name for slot in finding.rivals)}
    for slot in dropped:
        if more or slot.plain or slot.name in known or len(known) > LIMITS.most_named:
            continue
        alone = every
        for other in every.selection.final.slots:
            alone = alone if other is slot else _without(alone, other)
        if not adds(trial_of(alone).holdout, one.holdout, rng):
            finding, known = replace(finding, rivals=(*finding.rivals, slot)), known | {slot.name}
    return replace(one, search=_of(search, replace(search.selection, found=(finding, *more))))


def _by_another_signal(slot: Slot, without: Trial, full: Trial, rng: np.random.Generator) -> bool:
    """Whether a name brings the locked gap down to its floor, where the others leave more of it or more of the training
    runs than the verdict allows, by a signal that they do not read: then it is no inexactness of theirs."""
    read = {signal for own in without.search.selection.final.slots for signal in _reads(own)}
    if _reads(slot) <= read | CONSTANT:
        return False
    fewer, more = (each.holdout.size_after.value / each.holdout.floor for each in (without, full))
    if more > LIMITS.several_leave:
        return False
    return fewer > LIMITS.several_leave or refused(without, rng)


def refused(trial: Trial, rng: np.random.Generator) -> bool:
    """Whether a trial's names leave more of the training runs than the verdict allows."""
    return decided(trial.search, trial.search.selection, rng).verdict.kind == UNEXPLAINED


def _reads(slot: Slot) -> set[str]:
    """The signals that a name's law reads; what only shows while the speed changes reads the acceleration."""
    return {*slot.origin[0].signals, *(["acceleration"] if slot.name in WHILE_SPEED_CHANGES else [])}


def _least_missed_first(search: Search) -> list[Slot]:
    """The names in the order in which the held-out loss of the training runs rises without them: of two that say much
    the same, the one found first need not be the one that says it best.
    """
    slots = search.selection.final.slots
    without = {id(slot): search.cross.explain(tuple(each for each in slots if each is not slot)) for slot in slots}
    return sorted(slots, key=lambda slot: without[id(slot)].loss)


def _without(search: Search, slot: Slot) -> Search:
    """The search without one of its names."""
    rest = tuple(each for each in search.selection.final.slots if each is not slot)
    found = tuple(each for each in search.selection.found if each.slot is not slot)
    return _of(search, replace(search.selection, final=search.cross.explain(rest), found=found))


def _judged_anew(search: Search, rng: np.random.Generator) -> Search:
    """The search with the rivals that its names have now that others are gone."""
    return _of(search, with_fewer(search.cross, search.selection, search.selection.final.slots, rng))


def _of(search: Search, selection: Selection) -> Search:
    verdict = search.verdict
    if verdict.kind in (MISSING, AMBIGUOUS):
        verdict = replace(verdict, kind=AMBIGUOUS if any(each.rivals for each in selection.found) else MISSING)
    return replace(search, selection=selection, verdict=verdict)


def nameless(search: Search) -> Search:
    """The search without any name."""
    selection = replace(search.selection, final=search.selection.base, found=())
    return replace(search, selection=selection, reversal=None, ripple=None, flow=())


def _judged(trial: Trial, why: str, rng: np.random.Generator) -> Search:
    """Without a name for the moving samples: nothing is missing only where the locked runs are at their noise, and the
    others, one of which may have met what none of the locked runs did, are not far off it. What the search found to be
    no effect of a plausible size tells of something only where the file leaves more than noise somewhere."""
    search = trial.search
    told = search.verdict.kind == UNEXPLAINED and not all(map(nobodys, (trial.train, trial.holdout)))
    if not told and at_the_floor(trial.holdout) and not far_off(trial.train):
        found = search.ripple or search.flow
        return replace(search, verdict=Verdict(MISSING if found else NOTHING, why))
    side, which = (trial.train, "training") if at_the_floor(trial.holdout) else (trial.holdout, "locked")
    kept = f"a refit without a name leaves the {which} runs {side.size_after.value:.3g}, noise {side.noise_floor:.3g}"
    return unexplained(search, "; ".join(filter(None, (why, kept))), rng)


def unexplained(search: Search, why: str, rng: np.random.Generator) -> Search:
    """The search with the signals that its gap depends on."""
    left = dependences(search.cross, search.cross.remainder(search.selection.base), rng)
    return replace(search, verdict=Verdict(UNEXPLAINED, why), left=tuple(left))
