"""Linear recursive filters over a whole record, as banded triangular systems.

`scipy.signal.lfilter` gives the same to rounding, but importing it brings scipy.stats and scipy.optimize: half a
second of every `gap`.
"""

import numpy as np
from scipy.linalg.blas import dtbsv

from winch_friction.discrepancy.engine import FloatArray


def filtered(numerator: FloatArray, denominator: FloatArray, x: FloatArray) -> FloatArray:
    """y with sum_i denominator_i y[k-i] = sum_i numerator_i x[k-i] from rest, shape (samples,); denominator_0 is 1.

    Weights are numbers, shape (order + 1,), or another at every sample k, shape (order + 1, samples).
    """
    over, under = (
        np.broadcast_to(np.reshape(each, (len(each), -1)), (len(each), len(x))) for each in (numerator, denominator)
    )
    right = over[0] * x
    for i, weight in enumerate(over[1:], 1):
        right[i:] += weight[i:] * x[:-i]
    bands = np.zeros((len(under), len(x)), order="F")
    for i, weight in enumerate(under):
        bands[i, : len(x) - i] = weight[i:]
    return np.asarray(dtbsv(len(denominator) - 1, bands, right, lower=1, diag=1, overwrite_x=1))


def lagged(x: FloatArray, dt: float, time_constant: float) -> FloatArray:
    """First-order lag of samples `dt` apart, exact for values held over a step; settled before the first of them."""
    keep = float(np.exp(-dt / time_constant))
    return x[0] + filtered(np.array([1.0 - keep]), np.array([1.0, -keep]), x - x[0])
