"""The oil: viscosity laws through two points of an ISO VG 46 oil (134 cSt at 20 degC, 21 cSt at 60 degC)."""

import numpy as np

THIN, THICK = (60.0, 21.0), (20.0, 134.0)  # degC, cSt
WALTHER, VOGEL, REYNOLDS, ANDRADE = 0.0, 1.0, 2.0, 3.0
VOGEL_POLE = -95.0  # degC, of the Vogel-Fulcher-Tammann equation; usual for mineral oils


def _loglog(viscosity: float) -> float:
    return float(np.log10(np.log10(viscosity + 0.7)))


_SLOPE = (_loglog(134.0) - _loglog(21.0)) / (np.log10(333.15) - np.log10(293.15))
_LEVEL = _loglog(134.0) + _SLOPE * np.log10(293.15)


def viscosity(celsius: np.ndarray, law: float = WALTHER) -> np.ndarray:
    """Kinematic viscosity, cSt: Walther (ASTM D341), Vogel 1921, Reynolds' exponential 1886, Andrade 1930."""
    celsius = np.asarray(celsius, float)
    if law == WALTHER:
        return 10**10 ** (_LEVEL - _SLOPE * np.log10(celsius + 273.15)) - 0.7
    scale = {VOGEL: lambda t: 1.0 / (t - VOGEL_POLE), REYNOLDS: lambda t: -t, ANDRADE: lambda t: 1.0 / (t + 273.15)}[
        law
    ]
    low, high = scale(THIN[0]), scale(THICK[0])
    share = (scale(celsius) - low) / (high - low)
    return np.asarray(THIN[1] * (THICK[1] / THIN[1]) ** share)


def relative_viscosity(celsius: np.ndarray, law: float = WALTHER, reference: float = 40.0) -> np.ndarray:
    """Viscosity relative to that at the reference temperature."""
    return viscosity(celsius, law) / viscosity(np.array(reference), law)
