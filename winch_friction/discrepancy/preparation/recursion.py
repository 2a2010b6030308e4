"""Linear recursive filters over a whole record, as banded triangular systems.

`scipy.signal.lfilter` gives the same to rounding, but importing it brings scipy.stats and scipy.optimize: half a
second of every `gap`.
"""

import numpy as np
from scipy.linalg.blas import dtbsv

from winch_friction.discrepancy.engine import FloatArray


def filtered(numerator: FloatArray, denominator: FloatArray, x: FloatArray) -> FloatArray:
    """y with sum_i denominator_i y[k-i] = sum_i numerator_i x[k-i] from rest, shape (samples,); denominator_0 is 1."""
    right = numerator[0] * x
    for i, weight in enumerate(numerator[1:], 1):
        right[i:] += weight * x[:-i]
    bands = np.empty((len(denominator), len(x)), order="F")
    bands[:] = np.asarray(denominator)[:, None]
    return np.asarray(dtbsv(len(denominator) - 1, bands, right, lower=1, diag=1, overwrite_x=1))


def lagged(x: FloatArray, dt: float, time_constant: float) -> FloatArray:
    """First-order lag of samples `dt` apart, exact for values held over a step; settled before the first of them."""
    keep = float(np.exp(-dt / time_constant))
    return x[0] + filtered(np.array([1.0 - keep]), np.array([1.0, -keep]), x - x[0])
