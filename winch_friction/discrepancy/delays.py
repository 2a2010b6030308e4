"""A delay as what the runs would be without it, once one is suspected.

A regressor shifts what was predicted; that leaves a quarter of a delay of a tenth of a second, since the acceleration,
the load's inertia and the reversals shift as well. Taken out of the signals themselves, all of it goes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape, Values
from winch_friction.discrepancy.candidates.signals import DELAY, PRESSURES, tau
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Given, meet
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction.correction import Correction

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
    columns = {}
    for shape in shapes:
        delay = shape.values["delay"]
        model = replace(given.model, corrections=(_delay(delay, late),))  # those that it has are out of these runs
        for old, new in zip(given.prepared, meet(given.runs, given.crane, model, ()).prepared, strict=True):
            gap = np.interp(old.time + old.start, new.time + new.start, new.gap)
            columns[old.name, delay] = (old.gap - gap)[:, None] / delay
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
