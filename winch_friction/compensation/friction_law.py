"""One model as the compensator uses it: its torque term by term, with gains, and its memory."""

from collections.abc import Callable, Mapping, Sequence
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
        self._values = model.values
        self._compiled: CompiledTerms
        self._contributions: Callable[..., tuple[float, ...]]
        self._states: tuple[float, ...]
        self.reset()

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
            self._states = advance_all(functions, x, self.model.values, self._states, dt)

    def reset(self) -> None:
        """Forget the memory of the terms."""
        self._groups = -1  # of what is at hand: nothing
        self._states = ()

    def _parts(self, x: Sequence[float], groups: int) -> Sequence[float]:
        if groups != self._groups:
            self._functions(groups)
        try:
            return self._contributions(x, self._values, self._states)
        except (OverflowError, ValueError, ZeroDivisionError):
            return [float("nan")] * len(self.gains)

    def _functions(self, groups: int) -> CompiledTerms:
        """The model's functions for so many motor groups, at hand until there are others."""
        if groups != self._groups:
            self._groups, self._compiled = groups, self.model.compile(groups)
            self._contributions = self._compiled.scalar_contributions
            if len(self._states) != len(self._compiled.initial_states):
                self._states = self._compiled.initial_states
        return self._compiled


def check_gains(gains: Mapping[str, float]) -> None:
    """Raise `InputError` for a gain whose name is no term at all."""
    for name in gains:
        if name not in registered_terms():
            raise InputError(f"gains: there is no term '{name}'; terms are {', '.join(sorted(registered_terms()))}")
