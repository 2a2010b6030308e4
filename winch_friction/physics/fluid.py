"""Oil and gas: how thick the oil is at a temperature, what leaks, and how gas and free air give way.

Viscosity is Walther's law (ASTM D341), log10 log10(nu + 0.7) = A - B log10 T, through 134 cSt at 20 degC and 21 cSt at
60 degC (docs/discrepancy.md).
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from winch_friction.physics.signals import FloatArray

# -- viscosity
REFERENCE = 40.0  # degC, at which viscous parameters hold

_LOG_20, _LOG_60 = (math.log10(math.log10(nu + 0.7)) for nu in (134.0, 21.0))
SLOPE = (_LOG_20 - _LOG_60) / (math.log10(333.15) - math.log10(293.15))
LEVEL = _LOG_20 + SLOPE * math.log10(293.15)


def walther(celsius: Any, log10: Callable[[Any], Any]) -> Any:
    """Kinematic viscosity in cSt at temperatures in degC: of arrays, or of a symbol, by their own logarithm."""
    return 10**10 ** (LEVEL - SLOPE * log10(celsius + 273.15)) - 0.7


def kinematic_viscosity(celsius: FloatArray | float) -> FloatArray:
    """Kinematic viscosity in cSt at temperatures in degC."""
    return np.asarray(walther(np.asarray(celsius), np.log10))


def relative_viscosity(celsius: FloatArray | float) -> FloatArray:
    """Viscosity relative to that at 40 degC."""
    return kinematic_viscosity(celsius) / kinematic_viscosity(REFERENCE)


# -- what leaks past the pistons
REFERENCE_PRESSURE = 150e5  # Pa, at which a coefficient's flow is the same in every law

_Law = Callable[[FloatArray, FloatArray | float], FloatArray]


def _gap(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return drop * thinness


def _orifice(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return np.sign(drop) * np.sqrt(np.abs(drop) * REFERENCE_PRESSURE)


def _opening_gap(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return drop * np.abs(drop) / REFERENCE_PRESSURE * thinness


def _warm_gap(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return drop


# by the name of the correction; q/C with q m^3/s the flow, from the pressure drop in Pa and mu_40/mu. A gap's flow is
# laminar, an orifice's turbulent and whatever the oil, and that of a gap of height h ~ 1 + k p grows, to first order in
# k, with the pressure's square; in a gap that warms its own oil it is as thick whatever the tank's
LEAKAGE_LAWS: dict[str, _Law] = {
    "slip_leakage": _gap, "orifice_leakage": _orifice, "opening_gap_leakage": _opening_gap,
    "isoviscous_leakage": _warm_gap,
}  # fmt: skip


def leakage_per_coefficient(law: str, drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    """Flow per unit of the law's coefficient (m^3/s/Pa, stated at 150 bar and 40 degC), Pa, with the drop's sign.

    `drop` Pa, shape (samples,); `thinness` mu_40/mu of the oil, alike or a number. `KeyError` for an unknown law.
    """
    return LEAKAGE_LAWS[law](drop, thinness)


# -- gas in oil and accumulators
def bridged(values: FloatArray) -> FloatArray:
    """Values with a straight line over what is no number: what is summed up along a record must not end there."""
    known = np.isfinite(values)
    if known.all() or not known.any():
        return values
    places = np.arange(len(values))
    return np.interp(places, places[known], values[known])


ATMOSPHERE = 1.0e5  # Pa, at which the volume of free air is stated
ADIABATIC = 1.4  # exponent of air that is compressed too fast to give its heat away


def relaxed_compression(time: FloatArray, pressure: FloatArray, time_constant: float) -> FloatArray:
    """First-order low-pass of ln(p / p_0) over `time_constant` s, from rest at the first sample; exact for a signal
    held over each step."""
    pressure = bridged(pressure)
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
    pressure_a, pressure_b = bridged(pressure_a), bridged(pressure_b)
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
