"""Units as people write them in brackets over a column, `motor_speed [rpm]`: read with pint, `rev` being a revolution.

Angle is a dimension of its own here: `Hz` or `cm^3` alone would leave open whether a revolution or a radian is meant.

How people write units, and what pint calls them, is one table for every header of every verb. A spelling is looked up
by the SI unit that its column has, since `C`, `1/min` or `t` mean nothing by themselves. What a spelling leaves open
(`ton`: three masses) is refused with the choices. Pint reads whatever the table does not know.
"""

import re
import unicodedata
from functools import lru_cache
from typing import Any

import numpy as np

from winch_friction.physics.channels import CHANNELS
from winch_friction.physics.errors import InputError

# -- how people write units

# SI unit of the column -> pint's name -> other spellings (compared without case, spaces and dots at the end)
SPELLINGS: dict[str, dict[str, tuple[str, ...]]] = {
    "rad/s": {
        "rpm": (
            "1/min", "min-1", "min^-1", "/min", "u/min", "upm", "umdr/min", "umdrehungen/min", "r/min", "rev/min",
            "r.p.m", "o/min", "omdr/min", "omdr./min", "omdreininger/min", "tr/min", "giri/min", "u/minute", "rot/min",
            "omw/min", "toeren/min", "tpm", "tr/mn", "tours/min", "varv/min", "v/min", "vueltas/min",
            "obr/min", "obr./min", "ot/min", "d/dak", "dev/dak", "об/мин", "ob/min", "rot/min", "opm",
        ),
        "rev/s": ("u/s", "rps", "r/s", "rev/s", "umdr/s", "omdr/s", "o/s", "rev/sec"),
        "rad/s": ("rad/sec", "rad/sek", "rads", "rad s-1", "rad*s^-1"),
        "deg/s": ("°/s", "deg/sec", "grad/s", "grader/s"),
    },
    "Pa": {
        "bar": (
            "barg", "bar g", "bar(g)", "bar_g", "bar-g", "bar ü", "bar ue", "barü", "bar gauge", "bar rel", "bar(rel)",
            "baro", "bar overtrykk", "bars",
        ),
        "bar_absolute": ("bara", "bar a", "bar(a)", "bar_a", "bar-a", "bar abs", "bar(abs)", "bar absolute",
            "bar absolut"),
        "psi": ("psig", "psi g", "psi(g)", "lbf/in2", "lbf/in^2"),
        "psi_absolute": ("psia", "psi a", "psi(a)"),
        "kgf/cm^2": ("kp/cm2", "kp/cm^2", "kgf/cm2", "kg/cm2", "kg/cm^2"),
        "kPa": (), "hPa": (), "mbar": (), "Pa": ("pascal",),
        "MPa": ("mpa", "n/mm2", "n/mm^2"),
    },
    "m^3/rad": {
        "cm^3/rev": (
            "ccm", "ccm/u", "ccm/rev", "ccm/r", "ccm/umdr", "ccm/omdr", "ccm/o", "cc", "cc/rev", "cc/r", "cc/u",
            "cm3/rev",            "cm3/u", "cm3/r", "cm3/umdr", "cm3/o", "cm3/omdr", "cm^3/u",
            "cm^3/r", "cm^3/o", "cm^3/omdr", "cm^3/umdr",
            "cm3/omw", "cc/omw", "cm3/tr", "cc/tr", "cm3/varv", "cm3/vuelta", "cm3/giro", "cc/giro",
            "cm3/obr", "cm3/ot", "cm3/rot", "cc/rot", "cm3/dev", "см3/об", "cm3/ob",
            "ml/rev", "ml/u", "ml/r", "cm3/revolution", "cm3/umdrehung",
        ),
        "l/rev": ("l/u", "l/r", "liter/u", "dm3/rev", "dm^3/rev", "l/omdr"),
        "in^3/rev": ("in3/rev", "cu in/rev", "cuin/rev", "cir", "in^3/r"),
        "m^3/rad": ("m3/rad",), "cm^3/rad": ("cm3/rad", "ccm/rad", "cc/rad"),
        "m^3/rev": ("m3/rev", "m3/u", "m^3/u"),
    },
    "kg": {
        "metric_ton": (
            "t", "te", "to", "tonne", "tonnes", "tonnen", "tonn", "mt", "metric ton", "metric tons", "metric t",
            "metrische tonnen", "tonne(s)", "metric_ton", "metric_tons",
        ),
        "pound": ("lb", "lbs"),
        "gram": ("g",), "kg": ("kgs", "kilo", "kilogramm", "kilogram"),
        "short_ton": ("short ton", "short tons", "us ton", "us tons", "short_ton", "short_tons", "ston",
                      "sh tn", "sh.tn", "shtn", "sh ton", "sht"),
        "long_ton": ("long ton", "long tons", "long_ton", "long_tons", "imperial ton", "uk ton"),
    },
    "N": {
        "N": ("newton",),
        "kgf": ("kp", "kgf", "kilopond", "kg", "kgs"),
        "metric_ton * gravity": ("tf", "t", "te", "tonnef", "to", "mp", "tonne", "tonnes", "tonn", "tonnen"),
        "kN": ("kn",), "decanewton": ("dan",), "meganewton": ("mn",),
        "lbf": ("lbs", "lb"),
    },
    "N*m": {
        "N*m": ("nm", "n_m", "n m", "n.m", "n·m", "newtonmeter"),
        "kN*m": ("knm", "kn m", "kn.m"),
        "mN*m": ("mnm", "mn m", "mn.m"),
        "N*cm": ("ncm",),
        "lbf*ft": ("lb-ft", "lbft", "ft-lb", "ftlb", "lbf-ft", "ft lbf"),
    },
    "degC": {
        "degC": ("°c", "c", "℃", "deg c", "grad c", "grad celsius", "celsius", "°celsius", "gr c", "degree c", "oc",
            "deg. c", "grader c"),
        "degF": ("°f", "f", "fahrenheit", "deg f"),
        "kelvin": ("k", "kelvin"),
    },
    "m/s": {"m/s": ("mps", "m/sec", "m/sek", "ms-1", "m s-1", "m*s^-1", "m·s-1"),
            "m/min": ("m/minute",), "mm/s": ("mm/sec",),
            "knot": ("kn", "kt", "kts", "knop", "knoten")},
    "s": {
        "s": ("sec", "secs", "sek", "sekunden", "sekunder", "seconds", "second", "sekunde"),
        "ms": ("msec", "msek", "millisekunden", "milliseconds", "millisek", "millisekunder"),
        "us": ("µs", "μs", "usec", "microseconds", "mikrosekunden"), "ns": ("nsec", "nanoseconds"),
        "minute": ("min", "minuten", "minutter", "mins"), "hour": ("h", "std", "stunden", "timer", "hrs", "hr"),
        "day": ("d", "tage", "dager", "days"),
    },
    "m": {"m": ("meter", "metre", "meters", "metres", "mtr"), "mm": ("millimeter",), "cm": (), "km": (),
          "foot": ("ft", "feet")},
    "rad": {"deg": ("°", "grad", "grader", "degree", "degrees"), "rev": ("u", "umdr", "omdr", "turns", "revs")},
    "W": {"kW": ("kw",), "metric_horsepower": ("ps", "hk"), "W": ("watt",), "MW": ("megawatt",)},
    "A": {"A": ("amp", "amps", "ampere"), "mA": ("milliampere",)},
    "1": {"percent": ("%", "pct", "prozent", "prosent", "procent"), "dimensionless": ("-", "1", "–", "none", "[-]")},
}  # fmt: skip

