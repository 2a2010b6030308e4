"""Locate and name on the training runs: everything that happens before the locked runs are looked at."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import MOVING, Candidate, Untestable
from winch_friction.discrepancy.candidates.catalogue import candidates_for, testable
from winch_friction.discrepancy.candidates.families import SURFACES, free_members
from winch_friction.discrepancy.delays import without_delay
from winch_friction.discrepancy.detectors import flow_balance, reversals, soft_oil
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.detectors.flow_balance import Leakage
from winch_friction.discrepancy.detectors.reversals import ReversalFinding
from winch_friction.discrepancy.detectors.ripple import Ripple
from winch_friction.discrepancy.detectors.soft_oil import FreeAir
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.omnibus import Dependence, dependences
from winch_friction.discrepancy.engine.rivals import near
from winch_friction.discrepancy.engine.selection import Selection, select
from winch_friction.discrepancy.expansion import Expansion, Given, expand_around
from winch_friction.discrepancy.holdout import Split
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.regressors import base_of, layout_of
from winch_friction.discrepancy.run_states import run_states
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.verdict import MISSING, NOTHING, UNEXPLAINED, Verdict, decide


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


def search_runs(
    split: Split, given: Given, options: GapOptions, rng: np.random.Generator, surfaces: bool = False
) -> Search:
    """What is missing according to the training runs; raises `InputError` for runs that lack what the balance needs.

    With `surfaces` a cause may have a law that only the data know, over two signals at once; then it is one cause
    alone, for a surface with company imitates anything.
    """
    model, prepared = given.model, given.prepared
    training = [(r, p) for r, p in zip(given.runs, prepared, strict=True) if r.name in split.train]
    own_runs, own_prepared = [r for r, _ in training], [p for _, p in training]
    ripple = angle.detect(own_runs, own_prepared, given.crane, model)
    known = options.candidates or [
        *candidates_for(prepared, model, options.effects_file), *run_states(prepared, model)
    ]  # fmt: skip
    if surfaces:
        known = [*known, *free_members(prepared, model, SURFACES)]
    usable, blind = testable(known, prepared, model)
    candidates = [each for each in usable if each.regime == MOVING]
    at_seed = Expansion(prepared, layout_of(base_of(model, model), candidates, prepared, model), model)
    cross = _cleaned(at_seed, ripple, _waves(at_seed, ripple)).cross(split.train)
    expansion, selection = at_seed, select(cross, rng, 1)
    for _ in range(LIMITS.most_expansions):
        shapes = (*selection.final.slots, *near(cross, selection.final))
        candidates, usable = (_refined(each, shapes) for each in (candidates, usable))
        candidates = without_delay(given, candidates, shapes, cross, selection.final)
        del cross  # the largest thing there is, and not needed beside the next one
        around = expand_around(given, expansion, selection.final, candidates)
        waves = _waves(around, ripple)
        expansion = _cleaned(around, ripple, waves)
        cross = expansion.cross(split.train, selection.final.slots)
        selection = select(cross, rng, 1 if surfaces else LIMITS.most_effects)
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
        reversal = reversals.detect(given, expansion, selection.final, usable, split.train, rng, cleaned)
    leakage, air = flow_balance.detect(own_runs, own_prepared), soft_oil.free_air(own_runs, own_prepared)
    flow = tuple(each for each in (leakage, air) if each is not None and each.found)
    if any(each.name == soft_oil.NAME for each in usable):
        blind += soft_oil.untestable(air)
    if any(each.name == flow_balance.NAME for each in usable):
        blind += flow_balance.untestable(own_runs, own_prepared)
    if verdict.kind == NOTHING and (reversal or ripple or flow):
        verdict = Verdict(MISSING)
    return Search(
        given,
        split.train,
        at_seed,
        expansion,
        cross,
        selection,
        tuple(left),
        verdict,
        reversal,
        ripple,
        flow,
        tuple(blind),
    )


def _refined(candidates: Sequence[Candidate], slots: Sequence[Slot]) -> list[Candidate]:
    """The candidates, these with a finer grid of shapes around their own."""
    found = {(slot.name, slot.law): slot.origin[1] for slot in slots}
    own = [(each.name, each.law_name) for each in candidates]
    return [each.refined(found[k]) if k in found else each for each, k in zip(candidates, own, strict=True)]


def _waves(expansion: Expansion, ripple: Ripple | None) -> Mapping[str, FloatArray]:
    """What each run has of the ripple."""
    return angle.waves_of(expansion.runs, ripple) if ripple else {}


def _cleaned(expansion: Expansion, ripple: Ripple | None, waves: Mapping[str, FloatArray]) -> Expansion:
    """The runs without these waves of the ripple."""
    if ripple is None:
        return expansion
    return replace(expansion, runs=tuple(angle.without_ripple(run, ripple, waves[run.name]) for run in expansion.runs))
