"""The independent noise of a record, from the data alone: what is left inside short windows once a parabola is out.

A parabola over two seconds follows any friction, load or wave; what remains is sensor noise, whatever model is
tried. No fit of candidates takes part, because a rich fit that lacks the true law would whiten the effect away.
"""

import numpy as np
from scipy.special import gammaincinv

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS

TINY = 1e-300  # against a division by nothing, where nothing moves


def noise_of_run(
    values: FloatArray, position: np.ndarray, least: float = LIMITS.least_noise, skew: FloatArray | None = None
) -> float:
    """Standard deviation of the block noise, same unit as `values`; `position` numbers the blocks on their grid.

    A hundredth of what no balance closes better than, `least`, is as good as noise-free. `skew`, one column
    or several, is what signals out of step leave in the values: in a quick sea it turns within the windows, no noise.
    """
    floor = LIMITS.noise_floor * least
    window, order = LIMITS.noise_window, LIMITS.noise_order
    windows = _windows(values, position, window)
    if len(windows) == 0:
        simple = float(np.std(np.diff(values)) / np.sqrt(2.0)) if len(values) > 2 else 0.0
        return max(simple, floor)
    grid = np.vander(np.linspace(-1.0, 1.0, window), order + 1)
    projector = np.eye(window) - grid @ np.linalg.pinv(grid)
    freedom = window - order - 1
    quick = windows @ projector
    if skew is not None:
        each = [_windows(column, position, window) @ projector for column in np.atleast_2d(skew.T)]
        along = np.column_stack([own.ravel() / max(float(np.abs(own).max()), TINY) for own in each])
        quick = quick - (along @ np.linalg.lstsq(along, quick.ravel(), rcond=None)[0]).reshape(quick.shape)
    variances = (quick**2).sum(axis=1) / freedom
    # that quantile of chi-squared, per degree of freedom
    expected = 2.0 * gammaincinv(0.5 * freedom, LIMITS.noise_quiet) / freedom
    return max(float(np.sqrt(np.quantile(variances, LIMITS.noise_quiet) / expected)), floor)


def _windows(values: FloatArray, position: np.ndarray, window: int) -> FloatArray:
    starts = range(0, len(values) - window + 1, window // 2)
    found = [values[k : k + window] for k in starts if position[k + window - 1] - position[k] == window - 1]
    return np.array(found)
