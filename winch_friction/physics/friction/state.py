"""Stepping the memory of terms: dz/dt = gain - decay z, exact for signals frozen over a step."""

import math
from collections.abc import Sequence

from winch_friction.physics.friction.compiled import CompiledTerms


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
