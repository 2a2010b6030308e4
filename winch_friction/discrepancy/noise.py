"""The independent noise of a run, from the data alone: what is left inside short windows once a parabola is taken out.

A parabola over two seconds follows any friction, load or wave; what remains is sensor noise, whatever model is
tried. No fit of candidates takes part, because a rich fit that lacks the true law would whiten the effect away.
"""

import numpy as np
from scipy.special import gammaincinv

from winch_friction.physics.signals import FloatArray

WINDOW = 12  # blocks
ORDER = 2
QUIET = 0.25  # the quieter windows speak for the noise; in the others an oscillation may ring down
FLOOR = 1e-3  # bar (N m): below it a record is as good as noise-free


def noise_of_run(values: FloatArray, position: np.ndarray) -> float:
    """Standard deviation of the block noise, same unit as `values`; `position` numbers the blocks on the run's grid."""
    windows = _windows(values, position)
    if len(windows) == 0:
        return max(float(np.std(np.diff(values)) / np.sqrt(2.0)) if len(values) > 2 else FLOOR, FLOOR)
    grid = np.vander(np.linspace(-1.0, 1.0, WINDOW), ORDER + 1)
    projector = np.eye(WINDOW) - grid @ np.linalg.pinv(grid)
    variances = ((windows @ projector) ** 2).sum(axis=1) / (WINDOW - ORDER - 1)
    freedom = WINDOW - ORDER - 1
    expected = 2.0 * gammaincinv(0.5 * freedom, QUIET) / freedom  # that quantile of chi-squared, per degree of freedom
    return max(float(np.sqrt(np.quantile(variances, QUIET) / expected)), FLOOR)


def _windows(values: FloatArray, position: np.ndarray) -> FloatArray:
    starts = range(0, len(values) - WINDOW + 1, WINDOW // 2)
    found = [values[k : k + WINDOW] for k in starts if position[k + WINDOW - 1] - position[k] == WINDOW - 1]
    return np.array(found)
