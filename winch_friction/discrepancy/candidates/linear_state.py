"""The states of terms with memory along a whole record, vectorised where the equations allow it."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.signals import FloatArray


def state_history(
    functions: CompiledTerms, point: Sequence[Any], theta: Sequence[float], dt: float
) -> tuple[FloatArray, ...]:
    """States dz/dt = gain - decay z from rest, exact for signals frozen over a step; one array per state.

    The equations of the shipped terms have rates that do not depend on the state, so one pass of a scalar recursion
    over precomputed coefficients is all it takes.
    """
    if not functions.initial_states:
        return ()
    size = np.broadcast(*point).size
    zeros = tuple(0.0 for _ in functions.initial_states)
    rates = functions.vector_state_rates(tuple(point), tuple(theta), zeros)
    out = []
    for k, initial in enumerate(functions.initial_states):
        gain, decay = (np.broadcast_to(rates[2 * k + j], size) for j in (0, 1))
        exponent = decay * dt
        keep = np.exp(-exponent)
        weight = np.where(exponent > 1e-9, -np.expm1(-exponent) / np.maximum(exponent, 1e-9), 1.0)
        out.append(_recursion(initial, keep.tolist(), (gain * dt * weight).tolist()))
    return tuple(out)


def _recursion(z: float, keep: list[float], add: list[float]) -> FloatArray:
    history: list[float] = []
    append = history.append
    for a, b in zip(keep, add, strict=True):
        z = a * z + b
        append(z)
    return np.array(history)
