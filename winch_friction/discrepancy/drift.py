"""What a loss that changes from run to run may come from when nobody logged a temperature."""

from collections.abc import Sequence

import numpy as np
from scipy.special import stdtr

from winch_friction.discrepancy.answer import Side
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.proof import TINY, drive_of

HOUR = 3600.0  # s
FEWEST_RUNS = 6  # fewer lie on a line by chance
SURE = 0.01  # chance that runs of a constant loss seem to drift
MATTERS = 0.02  # of the drive, over the whole time: less is no one's concern
EXPLAINED = ("wear_drift", "viscosity_temperature")


def drift_note(sides: Sequence[Side], named: Sequence[str], unit: str) -> str:
    """What the loss beyond the model does over the runs' dates, in a sentence; '' where it stays or is told apart.

    Warming oil and running-in or wear make the same slow change: only a temperature in the log tells them apart, and
    with one the effects themselves are looked for.
    """
    runs = [run for side in sides for run in side.runs]
    if len(runs) < FEWEST_RUNS or set(named) & set(EXPLAINED) or any("oil_temperature" in r.present for r in runs):
        return ""
    points = [point for side in sides for point in _losses(side)]
    start, loss = np.array(points).T if points else (np.empty(0), np.empty(0))
    hours = (start - start.min()) / HOUR if len(start) else start
    if len(hours) < FEWEST_RUNS or np.ptp(hours) <= 0.0:
        return ""
    slope, std = _line(hours, loss)
    drive = float(np.mean([drive_of(run) for run in runs]))
    change = slope * np.ptp(hours)
    p_value = 2.0 * float(stdtr(len(hours) - 2, -abs(slope) / std))
    if p_value > SURE or abs(change) < MATTERS * drive:
        return ""
    return (
        f"over {np.ptp(hours):.1f} h the loss along the motion changes by {change:+.3g} ± "
        f"{1.96 * std * np.ptp(hours):.2g} {unit} (95 %, p = {p_value:.1g}): undecided between temperature "
        "and wear, for no oil_temperature was logged; log it, or repeat a run cold and warm"
    )


def _line(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Slope of the straight line through points and its standard deviation."""
    away = x - x.mean()
    square = float(away @ away)
    slope = float(away @ y) / square
    left = y - y.mean() - slope * away
    return slope, max(float(np.sqrt(left @ left / (len(x) - 2) / square)), TINY)


def _losses(side: Side) -> list[tuple[float, float]]:
    """Start in s and the median of what is left along the motion, of every run."""
    found = []
    for k, run in enumerate(side.runs):
        own = (side.blocks.run == k) & (side.blocks.direction != 0.0)
        if own.any():
            found.append((run.start, float(np.median(side.after[own] * side.blocks.direction[own]))))
    return found
