"""Shaft, elastic wire and hanging mass as one linear system, stepped by the trapezoidal (Tustin) rule.

J domega/dt = torque - r (k stretch + c rate),   dstretch/dt = rate = v_heave + r omega - v_load,   m dv_load/dt = k
stretch + c rate

with r = R/i the rope speed per shaft speed and stretch counted from the static one. A payload that is taken as rigid
with the shaft
would leave the wire's mode (1.5 to 3 Hz), which every reversal excites, to be explained by friction.
"""

from dataclasses import dataclass

import numpy as np

from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

STIFFEST = 40.0  # rad/s; a wire of unknown stiffness is taken as this stiff against the hanging mass


@dataclass(frozen=True, slots=True)
class WireStep:
    """One step of [omega, stretch, v_load]: transition (3, 3), and what torque (N m) and heave velocity (m/s) add
    (3,)."""

    transition: FloatArray
    by_torque: FloatArray
    by_heave: FloatArray


def wire_step(crane: Crane, mass: float, layer: float, length: float, damping: float, dt: float) -> WireStep:
    """The step for a hanging mass in kg on `length` m of wire, damped by `damping` N s/m; without a mass the shaft is
    alone."""
    if mass <= 0.0:
        return WireStep(np.eye(3), np.array([dt / crane.inertia, 0.0, 0.0]), np.zeros(3))
    r = crane.drum.radius(layer) / crane.gear_ratio
    k = min(crane.wire_stiffness / length, mass * STIFFEST**2)
    shaft = r / crane.inertia
    rates = np.array(
        [
            [-damping * r * shaft, -k * shaft, damping * shaft],
            [r, 0.0, -1.0],
            [damping * r / mass, k / mass, -damping / mass],
        ]
    )
    solved = np.linalg.inv(np.eye(3) - 0.5 * dt * rates)
    by_torque = np.asarray(dt / crane.inertia * solved[:, 0], float)
    by_heave = np.asarray(dt * (solved @ np.array([-damping * shaft, 1.0, damping / mass])), float)
    return WireStep(solved @ (np.eye(3) + 0.5 * dt * rates), by_torque, by_heave)
