"""The seed's friction terms at the mean point of a step, with whatever parameter values, and their memory."""

from collections.abc import Sequence
from dataclasses import dataclass

from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.friction.state import advance_all


@dataclass(frozen=True, slots=True)
class Friction:
    """Friction at one operating point, N m: torque, its derivatives by the parameters, and what a full direction
    would make of it."""

    torque: float
    by_parameters: Sequence[float]
    magnitude: float


class FrictionFunctions:
    """Evaluates the seed's terms; keeps the memory of those that have one."""

    def __init__(self, seed: FrictionModel) -> None:
        self._seed = seed
        self._compiled: dict[int, CompiledTerms] = {}
        self.memory: tuple[float, ...] | None = None

    def at(self, x: Sequence[float], theta: Sequence[float], groups: int) -> Friction:
        """Friction at the operating point `x` with the parameter values `theta`."""
        functions = self._functions(groups)
        memory = self._memory(functions)
        torque, _, *gradient = functions.scalar_torque_and_gradient(x, theta, memory)
        full = functions.scalar_torque((1.0, *x[1:]), theta, memory)
        return Friction(torque, gradient, abs(full - functions.scalar_torque((0.0, *x[1:]), theta, memory)))

    def advanced(self, x: Sequence[float], theta: Sequence[float], groups: int, dt: float) -> tuple[float, ...]:
        """The memory `dt` s later."""
        functions = self._functions(groups)
        return advance_all(functions, x, theta, self._memory(functions), dt)

    def _memory(self, functions: CompiledTerms) -> tuple[float, ...]:
        if self.memory is None or len(self.memory) != len(functions.initial_states):
            return functions.initial_states
        return self.memory

    def _functions(self, groups: int) -> CompiledTerms:
        if groups not in self._compiled:
            self._compiled[groups] = self._seed.compile(groups)
        return self._compiled[groups]


def mean_direction(before: float, after: float) -> float:
    """Mean of the sign of a speed that goes linearly from `before` to `after`, between -1 and 1."""
    if before * after >= 0.0:
        total = before + after
        return float(total > 0.0) - float(total < 0.0)
    return (abs(after) - abs(before)) / (after - before)
