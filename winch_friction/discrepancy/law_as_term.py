"""A proposed law as a declared term, as the text of a file of terms, and in words."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from winch_friction.discrepancy.engine.grammar import Factor, Law
from winch_friction.discrepancy.vocabulary import BY_NAME, CONSTANT_UNITS, POWERS, TEXTS
from winch_friction.physics.channels import BAR, CM3_PER_REV, RPM, quotient_unit
from winch_friction.physics.friction import Parameter, Scope, State, Term, symbols

SOURCE = "proposed by winch-friction gap: it fits, what it is the data do not say"
WORDS_OF = {
    "linear": "in proportion to {s}", "root": "with the root of {s}", "square": "with the square of {s}",
    "about": "linearly with {s}, none at {c}", "step": "as soon as {s} exceeds {c}", "above": "with {s} above {c}",
    "below": "with {s} below {c}", "hump": "around {c} of {s}", "fade": "fading with {s} by {c}",
    "grow": "rising with {s} by {c}",
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
        return TEXTS["grow"].format(z=z) if factor.kind == "grow" else z, rows, state
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
