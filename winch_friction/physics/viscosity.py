"""Viscosity of the hydraulic oil over temperature: Walther's law (ASTM D341), log10 log10(nu + 0.7) = A - B log10 T.

The line goes through 134 cSt at 20 degC and 21 cSt at 60 degC (docs/discrepancy.md).
"""

import math

import numpy as np

from winch_friction.physics.signals import FloatArray

REFERENCE = 40.0  # degC, at which viscous parameters hold

_LOG_20, _LOG_60 = (math.log10(math.log10(nu + 0.7)) for nu in (134.0, 21.0))
SLOPE = (_LOG_20 - _LOG_60) / (math.log10(333.15) - math.log10(293.15))
LEVEL = _LOG_20 + SLOPE * math.log10(293.15)


def kinematic_viscosity(celsius: FloatArray | float) -> FloatArray:
    """Kinematic viscosity in cSt at temperatures in degC."""
    return np.asarray(10.0**10.0 ** (LEVEL - SLOPE * np.log10(np.asarray(celsius) + 273.15)) - 0.7)


def relative_viscosity(celsius: FloatArray | float) -> FloatArray:
    """Viscosity relative to that at 40 degC."""
    return kinematic_viscosity(celsius) / kinematic_viscosity(REFERENCE)
