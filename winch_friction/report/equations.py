"""Equations for a page: MathML from a term's own declaration, with a table that explains every symbol.

Powers of speed are written over a reference speed, as people read them, and what only keeps a derivative finite at
standstill is left out.
"""

import re
from functools import lru_cache
from html import escape

import sympy as sp

from winch_friction.physics.channels import RPM
from winch_friction.physics.friction.symbols import SIGNAL_OF_SYMBOL
from winch_friction.physics.friction.term import Term
from winch_friction.report.tables import for_people, table_html

# how a signal is written where its symbol in the code would not be understood
_WRITTEN = {
    "direction": "sgn(ω)", "speed_magnitude": "|ω|", "speed": "ω", "drum_torque": "T_d", "acceleration": "ω̇",
    "oil_temperature": "ϑ", "shaft_angle": "φ", "wire_layer": "layer", "wire_out": "L", "motor_total": "N",
    "count": "n", "pressure": "Δp", "pressure_sum": "Σp", "displacement": "D", "higher_port": "sgn(p_A - p_B)",
    "role": "role", "max_displacement": "D_max", "density": "ρ", "viscosity": "μ", "gear_ratio": "i",
}  # fmt: skip
_NEGLIGIBLE = 1e-7  # of the largest number in a sum: keeps a derivative finite, means nothing


def term_html(term: Term) -> str:
    """The term's torque as a formula, its memory where it has one, and what each symbol means."""
    expressions = [("T", term.torque)]
    if term.state is not None:
        z = _written(term.state.symbol)
        expressions.append((f"{z}̇", term.state.gain - term.state.decay * term.state.symbol))
    made = [_prepared(expression) for _, expression in expressions]
    formulas = "".join(_formula(name, each) for (name, _), (each, _) in zip(expressions, made, strict=True))
    references = {symbol: value for _, found in made for symbol, value in found.items()}
    return formulas + symbol_table(term, references)


def written(term: Term) -> str:
    """The term's torque in one line of text, with the symbols that people know."""
    expression, references = _prepared(term.torque)
    known = ", ".join(f"{symbol} = {value / RPM:.4g} rpm" for symbol, value in references.items())
    return str(expression).replace("**", "^") + (f"   ({known})" if known else "")


def latex_html(law: str) -> str:
    """A law that is given in LaTeX, as MathML; its source where the converter is absent."""
    try:
        from latex2mathml.converter import convert
    except ModuleNotFoundError:
        return f'<div class="formula"><code>{escape(law)}</code></div>'
    return f'<div class="formula">{convert(law, display="block")}</div>'


def symbol_table(term: Term, references: dict[sp.Symbol, float]) -> str:
    """Every symbol of a term: meaning and unit."""
    rows = [("T", "friction torque " + _COUNTED[term.scope.value], "N·m")]
    for symbol in sorted(term.free_symbols & set(SIGNAL_OF_SYMBOL), key=str):
        signal = SIGNAL_OF_SYMBOL[symbol]
        rows.append((_WRITTEN.get(signal.name, signal.name), signal.doc, for_people(signal.unit)))
    if term.opposing:
        rows.append(("sgn(ω)", "direction of motion: the torque opposes it", "–"))
    for symbol, value in references.items():
        rows.append((_plain(symbol.name), f"reference speed, {value / RPM:.4g} rpm", for_people("rad/s")))
    if term.state is not None:
        rows.append((_plain(_written(term.state.symbol)), term.state.doc or "memory of the term", "–"))
    rows += [(_plain(each.name), each.doc, for_people(each.unit)) for each in term.parameters]
    return table_html(("symbol", "meaning", "unit"), list(dict.fromkeys(rows)))


_COUNTED = {
    "motor": "of each motor", "system": "at each motor's shaft", "shaft": "at the common shaft",
}  # fmt: skip


def _prepared(expression: sp.Expr) -> tuple[sp.Expr, dict[sp.Symbol, float]]:
    """The expression with the symbols that people know, and the reference speeds that were taken out of it."""
    tidy = expression.replace(lambda e: e.is_Add, _without_tiny)
    found: dict[sp.Symbol, float] = {}
    speeds = [s for s, signal in SIGNAL_OF_SYMBOL.items() if signal.name in ("speed", "speed_magnitude")]

    def over_reference(product: sp.Expr) -> sp.Expr:
        factor, rest = product.as_coeff_Mul()
        if not (factor.is_Float and rest in speeds and 0.0 < float(factor) < 1.0):
            return product
        symbol = sp.Symbol("ω_0", real=True)
        found[symbol] = 1.0 / float(factor)
        return sp.Mul(rest, sp.Pow(symbol, -1), evaluate=False)

    tidy = tidy.replace(lambda e: e.is_Mul, over_reference)
    names = {s: sp.Symbol(_written(s), real=True) for s in tidy.free_symbols}
    tidy = tidy.replace(sp.exp, sp.Function("exp"))  # set as exp(...), not as a fraction over a power of e
    return tidy.xreplace(names), found


def _without_tiny(total: sp.Expr) -> sp.Expr:
    numbers = [a for a in total.args if a.is_Float]
    scale = max((abs(float(a.as_coeff_Mul()[0])) for a in total.args if not a.is_Float), default=1.0)
    small = [a for a in numbers if abs(float(a)) < max(_NEGLIGIBLE, 1e-5 * scale)]
    return sp.Add(*(a for a in total.args if a not in small))


def _written(symbol: sp.Basic) -> str:
    signal = SIGNAL_OF_SYMBOL.get(symbol)  # type: ignore[call-overload]
    return _WRITTEN.get(signal.name, signal.name) if signal else str(symbol)


def _formula(name: str, expression: sp.Expr) -> str:
    return f'<div class="formula">{mathml(expression, name)}</div>'


def mathml(expression: sp.Expr, name: str = "") -> str:
    """An expression as MathML that today's browsers set themselves; numbers with four significant digits."""
    rounded = expression.xreplace({f: sp.Float(f"{float(f):.4g}", 4) for f in expression.atoms(sp.Float)})
    body = _fenced(_print(rounded))
    left = f"<mrow>{_print(sp.Symbol(name))}<mo>=</mo></mrow>" if name else ""
    label = escape(f"{name} = {rounded}" if name else str(rounded), quote=True)
    space = "http://www.w3.org/1998/Math/MathML"
    return f'<math xmlns="{space}" display="block" aria-label="{label}"><mrow>{left}{body}</mrow></math>'


@lru_cache(maxsize=512)
def _print(expression: sp.Basic) -> str:
    from sympy.printing.mathml import mathml as printed

    return str(printed(expression, printer="presentation"))


def _fenced(text: str) -> str:
    """`mfenced`, which browsers no longer draw, as a row with brackets."""
    text = re.sub(r"<mfenced[^>]*>", "<mrow><mo>(</mo>", text)
    return text.replace("</mfenced>", "<mo>)</mo></mrow>").replace("&InvisibleTimes;", "&#x2062;")


def _plain(name: str) -> str:
    return name.replace("\\", "")
