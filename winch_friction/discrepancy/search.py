"""Locate and name on the training runs: everything that happens before the locked runs are looked at.

A delay, once one is suspected, is what the runs would be without it. A regressor shifts what was predicted; that leaves
a quarter of a delay of a tenth of a second, since the acceleration, the load's inertia and the reversals shift as well.
Taken out of the signals themselves, all of it goes.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.answer import MISSING, NOTHING, UNEXPLAINED, GapOptions, Verdict, decide
from winch_friction.discrepancy.candidates.candidate import MOVING, Candidate, Shape, Untestable, Values
from winch_friction.discrepancy.candidates.catalogue import candidates_for, testable
from winch_friction.discrepancy.candidates.signals import DELAY, PRESSURES, tau
from winch_friction.discrepancy.detectors import flow_balance, reversals, soft_oil
from winch_friction.discrepancy.detectors import ripple as angle
from winch_friction.discrepancy.detectors.flow_balance import Leakage
from winch_friction.discrepancy.detectors.reversals import ReversalFinding
from winch_friction.discrepancy.detectors.ripple import Ripple
from winch_friction.discrepancy.detectors.ripple_waves import waves_of, without_ripple
from winch_friction.discrepancy.detectors.soft_oil import FreeAir
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import Dependence, dependences, near
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.selection import Selection, select
from winch_friction.discrepancy.expansion import Expansion, Given, expand_around, meet, met_in_turn
from winch_friction.discrepancy.locking import Split
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import base_of, layout_of
from winch_friction.discrepancy.run_states import run_states
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction

LastResort = Callable[[Sequence[PreparedRun], FrictionModel], list[Candidate]]
BY_LOAD = ("gear_load_loss", "sheave_bending")

# -- a delay taken out
AROUND = (0.7, 0.85, 1.0, 1.15, 1.3)  # times the first estimate, which a law that is inexact by a quarter gives
REACH = 1.1  # times a delay: half way to the next one


def without_delay(
    given: Given, candidates: Sequence[Candidate], suspects: Sequence[Slot], cross: CrossFit, fitted: Explanation
) -> list[Candidate]:
    """The candidates, a delay that is among the suspects as what its signals are without it."""
    suspect = next((each for each in suspects if each.name == DELAY and not each.law and _long(each)), None)
    if suspect is None:
        return list(candidates)
    late, size = suspect.origin[1].values["late"], _size(suspect, cross, fitted)
    shapes = [_shape(size * factor, late) for factor in AROUND]
    columns: dict[tuple[str, float], FloatArray] = {}

    def taken_out(delay: float) -> FrictionModel:
        return replace(given.model, corrections=(_delay(delay, late),))  # those that it has are out of these runs

    def keep(delay: float, without: Iterable[PreparedRun]) -> None:
        for old, new in zip(given.prepared, without, strict=True):
            gap = np.interp(old.time + old.start, new.time + new.start, new.gap)
            columns[old.name, delay] = (old.gap - gap)[:, None] / delay

    # a swing on the wire, which a delay hides, is told once, without the first estimate: then only the delay differs
    met = meet(given.runs, given.crane, taken_out(size), ()).prepared
    modes = {run.name: run.wire_mode for run in met}
    keep(size, met)
    del met  # its gaps are all that is needed
    for shape in shapes:
        if (delay := shape.values["delay"]) != size:
            keep(delay, met_in_turn(given, taken_out(delay), modes))
    return [
        replace(each, columns=partial(_columns, each, columns), shapes=partial(_shapes, each, shapes))
        if each.name == DELAY and not each.law_name
        else each
        for each in candidates
    ]


def _long(slot: Slot) -> bool:
    """Whether it is no small one, which its first derivative says."""
    return 0.0 in (slot.origin[1].values["ahead"], slot.origin[1].values["behind"])


def _size(slot: Slot, cross: CrossFit, fitted: Explanation) -> float:
    """The delay in s, of the speed behind the pressures: as fitted, or as its shape has it."""
    if slot in fitted.slots:
        at = cross.problem.columns(fitted.slots).index(slot.columns[0])
        return float(fitted.beta[at] * cross.problem.layout.scales[slot.columns[0]])
    values = slot.origin[1].values
    return values["ahead"] - values["behind"]


def _shape(delay: float, late: float) -> Shape:
    values = {"ahead": max(delay, 0.0), "behind": max(-delay, 0.0), "late": late, "delay": delay}
    reach = sorted((delay / REACH / tau.typical, delay * REACH / tau.typical))
    signal = "pressures" if late == PRESSURES else "speed"
    return Shape(f"{signal} late by {1e3 * abs(delay):.0f} ms", values, (reach[0], reach[1]))


def _delay(delay: float, late: float) -> Correction:
    name, value = ("pressure_delay", -delay) if late == PRESSURES else ("signal_delay", delay)
    return Correction(name, float(np.clip(value, *Correction(name, 0.0).bounds)))


def _shapes(candidate: Candidate, exact: Sequence[Shape], runs: Sequence[PreparedRun]) -> list[Shape]:
    return [*candidate.shapes(runs), *exact]


def _columns(
    candidate: Candidate, exact: Mapping[tuple[str, float], FloatArray], run: PreparedRun, values: Values
) -> FloatArray:
    own = exact.get((run.name, values.get("delay", 0.0)))
    return candidate.columns(run, values) if own is None else own


# -- the search
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
    split: Split, given: Given, options: GapOptions, rng: np.random.Generator, also: LastResort | None = None
) -> Search:
    """What is missing according to the training runs; raises `InputError` for runs that lack what the balance needs.

    `also` makes candidates of last resort of all runs and the model, such as laws that only the data know, over two
    signals at once: then it is one cause alone, for one of these with company imitates anything.
    """
    model, prepared = given.model, given.prepared
    training = [(r, p) for r, p in zip(given.runs, prepared, strict=True) if r.name in split.train]
    own_runs, own_prepared = [r for r, _ in training], [p for _, p in training]
    ripple = angle.detect(own_runs, own_prepared, given.crane, model)
    known = options.candidates or [
        *candidates_for(prepared, model, options.effects_file), *run_states(prepared, model)
    ]  # fmt: skip
    if also is not None:
        known = [*known, *also(prepared, model)]
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
