"""From declared equations to functions of an operating point: scalar, vectorised, numba kernel; each with its Jacobian.

All of them take (x, theta, z): the operating point, in the order of `layout`, the parameters, and the states of the
terms with memory, each in the model's order. Nothing here restates an equation. A state is stepped by
dz/dt = gain - decay z, exactly for signals frozen over a step.
"""

import math
from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp

from winch_friction.physics.friction import symbols
from winch_friction.physics.friction.sources import function_of
from winch_friction.physics.friction.term import Parameter, Scope, Term, unique_parameters


# -- the operating point
def group_symbol(symbol: sp.Symbol, group: int) -> sp.Symbol:
    """The symbol of one group's signal in a model with several groups."""
    return sp.Symbol(f"{symbol.name}_{{{group}}}", real=True)


def layout(group_count: int) -> tuple[sp.Symbol, ...]:
    """Symbols of an operating point with `group_count` motor groups, in order."""
    winch = tuple(signal.symbol for signal in symbols.WINCH_SIGNALS)
    groups = tuple(group_symbol(signal.symbol, g) for g in range(group_count) for signal in symbols.GROUP_SIGNALS)
    return winch + groups


# its signals by name, and those that have a value where nobody gives one
ORDER = tuple(signal.name for signal in symbols.WINCH_SIGNALS)
DEFAULTS: dict[str, Any] = {each.name: each.default for each in symbols.WINCH_SIGNALS if each.default is not None}
# of a motor group's last signals, for whoever does not give them
_GROUP_DEFAULTS = tuple(signal.default for signal in symbols.GROUP_SIGNALS)


def operating_point(
    *,
    direction: Any,
    speed: Any,
    drum_torque: Any,
    groups: Sequence[tuple[Any, ...]] = (),
    motor_total: Any,
    **optional: Any,
) -> tuple[Any, ...]:
    """The operating point as a flat tuple of floats or of arrays; SI.

    `groups` holds per motor group: number of motors, |p_A - p_B|, p_A + p_B, displacement per motor, which port's
    pressure is the higher (left out: port A's) and its role (left out: alone), in short a `group_point`. `optional` are
    signals of the table that have a default: acceleration, oil_temperature, time, ... (`symbols.WINCH_SIGNALS`).
    """
    values = DEFAULTS | optional
    if len(values) > len(DEFAULTS):
        raise TypeError(f"no such signals: {sorted(set(optional) - set(DEFAULTS))}")
    values |= {
        "direction": direction, "speed_magnitude": abs(speed), "speed": speed, "drum_torque": drum_torque,
        "motor_total": motor_total,
    }  # fmt: skip
    return tuple(values[name] for name in ORDER) + tuple(value for group in groups for value in _whole(group))


def _whole(group: tuple[Any, ...]) -> tuple[Any, ...]:
    """A group's signals with the defaults of those at the end that are not given."""
    missing = _GROUP_DEFAULTS[len(group) :]
    if len(group) > len(_GROUP_DEFAULTS) or None in missing:
        raise TypeError(f"a group has {[signal.name for signal in symbols.GROUP_SIGNALS]}, not {len(group)} values")
    return (*group, *missing)


def group_point(
    count: Any, drop: Any, displacement: Any, pressure_sum: Any = None, role: float = 0.0
) -> tuple[Any, ...]:
    """A motor group's part of an operating point: `drop` is p_A - p_B in Pa, a float or an array; without p_A + p_B the
    lower port's pressure is taken for zero. `role` is +1 of a group that drives beside a passive one, -1 of that.

    The higher port is +1 for port A and -1 for port B, so that p_B = (p_A + p_B - higher_port |p_A - p_B|) / 2; it
    steps where the pressures are equal and |p_A - p_B| is zero.
    """
    size = np.abs(drop)
    higher_port = np.where(np.asarray(drop) < 0.0, -1.0, 1.0)
    both = size if pressure_sum is None else pressure_sum
    return count, size, both, displacement, higher_port, np.full_like(size, role, dtype=float)


