"""The unit of a column: from its name, from a row of units; what a channel may be logged in, and the way to SI.

A load may be logged as a force, a displacement as a share of the largest, a speed at the rope: `conversion` says how.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.records.unit_names import AMBIGUOUS, SPELLINGS, conversion_to_si, known_spelling, plain_spelling

# channel (without its group) -> the SI units that it may be logged in, its own first
CHANNEL_UNITS: dict[str, tuple[str, ...]] = {
    "time": ("s",),
    "motor_speed": ("rad/s", "m/s", "1"),
    "drum_speed": ("rad/s", "1"),
    "rope_speed": ("m/s",),
    "speed_reference": ("rad/s",),
    "pressure_a": ("Pa",),
    "pressure_b": ("Pa",),
    "displacement": ("m^3/rad", "1"),
    "motor_torque": ("N*m", "1"),
    "load_torque": ("N*m",),
    "hook_load": ("kg", "N"),
    "rope_force": ("N",),
    "mechanical_power": ("W",),
    "motor_current": ("A", "1"),
    "heave_velocity": ("m/s", "m"),
    "oil_temperature": ("degC",),
    "wire_layer": ("1",),
    "wire_out": ("m",),
    "shaft_angle": ("rad",),
}
_BRACKETED = re.compile(r"^(.*?)\s*[\[({<]\s*([^\[\](){}<>]*(?:\([^()]*\))?[^\[\](){}<>]*)\s*[\])}>]\s*(.*)$")
_AFTER_MARK = re.compile(r"^(.*\S)\s+(?:in|/)\s*([^\s]+)$|^(.*\S)\s*[,;:]\s*([^\s,;:]+)$", re.IGNORECASE)
_SUFFIX = re.compile(r"^(.+?)[_\s\-]+([^\s_]{1,9}(?:_per_[a-z]+)?)$")
# a unit of two words behind an underscore: displacement_cc_rev, speed_rad_s, torque_N_m
_LONG_SUFFIX = re.compile(r"^(.+?)[_\s\-]+([^\s_/]{1,6}_(?:rev|rad|min|s|h|u|o|omdr|m|cm2))$", re.IGNORECASE)
_OVER = re.compile(r"^(.+)_(rev|rad|min|s|h|u|o|omdr|cm2)$", re.IGNORECASE)
# units of what no channel is; those with a slash are told by pint, the others by their spelling (casefolded)
_FOREIGN_SI = ("m^3/s", "m^2/s", "kg/m^3", "kg/s", "m/s^2", "Pa/s", "K/s", "N/m")
_FOREIGN = frozenset({"v", "mv", "kv", "volt", "va", "kva", "wh", "kwh", "mwh", "j", "kj", "mj", "ah", "ohm", "cst",
                      "l", "ltr", "liter", "litre", "gal", "lpm", "gpm", "slpm", "m3", "m^3", "kg/m3", "ppm", "db",
                      "dba", "rh", "%rh"})  # fmt: skip
_DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
_WORDED = (("_per_", "/"), (" per ", "/"), (" pro ", "/"))


@dataclass(frozen=True)
class Conversion:
    """From the log's number to SI: value * scale + offset; `what` says the physics in words, '' for a plain unit."""

    scale: float
    offset: float
    what: str = ""


def header_readings(name: str) -> list[tuple[str, str]]:
    """How a header can be read: (name, unit), the unit '' for none; the first is the most likely."""
    match = _BRACKETED.match(name)
    if match:
        bare, unit = f"{match[1]} {match[3]}".strip(), match[2].strip()
        told = looks_like_unit(unit) or is_foreign(unit)
        return [(bare, worded(unit)), (name, "")] if told else [(name, ""), (bare, "")]
    readings = []
    for pattern in (_AFTER_MARK, _LONG_SUFFIX, _SUFFIX):
        match = pattern.match(name)
        parts = match.groups() if match else ()
        bare, unit = next((pair for pair in zip(parts[::2], parts[1::2], strict=True) if pair[0]), ("", ""))
        if looks_like_unit(unit, marked=pattern is _AFTER_MARK) or (pattern is _AFTER_MARK and is_foreign(unit)):
            readings.append((bare.strip(" ,;:/"), worded(unit)))
    return [*dict.fromkeys(readings), (name, "")]


@lru_cache(maxsize=4096)
def is_foreign(text: str) -> bool:
    """Whether a text is a unit of what no channel is: a flow, a viscosity, a voltage."""
    plain = worded(text)
    return plain_spelling(plain) in _FOREIGN or any(_converts(plain, si) for si in _FOREIGN_SI if "/" in plain)


def bare_unit(cell: str) -> str:
    """The unit in a cell of a row of units, without the brackets around it: `[bar(a)]` is bar(a)."""
    text = cell.strip()
    while text[:1] in ("[", "(") and text[-1:] == {"[": "]", "(": ")"}[text[0]]:
        text = text[1:-1].strip()
    return text


def says_unit(name: str, unit: str) -> bool:
    """Whether a header marks a unit as one (in brackets, after a slash, a comma or 'in'), so that it is no word of it.

    A single A or B is a port, whatever stands around it; behind a mere blank or underscore only longer units are.
    """
    if unit.upper() in ("A", "B"):
        return False
    return len(unit) > 1 or bool(re.search(rf"(?:[\[({{<]\s*|/\s*|,\s*|\bin\s+){re.escape(unit)}\s*\W*$", name))


