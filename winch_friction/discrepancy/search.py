"""Locate and name on the training runs: everything that happens before the locked runs are looked at.

What shows only just after a reversal, bristles that turn over with travel and contacts that have grown while at rest,
has a problem of its own. The moving regime names everything else first; here its explanation is the base, on samples
whose travel since the reversal is certain but short. Samples at rest take no part: static friction is undetermined
there.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.answer import MISSING, NOTHING, UNEXPLAINED, Effect, GapOptions, Verdict, decide
from winch_friction.discrepancy.candidates.candidate import MOVING, REVERSALS, Candidate, Estimates, Shape, Untestable
from winch_friction.discrepancy.candidates.creep import GAS
from winch_friction.discrepancy.candidates.friction import blurred_travel
from winch_friction.discrepancy.candidates.lateness import DELAY, SMALL, tau
from winch_friction.discrepancy.catalogue import at_hand, testable
from winch_friction.discrepancy.detectors import flow_balance
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.detectors.delay import without_delay
from winch_friction.discrepancy.detectors.delay_course import passing_delay
from winch_friction.discrepancy.detectors.lost_flow import FreeAir, Leakage
from winch_friction.discrepancy.detectors.ripple import Ripple
from winch_friction.discrepancy.detectors.ripple_waves import waves_of, without_ripple
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import Dependence, chance_of_no_gain, dependences, most_of_it, near
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, flip_p_values
from winch_friction.discrepancy.engine.selection import Selection, select
from winch_friction.discrepancy.engine.trials import candidate_trials
from winch_friction.discrepancy.expansion import Expansion, Given, Split, expand_around
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import base_of, build_problem, layout_of
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch import Crane

LastResort = Callable[[Sequence[PreparedRun], FrictionModel], list[Candidate]]
BY_LOAD = ("gear_load_loss", "sheave_bending")
PRESSES = 0.5  # of the longest small delay: of a filter of 60 ms the first derivative told 33

# -- just after reversals
SIGNIFICANCE_AFTER_REVERSALS = 0.005
FEWEST_BLOCKS = 200


@dataclass(frozen=True)
class ReversalFinding:
    """One effect of the turning regime: its slot in the regime's own problem, evidence and fit."""

    slot: Slot
    p_value: float
    gain: float
    cross: CrossFit
    fitted: Explanation
    base: Explanation  # the same without it
    expansion: Expansion

    def effect(self, parameters: Estimates) -> Effect:
        """The finding as an entry of the result, with its parameters in the repaired model."""
        candidate = self.slot.origin[0]
        return Effect(
            candidate.name, (), self.slot.label, candidate.latex, parameters, self.p_value, self.gain, 1.0,
            "just after reversals", candidate.law_name, candidate.free,
        )  # fmt: skip

    def holds_on(self, names: Sequence[str], rng: np.random.Generator) -> bool:
        """Whether it also shrinks the gap just after reversals of runs that it was not fitted to, each run by its own
        noise: one whose reversals are blurred would otherwise speak for all."""
        chosen = [run for run in self.expansion.runs if run.name in names and run.used.any()]
        if not chosen:
            return False
        blocks = build_problem(chosen, self.expansion.layout, by_sample=True).blocks
        columns = self.cross.problem.columns
        without, with_it = (
            (blocks.y - blocks.x[:, list(columns(each.slots))] @ each.beta) * blocks.weight
            for each in (self.base, self.fitted)
        )
        return chance_of_no_gain(without, with_it, blocks.segment, blocks.run, rng) <= LIMITS.proof_p


def too_short(candidate: Candidate, shape: Shape, runs: Sequence[PreparedRun]) -> bool:
    """Whether a travel is over before the instant of a reversal is known."""
    if candidate.shortest is None:
        return False
    name, least = candidate.shortest
    return shape.values[name] <= max(least, blurred_travel(runs))


