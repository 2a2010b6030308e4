"""SI inside; the few units that crane files, model files and people use, and their factors.

Table headers with arbitrary units are parsed with pint in `records`; this table is what the nodes need without it.
"""

import math

from winch_friction.physics.errors import InputError

GRAVITY = 9.81  # m/s^2
RPM = 2.0 * math.pi / 60.0  # rad/s per rev/min
BAR = 1.0e5  # Pa per bar
CM3_PER_REV = 1.0e-6 / (2.0 * math.pi)  # m^3/rad per cm^3/rev

# unit -> (SI unit, factor); a unit that stands for itself has factor 1
_CONVERSIONS = {
    "rpm": ("rad/s", RPM),
    "bar": ("Pa", BAR),
    "cm^3/rev": ("m^3/rad", CM3_PER_REV),
    "t": ("kg", 1.0e3),
    "kN*m": ("N*m", 1.0e3),
    "kN": ("N", 1.0e3),
    "kW": ("W", 1.0e3),
    "mm": ("m", 1.0e-3),
    "ms": ("s", 1.0e-3),
    "h": ("s", 3600.0),
    "deg": ("rad", math.pi / 180.0),
    "-": ("1", 1.0),
    "N*m*s": ("N*m*s/rad", 1.0),
}


def factor_to_si(unit: str, expected: str, where: str = "") -> float:
    """Factor that takes a value in `unit` to the SI unit `expected`; raises `InputError` for another dimension."""
    if unit == expected:
        return 1.0
    si_unit, factor = _CONVERSIONS.get(unit, (unit, 1.0))
    if si_unit == expected:
        return factor
    raise InputError(
        f"{where or 'value'}: unit '{unit}' cannot be used, expected {' or '.join(accepted_units(expected))}"
    )


def accepted_units(si_unit: str) -> list[str]:
    """The SI unit and every unit of the table that converts to it."""
    return [si_unit, *(unit for unit, (target, _) in _CONVERSIONS.items() if target == si_unit)]
