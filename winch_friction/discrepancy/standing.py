"""Which names stand: those that the locked runs bear out, no more of them than it takes, and none where one law does
what they do together.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.assembly import Trial, as_given, tried
from winch_friction.discrepancy.candidates.families import shapes_over
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.grammar import Factor, Scored
from winch_friction.discrepancy.engine.omnibus import dependences
from winch_friction.discrepancy.engine.selection import Selection, select, with_fewer
from winch_friction.discrepancy.holdout import Split
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.proof import adds, at_the_floor, is_minor, leaves_too_much, prove, worse_runs
from winch_friction.discrepancy.proposals import near_laws
from winch_friction.discrepancy.search import Search, search_runs
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.verdict import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, Verdict, decide
from winch_friction.discrepancy.vocabulary import FALLING, PICKING, RISING, UNLIKE_A_CURVE
from winch_friction.physics.winch import Crane

# signals of an equation by the proposals' word for them
_SAME = {"speed_magnitude": "motor_speed", "pressure_sum": "pressure"}
_TrialOf = Callable[[Search], Trial]


def standing(split: Split, crane: Crane, options: GapOptions, search: Search, rng: np.random.Generator) -> Trial:
    """The trial that the locked runs bear out: with the names found, with fewer, with what shows beside the moving
    samples, or with none."""
    search = _replicated(search, split, rng)
    trial_of = partial(tried, split, crane, options, rng=rng)
    refit = trial_of(_nameless(search))
    whys = []
    for each in _sets(search, rng):
        full, why = _stands(each, refit, trial_of, rng)
        if full is not None:
            return _each_proven(full, refit, trial_of, rng)
        whys.append(why)
    beside = replace(_nameless(search), ripple=search.ripple, flow=search.flow)
    if search.ripple or search.flow:
        trial = trial_of(beside)
        if not worse_runs(trial.holdout, rng):
            refit = trial
    judged = replace(refit, search=_judged(refit, next(filter(None, whys), ""), rng))
    if judged.search.verdict.kind == UNEXPLAINED != search.verdict.kind and not search.selection.found:
        # little data may lead a refit astray where the model that was given leaves nothing
        given = as_given(split, options, _nameless(search), rng)
        if at_the_floor(given.holdout):
            return replace(given, search=replace(given.search, verdict=Verdict(NOTHING)))
    # what is fitted to a gap that nothing explains may fit the next runs worse than the model that was given
    harmful = judged.search.verdict.kind == UNEXPLAINED and worse_runs(judged.holdout, rng)
    return as_given(split, options, judged.search, rng) if harmful else judged


def by_surfaces(split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator) -> Trial:
    """What no known law explains, or one name's law not well, once more with laws that only the data know; the trial as
    it is where that does not end in a proven name that leaves surely less."""
    given = trial.search
    named = given.verdict.kind in (MISSING, AMBIGUOUS)
    left = given.cross.excess(given.explanation)
    if named and (len(given.explanation.slots) != 1 or left <= LIMITS.least_excess):
        return trial
    search = search_runs(split, given.given, options, rng, surfaces=True)
    if not search.selection.found:
        return trial
    if named and search.cross.excess(search.selection.final) > LIMITS.outdone * left:
        return trial
    other = not_one_law(split, crane, options, standing(split, crane, options, search, rng), rng)
    if other.search.verdict.kind not in (MISSING, AMBIGUOUS):
        return trial
    return other if not named or adds(trial.holdout, other.holdout, rng) else trial


def not_one_law(split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator) -> Trial:
    """The trial without its names where one law that is none of theirs does by itself what they do.

    Of hundreds of laws one that picks the right runs always leaves a little less of those it was chosen on: where one
    name leaves the locked runs at their floor such are asked only if they leave next to nothing of what it leaves.
    """
    search = trial.search
    slots = [slot for slot in search.explanation.slots if not slot.plain]
    left = search.cross.excess(search.explanation)
    asked = len(slots) > 1 or any(slot.free for slot in slots) or (slots and left > LIMITS.least_excess)
    closed = len(slots) == 1 and at_the_floor(trial.holdout)
    near = partial(near_laws, search, split.train, rng)
    laws = _asked(near, search.cross, search.selection.final, closed) if asked else []
    why = outdone(laws, search.cross, search.selection, closed)
    if not why:
        return trial
    refit = tried(split, crane, options, _nameless(search), rng)
    return replace(refit, search=_unexplained(refit.search, why, rng))


def outdone(laws: Sequence[Scored], cross: CrossFit, selection: Selection, closed: bool = False) -> str:
    """Why names do not stand beside a law of the grammar; empty where they do.

    Several names, and a curve, fall where one law does as much; one name of a given law, or one that has `closed` the
    locked gap down to its floor, only where the other takes half of what it leaves. A law that a name's own could be
    speaks for it, if the first of the `laws` does not take half of what that one leaves.
    """
    named = selection.final
    slots = [slot for slot in named.slots if not slot.plain]
    if not laws or not slots:
        return ""
    law = laws[0]
    given = len(slots) == 1 and not slots[0].free
    share = LIMITS.outdone if given or closed else 1.0
    if law.loss - cross.floor > share * (named.loss - cross.floor):
        return ""
    if len(slots) == 1:
        rivals = [slot for found in selection.found for slot in (found.slot, *found.rivals)]
        many = [slot for slot in rivals if _has_laws(slot, cross)]
        own = [each.loss for each in laws if any(_could_be(each, slot, closed) for slot in many)]
        if own and law.loss - cross.floor > LIMITS.outdone * (min(own) - cross.floor):
            return ""
    names = " and ".join(dict.fromkeys(slot.name for slot in slots))
    together = "together " if len(slots) > 1 else ""
    return f"one law of {' and '.join(law.law.signals)} does by itself more than {names} {together}would explain"


def _asked(
    near: Callable[[Sequence[str]], list[Scored]], cross: CrossFit, named: Explanation, closed: bool
) -> list[Scored]:
    """The laws that a set of names is held against, `near` gives them without some kinds of factors."""
    laws = near(())
    surely = laws and laws[0].loss - cross.floor <= LIMITS.surely_outdone * (named.loss - cross.floor)
    return near(PICKING) if closed and laws and not surely else laws


def _could_be(scored: Scored, slot: Slot, closed: bool) -> bool:
    """Whether a law may be what a name's own term draws: of signals that it reads, of their present value, bent the way
    in which its cause's curves may bend.

    Where the name has closed the locked gap, a memory of the same signals says no more than how its law is inexact.
    """
    law, term = scored.law, slot.origin[0].term
    own = {_SAME.get(name, name) for name in term.reads} if term is not None else set()
    unlike = {factor.kind for factor in law.factors} & set(UNLIKE_A_CURVE)
    bent = all(_bends_as(factor, scored, slot.name) for factor in law.factors)
    return set(law.signals) <= own and unlike <= ({"lag"} if closed else set()) and bent


def _bends_as(factor: Factor, scored: Scored, cause: str) -> bool:
    """Whether a factor rises or falls as a cause's curves over its signal may; of what the catalogue draws no curve of
    there is nothing to say, nor of two factors that a negative amount belongs to.
    """
    names = (name for name, word in _SAME.items() if word == factor.signal)
    shapes = set().union(*(shapes_over(cause, name) for name in (factor.signal, *names)))
    turned = scored.amount < 0.0 and (len(scored.law.factors) == 1 or factor.kind == "about")
    rises = (factor.kind in RISING) != turned
    if not shapes or factor.kind not in (*RISING, *FALLING):
        return True
    if shapes == {"convex_rising"} and factor.kind == "root" and rises:
        return False
    return shapes != {"falling"} if rises else "falling" in shapes


def _has_laws(slot: Slot, cross: CrossFit) -> bool:
    """Whether its cause is known under more laws than one: viscous friction of another power is no viscous friction."""
    return slot.free or len({each.law for each in cross.problem.slots if each.name == slot.name}) > 1


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
        yield from (_with_at_most(count, search, rng) for count in reversed(counts))


def _with_at_most(count: int, search: Search, rng: np.random.Generator) -> Search:
    """The best with so many names, judged anew."""
    cross, selection = search.cross, select(search.cross, rng, count)
    left = dependences(cross, cross.remainder(selection.final), rng)
    verdict = decide(cross, selection, left, search.ripple is not None)
    return replace(search, selection=selection, verdict=verdict, left=tuple(left))


def _stands(search: Search, refit: Trial, trial_of: _TrialOf, rng: np.random.Generator) -> tuple[Trial | None, str]:
    """The trial of a set of names where the locked runs bear it out, otherwise why not."""
    slots = search.explanation.slots
    if not slots and not search.reversal:
        return None, search.verdict.refused
    full = trial_of(search)
    names = ", ".join([*search.explanation.names, *([search.reversal.slot.name] if search.reversal else [])])
    if not slots:  # just after reversals a gap of its own has shrunk; the moving samples need only stay as they are
        worse = "".join(worse_runs(full.holdout, rng))
        return (None, worse) if worse else (full, "")
    proof = prove(names, refit.holdout, full.holdout, rng)
    why = proof.why or leaves_too_much(full.holdout)
    return (None, why) if why else (full, "")


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
    """The trial without those names, the one that the training runs miss least first, that the locked runs do not
    need beside the others: which
    take nothing off them surely, or no more than the others' laws may be inexact by, or, beside a name whose law is
    not the catalogue's own and may want mending, those without which nothing would be missing.
    """
    count = len(full.search.selection.final.slots)
    for slot in _least_missed_first(full.search):
        search, final = full.search, full.search.selection.final
        brought = any(slot.name in each.brings for each in final.slots)
        if len(final.slots) == 1 or brought or slot.plain:
            continue
        without = trial_of(_without(search, slot))
        mends = any(each.law for each in without.search.selection.final.slots) and at_the_floor(without.holdout)
        minor = is_minor(refit.holdout, without.holdout, full.holdout) and not leaves_too_much(without.holdout)
        if mends or minor or not adds(without.holdout, full.holdout, rng):
            full = without
    if len(full.search.selection.final.slots) < count:
        full = replace(full, search=_judged_anew(full.search, rng))
    return full


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
    selection = search.selection
    return _of(search, with_fewer(search.cross, selection, selection.final.slots, rng))


def _of(search: Search, selection: Selection) -> Search:
    verdict = search.verdict
    if verdict.kind in (MISSING, AMBIGUOUS):
        verdict = replace(verdict, kind=AMBIGUOUS if any(each.rivals for each in selection.found) else MISSING)
    return replace(search, selection=selection, verdict=verdict)


def _nameless(search: Search) -> Search:
    """The search without any name."""
    selection = replace(search.selection, final=search.selection.base, found=())
    return replace(search, selection=selection, reversal=None, ripple=None, flow=())


def _judged(trial: Trial, why: str, rng: np.random.Generator) -> Search:
    """Without a name for the moving samples: nothing is missing only where the locked runs are at their noise."""
    search = trial.search
    if search.verdict.kind != UNEXPLAINED and at_the_floor(trial.holdout):
        found = search.ripple or search.flow
        return replace(search, verdict=Verdict(MISSING if found else NOTHING, why))
    after, noise = trial.holdout.size_after.value, trial.holdout.noise_floor
    kept = f"the locked runs keep {after:.3g} where their noise is {noise:.3g}"
    return _unexplained(search, "; ".join(filter(None, (why, kept))), rng)


def _unexplained(search: Search, why: str, rng: np.random.Generator) -> Search:
    """The search with the signals that its gap depends on."""
    left = dependences(search.cross, search.cross.remainder(search.selection.base), rng)
    return replace(search, verdict=Verdict(UNEXPLAINED, why), left=tuple(left))