def after_reversals(
    given: Given, expansion: Expansion, explanation: Explanation, candidates: Sequence[Candidate],
    train: Sequence[str], rng: np.random.Generator, cleaned: Callable[[Expansion], Expansion],
) -> ReversalFinding | None:  # fmt: skip
    """The best effect just after reversals, if it is one that only shows there, surely and usefully.

    `cleaned` takes out of the runs what has been found beside the torque balance.
    """
    named = {slot.name for slot in explanation.slots}
    balanced = [each for each in candidates if each.regime in (MOVING, REVERSALS)]
    tried = [each for each in balanced if each.reversal_rival or each.name in named]
    if DELAY in named:  # with speed and pressure apart, the instant of a reversal is not known well enough
        return None
    turning = cleaned(expand_around(given, expansion, explanation, tried, turning=True))
    if GAS in named:  # what its law has wrong is largest where the passive side's motion turns
        turning = replace(turning, runs=tuple(run for run in turning.runs if len(run.groups) < 2))
    chosen = [run for run in turning.runs if run.name in train and run.used.any()]
    if sum(int(run.used.sum()) for run in chosen) < FEWEST_BLOCKS:
        return None
    cross = CrossFit(build_problem(chosen, turning.layout, by_sample=True))
    kept = [turning.layout.slot_like(slot) for slot in explanation.slots]
    base = cross.explain(kept)
    trials = candidate_trials(cross, base, named)
    if not trials:
        return None
    p = flip_p_values(np.array([base.losses - each.losses for each in trials]), rng)
    best = min(range(len(trials)), key=lambda k: trials[k].loss)
    gain = cross.gain(base, trials[best])
    candidate, shape = trials[best].slots[-1].origin
    if too_short(candidate, shape, chosen) or cross.at_bound(trials[best], trials[best].slots[-1]):
        return None
    # what a named effect's law leaves of itself is its own second order, here as elsewhere
    own = max(cross.explain(()).loss - base.loss, 0.0) if kept else 0.0
    if base.loss - trials[best].loss < LIMITS.small_left_over * own:
        return None
    # what swings, rings or is squeezed after a reversal is imitated in part; what is there is most of it
    if base.loss - trials[best].loss < LIMITS.reversal_share * (base.loss - cross.floor):
        return None
    least = 1.0 if candidate.reversal_gain is None else candidate.reversal_gain
    if p[best] > SIGNIFICANCE_AFTER_REVERSALS or gain < least:
        return None
    return ReversalFinding(trials[best].slots[-1], float(p[best]), float(gain), cross, trials[best], base, turning)


# -- the search
@dataclass(frozen=True)
class Study:
    """What every step of one call shares: the locked runs, the crane, what the user chose, the source of chance."""

    split: Split
    crane: Crane
    options: GapOptions
    rng: np.random.Generator


def long_delay(slots: Sequence[Slot], cross: CrossFit, fitted: Explanation) -> Slot | None:
    """The first delay among these that its first derivative does not tell: of the longer ones that are tried, or a
    small one that was fitted so large that it may be longer."""
    for slot in slots:
        if slot.name != DELAY or slot.law:
            continue
        shape: Shape = slot.origin[1]
        small = 0.0 not in (shape.values["ahead"], shape.values["behind"])
        if not small or slot in fitted.slots and abs(cross.size(fitted, slot)) >= PRESSES * SMALL * tau.typical:
            return slot
    return None


@dataclass(frozen=True)
class Search:
    """What the training runs gave."""

    given: Given
    train: tuple[str, ...]  # names of the runs that it learnt from
    at_seed: Expansion
    expansion: Expansion
    cross: CrossFit
    selection: Selection
    left: tuple[Dependence, ...]
    verdict: Verdict
    reversal: ReversalFinding | None
    ripple: Ripple | None
    flow: tuple[Leakage | FreeAir, ...]
    untestable: tuple[Untestable, ...]

    @property
    def explanation(self) -> Explanation:
        """The effects that the verdict stands by."""
        return self.selection.base if self.verdict.kind in (UNEXPLAINED, NOTHING) else self.selection.final


def every_candidate(study: Study, given: Given) -> Sequence[Candidate]:
    """All that a search of these runs begins with."""
    file = study.options.effects_file
    return given.once(("candidates", file), lambda: at_hand(given.prepared, given.model, file))


