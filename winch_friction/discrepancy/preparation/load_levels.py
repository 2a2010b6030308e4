"""What a load cell says of a mass that hangs still on the wire: one level, or several where a part was set down."""

from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from winch_friction.physics.signals import FloatArray

LASTS = 15.0  # s on either side of a change: the middle of three quarters of the longest swell is near its mean
EVERY = 0.5  # s, at which changes are looked for
# a load that changes does so by more: of it, half of what pins in sheaves are stated with (1 %), for less may be the
# cell's own; and times the cell's deviation within such a time, of which half a swell's period reaches one and a half
LEAST, CLEARLY = 0.005, 4.0


def level_of(cell: FloatArray, slow: FloatArray, dt: float) -> FloatArray:
    """The mass by its levels, shape and unit of `cell`, every `dt` s: the median between two changes, and the `slow`
    cell, no further than these, where one level becomes another."""
    size, lasts = max(round(EVERY / dt), 1), round(LASTS / EVERY)
    coarse = cell[: len(cell) // size * size].reshape(-1, size).mean(axis=1)
    cuts = [0, *(size * cut for cut in _changes(coarse, lasts)), len(cell)]
    medians = [float(np.median(cell[a:b])) for a, b in pairwise(cuts)]
    level = np.repeat(medians, np.diff(cuts))
    half = size * lasts // 2
    for cut, *both in zip(cuts[1:-1], medians, medians[1:], strict=False):
        near = slice(cut - half, cut + half)
        level[near] = np.clip(slow[near], min(both), max(both))
    return level


def _changes(values: FloatArray, lasts: int) -> list[int]:
    """Where what lasts before differs from what lasts after, the surest first, in order."""
    if len(values) < 2 * lasts:
        return []
    windows = sliding_window_view(values, lasts)
    middle, mean = np.median(windows, axis=1), windows.mean(axis=1)
    step = np.abs(middle[lasts:] - middle[:-lasts])
    least = max(LEAST * abs(float(np.median(values))), CLEARLY * float(np.median(windows.std(axis=1))))
    # medians tell that it lasts, means where it is: the former stay while either window is half over it
    sure = np.where(step > least, np.abs(mean[lasts:] - mean[:-lasts]), 0.0)
    found = []
    while sure.max() > 0.0:
        at = int(sure.argmax())
        found.append(at + lasts)
        sure[max(at - lasts + 1, 0) : at + lasts] = 0.0
    return sorted(found)
