"""What was logged that may tell why some runs have something and others have not, or by what amount.

A brake that hangs in some runs, or by another amount in each, is what no logged signal tells: what one of them says as
well is that signal's.
"""

from collections.abc import Sequence

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS

NO_SIGNAL = ("time", "shaft_angle", "acceleration")  # channels that every run has all of
NUMBERED = ("wire_layer",)  # whose values are names: the middle one may be wrong
DAY = 86400.0  # s
FEWEST_FREE = 3  # runs beyond what a parabola uses up, to tell that levels do not follow it


def follows_a_signal(runs: Sequence[PreparedRun], levels: FloatArray) -> bool:
    """Whether a parabola or a step over the medians of something that was logged, or over the date, a product with the
    load, the layer of the drum or the time of day says most of what the runs' levels differ by, beside what hoisting
    and heave compensation differ by."""
    kinds = sorted({run.kind for run in runs})
    beside = np.array([[float(run.kind == kind) for kind in kinds] for run in runs])
    if len(runs) - len(kinds) - 2 < FEWEST_FREE:
        return True
    most = LIMITS.followed * _left_by(beside, levels)
    medians, starts = _medians(runs), np.array([run.start for run in runs])
    load = _spread(np.array([float(np.median(run.load)) for run in runs]))
    hour = 2.0 * np.pi * starts / DAY
    laws = [np.column_stack([np.sin(hour), np.cos(hour)])] if np.ptp(starts) > DAY else []
    for name, values in {"": starts, **medians}.items():
        x = _spread(values)
        if x is None:
            continue
        laws += [np.column_stack([x, x**2]), *(x[:, None] > at for at in np.unique(x)[:-1])]
        laws += [np.column_stack([x, load, x * load])] if load is not None else []
        laws += [x[:, None] == np.unique(x)] if name in NUMBERED else []
    fits = [np.column_stack([beside, law]) for law in laws]
    return any(_left_by(each, levels) < most for each in fits if len(runs) - each.shape[1] >= FEWEST_FREE)


def _spread(values: FloatArray) -> FloatArray | None:
    """The same about their mean, over their range; None where they are all alike or one is not known."""
    wide = float(np.ptp(values))
    return (values - values.mean()) / wide if wide > 1e-9 * float(np.abs(values).max()) else None


def _medians(runs: Sequence[PreparedRun]) -> dict[str, FloatArray]:
    """What every signal that all runs have was in the middle of each one's samples; nan where a run has none."""
    known = []
    for run in runs:  # what the driving group does, whatever its name: it is another one in heave compensation
        drives = [{"displacement": g.displacement, "pressure": g.pressure} for g in run.groups if g.balances]
        known.append({**run.channels, **(drives or [{}])[0]})
    return {
        name: np.array(
            [np.median(x[name][r.used]) if r.used.any() else np.nan for r, x in zip(runs, known, strict=True)]
        )
        for name in sorted(set.intersection(*map(set, known)) - set(NO_SIGNAL))
    }


def _left_by(columns: FloatArray, values: FloatArray) -> float:
    """Sum of squares that a fit leaves, per value that it does not use up."""
    left = values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(left @ left) / max(len(values) - columns.shape[1], 1)


def told_by_a_signal(runs: Sequence[PreparedRun], there: np.ndarray) -> bool:
    """Whether something that was logged is larger in all runs of one level than in any of the other: then what is there
    may hang on it."""
    kinds = {run.kind for run in runs}
    if len({(run.kind, bool(on)) for run, on in zip(runs, there, strict=True)}) == len(kinds):
        return len(kinds) > 1
    for name, medians in _medians(runs).items():
        yes, no = medians[there], medians[~there]
        if np.nanmin(yes) > np.nanmax(no) or np.nanmax(yes) < np.nanmin(no):
            return True
        if name in NUMBERED and not set(yes) & set(no) and len(set(yes)) < len(yes):  # of two runs or more
            return True
    return False
