"""Flow that leaks past a motor: through gaps, through orifices, and through gaps that the pressure opens."""

from collections.abc import Callable

import numpy as np

from winch_friction.physics.signals import FloatArray

REFERENCE_PRESSURE = 150e5  # Pa, at which a coefficient's flow is the same in every law

_Law = Callable[[FloatArray, FloatArray | float], FloatArray]


def _gap(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return drop * thinness


def _orifice(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return np.sign(drop) * np.sqrt(np.abs(drop) * REFERENCE_PRESSURE)


def _opening_gap(drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    return drop * np.abs(drop) / REFERENCE_PRESSURE * thinness


# by the name of the correction; q/C with q m^3/s the flow, from the pressure drop in Pa and mu_40/mu. A gap's flow is
# laminar, an orifice's turbulent and whatever the oil, and that of a gap of height h ~ 1 + k p grows, to first order in
# k, with the pressure's square
LEAKAGE_LAWS: dict[str, _Law] = {
    "slip_leakage": _gap, "orifice_leakage": _orifice, "opening_gap_leakage": _opening_gap,
}  # fmt: skip


def leakage_per_coefficient(law: str, drop: FloatArray, thinness: FloatArray | float) -> FloatArray:
    """Flow per unit of the law's coefficient (m^3/s/Pa, stated at 150 bar and 40 degC), Pa, with the drop's sign.

    `drop` Pa, shape (samples,); `thinness` mu_40/mu of the oil, alike or a number. `KeyError` for an unknown law.
    """
    return LEAKAGE_LAWS[law](drop, thinness)