# SI unit of the column -> spelling -> what it may mean
AMBIGUOUS: dict[str, dict[str, str]] = {
    "kg": dict.fromkeys(("ton", "tons", "tn"),
        "'t' (metric, 1000 kg), 'short_ton' (US, 907 kg) or 'long_ton' (UK, 1016 kg)"),
    "N": dict.fromkeys(("ton", "tons", "tonf"), "'tf' (metric, 9807 N), 'short_ton * gravity' or 'long_ton * gravity'"),
    "rad/s": dict.fromkeys(("1/s", "s-1", "s^-1", "/s", "hz"), "'rad/s' or 'rev/s'"),
}  # fmt: skip

# a pressure's unit, and from what it counts: the vacuum (second group) or the air around (third)
_COUNTED_FROM = re.compile(
    r"^(.*?\w)[\s_,-]*\(?(?:(a|abs\.?|absolute?)|(g|gauge|rel\.?|relative?|relativ|ü|ue|overtrykk))\)?$"
)
_FROM_VACUUM = ("bar", "psi", "Pa", "hPa", "mbar", "kPa", "MPa")  # of what `_DEFINITIONS` has one from the vacuum

_SUPERSCRIPTS = str.maketrans(
    {"º": "°", "⁻": "-", "²": "^2", "³": "^3", "¹": "1", "·": "*", "⋅": "*", "×": "*", "µ": "u", "μ": "u"}
)


def pint_name(unit: str, si_unit: str, where: str = "") -> str:
    """What pint calls a unit as it is written over a column of `si_unit`; raises `InputError` for an ambiguous one."""
    plain = plain_spelling(unit)
    choices = AMBIGUOUS.get(si_unit, {}).get(plain)
    if choices:
        raise InputError(f"{where or 'unit'}: unit '{unit}' is ambiguous; write {choices}")
    return _listed(plain, si_unit) or _LOOKUP["1"].get(plain) or _cleaned(unit)


def known_spelling(unit: str, si_unit: str) -> bool:
    """Whether the table lists a spelling for columns of this SI unit, be it an ambiguous one."""
    plain = plain_spelling(unit)
    return _listed(plain, si_unit) is not None or plain in AMBIGUOUS.get(si_unit, {})


def _listed(plain: str, si_unit: str) -> str | None:
    """pint's name of a spelling in the table; a pressure's may say behind it from what it counts: `kPa (abs)`."""
    name = _LOOKUP.get(si_unit, {}).get(plain)
    said = _COUNTED_FROM.match(plain) if name is None and si_unit == "Pa" else None
    if said is None:
        return name
    base = _LOOKUP["Pa"].get(said[1])
    if not said[2] or base is None:
        return base
    return f"{base}_absolute" if base in _FROM_VACUUM else None


def plain_spelling(unit: str) -> str:
    """A spelling as the table compares it: no case, no doubled spaces, superscripts as powers."""
    text = unicodedata.normalize("NFC", unit).strip().strip("[]").strip().casefold()
    text = text.replace("min⁻¹", "min-1").translate(_SUPERSCRIPTS)
    text = re.sub(r"\s*/\s*", "/", re.sub(r"\s+", " ", text))
    return text.removesuffix(".")


def _cleaned(unit: str) -> str:
    return unicodedata.normalize("NFC", unit).strip().translate(_SUPERSCRIPTS)


_LOOKUP = {
    si_unit: {plain_spelling(each): name for name, spellings in names.items() for each in (name, *spellings)}
    for si_unit, names in SPELLINGS.items()
}


# -- to SI

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
    "Pa_absolute = 1 * pascal; offset: -101325",
    "hPa_absolute = 100 * pascal; offset: -101325",
    "mbar_absolute = 100 * pascal; offset: -101325",
    "kPa_absolute = 1000 * pascal; offset: -101325",
    "MPa_absolute = 1000000 * pascal; offset: -101325",
)


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