# -- their functions
class CompiledTerms:
    """The functions of one list of terms, for one number of motor groups and one set of constants.

    `torque` etc. are compiled on first use. Units: torque N m at the motor shaft, against the hoisting direction.
    """

    def __init__(self, terms: tuple[Term, ...], group_count: int, constants: tuple[tuple[str, float], ...]) -> None:
        self.terms = terms
        self.group_count = group_count
        self.constants = dict(constants)
        self.parameters: tuple[Parameter, ...] = unique_parameters(terms)
        self.stateful = tuple(term for term in terms if term.state is not None)

    @cached_property
    def _arguments(self) -> tuple[tuple[sp.Symbol, ...], ...]:
        own = tuple(parameter.symbol for parameter in self.parameters)
        states = [f"z_{{{k},{g}}}" for k, term in enumerate(self.stateful) for g in self._groups(term)]
        return layout(self.group_count), own, tuple(sp.Symbol(name, real=True) for name in states)

    def _groups(self, term: Term) -> range:
        per_group = term.scope is Scope.MOTOR and bool(term.state_symbols)
        return range(self.group_count if per_group else 1)

    @cached_property
    def expressions(self) -> tuple[sp.Expr, ...]:
        """Each term's torque at the shaft, summed over motors, as an expression of x, theta and z."""
        return tuple(self._at_shaft(term, self._constant_values()) for term in self.terms)

    def _at_shaft(self, term: Term, constants: dict[sp.Basic, sp.Basic]) -> sp.Expr:
        torque = term.torque.xreplace(constants)
        if term.scope is Scope.MOTOR:
            return sp.Add(*(self._in_group(term, symbols.n * torque, g) for g in range(self.group_count)))
        return self._in_group(term, symbols.N * torque if term.scope is Scope.SYSTEM else torque, 0)

    def _in_group(self, term: Term, expression: sp.Expr, group: int) -> sp.Expr:
        own = {symbol: group_symbol(symbol, group) for symbol in symbols.GROUP_SYMBOLS}
        return expression.xreplace({**own, **self._state_of(term, group)})

    def _state_of(self, term: Term, group: int) -> dict[sp.Basic, sp.Basic]:
        if term.state is None:
            return {}
        index = self.stateful.index(term)
        return {term.state.symbol: sp.Symbol(f"z_{{{index},{group}}}", real=True)}

    def _constant_values(self) -> dict[sp.Basic, sp.Basic]:
        values = {each.symbol: self.constants.get(each.name, each.default or 0.0) for each in symbols.CONSTANTS}
        return {symbol: sp.Float(value) for symbol, value in values.items()}

    @cached_property
    def total(self) -> sp.Expr:
        """The whole friction torque as one expression."""
        return sp.Add(*self.expressions)

    @cached_property
    def gradient(self) -> list[sp.Expr]:
        """Its partial derivatives by the parameters."""
        return [sp.diff(self.total, parameter.symbol) for parameter in self.parameters]

    @cached_property
    def columns(self) -> list[sp.Expr]:
        """What each parameter that is no shape multiplies, constants as symbols: the torque is linear in these."""
        total = sp.Add(*(self._at_shaft(term, {}) for term in self.terms))
        return [sp.diff(total, parameter.symbol) for parameter in self.parameters if not parameter.shape]

    @cached_property
    def speed_derivative(self) -> sp.Expr:
        """Its partial derivative by speed at frozen direction: d/d omega with w = |omega|, dw/d omega = s."""
        return symbols.s * sp.diff(self.total, symbols.w) + sp.diff(self.total, symbols.omega)

    @cached_property
    def total_and_derivatives(self) -> list[sp.Expr]:
        """The torque, its derivative by speed and those by the parameters."""
        return [self._by_parameter(self.total), self._by_parameter(self.speed_derivative), *self.gradient]

    def _by_parameter(self, expression: sp.Expr) -> sp.Expr:
        """The same, with all that a parameter multiplies in one bracket: that is its derivative, whose sums over the
        motor groups SymPy's common subexpressions then share."""
        brackets, rest = [], expression
        for symbol in (parameter.symbol for parameter in self.parameters):
            slope = sp.diff(rest, symbol)
            if slope != 0 and not slope.has(symbol):
                brackets.append(symbol * slope)
                rest = rest.xreplace({symbol: sp.Integer(0)})
        return sp.Add(*brackets, rest)

    @cached_property
    def _key(self) -> str:
        """Everything that the functions are made of."""
        return repr((*self._forms, sorted(self.constants.items())))

    @cached_property
    def _forms(self) -> tuple[Any, ...]:
        return *map(_declared, self.terms), self.group_count

    def _function(self, part: str, dialect: str) -> Callable[..., Any]:
        key = f"{part} {dialect} {self._key}"
        return function_of(key, dialect, lambda: self._lambdify(part, dialect, self._arguments))

    def _lambdify(self, part: str, dialect: str, arguments: Sequence[tuple[sp.Symbol, ...]]) -> Callable[..., Any]:
        # several values as a tuple: numba would put a list on the heap, three times what the equations cost
        expression = getattr(self, part)
        several = tuple(expression) if isinstance(expression, Sequence) else expression
        return sp.lambdify(arguments, several, modules=[dialect], cse=True)

    @cached_property
    def scalar_torque(self) -> Callable[..., float]:
        """Torque at one operating point of plain floats."""
        return self._function("total", "math")

    @cached_property
    def scalar_torque_and_gradient(self) -> Callable[..., tuple[float, ...]]:
        """(torque, dT/domega, dT/dtheta_0, ...) at one operating point of plain floats."""
        return self._function("total_and_derivatives", "math")

    @cached_property
    def scalar_contributions(self) -> Callable[..., tuple[float, ...]]:
        """Torque of each term at one operating point of plain floats."""
        return self._function("expressions", "math")

    @cached_property
    def vector_torque(self) -> Callable[..., Any]:
        """Torque over arrays."""
        return self._function("total", "numpy")

    @cached_property
    def vector_gradient(self) -> Callable[..., tuple[Any, ...]]:
        """Partial derivatives over arrays (entries that are constant come back as scalars)."""
        return self._function("gradient", "numpy")

    @cached_property
    def vector_columns(self) -> Callable[..., tuple[Any, ...]]:
        """What each parameter that is no shape multiplies, over arrays (constant entries come back as scalars).

        A search asks for those of a hundred laws: made with the constants as arguments they serve every machine.
        """
        free = (*self._arguments, tuple(each.symbol for each in symbols.CONSTANTS))
        values = tuple(map(float, self._constant_values().values()))
        key = f"columns numpy {self._forms!r}"
        made = function_of(key, "numpy", lambda: self._lambdify("columns", "numpy", free))
        return lambda x, theta, z: made(x, theta, z, values)

    @cached_property
    def vector_contributions(self) -> Callable[..., tuple[Any, ...]]:
        """Torque of each term over arrays."""
        return self._function("expressions", "numpy")

    @cached_property
    def kernel(self) -> Callable[..., float]:
        """Torque as a numba function of three tuples of floats (x, theta, z)."""
        import numba

        return numba.njit(self.scalar_torque)

    @cached_property
    def state_equations(self) -> list[sp.Expr]:
        """Gain and decay of every state, in their order."""
        return [
            self._in_group(term, part.xreplace(self._constant_values()), g)
            for term in self.stateful
            if term.state is not None
            for g in self._groups(term)
            for part in (term.state.gain, term.state.decay)
        ]

    @cached_property
    def scalar_state_rates(self) -> Callable[..., tuple[float, ...]]:
        """(gain_0, decay_0, gain_1, ...) of the states at one operating point of plain floats."""
        return self._function("state_equations", "math")

    @cached_property
    def vector_state_rates(self) -> Callable[..., tuple[Any, ...]]:
        """(gain_0, decay_0, gain_1, ...) over arrays."""
        return self._function("state_equations", "numpy")

    @cached_property
    def initial_states(self) -> tuple[float, ...]:
        """States at the start of a record."""
        return tuple(term.state.initial for term in self.stateful if term.state for _ in self._groups(term))


