"""The words of a proposed law, and the law as a declared term, as the text of a file of terms, and in words.

The words are signals that an equation may read, and the functions of one signal that it may hold. Each function stands
once as text (for the file of terms and, evaluated by SymPy, for the term itself) and once over arrays (for the
search).
"""

import hashlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.grammar import Factor, Law
from winch_friction.discrepancy.preparation.grid import lagged
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.seen import GroupSignals
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM, quotient_unit
from winch_friction.physics.friction import Parameter, Scope, State, Term, symbols

QUANTILES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
LAGS = (3.0, 10.0, 30.0, 90.0)  # s
FADES = (15.0, 45.0, 140.0)  # s
SEEN = 2.0  # times, what is to be called periodic: a period of all the wire that came and went is any curve over it
PERIODS = tuple(float(x) for x in np.geomspace(0.6, 60.0, 41))  # m of wire, from a groove to a layer
SECTORS, WIDTHS = 12, (0.15, 0.3, 0.5)  # of a turn


@dataclass(frozen=True)
class Word:
    """A signal: its symbol in equations, its unit, and how to read it from a run or a motor group."""

    name: str
    symbol: str
    unit: str
    reads: str  # the run column
    of_run: Callable[[PreparedRun], FloatArray] | None = None
    of_group: Callable[[GroupSignals], FloatArray] | None = None
    needs: str = ""  # column that the runs must have
    whole: bool = False  # a count: its constants are whole numbers, and no fit moves them
    kinds: tuple[str, ...] = ("linear", "root", "square", "about", "step", "above", "below")


PICKING = ("about", "step", "above", "below")  # of a signal that a run has one value of, these pick some of the runs
UNLIKE_A_CURVE = ("lag", "hump", "wave", "sector")  # what no monotone function of a signal's present value draws
RISING, FALLING = ("linear", "root", "square", "about", "step", "above"), ("below", "fade")  # with the signal
_SHAPES = ("linear", "root", "square", "about", "step", "above", "below", "hump", "fade", "lag")
WORDS = (
    Word("motor_speed", "w", "rad/s", "motor_speed", lambda r: np.abs(r.speed), kinds=_SHAPES),
    Word("drum_torque", "T_d", "N*m", "hook_load", lambda r: r.drum_torque, kinds=("linear", "root", "square", "lag")),
    Word("acceleration", "sp.Abs(acceleration)", "rad/s^2", "acceleration", lambda r: np.abs(r.acceleration),
         kinds=("linear", "root", "square", "lag")),
    Word("oil_temperature", "oil_temperature", "degC", "oil_temperature", lambda r: r.channels["oil_temperature"],
         needs="oil_temperature", kinds=("about", "step", "above", "below")),
    Word("wire_out", "wire_out", "m", "wire_out", lambda r: r.channels["wire_out"], needs="wire_out",
         kinds=("linear", "root", "square", "about", "step", "above", "below", "wave")),
    Word("wire_layer", "wire_layer", "1", "wire_layer", lambda r: r.channels["wire_layer"], needs="wire_layer",
         whole=True, kinds=("linear", "about")),
    Word("run_time", "run_time", "s", "time", lambda r: r.time, kinds=("fade",)),
    Word("drum_angle", "(shaft_angle / gear_ratio)", "rad", "shaft_angle", lambda r: r.angle / r.gear_ratio,
         kinds=("sector",)),
    Word("displacement", "D", "m^3/rad", "displacement", of_group=lambda g: g.displacement,
         kinds=("linear", "square", "about", "step", "above", "below")),
    Word("pressure", "p", "Pa", "pressure", of_group=lambda g: np.abs(g.pressure),
         kinds=("linear", "root", "square", "above", "step", "lag")),
)  # fmt: skip
BY_NAME = {word.name: word for word in WORDS}

