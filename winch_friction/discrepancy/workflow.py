"""Locate, name, add, prove: the whole workflow on runs in memory.

Last it is asked whether one law of the grammar does by itself what names do: then they do not stand, however well they
fit.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy import adequacy
from winch_friction.discrepancy.adequacy import lock_holdout, refuse
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, GapOptions, GapResult
from winch_friction.discrepancy.assembly import Trial, assemble, insufficient, tried
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.candidates.catalogue import of_one_group
from winch_friction.discrepancy.candidates.families import SURFACES, free_members, shapes_over
from winch_friction.discrepancy.engine.blocks import Slot, on_their_own
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.grammar import Factor, Scored
from winch_friction.discrepancy.engine.selection import Selection
from winch_friction.discrepancy.estimates import try_seed, widened
from winch_friction.discrepancy.expansion import Expansion, Given, Split, as_rigid, expand_around, meet, swings
from winch_friction.discrepancy.next_experiment import of_wire
from winch_friction.discrepancy.preparation.grid import thinned
from winch_friction.discrepancy.preparation.own_simulation import SIMULATED, against_simulations
from winch_friction.discrepancy.proof import adds, at_the_floor, far_off, nobodys
from winch_friction.discrepancy.proposals import Proposal, explained, near_laws, propose
from winch_friction.discrepancy.run_states import EACH_RUN, another_in_each_run
from winch_friction.discrepancy.search import Search, search_runs
from winch_friction.discrepancy.standing import nameless, refused, standing, unexplained
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.vocabulary import FALLING, PICKING, RISING, UNLIKE_A_CURVE
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.records.runs import apart, without_broken

# -- names that one law outdoes

# signals of an equation by the proposals' word for them
_SAME = {"speed_magnitude": "motor_speed", "pressure_sum": "pressure"}


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


def _closing(
    split: Split, crane: Crane, options: GapOptions, search: Search, trial: Trial, rng: np.random.Generator
) -> Trial:
    """What a search finds, if it brings the locked runs to their floor and the others near theirs; else the trial."""
    other = not_one_law(split, crane, options, standing(split, crane, options, search, rng), rng)
    named = other.search.verdict.kind in (MISSING, AMBIGUOUS)
    return other if named and at_the_floor(other.holdout) and not far_off(other.train) else trial


def not_one_law(split: Split, crane: Crane, options: GapOptions, trial: Trial, rng: np.random.Generator) -> Trial:
    """The trial without its names where one law that is none of theirs does by itself what they do.

    Of hundreds of laws one that picks the right runs always leaves a little less of those it was chosen on: where one
    name leaves the locked runs at their floor such are asked only if they leave next to nothing of what it leaves, and
    where it leaves nothing that is anybody's of any run none.
    """
    search = trial.search
    slots = on_their_own(search.explanation.slots)
    left = search.cross.excess(search.explanation)
    causes = {slot.name for slot in slots}
    asked = len(causes) > 1 or any(slot.free for slot in slots) or (slots and left > LIMITS.least_excess)
    asked = asked and not (len(causes) == 1 and nobodys(trial.train) and nobodys(trial.holdout))
    closed = bool(asked) and len(causes) == 1 and _closed(trial, rng)
    near = partial(near_laws, search, split.train, rng)
    laws = _asked(near, search.cross, search.selection.final, closed) if asked else []
    why = outdone(laws, search.cross, search.selection, closed)
    if not why:
        return trial
    refit = tried(split, crane, options, nameless(search), rng)
    return replace(refit, search=unexplained(refit.search, why, rng))


def _closed(trial: Trial, rng: np.random.Generator) -> bool:
    """Whether names leave the locked runs at their floor, and of the training runs no more than the verdict allows.

    A few locked runs do not vouch for what the many others refuse: a name whose company was dropped may leave in these
    a third of the gap, for which it would never have been given by itself.
    """
    if not at_the_floor(trial.holdout):
        return False
    return not refused(trial, rng)


def outdone(laws: Sequence[Scored], cross: CrossFit, selection: Selection, closed: bool = False) -> str:
    """Why names do not stand beside a law of the grammar; empty where they do.

    Several names, and a curve, fall where one law does as much; one name of a given law, or one that has `closed` the
    locked gap down to its floor, only where the other takes half of what it leaves. A law that a name's own could be
    speaks for it, if the first of the `laws` does not take half of what that one leaves.
    """
    named = selection.final
    slots = on_their_own(named.slots)
    if not laws or not slots:
        return ""
    law = laws[0]
    one = len({slot.name for slot in slots}) == 1
    given = one and not any(slot.free for slot in slots)
    left, left_by_law = _above_floor(cross, named.loss), _above_floor(cross, law.loss)
    if left_by_law >= LIMITS.outdone * left if given or closed else left_by_law > left:
        return ""
    if one:
        rivals = [slot for found in selection.found for slot in (found.slot, *found.rivals)]
        many = [slot for slot in rivals if _has_laws(slot, cross)]
        own = [each.loss for each in laws if any(_could_be(each, slot, closed) for slot in many)]
        if own and left_by_law >= LIMITS.outdone * _above_floor(cross, min(own)):
            return ""
    names = " and ".join(dict.fromkeys(slot.name for slot in slots))
    together = "" if one else "together "
    return f"one law of {' and '.join(law.law.signals)} does by itself more than {names} {together}would explain"


def _above_floor(cross: CrossFit, loss: float) -> float:
    """What a loss leaves above the noise; of nothing, nobody takes half."""
    return max(loss - cross.floor, 0.0)


def _asked(
    near: Callable[[Sequence[str]], list[Scored]], cross: CrossFit, named: Explanation, closed: bool
) -> list[Scored]:
    """The laws that a set of names is held against, `near` gives them without some kinds of factors."""
    laws = near(())
    left = LIMITS.surely_outdone * _above_floor(cross, named.loss)
    surely = laws and _above_floor(cross, laws[0].loss) < left
    return near(PICKING) if closed and laws and not surely else laws


def _could_be(scored: Scored, slot: Slot, closed: bool) -> bool:
    """Whether a law may be what a name's own term or correction draws: of signals that it reads, of their present
    value, acting as it acts and bent the way in which its cause's curves may bend.

    Where the name has closed the locked gap, a memory of the same signals says no more than how its law is inexact.
    """
    law, candidate = scored.law, slot.origin[0]
    own = {_SAME.get(name, name) for name in candidate.signals} if law.opposing == candidate.opposing else set()
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
    """Whether its cause is known under more laws than one: viscous friction of another power is no viscous friction; an
    error of signals or load has any."""
    laws = {each.law for each in cross.problem.slots if each.name == slot.name}
    return slot.free or slot.origin[0].term is None or len(laws) > 1


# -- the order of the steps
def find_gap(runs: Sequence[Run], crane: Crane, model: FrictionModel, options: GapOptions | None = None) -> GapResult:
    """Where runs and model disagree, which effect is missing, and the proof on locked runs.

    Raises `InputError` for runs that lack what the torque balance needs, for two runs of one name and for no run at
    all.
    """
    options = options or GapOptions()
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
        return insufficient([*checks, names], notes, crane, model, (given, split))
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
    result = replace(
        result, seed_model=model, seed_refuted=refuted, adequacy=tuple(checks), notes=(*notes, *result.notes),
        proposals=proposals,
    )  # fmt: skip
    swing = adequacy.of_swing(crane, [*result.train.left_by_run, *result.holdout.left_by_run])
    # a floor that noise alone has raised excuses nothing: then it is not known whether anything is missing
    if not swing.met and (result.verdict == UNEXPLAINED or (result.verdict == NOTHING and not nobodys(result.holdout))):
        return insufficient([*checks, swing], notes, crane, model, (given, split))
    return result


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
