"""Gas in the hydraulics: a compression's heat that the accumulator's wall takes, and free air that makes oil soft."""

from collections.abc import Callable

import numpy as np

from winch_friction.physics.signals import FloatArray

ATMOSPHERE = 1.0e5  # Pa, at which the volume of free air is stated
ADIABATIC = 1.4  # exponent of air that is compressed too fast to give its heat away


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


def air_compressed(pressure_a: FloatArray, pressure_b: FloatArray) -> FloatArray:
    """Volume by which free air in the two lines has given way to the flow towards port A, since the first sample.

    Per volume of the air of one line at atmospheric pressure; pressures in Pa, shape (samples,). Adiabatic, p V^1.4 is
    constant. The line with the higher pressure takes the flow up, the other one is held by the boost; where they
    change places, the new one begins at the pressure at which the boost held it.
    """
    return path_of_high_side(pressure_a, pressure_b, _air_taken)


def path_of_high_side(
    pressure_a: FloatArray, pressure_b: FloatArray, taken: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """What a function of pressure has taken up in the line with the higher pressure, positive towards port A."""
    side = np.where(pressure_a >= pressure_b, 1.0, -1.0)
    high = np.maximum(pressure_a, pressure_b)
    left, came = side[:-1], side[1:]
    boost = np.where(left > 0.0, pressure_b[:-1], pressure_a[:-1])
    at = taken(high)
    same = left * np.diff(at)
    crossed = left * (taken(boost) - at[:-1]) + came * (at[1:] - taken(boost))
    return np.concatenate([[0.0], np.cumsum(np.where(left == came, same, crossed))])


def _air_taken(pressure: FloatArray) -> FloatArray:
    return 1.0 - (ATMOSPHERE / np.maximum(pressure, ATMOSPHERE)) ** (1.0 / ADIABATIC)
