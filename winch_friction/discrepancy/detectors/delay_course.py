"""A delay that changes within a run: a buffer fills up and is emptied, a backlog is worked off, one comes to stay; or
it takes a course that only the data know, the same in every run.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from winch_friction.discrepancy.candidates.candidate import Values
from winch_friction.discrepancy.candidates.lateness import (
    DELAY,
    DRAINS_IN,
    DRAWN_IN,
    FILLS_IN,
    PRESSURES,
    SETTLES_IN,
    SPEED,
    delay_columns,
)
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.engine.selection import Selection
from winch_friction.discrepancy.expansion import Given
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.corrections import lateness

LOOKED_FOR = 0.1  # s, a delay that changes within a run, if none that stays is suspected
SOONEST = 5.0  # s; what comes as often as waves do is not told from what waves do
FILLINGS = 1.25  # in the median run: of one that is not seen to start again, or to end, it is a clock that drifts
COHERENT = 0.2  # of a filling, by which neighbours on the grid of periods differ at the end of what is looked at
FINER = 41  # around the best period on the grid: a hundredth of a filling apart at the end of what is looked at
APART = 1.1  # times a time constant: what is a tenth slower tells 1 % less of it
LOOKED_AT = 600.0  # s of each run: enough for a hundredth of a period, and no more of an hour's log than of a test's
BIN = 0.05  # s, a hundredth of the soonest: within it a delay hardly grows
EMPTY = 1e-300  # where a column is nothing
INTERVALS = (3, 5, 8, 12, 18, 27, 40)  # of a drawn course in the longest run: those that tell most of other runs
AS_MUCH = 0.9  # of what a drawn course tells: a known one that does is it, and the first order of a delay inexact
UNSEEN = 1e-9  # of the largest, that a point which no run has reached is taken to be nothing by


class Course(NamedTuple):
    """How a delay changes from each run's beginning on, the time constant in s, what it is at most in s (of the speed
    behind the pressures), what it tells of a gap's square, and, where it is drawn, the share of each of its points."""

    told: float
    how: str
    over: float
    most: float
    shares: tuple[float, ...] = ()


NO_COURSE = Course(0.0, "", 0.0, 0.0)


def passing_delay(given: Given, train: tuple[str, ...], cross: CrossFit, selection: Selection) -> Slot | None:
    """A delay of about a tenth of a second that is gone, or not yet there, for most of each run, where that tells a
    good part of what the base leaves and one that stays tells little. None where nothing is missing."""
    if cross.excess(selection.base) <= LIMITS.least_excess:
        return None
    delays = [slot for slot in cross.problem.slots if slot.name == DELAY and not slot.law]
    runs = [run for run in given.prepared if run.name in train]
    total = sum(float(run.gap[run.used] @ run.gap[run.used]) for run in runs)
    best: tuple[float, Slot | None] = (LIMITS.proposal_gain * total, None)
    for slot in delays:
        values = slot.origin[1].values
        if max(values["ahead"], values["behind"]) == LOOKED_FOR:
            told = course_of(runs, values["ahead"] - values["behind"]).told
            best = max(best, (told, slot), key=lambda each: each[0])
    return best[1]