@lru_cache(maxsize=4096)
def looks_like_unit(text: str, marked: bool = True) -> bool:
    """Whether a text can be a unit of any channel; not marked as one, only the table's spellings and formulas count."""
    text = worded(text)
    formula = marked or bool(re.search(r"[/^*°%²³·]", text))
    return 0 < len(text) <= 24 and any(
        known_spelling(text, si) or (formula and _converts(text, si)) for si in SPELLINGS
    )


def worded(unit: str) -> str:
    """A unit in words as a formula: `cm3_per_rev` -> `cm3/rev`; with a decimal point: `0,1 bar` -> `0.1 bar`."""
    unit = _DECIMAL_COMMA.sub(".", unit)
    for word, mark in _WORDED:
        unit = unit.replace(word, mark)
    return _OVER.sub(r"\1/\2", unit.strip())


@lru_cache(maxsize=4096)
def _converts(unit: str, si_unit: str) -> bool:
    if not re.fullmatch(r"[\w°^*/.%²³µ·\- ]+", unit) or re.fullmatch(r"[\d. ]+", unit) or len(unit) < 2:
        return False
    try:
        conversion_to_si(unit, si_unit, "")
    except InputError:
        return False
    return True


def fitting_si_unit(channel: str, unit: str) -> str | None:
    """Which of a channel's SI units a unit belongs to, an ambiguous spelling included; None when it fits none."""
    unit = _of_one_turn(channel, worded(unit))
    for si in CHANNEL_UNITS[channel]:
        if known_spelling(unit, si) or _converts(unit, si):
            return si
    return None


def is_share(channel: str, unit: str) -> bool:
    """Whether a unit makes a channel a share of something that must be said, as `%` of a speed."""
    return CHANNEL_UNITS[channel][0] != "1" and fitting_si_unit(channel, unit) == "1"


def _of_one_turn(channel: str, unit: str) -> str:
    """The unit of a displacement that is written as a volume: in the trade it is that of one revolution (ISO 3019)."""
    return f"{unit}/rev" if channel == "displacement" and plain_spelling(unit) in ("cm3", "cm^3") else unit


def ambiguity(channel: str, unit: str) -> str:
    """What an ambiguous unit may mean over this channel, '' for a plain one."""
    return next((AMBIGUOUS[si][plain_spelling(unit)] for si in CHANNEL_UNITS[channel]
                 if plain_spelling(unit) in AMBIGUOUS.get(si, ())), "")  # fmt: skip


def conversion(channel: str, unit: str, where: str, *, of: float = float("nan"), rope_radius: float = float("nan"),
               gear_ratio: float = 1.0) -> Conversion:  # fmt: skip
    """How a channel's numbers in a unit become SI; raises `InputError` for a unit that does not fit.

    `of`: what a share (%) is of, in the channel's own SI unit; `rope_radius` m and `gear_ratio` take a speed of the
    rope in m/s to the motor's shaft.
    """
    own, *others = CHANNEL_UNITS[channel]
    si = fitting_si_unit(channel, unit)
    if si is None:
        examples = " or ".join(f"'{next(iter(SPELLINGS.get(each, {each: ()})))}'" for each in (own, *others))
        raise InputError(f"{where}: unit '{unit}' is no unit of {channel}; write e.g. {examples}")
    scale, offset = conversion_to_si(_of_one_turn(channel, worded(unit)), si, where)
    if si == own:
        return Conversion(scale, offset)
    if si == "1":
        if of != of:
            raise InputError(f"{where}: '{unit}' is a share; say of what, e.g. of: 215 cm^3/rev or of: 9.84 mN*m")
        return Conversion(scale * of, 0.0, f"share of {of:.4g} {own}")
    if si == "m":
        raise InputError(f"{where}: '{unit}' is a position; say the low-pass of its speed: differentiate: HZ")
    if channel == "hook_load":
        return Conversion(scale / GRAVITY, offset, "mass = force / 9.81 m/s^2")
    if rope_radius != rope_radius:
        raise InputError(
            f"{where}: '{unit}' is a speed of the rope; give the crane, whose drum and gear make it the motor's"
        )
    return Conversion(
        scale * gear_ratio / rope_radius, 0.0, f"rope speed * gear {gear_ratio:g} / radius {rope_radius:g} m"
    )


def usual_units(channel: str) -> Sequence[str]:
    """Units that a log without units may mean, the most usual first."""
    return _USUAL.get(channel, ())


_USUAL: dict[str, tuple[str, ...]] = {
    "motor_speed": ("rpm", "rad/s", "rev/s"),
    "drum_speed": ("rpm", "rad/s"),
    "rope_speed": ("m/s",),
    "speed_reference": ("rpm", "rad/s", "rev/s"),
    "pressure_a": ("bar", "Pa", "MPa", "psi", "kPa", "0.1 bar"),  # the last: whole numbers of a controller
    "pressure_b": ("bar", "Pa", "MPa", "psi", "kPa", "0.1 bar"),
    "displacement": ("cm^3/rev", "%", "-", "m^3/rad"),
    "motor_torque": ("N*m", "kN*m"),
    "load_torque": ("N*m", "kN*m"),
    "hook_load": ("t", "kg", "kN"),
    "rope_force": ("kN", "N", "t", "kgf"),
    "mechanical_power": ("kW", "W"),
    "motor_current": ("A",),
    "heave_velocity": ("m/s", "mm/s"),
    "oil_temperature": ("degC", "kelvin"),
    "wire_layer": ("-",),
    "wire_out": ("m", "mm"),
    "shaft_angle": ("rad", "deg", "rev"),
}
