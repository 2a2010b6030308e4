"""Gas that gives its heat away: what relaxes of a compression's heat with the wall's time constant."""

import numpy as np

from winch_friction.physics.signals import FloatArray


def relaxed_compression(time: FloatArray, pressure: FloatArray, time_constant: float) -> FloatArray:
    """First-order low-pass of ln(p / p_0) over `time_constant` s, from rest at the first sample; exact for a signal
    held over each step."""
    change = np.log(np.maximum(pressure, 1.0) / max(float(pressure[0]), 1.0))
    keep = np.exp(-np.diff(time, prepend=time[0]) / time_constant)
    relaxed, value = np.empty(len(time)), 0.0
    for k, (share, target) in enumerate(zip(keep.tolist(), change.tolist(), strict=True)):
        value = share * value + (1.0 - share) * target
        relaxed[k] = value
    return relaxed
