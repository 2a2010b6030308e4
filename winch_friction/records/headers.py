"""Headers of run files: `motor_speed [rpm]` is a column with its unit, read with pint, `rev` meaning a revolution.

Angle is a dimension of its own here: `Hz` or `cm^3` alone would leave open whether a revolution or a radian is meant.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from winch_friction.physics.channels import CHANNELS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, column_unit
from winch_friction.records.unit_names import pint_name

# what people write for the units a winch is logged in; quoted in error messages
_EXAMPLES = {each.unit: each.display for each in CHANNELS if each.display != each.unit} | {
    "s": "ms",
    "rad": "deg",
    "N*m": "kN*m",
}

LONGEST_UNIT = 80  # characters; `kilogram * meter ** 2 / second ** 2 / radian` has half of it
MOST_POWERS = 4
# one digit, in brackets or not, and no power of a power
_EXPONENT = re.compile(r"\s*(?:[-+]?\d(?:\.\d+)?|\(\s*[-+]?\d(?:\.\d+)?\s*\))(?![\d.])(?!\s*$)")

_SI_NAMES = {"1": "dimensionless"}
_DEFINITIONS = (
    "radian = [angle] = rad",
    "revolution = 2 * pi * radian = rev",
    "rpm = rev / minute",
    "gravity = 9.80665 * meter / second ** 2",
    "bar_absolute = 100000 * pascal; offset: -101325",  # to the gauge pressure that a run holds
    "psi_absolute = 6894.757293168 * pascal; offset: -101325",
)


@dataclass(frozen=True)
class Header:
    """One header: `text` as it stands, the column's `name`, the `unit` in brackets (empty: SI)."""

    text: str
    name: str
    unit: str

    @property
    def known(self) -> bool:
        """Whether the name is one of the contract's columns."""
        return column_unit(self.name) is not None

    def to_si(self, values: FloatArray, where: str) -> FloatArray:
        """Values of a known column in SI; raises `InputError` for a unit that does not fit."""
        expected = column_unit(self.name) or "1"
        if self.unit in ("", expected):
            return values
        scale, offset = conversion_to_si(self.unit, expected, f"{where}: column '{self.text}'")
        return values * scale + offset if offset else values * scale


def parse_header(text: str, where: str = "") -> Header:
    """Name and unit of a header; a bracket that does not close raises `InputError`."""
    name, bracket, rest = text.strip().partition("[")
    if bracket and not rest.rstrip().endswith("]"):
        raise InputError(
            f"{where}: header '{text}' opens a bracket that does not close; write e.g. 'motor_speed [rpm]'"
        )
    return Header(text.strip(), name.strip(), rest.strip().removesuffix("]").strip())


def header_text(column: str) -> str:
    """The header that this package writes for a column: with its SI unit, bare for an unknown one or a plain number."""
    unit = column_unit(column)
    return column if unit in (None, "1") else f"{column} [{unit}]"


_COUNTED = re.compile(r"^[x×]?\s*(0?[.,]0{0,5}1|10{1,5})\s*[x×*]?\s*([A-Za-z°%µμ].*)$")  # powers of ten alone


@lru_cache(maxsize=256)
def conversion_to_si(unit: str, expected: str, where: str) -> tuple[float, float]:
    """Scale and offset that take values in `unit` to `expected`; raises `InputError` for a unit that does not fit."""
    counted = _COUNTED.match(unit.strip())
    if counted:  # a controller's whole numbers: tenths of a bar, hundreds of microseconds
        scale, offset = conversion_to_si(counted[2], expected, where)
        return scale * float(counted[1].replace(",", ".")), offset
    registry, name = _registry(), pint_name(unit, expected, where)
    try:
        _refuse_arithmetic(name)
        at = [registry.Quantity(np.float64(value), name).to(_SI_NAMES.get(expected, expected)) for value in (0.0, 1.0)]
    except Exception as error:  # pint raises whatever its tokenizer and parser meet
        example = f", e.g. '{_EXAMPLES[expected]}'" if expected in _EXAMPLES else ""
        raise InputError(f"{where}: unit '{unit}' cannot be read as {expected}{example}") from error
    return float(at[1].magnitude - at[0].magnitude), float(at[0].magnitude)


def _refuse_arithmetic(name: str) -> None:
    """pint works out what a unit says in whole numbers: `9**9**9**9` would keep it busy for ever."""
    powers = re.split(r"\*\*|\^", f"{name} .")[1:]
    if len(name) > LONGEST_UNIT or len(powers) > MOST_POWERS or not all(map(_EXPONENT.match, powers)):
        raise ValueError("not a unit")


@lru_cache(maxsize=1)
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(on_redefinition="ignore", autoconvert_offset_to_baseunit=True)
    for definition in _DEFINITIONS:
        registry.define(definition)
    registry._build_cache()  # pint keeps what it worked out of the old radian: 'rev' would not be a 'rad'
    if "percent" not in registry:  # Ubuntu 24.04's pint does not know it
        registry.define("percent = 0.01")
    return registry
