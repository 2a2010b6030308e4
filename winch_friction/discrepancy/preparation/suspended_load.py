"""What hangs on the wire: mass, radius, and the acceleration that it takes part in.

Where the rope's force, or the load's torque at the shaft, was measured, that is the load with all it does, and the mass
behind it need not be known.
"""

from dataclasses import dataclass, replace

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, smooth
from winch_friction.discrepancy.preparation.motion import Motion
from winch_friction.discrepancy.preparation.wire_mode import on_the_wire
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.units import GRAVITY
from winch_friction.physics.winch import Crane

CONSTANT = 0.05  # a load cell's noise is not the load: a hanging mass that stays within 5 % is constant


@dataclass(frozen=True)
class SuspendedLoad:
    """Mass kg, rope radius m and upward accelerations m/s^2 of the load; `heave` is the crane's part of it."""

    mass: FloatArray
    radius: FloatArray
    lever: FloatArray  # m, radius over gear ratio
    acceleration: FloatArray
    heave: FloatArray
    tension_measured: bool = False  # then `mass` is the force over gravity, and its inertia is in it

    @property
    def drum_torque(self) -> FloatArray:
        """Of the load at rest, N m."""
        return self.mass * GRAVITY * self.radius

    @property
    def inertial_torque(self) -> FloatArray:
        """At the motor shaft, N m."""
        return self.mass * self.lever * self.acceleration

    @property
    def heave_torque(self) -> FloatArray:
        """What of it the heaving crane makes, N m at the motor shaft."""
        return self.mass * self.lever * self.heave

    def on_wire(self, dt: float, mode: tuple[float, float]) -> "SuspendedLoad":
        """The load behind the wire's mode (frequency rad/s, damping ratio); as it is where the wire is rigid."""
        if mode[1] <= 0.0:
            return self
        moved = on_the_wire(self.acceleration, dt, *mode), on_the_wire(self.heave, dt, *mode)
        return replace(self, acceleration=moved[0], heave=moved[1])


def load_of(grid: Grid, motion: Motion, crane: Crane, known: float) -> SuspendedLoad:
    """The load on a rigid wire; `known` kg where the run has neither `hook_load` nor a measured force (NaN: none)."""
    columns, size = grid.columns, len(grid.time)
    radius, heave = _radius(grid, crane), np.zeros(size)
    tension = _tension(grid, radius, crane)
    if tension is not None:
        mass = smooth(tension, motion.window) / GRAVITY
        return SuspendedLoad(mass, radius, radius / crane.gear_ratio, np.zeros(size), heave, tension_measured=True)
    mass = columns.get("hook_load", np.full(size, 0.0 if np.isnan(known) else known))
    steady = np.median(mass)
    is_constant = np.std(mass) <= CONSTANT * abs(steady)
    mass = np.full(size, steady) if is_constant else smooth(mass, 5 * motion.window)
    if "heave_velocity" in columns:
        heave = np.gradient(smooth(columns["heave_velocity"], motion.window), grid.dt)
    lever = radius / crane.gear_ratio
    return SuspendedLoad(mass, radius, lever, lever * motion.acceleration + heave, heave)


def _tension(grid: Grid, radius: FloatArray, crane: Crane) -> FloatArray | None:
    """The rope's force in N as it was measured, directly or as a torque at the motor shaft; None where it was not."""
    if "load_torque" in grid.columns:
        return grid.columns["load_torque"] * crane.gear_ratio / radius
    return None if "hook_load" in grid.columns else grid.columns.get("rope_force")


def _radius(grid: Grid, crane: Crane) -> FloatArray:
    radius = np.full(len(grid.time), crane.drum.radius(float("nan")))
    if "wire_layer" in grid.columns:
        layers = np.rint(grid.columns["wire_layer"])
        for layer in np.unique(layers):
            radius[layers == layer] = crane.drum.radius(float(layer))
    return radius
