"""Tabulated terms: a curve or surface over one or two signals that stands in the model file, not in the code.

The curve is piecewise linear between its knots and constant beyond them, written with one ramp per interval: 0 below
it, 1 above. Its parameters are the rises over the intervals, so that bounds of one sign make it monotone, every fit is
linear in them, and it is a term like any other.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import sympy as sp

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import symbols
from winch_friction.physics.friction.term import Parameter, Scope, Term
from winch_friction.physics.signals import FloatArray

MOST_SIGNALS = 2
SHAPES = ("free", "rising", "falling", "convex_rising", "windows")
ANCHORS = ("none", "low", "high")
SIDES = {"both": 0, "hoisting": 1, "lowering": -1}
# what a curve may be over, and what may multiply it: symbol or expression, and unit
FACTORS: dict[str, tuple[sp.Expr, str]] = {
    # which port is the higher is a step that only a pressure beside it takes away
    **{
        each.name: (each.symbol, each.unit)
        for each in (*symbols.WINCH_SIGNALS, *symbols.GROUP_SIGNALS)
        if each.name not in ("higher_port", "role")
    },
    "displacement_left": (symbols.X - symbols.D, "m^3/rad"),  # up to the largest
    "flow": (symbols.n * symbols.D * symbols.w, "m^3/s"),  # that a group of motors takes, of no leaks
}


@dataclass(frozen=True)
class Table:
    """What a tabulated term is, apart from its values.

    `knots` by signal, one of `FACTORS`, SI, rising; `times` names those whose product multiplies the curve. `shape`
    says whether it may only rise or fall with every signal, or rise ever more steeply, on beyond the last knot.
    `anchor`: where it is zero ('low' the first knot, 'high' the last), 'none': its level there is a parameter of its
    own. `unit` of the curve's values; times `times` they must be N m. Over two signals `shape` and `anchor` may be two
    words, one per signal; a surface of monotone shapes is never negative. `side`: whether it counts one way alone.
    `windows`: one level from each odd knot to the next, nothing elsewhere; with `weights`, one per window and none
    below 0, so many times that level.
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
    side: str = "both"
    weights: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if problems := self._problems():
            raise InputError(f"table '{self.name}': {'; '.join(problems)}")

    def _problems(self) -> list[str]:
        found = [f"signal '{n}' is not known" for n in self.signals if n not in FACTORS]
        found += [f"factor '{n}' is not known" for n in self.times if n not in FACTORS]
        if not 1 <= len(self.knots) <= MOST_SIGNALS or len(set(self.signals)) != len(self.signals):
            found.append(f"it needs one or {MOST_SIGNALS} different signals")
        for name, at in self.knots:
            if len(at) < 2 or any(b <= a for a, b in itertools.pairwise(at)):
                found.append(f"the knots over {name} must be at least two and rising")
        for kind, text, known in (("shape", self.shape, SHAPES), ("anchor", self.anchor, ANCHORS)):
            words = text.split()
            found += [f"{kind} '{word}' is none of {', '.join(known)}" for word in words if word not in known]
            if len(words) not in (1, len(self.knots)):
                found.append(f"{kind} '{text}' must be one word, or one for each of {', '.join(self.signals)}")
        if "windows" in self.shape.split() and (len(self.knots) != 1 or len(self.knots[0][1]) % 2):
            found.append("windows are over one signal, and have a knot at either end")
        if self.weights and (self.shape != "windows" or len(self.weights) != len(self.knots[0][1]) // 2):
            found.append("weights are one for each of the windows")
        if any(not 0.0 <= weight < float("inf") for weight in self.weights):
            found.append("weights must be 0 or more")
        found += [f"side '{self.side}' is none of {', '.join(SIDES)}"] if self.side not in SIDES else []
        return found

    @property
    def axes(self) -> "tuple[_Axis, ...]":
        """Signal, knots, shape and anchor of each axis."""
        count = len(self.knots)
        shapes, anchors = (words * count if len(words) == 1 else words for words in _words(self.shape, self.anchor))
        return tuple(
            _Axis(name, at, shape, anchor, count > 1)
            for (name, at), shape, anchor in zip(self.knots, shapes, anchors, strict=True)
        )

    @property
    def in_times(self) -> bool:
        """Whether it says what was there for a time: windows over the date."""
        return self.shape == "windows" and self.signals == ("time",)

    @property
    def latex(self) -> str:
        """Of windows their law with m, so many times the level, and what m is in words; '' of what bends."""
        if self.shape != "windows":
            return ""
        signal, unit = FACTORS[self.signals[0]]
        many = sp.Function("m")(signal)
        told = [f"{w:.4g} {_between(a, b, unit)}" for w, a, b in _each_window(self) if w > 0.0]
        law = _term(self, _level(self).symbol * many, [_level(self)], "")
        words = ", ".join([*told, "0 elsewhere"])
        return rf"{replace(law, table=None).latex},\quad {sp.latex(many)} = \text{{{words}}}"

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the signals that it is a table over."""
        return tuple(name for name, _ in self.knots)


@dataclass(frozen=True)
class _Axis:
    """One signal of a table; `of_surface` where there is another."""

    signal: str
    knots: tuple[float, ...]  # their symbols in an outline
    shape: str
    anchor: str
    of_surface: bool

    @property
    def level(self) -> bool:
        """Whether it is not zero at either end."""
        return self.anchor == "none"

    @property
    def to_come(self) -> bool:
        """Whether it is written with what of each fall is still to come, so that falling means positive."""
        return self.anchor == "high" or (self.of_surface and self.shape == "falling")

    @property
    def sign(self) -> int:
        """Of the rises over its intervals; 0: either."""
        if self.shape == "free":
            return 0
        return -1 if (self.shape == "falling") != self.to_come else 1


def _words(*texts: str) -> list[list[str]]:
    return [text.split() for text in texts]


def tabulated(table: Table) -> Term:
    """The term of a table; one parameter per interval (or pair of intervals), named `<table>_<k>[_<l>]`."""
    return _declared(table, table.axes)


def outlined(table: Table) -> tuple[Term, dict[str, float]]:
    """The term with its knots as shape parameters, and their values: one for all tables that differ in these alone.

    What is compiled of it serves every curve that data draw, wherever they bend it.
    """
    knots = tuple((name, tuple(float(k) for k in range(len(at)))) for name, at in table.knots)
    form = replace(table, knots=knots, typical=1.0, source="", place="")
    values = itertools.chain.from_iterable(at for _, at in table.knots)
    return _outline(form), dict(zip((p.name for p in _knots(form)), values, strict=True))


@lru_cache(maxsize=256)
def _outline(form: Table) -> Term:
    own = _knots(form)
    symbol = iter(parameter.symbol for parameter in own)
    axes = tuple(replace(axis, knots=tuple(next(symbol) for _ in axis.knots)) for axis in form.axes)
    return replace(_declared(form, axes, own), table=None)


def _knots(form: Table) -> list[Parameter]:
    """The knots of a table as parameters, axis by axis."""
    return [
        Parameter(f"{form.name}_at_{name}_{k}", FACTORS[name][1], 0.0, lower=float("-inf"), shape=True)
        for name, at in form.knots
        for k in range(len(at))
    ]


def _declared(table: Table, axes: Sequence[_Axis], shapes: Sequence[Parameter] = ()) -> Term:
    if table.shape == "windows":
        return _in_windows(table, axes[0], shapes)
    bases = [_basis(axis) for axis in axes]
    parameters, equation = [], sp.Integer(0)
    for index in itertools.product(*(range(len(basis)) for basis in bases)):
        if any(k == 0 and not axis.level for k, axis in zip(index, axes, strict=True)):
            continue
        parameter = _parameter(table, index)
        parameters.append(parameter)
        equation += parameter.symbol * sp.Mul(*(basis[k] for basis, k in zip(bases, index, strict=True)))
    return _term(
        table, equation, [*parameters, *shapes], f"piecewise linear over {' and '.join(table.signals)}, {table.shape}"
    )


def _term(table: Table, equation: sp.Expr, parameters: list[Parameter], doc: str) -> Term:
    factor = sp.Mul(*(FACTORS[name][0] for name in table.times))
    way = SIDES[table.side]
    side = (1 + way * symbols.s) / 2 if way else sp.Integer(1)
    return Term(
        table.name, equation * factor * side, tuple(parameters), table.scope, table.source, table.place, table.opposing,
        doc=doc, table=table,
    )  # fmt: skip


def _in_windows(table: Table, axis: _Axis, shapes: Sequence[Parameter]) -> Term:
    """One level, there or not: a step up at every odd knot and down at the next."""
    name, knots = axis.signal, axis.knots
    signal = FACTORS[name][0]
    steps = [sp.Piecewise((0.0, signal <= at), (1.0, True)) for at in knots]
    weights = _weights(table)
    inside = sp.Add(*(weights[k // 2] * (step if k % 2 == 0 else -step) for k, step in enumerate(steps)))
    level = _level(table)
    return _term(table, level.symbol * inside, [level, *shapes], f"in {len(knots) // 2} windows of {name}")


def _level(table: Table) -> Parameter:
    doc = f"level in windows of {table.signals[0]}"
    return Parameter(f"{table.name}_0", table.unit, abs(table.typical), lower=0.0, doc=doc)


def _each_window(table: Table) -> Iterator[tuple[float, float, float]]:
    """Weight, begin and end of every window."""
    knots = table.knots[0][1]
    return zip(_weights(table), knots[::2], knots[1::2], strict=True)


def _between(begin: float, end: float, unit: str) -> str:
    unit = unit.replace("^", r"\^{}")  # within a text
    if end == float("inf"):
        return f"after {begin:.12g} {unit}"
    return f"up to {end:.12g} {unit}" if begin == float("-inf") else f"from {begin:.12g} to {end:.12g} {unit}"


def _weights(table: Table) -> tuple[float, ...]:
    return table.weights or (1.0,) * (len(table.knots[0][1]) // 2)


def in_windows(table: Table, level: float, at: float) -> float:
    """What a table of windows is at one value of its signal, in the unit of its `level`: 0 outside of them."""
    return level * next((w for w, a, b in _each_window(table) if a < at <= b), 0.0)


def at_knots(table: Table) -> FloatArray:
    """What makes of the parameters of a curve over one signal its values at its knots, shape (knots, parameters)."""
    axis, signal = table.axes[0], sp.Symbol("x", real=True)
    basis = _basis(axis, signal)[0 if axis.level else 1 :]
    return np.array([[float(each.subs(signal, knot)) for each in basis] for knot in axis.knots])


def _basis(axis: _Axis, signal: sp.Expr | None = None) -> list[sp.Expr]:
    """1 and one ramp per interval; anchored at the high end, what of each ramp is still to come."""
    signal, knots = FACTORS[axis.signal][0] if signal is None else signal, axis.knots
    if axis.shape == "convex_rising":
        top = knots[-1]
        hinges = [sp.Piecewise((0.0, signal <= a), ((signal - a) / (top - a), True)) for a in knots[:-1]]
        return [sp.Integer(1), *hinges]
    ramps = [_ramp(signal, a, b) for a, b in itertools.pairwise(knots)]
    return [sp.Integer(1), *((1 - ramp for ramp in ramps) if axis.to_come else ramps)]


def _ramp(signal: sp.Expr, a: float, b: float) -> sp.Expr:
    return sp.Piecewise((0.0, signal <= a), ((signal - a) / (b - a), signal < b), (1.0, True))


def _parameter(table: Table, index: tuple[int, ...]) -> Parameter:
    name = "_".join([table.name, *map(str, index)])
    signs = {axis.sign for axis, k in zip(table.axes, index, strict=True) if k or axis.of_surface}
    if not any(index) and signs != {1}:
        return Parameter(name, table.unit, table.typical, lower=float("-inf"), doc="level at the first knots")
    sign = signs.pop() if len(signs) == 1 else 0
    lower, upper = (0.0 if sign > 0 else float("-inf")), (0.0 if sign < 0 else float("inf"))
    between = ", ".join(
        f"{axis.signal} {axis.knots[k - 1]:g} ... {axis.knots[k]:g}"
        for axis, k in zip(table.axes, index, strict=True) if k
    )  # fmt: skip
    return Parameter(
        name, table.unit, (sign or 1) * abs(table.typical), lower=lower, upper=upper,
        doc=f"rise over {between}" if between else "level at the last knots",
    )  # fmt: skip
