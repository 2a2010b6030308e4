"""A delay taken out: once one is suspected, what the runs would be without it.

A regressor shifts what was predicted; that leaves a quarter of a delay of a tenth of a second, since the acceleration,
the load's inertia and the reversals shift as well. Taken out of the signals themselves, all of it goes.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape, Values
from winch_friction.discrepancy.candidates.signals import (
    CLOCKED,
    DELAY,
    FILLS_IN,
    PRESSURES,
    SPEED,
    delay_columns,
    fills_in,
    late_by,
    tau,
)
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Given, meet, met_in_turn
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.declared_correction import DECLARED

AROUND = (1.0, 0.7, 0.85, 1.15, 1.3)  # times the first estimate, which a law that is inexact by a quarter gives
COARSELY = (1.0, 0.8, 1.25)  # the same of a clock that drifts, of a buffer and of a filter
FILTERED = (1.0, 0.5)  # shares of what is late that a filter of first order makes, alone or behind a scan or a bus
REACH = 1.1  # times a delay: half way to the next one
# of a buffer that fills up and is emptied, again and again from a run's beginning
SOONEST = 5.0  # s; what comes as often as waves do is not told from what waves do
FILLINGS = 1.25  # in the median run: of one that is not seen to start again it is a clock that drifts
LOOKED_AT = 600.0  # s of each run: enough for a hundredth of a period, and no more of an hour's log than of a test's
BIN = 0.25  # s, a twentieth of the soonest: within it a delay hardly grows
COHERENT = 0.2  # of a filling, by which neighbours on the grid of periods differ at the end of what is looked at

EMPTY = 1e-300  # where a column is nothing

Key = tuple[str, frozenset[tuple[str, float]]]  # a run's name and the values of a shape


def without_delay(
    given: Given,
    candidates: Sequence[Candidate],
    suspect: Slot,
    cross: CrossFit,
    fitted: Explanation,
    train: tuple[str, ...],
) -> list[Candidate]:
    """The candidates, the `suspect` delay as what its signals are without it, and without one that grows in each run:
    two loggers' clocks are set when a run begins, and drift; a buffer fills up until it is emptied, by the runs of the
    names `train`. What starts, stops or swings within tenths of a second comes out of a filter smaller too, which no
    delay makes; of a wave it delays all alike."""
    half = 0.5 * float(np.median([run.time[-1] for run in given.prepared]))  # s, when one that grows is its mean
    late, size = suspect.origin[1].values["late"], _size(suspect, cross, fitted, half)
    filled = given.once(("filled", size, train), lambda: _filled([r for r in given.prepared if r.name in train], size))
    ways = _ways(size, late, half) + ([filled] if filled else [])
    columns = given.once(("without a delay", size, half, late, train), lambda: _gaps_without(given, ways))
    shapes = [each for way in ways for each in way]
    return [
        replace(each, columns=partial(_columns, each, columns), shapes=partial(_shapes, each, shapes))
        if each.name == DELAY and not each.law_name
        else each
        for each in candidates
    ]


def _ways(size: float, late: float, half: float) -> list[list[Shape]]:
    """Shapes of what may be late by about `size` s, those of one kind together, first the one of that very size; of
    what seems early the other side as late, which its first derivative does not tell apart."""
    delays = [_shape(size * factor, late) for factor in AROUND]
    clocks = [_shape(size * factor * CLOCKED / half, late, by_time=1.0) for factor in COARSELY]
    behind = SPEED if size > 0.0 else PRESSURES
    if late != behind:
        return [delays + clocks, *_ways(size, behind, half)]
    return [delays + clocks, *([_shape(size * f, late, filtered=share) for f in COARSELY] for share in FILTERED)]


def _filled(runs: Sequence[PreparedRun], size: float) -> list[Shape]:
    """Shapes of a buffer that fills up and is emptied, if one tells more of these runs' gap than a delay of `size` s
    (of the speed behind the pressures) that stays and than one that grows on; none where not.

    One period after the other, as a periodogram has them; what a delay grows to is fitted to each.
    """
    durations = np.minimum([run.time[-1] for run in runs], LOOKED_AT)
    late = SPEED if size > 0.0 else PRESSURES
    behind = {"ahead": max(size, 0.0), "behind": max(-size, 0.0), "late": late}
    parts = [_binned(run, delay_columns(run, behind)[:, 0]) for run in runs]
    time, along, square = (np.concatenate(each) for each in zip(*parts, strict=True))

    def told(full: FloatArray) -> float:
        return max(float(np.sign(size) * (full @ along)), 0.0) ** 2 / max(float(full**2 @ square), EMPTY)

    def best(each_second: FloatArray) -> float:
        return max(each_second, key=lambda f: told(np.mod(time * f, 1.0)), default=0.0)

    step = COHERENT / durations.max()
    coarse = best(np.arange(FILLINGS / np.median(durations), 1.0 / SOONEST, step))
    often = best(coarse + step * np.linspace(-1.0, 1.0, 21))
    full = np.mod(time * often, 1.0)
    if coarse == 0.0 or told(full) <= max(told(np.ones_like(time)), told(time)):
        return []
    most = float(full @ along) / float(full**2 @ square)
    return [_shape(most * factor, late, **{FILLS_IN: float(1.0 / often)}) for factor in COARSELY]


def _binned(run: PreparedRun, column: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of a run's beginning, in bins of time: their middle in s, and the sums that a fit of the gap by this column
    takes."""
    own = run.used & (run.time < LOOKED_AT)
    at = np.floor(run.time[own] / BIN).astype(int)

    def summed(other: FloatArray) -> FloatArray:
        return np.bincount(at, column[own] * other[own]).astype(float)

    along, square = summed(run.gap), summed(column)
    return (np.arange(len(along), dtype=float) + 0.5) * BIN, along, square


