"""Locate and name on the training runs: everything that happens before the locked runs are looked at."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Untestable
from winch_friction.discrepancy.candidates.catalogue import all_candidates, testable
from winch_friction.discrepancy.candidates.refine import refined
from winch_friction.discrepancy.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.holdout import Split
from winch_friction.discrepancy.linearise import Expansion, expand_around, expand_at_seed
from winch_friction.discrepancy.loads import estimated_loads
from winch_friction.discrepancy.omnibus import Dependence, dependences, remainder
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.problem import base_of, layout_of
from winch_friction.discrepancy.result import Effect
from winch_friction.discrepancy.ripple import Ripple
from winch_friction.discrepancy.selection import Selection, select
from winch_friction.discrepancy.side_findings import (
    find_ripple,
    leakage_effect,
    ripple_effect,
    ripple_waves,
    without_ripple,
)
from winch_friction.discrepancy.turning import TurningFinding, search_turning
from winch_friction.discrepancy.verdict import MISSING, NOTHING, UNEXPLAINED, Verdict, decide
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane

MOST_EXPANSIONS = 2


@dataclass(frozen=True)
class Search:
    """What the training runs gave."""

    at_seed: Expansion
    expansion: Expansion
    cross: CrossFit
    selection: Selection
    left: tuple[Dependence, ...]
    verdict: Verdict
    turning: TurningFinding | None
    side: tuple[Effect, ...]
    untestable: tuple[Untestable, ...]
    loads: Mapping[str, float]

    @property
    def explanation(self) -> Explanation:
        """The effects that the verdict stands by."""
        return self.selection.base if self.verdict.kind in (UNEXPLAINED, NOTHING) else self.selection.final


def search_runs(
    split: Split, crane: Crane, model: FrictionModel, options: GapOptions, rng: np.random.Generator
) -> Search:
    """What is missing according to the training runs; raises `InputError` for runs that lack what the balance needs."""
    loads = estimated_loads(split.runs, crane, model)
    prepared = expand_at_seed(split.runs, crane, model, loads)
    training = [(r, p) for r, p in zip(split.runs, prepared, strict=True) if r.name in split.train]
    own_runs, own_prepared = [r for r, _ in training], [p for _, p in training]
    ripple = find_ripple(own_runs, own_prepared, crane)
    usable, blind = testable(options.candidates or all_candidates(options.effects_file), prepared, model)
    candidates = [each for each in usable if each.regime == "moving"]
    at_seed = Expansion(prepared, layout_of(base_of(model, model), candidates, prepared, model), model)
    cross = _cleaned(at_seed, ripple, _waves(at_seed, ripple)).cross(split.train)
    expansion, selection = at_seed, select(cross, rng, 1)
    for _ in range(MOST_EXPANSIONS):
        candidates, usable = (_refined(each, selection.final) for each in (candidates, usable))
        around = expand_around(split.runs, crane, model, loads, expansion, selection.final, candidates)
        waves = _waves(around, ripple)
        expansion = _cleaned(around, ripple, waves)
        cross = expansion.cross(split.train, selection.final.slots)
        selection = select(cross, rng)
        if not any(slot.candidate.continuous for slot in selection.final.slots):
            break
    left = dependences(cross, remainder(cross, selection.final), rng)
    verdict = decide(cross, selection, left, ripple is not None)
    if verdict.kind == UNEXPLAINED:
        left = dependences(cross, remainder(cross, selection.base), rng)
    turning = None
    if verdict.kind != UNEXPLAINED:
        # just after reversals there is too little of a run to tell a ripple from what is looked for
        cleaned = partial(_cleaned, ripple=ripple, waves=waves)
        turning = search_turning(
            split.runs, crane, model, loads, expansion, selection.final, usable, split.train, rng, cleaned
        )
    leakage = leakage_effect(own_runs, own_prepared)
    side = ([ripple_effect(ripple)] if ripple else []) + ([leakage] if leakage else [])
    if verdict.kind == NOTHING and (turning or side):
        verdict = Verdict(MISSING)
    return Search(at_seed, expansion, cross, selection, tuple(left), verdict, turning, tuple(side), tuple(blind), loads)


def _refined(candidates: Sequence[Candidate], explanation: Explanation) -> list[Candidate]:
    """The candidates, those that were found with a finer grid of shapes."""
    found = {slot.candidate.name: slot.variant for slot in explanation.slots}
    return [refined(each, found[each.name]) if each.name in found else each for each in candidates]


def _waves(expansion: Expansion, ripple: Ripple | None) -> Mapping[str, FloatArray]:
    """What each run has of the ripple."""
    return ripple_waves(expansion.runs, ripple) if ripple else {}


def _cleaned(expansion: Expansion, ripple: Ripple | None, waves: Mapping[str, FloatArray]) -> Expansion:
    """The runs without these waves of the ripple."""
    if ripple is None:
        return expansion
    return replace(expansion, runs=tuple(without_ripple(run, ripple, waves[run.name]) for run in expansion.runs))