# text of each function: {x} the signal, {c}, {h} its constants; a state equation where it has memory
TEXTS: Mapping[str, str] = {
    "linear": "{x}",
    "root": "sp.sqrt({x})",
    "square": "({x})**2",
    "about": "({x} - {c})",
    "step": "sp.Piecewise((0.0, {x} <= {c}), (1.0, True))",
    "above": "sp.Piecewise((0.0, {x} <= {c}), ({x} - {c}, True))",
    "below": "sp.Piecewise(({c} - {x}, {x} <= {c}), (0.0, True))",
    "hump": "sp.exp(-((({x} - {c}) / {h})**2) / 2)",
    "fade": "sp.exp(-{x} / {c})",
    "lag": "{z}",
    "wave": "(1 + sp.sin(2 * sp.pi * ({x} - {h}) / {c})) / 2",
    "sector": "sp.Piecewise((1.0, sp.Mod({x} / (2 * sp.pi) - {c}, 1) < {h}), (0.0, True))",
}
# powers of the signal's unit that a function has; none: it is a pure number
POWERS = {"linear": 1.0, "root": 0.5, "square": 2.0, "about": 1.0, "above": 1.0, "below": 1.0, "lag": 1.0}
CONSTANT_UNITS = {"lag": {"c": "s"}, "sector": {"c": "1", "h": "1"}}


def shape(kind: str, x: FloatArray, constants: Mapping[str, float], dt: float) -> FloatArray:
    """A function over the samples of one run."""
    c, h = constants.get("c", 0.0), constants.get("h", 1.0)
    if kind == "lag":
        return lagged(x, dt, c)
    made: dict[str, Callable[[], FloatArray]] = {
        "linear": lambda: x,
        "root": lambda: np.sqrt(np.maximum(x, 0.0)),
        "square": lambda: x**2,
        "about": lambda: x - c,
        "step": lambda: (x > c).astype(float),
        "above": lambda: np.maximum(x - c, 0.0),
        "below": lambda: np.maximum(c - x, 0.0),
        "hump": lambda: np.exp(-(((x - c) / h) ** 2) / 2),
        "fade": lambda: np.exp(-x / c),
        "wave": lambda: (1.0 + np.sin(2 * np.pi * (x - h) / c)) / 2,
        "sector": lambda: (np.mod(x / (2 * np.pi) - c, 1.0) < h).astype(float),
    }
    return made[kind]()


def factors(word: Word, covered: FloatArray) -> Iterator[Factor]:
    """Every function of a signal that the data could tell, its constants on a grid over what was covered."""
    span = float(np.ptp(covered)) if len(covered) else 0.0
    if span <= 1e-6 * float(np.abs(covered).max(initial=1e-12)):
        return
    quantiles = (float(f"{q:.3g}") for q in np.quantile(covered, QUANTILES))
    knots = _counts(covered) if word.whole else list(dict.fromkeys(quantiles))
    for kind in word.kinds:
        for constants in _constants(kind, word, knots, span):
            if 0.0 in constants.values():  # a constant of no size has no scale to be fitted on
                continue
            yield Factor(kind, word.name, tuple(constants.items()))


def _counts(covered: FloatArray) -> list[float]:
    """The whole numbers that were seen, and 1, where counting begins."""
    return sorted({1.0, *np.unique(np.round(covered)).tolist()})