def _gaps_without(given: Given, ways: Iterable[Sequence[Shape]]) -> Mapping[Key, FloatArray]:
    """By how much the gap of each run changes without what each of these shapes is, N m per s of it."""
    columns: dict[Key, FloatArray] = {}

    def keep(shape: Shape, without: Iterable[PreparedRun]) -> None:
        for old, new in zip(given.prepared, without, strict=True):
            gap = np.interp(old.time + old.start, new.time + new.start, new.gap)
            columns[_key(old, shape.values)] = (old.gap - gap)[:, None] / shape.values["delay"]

    for shapes in ways:
        # a swing on the wire, which a delay hides, is told once, without the first estimate: then only that differs
        own, *others = shapes
        met = meet(given.runs, given.crane, _without(own, given.model), ()).prepared
        modes = {run.name: run.wire_mode for run in met}
        keep(own, met)
        del met  # its gaps are all that is needed
        for shape in others:
            keep(shape, met_in_turn(given, _without(shape, given.model), modes))
    return columns


def _size(slot: Slot, cross: CrossFit, fitted: Explanation, half: float) -> float:
    """The delay in s, of the speed behind the pressures: as fitted, or as its shape has it; of one that grows what it
    is after `half` s."""
    values = slot.origin[1].values
    size = values["ahead"] - values["behind"]
    if slot in fitted.slots:
        size = cross.size(fitted, slot)
    return size * half / CLOCKED if "by_time" in values else size


def _shape(delay: float, late: float, **how: float) -> Shape:
    """One of `delay` s, or that has grown to it `CLOCKED` s after a run began or when a buffer is full, or of which a
    filter makes a share."""
    values = {"ahead": max(delay, 0.0), "behind": max(-delay, 0.0), "late": late, "delay": delay, **how}
    reach = sorted((delay / REACH / tau.typical, delay * REACH / tau.typical))
    signal, by, when = "pressures" if late == PRESSURES else "speed", "", ""
    how_late = "late" if (delay > 0.0) == (late == SPEED) else "early"
    if "by_time" in how:
        when = f" after {CLOCKED:g} s"
    elif FILLS_IN in how:
        by, when = " by a buffer", f" when full, every {how[FILLS_IN]:.3g} s"
    elif "filtered" in how:
        by = " by a filter" if how["filtered"] == 1.0 else " by a filter and a delay"
    # the estimate is its own; this is the size at which it was looked at
    label = f"{signal} {how_late}{by}, looked at with {1e3 * abs(delay):.0f} ms{when}"
    return Shape(label, values, (reach[0], reach[1]))


def _without(shape: Shape, model: FrictionModel) -> FrictionModel:
    """The model that takes this out of the signals; what it has itself is out of these runs."""
    period = fills_in(shape.values)
    found = [
        Correction(name, float(np.clip(shape.values["delay"] * share, *_bounds(name))), time_constant=period)
        for name, share in late_by(shape.values).items()
    ]
    return replace(model, corrections=tuple(found))


def _bounds(name: str) -> tuple[float, float]:
    declared = DECLARED[name].parameter
    return declared.lower, declared.upper


def _key(run: PreparedRun, values: Values) -> Key:
    return run.name, frozenset(values.items())


def _shapes(candidate: Candidate, exact: Sequence[Shape], runs: Sequence[PreparedRun]) -> list[Shape]:
    return [*candidate.shapes(runs), *exact]


def _columns(candidate: Candidate, exact: Mapping[Key, FloatArray], run: PreparedRun, values: Values) -> FloatArray:
    own = exact.get(_key(run, values))
    return candidate.columns(run, values) if own is None else own
