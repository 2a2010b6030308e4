"""A delay taken out: once one is suspected, what the runs would be without it.

A regressor shifts what was predicted; that leaves a quarter of a delay of a tenth of a second, since the acceleration,
the load's inertia and the reversals shift as well. Taken out of the signals themselves, all of it goes.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape, Values
from winch_friction.discrepancy.candidates.signals import CLOCKED, DELAY, PRESSURES, tau
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Given, meet, met_in_turn
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction

AROUND = (0.7, 0.85, 1.0, 1.15, 1.3)  # times the first estimate, which a law that is inexact by a quarter gives
GROWING = (0.8, 1.0, 1.25)  # the same of a clock that drifts
REACH = 1.1  # times a delay: half way to the next one


def without_delay(
    given: Given, candidates: Sequence[Candidate], suspect: Slot, cross: CrossFit, fitted: Explanation
) -> list[Candidate]:
    """The candidates, the `suspect` delay as what its signals are without it, and without one that grows in each run:
    two loggers' clocks are set when a run begins, and drift."""
    half = 0.5 * float(np.median([run.time[-1] for run in given.prepared]))  # s, when one that grows is its mean
    late, size = suspect.origin[1].values["late"], _size(suspect, cross, fitted, half)
    shapes = [_shape(size * factor, late) for factor in AROUND]
    shapes += [_shape(size * factor * CLOCKED / half, late, by_time=True) for factor in GROWING]
    columns: dict[tuple[str, float, bool], FloatArray] = {}

    def taken_out(delay: float, by_time: bool = False) -> FrictionModel:
        return replace(given.model, corrections=(_delay(delay, late, by_time),))  # what it has is out of these runs

    def keep(delay: float, by_time: bool, without: Iterable[PreparedRun]) -> None:
        for old, new in zip(given.prepared, without, strict=True):
            gap = np.interp(old.time + old.start, new.time + new.start, new.gap)
            columns[old.name, delay, by_time] = (old.gap - gap)[:, None] / delay

    # a swing on the wire, which a delay hides, is told once, without the first estimate: then only the delay differs
    met = meet(given.runs, given.crane, taken_out(size), ()).prepared
    modes = {run.name: run.wire_mode for run in met}
    keep(size, False, met)
    del met  # its gaps are all that is needed
    for shape in shapes:
        delay, by_time = shape.values["delay"], "by_time" in shape.values
        if by_time or delay != size:
            keep(delay, by_time, met_in_turn(given, taken_out(delay, by_time), modes))
    return [
        replace(each, columns=partial(_columns, each, columns), shapes=partial(_shapes, each, shapes))
        if each.name == DELAY and not each.law_name
        else each
        for each in candidates
    ]


def _size(slot: Slot, cross: CrossFit, fitted: Explanation, half: float) -> float:
    """The delay in s, of the speed behind the pressures: as fitted, or as its shape has it; of one that grows what it
    is after `half` s."""
    values = slot.origin[1].values
    size = values["ahead"] - values["behind"]
    if slot in fitted.slots:
        at = cross.problem.columns(fitted.slots).index(slot.columns[0])
        size = float(fitted.beta[at] * cross.problem.layout.scales[slot.columns[0]])
    return size * half / CLOCKED if "by_time" in values else size


def _shape(delay: float, late: float, by_time: bool = False) -> Shape:
    """One of `delay` s, or that has grown to it `CLOCKED` s after a run began."""
    values = {"ahead": max(delay, 0.0), "behind": max(-delay, 0.0), "late": late, "delay": delay}
    values |= {"by_time": 1.0} if by_time else {}
    reach = sorted((delay / REACH / tau.typical, delay * REACH / tau.typical))
    signal, when = "pressures" if late == PRESSURES else "speed", f" after {CLOCKED:g} s" if by_time else ""
    return Shape(f"{signal} late by {1e3 * abs(delay):.0f} ms{when}", values, (reach[0], reach[1]))


def _delay(delay: float, late: float, by_time: bool) -> Correction:
    side, value = ("pressure", -delay) if late == PRESSURES else ("signal", delay)
    name, value = (f"{side}_clock", value / CLOCKED) if by_time else (f"{side}_delay", value)
    return Correction(name, float(np.clip(value, *Correction(name, 0.0).bounds)))


def _shapes(candidate: Candidate, exact: Sequence[Shape], runs: Sequence[PreparedRun]) -> list[Shape]:
    return [*candidate.shapes(runs), *exact]


def _columns(
    candidate: Candidate, exact: Mapping[tuple[str, float, bool], FloatArray], run: PreparedRun, values: Values
) -> FloatArray:
    own = exact.get((run.name, values.get("delay", 0.0), "by_time" in values))
    return candidate.columns(run, values) if own is None else own