def search_runs(study: Study, given: Given, also: LastResort | None = None) -> Search:
    """What is missing according to the training runs; raises `InputError` for runs that lack what the balance needs.

    `also` makes candidates of last resort of all runs and the model, such as laws that only the data know, over two
    signals at once: then it is one cause alone, for one of these with company imitates anything.
    """
    model, prepared, train, rng = given.model, given.prepared, study.split.train, study.rng
    training = [(r, p) for r, p in zip(given.runs, prepared, strict=True) if r.name in train]
    own_runs, own_prepared = [r for r, _ in training], [p for _, p in training]
    ripple = given.once(("ripple", train), partial(angle.detect, own_runs, own_prepared, given.crane, model))
    known = study.options.candidates or every_candidate(study, given)
    if also is not None:
        known = [*known, *also(prepared, model)]
    usable, blind = testable(known, prepared, model)
    candidates = [each for each in usable if each.regime == MOVING]
    at_seed = Expansion(prepared, layout_of(base_of(model, model), candidates, prepared, model), model)
    cross = _cleaned(at_seed, ripple, _waves(at_seed, ripple)).cross(train)
    expansion, selection = at_seed, select(cross, rng, 1)
    for _ in range(LIMITS.most_expansions):
        shapes = (*selection.final.slots, *near(cross, selection.final))
        candidates, usable = (_refined(each, shapes) for each in (candidates, usable))
        if not selection.final.slots and (most := most_of_it(cross, selection.base)):
            shapes = (most,)
        late = long_delay(shapes, cross, selection.final) if shapes else passing_delay(given, train, cross, selection)
        if late is not None:
            candidates = without_delay(given, candidates, late, cross, selection.final, train)
        del cross  # the largest thing there is, and not needed beside the next one
        around = expand_around(given, expansion, selection.final, candidates)
        waves = _waves(around, ripple)
        expansion = _cleaned(around, ripple, waves)
        cross = expansion.cross(train, selection.final.slots)
        selection = select(cross, rng, LIMITS.most_effects if also is None else 1)
        if not any(slot.origin[0].continuous for slot in selection.final.slots):
            break
    left = dependences(cross, cross.remainder(selection.final), rng)
    verdict = decide(cross, selection, left, ripple is not None)
    if verdict.kind == UNEXPLAINED:
        left = dependences(cross, cross.remainder(selection.base), rng)
    reversal = None
    if verdict.kind != UNEXPLAINED:
        # just after reversals there is too little of a run to tell a ripple from what is looked for
        cleaned = partial(_cleaned, ripple=ripple, waves=waves)
        reversal = after_reversals(given, expansion, selection.final, usable, train, rng, cleaned)
    flow, unseen = flow_balance.shown_by(own_runs, own_prepared, {each.name for each in usable})
    if verdict.kind == NOTHING and (reversal or ripple or flow):
        verdict = Verdict(MISSING)
    return Search(
        given, train, at_seed, expansion, cross, selection, tuple(left), verdict, reversal, ripple, flow,
        (*blind, *unseen),
    )  # fmt: skip


def _refined(candidates: Sequence[Candidate], slots: Sequence[Slot]) -> list[Candidate]:
    """The candidates, these with a finer grid of shapes around their own, and of a curve its twin: the motors are
    always as many, so that what the load alone tells of gear and of sheaves is one trace, to be drawn as finely."""
    found = {(slot.name, slot.law): slot.origin[1] for slot in slots}
    twins = {
        (other, slot.law.replace(slot.name, other)): slot.origin[1]
        for slot in slots
        for other in set(BY_LOAD) - {slot.name}
        if slot.free and slot.name in BY_LOAD
    }
    known = {**twins, **found}
    own = [(each.name, each.law_name) for each in candidates]
    return [each.refined(known[k]) if k in known else each for each, k in zip(candidates, own, strict=True)]


def _waves(expansion: Expansion, ripple: Ripple | None) -> Mapping[str, FloatArray]:
    """What each run has of the ripple."""
    return waves_of(expansion.runs, ripple) if ripple else {}


def _cleaned(expansion: Expansion, ripple: Ripple | None, waves: Mapping[str, FloatArray]) -> Expansion:
    """The runs without these waves of the ripple."""
    if ripple is None:
        return expansion
    return replace(expansion, runs=tuple(without_ripple(run, ripple, waves[run.name]) for run in expansion.runs))


# -- the same search with other names
def decided(search: Search, selection: Selection, rng: np.random.Generator) -> Search:
    """The search with a selection and the verdict that the training runs give it."""
    left = dependences(search.cross, search.cross.remainder(selection.final), rng)
    verdict = decide(search.cross, selection, left, search.ripple is not None)
    return replace(search, selection=selection, verdict=verdict, left=tuple(left))


def refused(search: Search, rng: np.random.Generator) -> bool:
    """Whether the names found leave more of the training runs than the verdict allows."""
    return decided(search, search.selection, rng).verdict.kind == UNEXPLAINED


def nameless(search: Search) -> Search:
    """The search without any name."""
    selection = replace(search.selection, final=search.selection.base, found=())
    return replace(search, selection=selection, reversal=None, ripple=None, flow=())


def unexplained(search: Search, why: str, rng: np.random.Generator) -> Search:
    """The search with the signals that its gap depends on."""
    left = dependences(search.cross, search.cross.remainder(search.selection.base), rng)
    return replace(search, verdict=Verdict(UNEXPLAINED, why), left=tuple(left))
