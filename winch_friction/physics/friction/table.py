"""Tabulated terms: a curve or surface over one or two signals that stands in the model file, not in the code.

The curve is piecewise linear between its knots and constant beyond them, written with one ramp per interval: 0 below
it, 1 above. Its parameters are the rises over the intervals, so that bounds of one sign make it monotone, every fit is
linear in them, and it is a term like any other.
"""

import itertools
from dataclasses import dataclass

import sympy as sp

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import symbols
from winch_friction.physics.friction.term import Parameter, Scope, Term

MOST_SIGNALS = 2
SHAPES = ("free", "rising", "falling", "convex_rising")
ANCHORS = ("none", "low", "high")
_SIGNALS = {each.name: each for each in (*symbols.WINCH_SIGNALS, *symbols.GROUP_SIGNALS)}


@dataclass(frozen=True)
class Table:
    """What a tabulated term is, apart from its values.

    `knots` by signal, SI, rising; `times` names signals whose product multiplies the curve. `shape` says whether it may
    only rise or fall with every signal, or rise ever more steeply, on beyond the last knot. `anchor`: where it is zero
    ('low' the first knot, 'high' the last), 'none': its level there is a parameter of its own. `unit` of the curve's
    values; times `times` they must be N m.
    """

    name: str
    knots: tuple[tuple[str, tuple[float, ...]], ...]
    unit: str = "N*m"
    times: tuple[str, ...] = ()
    scope: Scope = Scope.SHAFT
    opposing: bool = True
    shape: str = "free"
    anchor: str = "none"
    typical: float = 1.0
    place: str = "gear and drum"
    source: str = "tabulated"

    def __post_init__(self) -> None:
        if problems := self._problems():
            raise InputError(f"table '{self.name}': {'; '.join(problems)}")

    def _problems(self) -> list[str]:
        found = [f"signal '{n}' is not known" for n in (*self.signals, *self.times) if n not in _SIGNALS]
        if not 1 <= len(self.knots) <= MOST_SIGNALS or len(set(self.signals)) != len(self.signals):
            found.append(f"it needs one or {MOST_SIGNALS} different signals")
        for name, at in self.knots:
            if len(at) < 2 or any(b <= a for a, b in itertools.pairwise(at)):
                found.append(f"the knots over {name} must be at least two and rising")
        found += [f"shape '{self.shape}' is none of {', '.join(SHAPES)}"] if self.shape not in SHAPES else []
        found += [f"anchor '{self.anchor}' is none of {', '.join(ANCHORS)}"] if self.anchor not in ANCHORS else []
        return found

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the signals that it is a table over."""
        return tuple(name for name, _ in self.knots)


def tabulated(table: Table) -> Term:
    """The term of a table; one parameter per interval (or pair of intervals), named `<table>_<k>[_<l>]`."""
    axes = [_basis(_SIGNALS[name].symbol, at, table) for name, at in table.knots]
    level = table.anchor == "none"
    parameters, equation = [], sp.Integer(0)
    for index in itertools.product(*(range(len(axis)) for axis in axes)):
        if not level and 0 in index:
            continue
        parameter = _parameter(table, index)
        parameters.append(parameter)
        equation += parameter.symbol * sp.Mul(*(axis[k] for axis, k in zip(axes, index, strict=True)))
    factor = sp.Mul(*(_SIGNALS[name].symbol for name in table.times))
    over = " and ".join(table.signals)
    return Term(
        table.name, equation * factor, tuple(parameters), table.scope, table.source, table.place, table.opposing,
        doc=f"piecewise linear over {over}, {table.shape}", table=table,
    )  # fmt: skip


def _basis(signal: sp.Symbol, knots: tuple[float, ...], table: Table) -> list[sp.Expr]:
    """1 and one ramp per interval; anchored at the high end, what of each ramp is still to come."""
    if table.shape == "convex_rising":
        top = knots[-1]
        hinges = [sp.Piecewise((0.0, signal <= a), ((signal - a) / (top - a), True)) for a in knots[:-1]]
        return [sp.Integer(1), *hinges]
    ramps = [_ramp(signal, a, b) for a, b in itertools.pairwise(knots)]
    return [sp.Integer(1), *((1 - ramp for ramp in ramps) if table.anchor == "high" else ramps)]


def _ramp(signal: sp.Symbol, a: float, b: float) -> sp.Expr:
    return sp.Piecewise((0.0, signal <= a), ((signal - a) / (b - a), signal < b), (1.0, True))


def _parameter(table: Table, index: tuple[int, ...]) -> Parameter:
    name = "_".join([table.name, *map(str, index)])
    if not any(index):
        doc = "level at the first knots"
        return Parameter(name, table.unit, table.typical, lower=float("-inf"), doc=doc)
    # what is still to come of a falling curve is positive
    sign = {"free": 0, "rising": 1, "falling": -1, "convex_rising": 1}[table.shape] * (
        -1 if table.anchor == "high" else 1
    )
    lower, upper = (0.0 if sign > 0 else float("-inf")), (0.0 if sign < 0 else float("inf"))
    between = ", ".join(
        f"{signal} {at[k - 1]:g} ... {at[k]:g}" for (signal, at), k in zip(table.knots, index, strict=True) if k
    )
    return Parameter(
        name, table.unit, (sign or 1) * abs(table.typical), lower=lower, upper=upper, doc=f"rise over {between}"
    )
