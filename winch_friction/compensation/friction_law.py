"""One model as the compensator uses it: its torque term by term, with gains, and its memory."""

from collections.abc import Mapping, Sequence
from operator import mul

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, registered_terms
from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.friction.state import advance_all

# what a sensor shows but the shaft does not feel must not be compensated unless the gains ask for it
NOT_FELT = "sensor"


class FrictionLaw:
    """The friction torque of a model at an operating point, with a gain for every term."""

    def __init__(self, model: FrictionModel, gains: Mapping[str, float]) -> None:
        self.model = model
        self.gains = tuple(gains.get(t.name, 0.0 if t.place == NOT_FELT else 1.0) for t in model.terms)
        self._all_used = min(self.gains, default=0.0) > 0.0
        self.reads = frozenset(name for term in model.terms for name in term.reads)
        self._compiled: dict[int, CompiledTerms] = {}
        self._states: tuple[float, ...] | None = None

    def torque(self, x: Sequence[float], groups: int) -> float:
        """Sum of gain times contribution, N m at the motor shaft; overflow comes out as NaN."""
        return sum(map(mul, self.gains, self._parts(x, groups)))

    def magnitude(self, x: Sequence[float], groups: int) -> float:
        """Sum of the terms' magnitudes at direction 1, N m: the largest torque that the signs could make of them."""
        parts = self._parts((1.0, *x[1:]), groups)
        if self._all_used:
            return sum(map(abs, parts))
        return sum(abs(part) for gain, part in zip(self.gains, parts, strict=True) if gain > 0.0)

    def advance(self, x: Sequence[float], groups: int, dt: float) -> None:
        """Step the terms with memory by `dt` s."""
        functions = self._functions(groups)
        if functions.initial_states:
            self._states = advance_all(functions, x, self.model.values, self._memory(functions), dt)

    def reset(self) -> None:
        """Forget the memory of the terms."""
        self._states = None

    def _parts(self, x: Sequence[float], groups: int) -> Sequence[float]:
        functions = self._functions(groups)
        try:
            return functions.scalar_contributions(x, self.model.values, self._memory(functions))
        except (OverflowError, ValueError, ZeroDivisionError):
            return [float("nan")] * len(self.gains)

    def _memory(self, functions: CompiledTerms) -> tuple[float, ...]:
        if self._states is None or len(self._states) != len(functions.initial_states):
            self._states = functions.initial_states
        return self._states

    def _functions(self, groups: int) -> CompiledTerms:
        found = self._compiled.get(groups)
        if found is None:
            found = self._compiled[groups] = self.model.compile(groups)
        return found


def check_gains(gains: Mapping[str, float]) -> None:
    """Raise `InputError` for a gain whose name is no term at all."""
    for name in gains:
        if name not in registered_terms():
            raise InputError(f"gains: there is no term '{name}'; terms are {', '.join(sorted(registered_terms()))}")