def _constants(kind: str, word: Word, knots: Sequence[float], span: float) -> list[dict[str, float]]:
    if kind in ("linear", "root", "square"):
        return [{}]
    if kind == "about" and not word.whole:
        return [{"c": c} for c in dict.fromkeys((knots[0], knots[len(knots) // 2], knots[-1]))]
    if kind == "hump":
        return [{"c": c, "h": width * span} for c in knots for width in (0.05, 0.12)]
    if kind == "fade":
        return [{"c": c} for c in (FADES if word.unit == "s" else (0.1 * span, 0.3 * span))]
    if kind == "lag":
        return [{"c": c} for c in LAGS]
    if kind == "wave":
        periods = [p for p in PERIODS if SEEN * p <= span]
        return [{"c": p, "h": share * p} for p in periods for share in (0.125, 0.375, 0.625, 0.875)]
    if kind == "sector":
        return [{"c": (k + 0.5) / SECTORS, "h": width} for k in range(SECTORS) for width in WIDTHS]
    return [{"c": c} for c in knots]


# -- a law as a term
SOURCE = "proposed by winch-friction gap: it fits, what it is the data do not say"
WORDS_OF = {
    "linear": "in proportion to {s}", "root": "with the root of {s}", "square": "with the square of {s}",
    "about": "linearly with {s}, none at {c}", "step": "as soon as {s} exceeds {c}", "above": "with {s} above {c}",
    "below": "with {s} below {c}", "hump": "around a {s} of {c}", "fade": "fading with {s} by {c}",
    "lag": "with the {s} of the last {c} s", "wave": "periodically in {s}, every {c}",
    "sector": "within a sector of {s}",
}  # fmt: skip


@dataclass(frozen=True)
class ProposedTerm:
    """The term with its file's text, its shape constants by parameter name, and a sentence without the amount."""

    term: Term
    text: str
    constants: Mapping[str, float]
    reads: tuple[str, ...]
    sentence: str


_READ_AS = {"Pa": ("bar", 1.0 / BAR), "m^3/rad": ("cm^3/rev", 1.0 / CM3_PER_REV), "rad/s": ("rpm", 1.0 / RPM)}
_Row = tuple[str, str, str, float, bool, str]  # short name, name, unit, value, shape, doc


def declare(law: Law, amount: float) -> ProposedTerm:
    """Declare a law of the grammar; `amount` sets its typical size."""
    grouped = any(BY_NAME[factor.signal].of_group for factor in law.factors)
    mark = hashlib.sha1(repr((law, float(f"{amount:.3g}"))).encode()).hexdigest()[:4]
    stem = "_".join(BY_NAME[s].name for s in law.signals)
    name = f"proposal_{stem}_{mark}"
    unit = quotient_unit("N*m", *((BY_NAME[f.signal].unit, POWERS[f.kind]) for f in law.factors if f.kind in POWERS))
    rows: list[_Row] = [("k", f"k_{stem}_{mark}", unit, amount, False, "amount")]
    parts, state = ["k.symbol"], None
    for number, factor in enumerate(law.factors, start=1):
        text, own, memory = _factor(factor, number, f"{stem}_{mark}")
        parts.append(text)
        rows += own
        state = memory or state
    equation = " * ".join(parts) + (" / n" if grouped and not law.each else "")
    declarations = [(row[0], _parameter_text(*row[1:])) for row in rows]
    scope = "MOTOR" if grouped else "SHAFT"
    namespace: dict[str, Any] = {"sp": sp, "Parameter": Parameter, "State": State, **_symbols()}
    for short, text in declarations:
        namespace[short] = eval(text, namespace)
    made_state = eval(state, namespace) if state else None
    parameters = tuple(namespace[short] for short, _ in declarations)
    term = Term(
        name, sp.sympify(eval(equation, namespace)), parameters, Scope[scope], SOURCE, "proposed", law.opposing,
        made_state,
    )  # fmt: skip
    text = _file_text(name, declarations, equation, scope, law.opposing, state)
    constants = {row[1]: float(row[3]) for row in rows[1:]}
    reads = tuple(BY_NAME[s].reads for s in law.signals)
    return ProposedTerm(term, text, constants, reads, _sentence(law))


def _factor(factor: Factor, number: int, suffix: str) -> tuple[str, list[_Row], str | None]:
    """Text, parameter rows and state text of one factor."""
    word = BY_NAME[factor.signal]
    symbol = word.symbol
    units = CONSTANT_UNITS.get(factor.kind, {})
    rows: list[_Row] = []
    names: dict[str, str] = {}
    state: str | None
    for key, value in factor.constants:
        if word.whole:
            names[key] = f"{value:.0f}"
            continue
        short = f"{key}{number}"
        rows.append((short, f"{short}_{suffix}", units.get(key, word.unit), value, True, f"{key} of {factor.kind}"))
        names[key] = f"{short}.symbol"
    z = f'sp.Symbol("z_{suffix}", real=True)'
    if factor.signal == "run_time":  # a run's own time is a memory that fades from its start
        state = f"State({z}, gain=sp.Integer(0), decay=1 / {names['c']}, initial=1.0, doc='time since the start')"
        return z, rows, state
    state = None
    if factor.kind == "lag":
        state = f"State({z}, gain={symbol} / {names['c']}, decay=1 / {names['c']}, doc='{word.name} of the last while')"
    return TEXTS[factor.kind].format(x=symbol, z=z, c=names.get("c", ""), h=names.get("h", "")), rows, state


def _parameter_text(name: str, unit: str, value: float, shape: bool, doc: str) -> str:
    reach = 20.0 * max(abs(value), 1e-30)
    lower = -reach if not shape or value <= 0.0 else 0.0
    more = ", shape=True" if shape else ""
    return f'Parameter("{name}", "{unit}", {value!r}, lower={lower!r}, upper={reach!r}{more}, doc="{doc}")'


def _symbols() -> dict[str, Any]:
    names = ("D", "T_d", "acceleration", "gear_ratio", "n", "oil_temperature", "p", "shaft_angle", "w", "wire_layer",
             "wire_out")  # fmt: skip
    return {name: getattr(symbols, name) for name in names}


def _file_text(
    name: str, declarations: list[tuple[str, str]], equation: str, scope: str, opposing: bool, state: str | None
) -> str:
    used = [s for s in _symbols() if any(_mentions(text, s) for text in (equation, state or ""))]
    imports = f"from winch_friction.physics.friction.symbols import {', '.join(used)}\n" if used else ""
    lines = "\n".join(f"{short} = {text}" for short, text in declarations)
    more = ("" if opposing else ", opposing=False") + (f",\n        state={state}" if state else "")
    return (
        f'"""{SOURCE[0].upper()}{SOURCE[1:]}."""\n\nimport sympy as sp  # noqa: F401\n\n'
        "from winch_friction.physics.friction import Parameter, Scope, State, Term, register  # noqa: F401\n"
        f"{imports}\n{lines}\n"
        f'register(\n    Term(\n        "{name}", {equation},\n        ({", ".join(s for s, _ in declarations)},), '
        f'Scope.{scope}, "{SOURCE}", "proposed"{more},\n    )\n)\n'
    )


def _mentions(text: str, symbol: str) -> bool:
    return re.search(rf"(?<![\w.\"]){symbol}(?![\w\"])", text) is not None


def in_words(law: Law, values: Sequence[float]) -> str:
    """The law's sentence with its constants, in their order, as the last fit has them."""
    rest = iter(values)
    factors = tuple(
        f if BY_NAME[f.signal].whole else replace(f, constants=tuple((key, next(rest)) for key, _ in f.constants))
        for f in law.factors
    )
    return _sentence(replace(law, factors=factors))


def _sentence(law: Law) -> str:
    acts = "friction that opposes motion" if law.opposing else "a torque that acts one way whatever the motion"
    how = " and ".join(_in_words(factor) for factor in law.factors)
    return f"{acts} and acts {how}"


def amount_in_words(value: float, unit: str) -> str:
    """A value in SI with the unit in which people read it; of a product the pressure in it is read in bar."""
    if unit in _READ_AS:
        unit, factor = _READ_AS[unit]
        value *= factor
    for sign, power in re.findall(r"([*/])Pa\b(?:\^([\d.]+))?", unit):
        value *= BAR ** (float(power or 1.0) * (1.0 if sign == "/" else -1.0))
    unit = re.sub(r"([*/])Pa\b", r"\1bar", unit)
    shown = f"{float(f'{value:.3g}'):.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.3g}"
    return shown + ("" if unit == "1" else f" {unit}")


def _in_words(factor: Factor) -> str:
    word, constants = BY_NAME[factor.signal], dict(factor.constants)
    unit = "1" if factor.kind == "lag" else word.unit
    c = amount_in_words(constants["c"], unit) if "c" in constants else ""
    return WORDS_OF[factor.kind].format(s=word.name.replace("_", " "), c=c)
