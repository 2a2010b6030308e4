"""When a load's swing is not that of the motion that was logged: it began before the record, or in a hole of it."""

import numpy as np

from winch_friction.discrepancy.preparation.grid import HOLE, Grid
from winch_friction.discrepancy.preparation.suspended_load import Mode
from winch_friction.physics.signals import FloatArray

USUAL_DAMPING = 0.05  # ratio of a load on a rope, by which is told when a swing from before the record hides no other
RINGS = 2.0  # times the gap's deviation elsewhere in the run, by which its beginning, or what follows a hole, swings
MOST_SETTLING = 0.2  # of a run, left out at its beginning while the load may still swing from before
FEWEST_AFTER, FEWEST_ELSEWHERE = 20, 100  # samples: a deviation is known to a sixth, and to a fourteenth


def beside_holes(grid: Grid, mode: Mode, gap: FloatArray, moving: np.ndarray) -> np.ndarray:
    """Samples without a swing from a hole of the record: nobody knows how the shaft moved there, and a load rings with
    it for four decay times. Only after holes after which the gap deviates so much more than elsewhere: where the speed
    went on as a line between its ends, nothing is unknown.

    `gap` in N m; the wire's `mode` has its frequency in rad/s, and no damping where it is taken for rigid. (samples,)
    """
    found = np.ones(len(gap), bool)
    if mode.frequency <= 0.0:
        return found
    mode = mode if mode.damping > 0.0 else Mode(mode.frequency, USUAL_DAMPING)
    lasts = max(round(min(mode.settling_time, MOST_SETTLING * grid.time[-1]) / grid.dt), 1)
    edges = np.diff(np.pad(grid.valid.astype(int), 1, constant_values=1))
    begins, ends = np.flatnonzero(edges < 0), np.flatnonzero(edges > 0)
    after = [slice(end, end + lasts) for begin, end in zip(begins, ends, strict=True) if end - begin >= HOLE - 1]
    elsewhere = moving.copy()
    for own in after:
        elsewhere[own] = False
    if not after or elsewhere.sum() < FEWEST_ELSEWHERE:
        return found
    usual = float(np.std(gap[elsewhere]))
    for own in after:
        tells = gap[own][moving[own]]
        found[own] &= not (len(tells) >= FEWEST_AFTER and np.std(tells) > RINGS * usual)
    return found
