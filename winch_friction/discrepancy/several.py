"""Which of several names stand: each must take its part of the locked gap, and all of them together leave noise; and
which of a cause's two regimes, where the other does not."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, Verdict
from winch_friction.discrepancy.candidates.lateness import DELAY
from winch_friction.discrepancy.catalogue import testable
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import least_part
from winch_friction.discrepancy.engine.crossfit import on_their_own
from winch_friction.discrepancy.engine.selection import Selection, with_fewer
from winch_friction.discrepancy.engine.trials import reshaped
from winch_friction.discrepancy.expansion import Expansion, meet
from winch_friction.discrepancy.proof import Trial, adds, at_the_floor, far_off, is_minor, leaves_too_much, read_back
from winch_friction.discrepancy.regressors import base_of, layout_of
from winch_friction.discrepancy.search import (
    ReversalFinding,
    Search,
    Study,
    after_reversals,
    every_candidate,
    nameless,
    refused,
)
from winch_friction.discrepancy.thresholds import LIMITS

CONSTANT = {"direction", "count", "gear_ratio", "max_displacement", "density"}  # what every law may read
WHILE_SPEED_CHANGES = (DELAY, "inertia_error")
ON_THE_DRUM = {"tare_load", "layer_radius"}  # add to the load, by the wire that is out and by the layer in use


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


def each_proven(full: Trial, refit: Trial, trial_of: Callable[[Search], Trial], rng: np.random.Generator) -> Trial:
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
        minor = is_minor(refit.holdout, without.holdout, full.holdout) and not leaves_too_much(without.holdout)
        # a second law of a cause is no second name: it is there to mend the first one, and may take little beside it
        same = slot.name in without.search.selection.final.names
        inexact = not same and (mends or minor) and not _by_another_signal(slot, without, full, rng)
        if inexact or not adds(without.holdout, full.holdout, rng):
            full = without
            dropped.append(slot)
    if dropped:
        anew = _judged_anew(full.search, rng)
        same = anew.selection.final.slots == full.search.selection.final.slots
        full = replace(full, search=anew) if same else trial_of(anew)
        full = _with_those_as_good_alone(full, every, dropped, trial_of, rng)
    return full


def by_reversals(study: Study, full: Trial, shown: ReversalFinding, trial_of: Callable[[Search], Trial]) -> Trial:
    """The trial without what is `shown` just after reversals beside names, where the file of these alone shows nothing
    of it: of a large effect a linear fit leaves most where the motion turns, and the file leaves none of that.
    """
    search = full.search
    alone, own = trial_of(replace(search, reversal=None)), shown.slot.origin[0]
    model = read_back(alone.repaired.model)
    bare = replace(model, corrections=())  # the runs are without them, and what they would change is not asked again
    given = replace(meet(study.split.runs, study.crane, model, (), search.given), model=bare)
    seen = Expansion(given.prepared, layout_of(base_of(bare, bare), (), given.prepared, bare), bare)
    base = seen.cross(study.split.train).explain(())
    shows = after_reversals(given, seen, base, [own], study.split.train, study.rng, lambda each: each)
    return full if shows is not None else alone


def at_reversals(study: Study, search: Search) -> Iterator[Search]:
    """The search with nothing named but what shows just after reversals, where it is one of the causes that were found
    in the moving samples as well: of these the base takes up most, and what is left of them may be too little for a
    name though a reversal itself shows it plainly. A cause that is named is not looked for there."""
    of_reversals = {each.name for each in search.selection.final.slots if each.origin[0].reversal_gain}
    given, train = search.given, study.split.train
    known, _ = testable(study.options.candidates or every_candidate(study, given), given.prepared, given.model)
    bare = search.cross.explain(())
    shown = after_reversals(given, search.expansion, bare, known, train, study.rng, lambda each: each)
    if shown and shown.slot.name in of_reversals and shown.holds_on(study.split.holdout, study.rng):
        yield replace(nameless(search), reversal=shown, verdict=Verdict(MISSING))


def _with_those_as_good_alone(
    one: Trial, every: Search, dropped: Sequence[Slot], trial_of: Callable[[Search], Trial], rng: np.random.Generator
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
    if slot.name in ON_THE_DRUM and ON_THE_DRUM & set(without.search.selection.final.names) and _wound(full.search):
        return False
    read = {signal for own in without.search.selection.final.slots for signal in _reads(own)}
    if _reads(slot) <= read | CONSTANT:
        return False
    fewer, more = (each.holdout.size_after.value / each.holdout.floor for each in (without, full))
    if more > LIMITS.several_leave:
        return False
    return fewer > LIMITS.several_leave or refused(without.search, rng)


def _wound(search: Search) -> bool:
    """Whether the wire that is out tells the layer in use, as on a drum that is paid out: then an error of the load by
    its length and one of the radius by layer are each what the other's law is inexact by."""
    names = ("wire_out", "wire_layer")
    runs = [run for run in search.given.prepared if all(name in run.channels for name in names)]
    if len(runs) < LIMITS.fewest_levels:
        return False
    out, layer = (np.array([np.median(run.channels[name]) for run in runs]) for name in names)
    if min(np.ptp(out), np.ptp(layer)) <= 0.0:
        return False
    return bool(1.0 - np.corrcoef(out, layer)[0, 1] ** 2 <= LIMITS.told_by_signal)


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
    """The search with the shapes and the rivals that its names have now that others are gone: a shape that was chosen
    beside a second law of its cause leaves much without it, which the file, fitted anew, does not."""
    slots = reshaped(search.cross, search.selection.final.slots)
    return _of(search, with_fewer(search.cross, search.selection, slots, rng))


def _of(search: Search, selection: Selection) -> Search:
    verdict = search.verdict
    if verdict.kind in (MISSING, AMBIGUOUS):
        verdict = replace(verdict, kind=AMBIGUOUS if any(each.rivals for each in selection.found) else MISSING)
    return replace(search, selection=selection, verdict=verdict)
