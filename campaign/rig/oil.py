"""The oil: Walther's law through two points of an ISO VG 46 oil (134 cSt at 20 degC, 21 cSt at 60 degC)."""

import numpy as np


def _loglog(viscosity: float) -> float:
    return float(np.log10(np.log10(viscosity + 0.7)))


_SLOPE = (_loglog(134.0) - _loglog(21.0)) / (np.log10(333.15) - np.log10(293.15))
_LEVEL = _loglog(134.0) + _SLOPE * np.log10(293.15)


def viscosity(celsius: np.ndarray) -> np.ndarray:
    """Kinematic viscosity, cSt."""
    return 10**10 ** (_LEVEL - _SLOPE * np.log10(np.asarray(celsius) + 273.15)) - 0.7


def relative_viscosity(celsius: np.ndarray) -> np.ndarray:
    """Viscosity relative to that at 40 degC."""
    return viscosity(celsius) / viscosity(np.array(40.0))
