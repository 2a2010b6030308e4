"""Short bursts far outside a run's own spread: the shaft stuck for an instant, or a sensor failed."""

import numpy as np
from scipy.ndimage import median_filter

from winch_friction.discrepancy.preparation.smoothing import dilated
from winch_friction.physics.signals import FloatArray

SPIKE, WINDOW, MOST = 12.0, 2.0, 0.01  # robust deviations, s, share of the moving samples
MARGIN = 0.1  # s left out on both sides
FEWEST = 100  # samples


def spikes_of(gap: FloatArray, moving: np.ndarray, dt: float) -> np.ndarray:
    """Samples to leave out; none where there are so many that they are no spikes."""
    none = np.zeros(len(gap), bool)
    if moving.sum() < FEWEST:
        return none
    size = max(int(WINDOW / dt), 3) | 1
    coarse = max(size // 25, 1)  # a running median over every few samples is as good and much faster
    slow = np.interp(
        np.arange(len(gap)), np.arange(0, len(gap), coarse), median_filter(gap[::coarse], max(size // coarse, 3))
    )
    off = np.abs(gap - slow)
    spread = 1.4826 * float(np.median(off[moving]))
    found = moving & (off > SPIKE * max(spread, 1e-12))
    return dilated(found, int(MARGIN / dt)) if 0 < found.sum() < MOST * moving.sum() else none