def course_of(runs: Sequence[PreparedRun], size: float) -> Course:
    """The course of a delay of about `size` s that tells most of these runs' gap, and nothing where one that stays, or
    grows on, tells as much.

    One time constant after the other, as a periodogram has its periods; what the delay is at most is fitted to each.
    """
    durations = np.minimum([run.time[-1] for run in runs], LOOKED_AT)
    behind = {"ahead": max(size, 0.0), "behind": max(-size, 0.0), "late": SPEED if size > 0.0 else PRESSURES}
    time, along, square = _binned(runs, behind)

    def told(share: FloatArray) -> float:
        return max(float(np.sign(size) * (share @ along)), 0.0) ** 2 / max(float(share**2 @ square), EMPTY)

    def best(often: FloatArray, how: str) -> tuple[float, float, str]:
        return max(((told(_share(how, time, 1.0 / each)), 1.0 / each, how) for each in often), default=(0.0, 0.0, how))

    slowest, step = FILLINGS / float(np.median(durations)), COHERENT / float(durations.max())
    _, period, _ = best(np.arange(slowest, 1.0 / SOONEST, step), FILLS_IN)
    near = 1.0 / period + step * np.linspace(-1.0, 1.0, FINER) if period > 0.0 else np.empty(0)
    decays = slowest * APART ** np.arange(max(np.log(1.0 / SOONEST / slowest) / np.log(APART), 0.0))
    most, over, how = max(best(near, FILLS_IN), best(decays, DRAINS_IN), best(decays, SETTLES_IN))
    steady = max(told(np.ones_like(time)), told(time))
    drawn = _drawn(runs, behind, float(np.sign(size)))
    if max(most, steady) < AS_MUCH * drawn.told:
        return drawn
    if most <= steady:
        return NO_COURSE
    share = _share(how, time, over)
    return Course(most, how, float(over), float(share @ along) / float(share**2 @ square))


def _drawn(runs: Sequence[PreparedRun], behind: Values, sign: float) -> Course:
    """A course through points that are as far apart as tells most of runs from which it was not drawn: of every second
    run by the others, and the other way. It is straight between them, and makes nothing early."""
    halves = [_binned(half, behind) for half in (runs[::2], runs[1::2]) if half]
    best = NO_COURSE
    if len(halves) < 2:
        return best
    size = max(len(time) for time, _, _ in halves)
    time, lasts = (np.arange(size) + 0.5) * BIN, size * BIN
    sums = [[np.pad(each, (0, size - len(each))) for each in half[1:]] for half in halves]
    for apart in sorted({max(lasts / count, SOONEST) for count in INTERVALS}):
        hats = np.maximum(1.0 - np.abs(time[:, None] / apart - np.arange(np.ceil(lasts / apart) + 1.0)), 0.0)
        fits = [(hats.T @ (square[:, None] * hats), sign * (hats.T @ along)) for along, square in sums]
        told = sum(_gain(_heights(*own), *other) for own, other in (fits, fits[::-1]))
        heights = _heights(fits[0][0] + fits[1][0], fits[0][1] + fits[1][1])
        if told > best.told and (most := float(heights.max())) > 0.0:
            shares = tuple(float(f"{each / most:.3g}") for each in heights)
            best = Course(float(told), DRAWN_IN, apart, sign * most, shares)
    return best


def _heights(gram: FloatArray, along: FloatArray) -> FloatArray:
    """What a course is at its points, s, none below nothing, by least squares."""
    room = UNSEEN * max(float(np.trace(gram)), EMPTY)
    root = np.linalg.cholesky(gram + room * np.eye(len(gram))).T
    return np.asarray(nnls(root, np.linalg.solve(root.T, along))[0])


def _gain(heights: FloatArray, gram: FloatArray, along: FloatArray) -> float:
    """What a course takes off the square of a gap."""
    return float(2.0 * heights @ along - heights @ gram @ heights)


def _share(how: str, since: FloatArray, over: float) -> FloatArray:
    """What there is of a delay that changes in this way over a time constant, `since` s from a run's beginning."""
    if how == FILLS_IN:
        return lateness("buffer", since, over)
    left = lateness("backlog", since, over)
    return left if how == DRAINS_IN else 1.0 - left


def _binned(runs: Sequence[PreparedRun], behind: Values) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of the beginning of all these runs, in bins of the time since then: their middle in s, and the sums that a fit of
    the gap by a delay of these values takes."""
    time, gap, column = (
        np.concatenate(each)
        for each in zip(
            *((r.time[r.used], r.gap[r.used], delay_columns(r, behind)[r.used, 0]) for r in runs), strict=True
        )
    )
    own = time < LOOKED_AT
    at, column = np.floor(time[own] / BIN).astype(int), column[own]
    along, square = (np.bincount(at, column * other).astype(float) for other in (gap[own], column))
    return (np.arange(len(along), dtype=float) + 0.5) * BIN, along, square