def _declared(term: Term) -> tuple[Any, ...]:
    """What a term's functions depend on, with its equations as SymPy writes them to be read again."""
    state = () if term.state is None else (term.state.symbol, term.state.gain, term.state.decay)
    names = tuple(parameter.name for parameter in term.parameters)
    return term.scope, term.opposing, names, *map(sp.srepr, (term.equation, *state))


@lru_cache(maxsize=256)  # 80 kB each; one search makes 140, of which 30 are its data's own and never come again
def compiled(terms: tuple[Term, ...], group_count: int, constants: tuple[tuple[str, float], ...]) -> CompiledTerms:
    """The functions of these terms, made once per process."""
    return CompiledTerms(terms, group_count, constants)


# -- memory
def advance(z: float, gain: float, decay: float, dt: float) -> float:
    """One exact step of a linear state; for decay dt -> 0 it tends to z + gain dt."""
    exponent = decay * dt
    weight = -math.expm1(-exponent) / exponent if exponent > 1e-12 else 1.0
    return z * math.exp(-exponent) + gain * dt * weight


def advance_all(
    compiled: CompiledTerms, x: Sequence[float], theta: Sequence[float], z: Sequence[float], dt: float
) -> tuple[float, ...]:
    """All states of a model one step on, at one operating point."""
    if not z:
        return ()
    rates = compiled.scalar_state_rates(x, theta, z)
    return tuple(advance(z[k], rates[2 * k], rates[2 * k + 1], dt) for k in range(len(z)))
