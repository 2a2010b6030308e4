"""A delay taken out: once one is suspected, what the runs would be without it.

A regressor shifts what was predicted; that leaves a quarter of a delay of a tenth of a second, since the acceleration,
the load's inertia and the reversals shift as well. Taken out of the signals themselves, all of it goes.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, ParameterEstimate, Shape, Values, correction
from winch_friction.discrepancy.candidates.lateness import (
    CLOCKED,
    DELAY,
    DRAINS_IN,
    DRAWN_IN,
    FILLS_IN,
    POINT,
    PRESSURES,
    SETTLES_IN,
    SPEED,
    changes,
    late_by,
    late_over,
    tau,
)
from winch_friction.discrepancy.detectors.delay_course import course_of
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Given, meet, met_in_turn
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.friction import FrictionModel

AROUND = (1.0, 0.7, 0.85, 1.15, 1.3)  # times the first estimate, which a law that is inexact by a quarter gives
COARSELY = (1.0, 0.8, 1.25)  # the same of one that changes within a run, and of a filter
FILTERED = (1.0, 0.5)  # shares of what is late that a filter of first order makes, alone or behind a scan or a bus
ALIKE = 0.002  # s, by which first estimates may differ that begin the same: a twentieth of the steps around them
REACH = 1.1  # times a delay: half way to the next one
BY = {
    FILLS_IN: (" by a buffer", " when full, every {:.3g} s"),
    DRAINS_IN: (" by a backlog", " at first, worked off over {:.3g} s"),
    SETTLES_IN: (" more and more", " in the end, after some {:.3g} s"),
    DRAWN_IN: (" by a course of its own", " at most, by points {:.3g} s apart"),
}

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
    two loggers' clocks are set when a run begins, and drift. A delay may change in other ways, which the runs of the
    names `train` tell. What starts, stops or swings within tenths of a second comes out of a filter smaller too, which
    no delay makes; of a wave it delays all alike."""
    half = 0.5 * float(np.median([run.time[-1] for run in given.prepared]))  # s, when one that grows is its mean
    late, size = suspect.origin[1].values["late"], ALIKE * round(_size(suspect, cross, fitted, half) / ALIKE)
    own = [run for run in given.prepared if run.name in train]
    changing = given.once(("a delay that changes", size, train), lambda: _changing(own, size))
    ways = _ways(size, late, half)
    columns = dict(given.once(("without a delay", size, half, late), lambda: _gaps_without(given, ways)))
    if changing:
        key = "without a delay that changes", size, train
        columns.update(given.once(key, lambda: _gaps_without(given, [changing])))
    shapes = [each for way in (*ways, changing) for each in way]
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


def _changing(runs: Sequence[PreparedRun], size: float) -> list[Shape]:
    """Shapes of a delay of about `size` s that changes within a run, if that tells more of these runs' gap than one
    that stays and than one that grows on; none where not."""
    found = course_of(runs, size)
    if found.told <= 0.0:
        return []
    late = SPEED if size > 0.0 else PRESSURES
    points = {f"{POINT}{k:02d}": share for k, share in enumerate(found.shares)}
    return [_shape(found.most * factor, late, **{found.how: found.over}, **points) for factor in COARSELY]


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
    """One of `delay` s, or that has grown to it `CLOCKED` s after a run began, or that is as large at most where it
    changes otherwise, or of which a filter makes a share."""
    values = {"ahead": max(delay, 0.0), "behind": max(-delay, 0.0), "late": late, "delay": delay, **how}
    reach = sorted((delay / REACH / tau.typical, delay * REACH / tau.typical))
    signal, by, when = "pressures" if late == PRESSURES else "speed", "", ""
    how_late = "late" if (delay > 0.0) == (late == SPEED) else "early"
    if "by_time" in how:
        when = f" after {CLOCKED:g} s"
    elif (change := changes(how)) is not None:
        by, when = BY[change][0], BY[change][1].format(how[change])
    elif "filtered" in how:
        by = " by a filter" if how["filtered"] == 1.0 else " by a filter and a delay"
    # the estimate is its own; this is the size at which it was looked at
    label = f"{signal} {how_late}{by}, looked at with {1e3 * abs(delay):.0f} ms{when}"
    return Shape(label, values, (reach[0], reach[1]))


def _without(shape: Shape, model: FrictionModel) -> FrictionModel:
    """The model that takes this out of the signals; what it has itself is out of these runs."""
    delay, values = ParameterEstimate(shape.values["delay"], 0.0, "s"), shape.values
    found = [correction(name, delay, share, **late_over(name, values)) for name, share in late_by(values).items()]
    return replace(model, corrections=tuple(found))


def _key(run: PreparedRun, values: Values) -> Key:
    return run.name, frozenset(values.items())


def _shapes(candidate: Candidate, exact: Sequence[Shape], runs: Sequence[PreparedRun]) -> list[Shape]:
    return [*candidate.shapes(runs), *exact]


def _columns(candidate: Candidate, exact: Mapping[Key, FloatArray], run: PreparedRun, values: Values) -> FloatArray:
    own = exact.get(_key(run, values))
    return candidate.columns(run, values) if own is None else own
