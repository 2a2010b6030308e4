"""Cranes: the one of docs/physics.md, and others drawn at random around what is built.

A world holds what its owner knows of it: geometry, motors, the seed model of its friction. What it hides: `hidden`.
"""

from dataclasses import dataclass, field

import numpy as np

from campaign.rig.truth import (
    BAR,
    CM3_PER_REV,
    CRANE2,
    GEAR,
    GRAVITY,
    INERTIA,
    LINE_VOLUME,
    MAX_DISPLACEMENT,
    PUMP_FLOW,
    RADII,
    RPM,
    WIRE_MASS,
    WIRE_STIFFNESS,
    Friction,
)

MOTOR_SIZES = (80, 107, 160, 200, 250, 355, 500)  # cm^3/rev that makers sell
ROPE_STRENGTH = 6.6e10  # Pa: EA over the square of the diameter, of a steel rope


@dataclass(frozen=True)
class World:
    """One crane, SI; the default is the crane of docs/physics.md with its seed model."""

    name: str = "crane_150t"
    gear: float = GEAR
    radii: tuple[float, ...] = RADII
    max_displacement: float = MAX_DISPLACEMENT
    active: int = 3
    passive: int = 8
    inertia: float = INERTIA
    wire_mass: float = WIRE_MASS
    wire_stiffness: float = WIRE_STIFFNESS
    line_volume: float = LINE_VOLUME
    pump_flow: float = PUMP_FLOW
    seed: Friction = field(default=CRANE2)

    @property
    def motors(self) -> int:
        """Motors on the shaft."""
        return self.active + self.passive

    @property
    def motor_size(self) -> float:
        """Size of one motor relative to the 215 cm^3/rev of docs/physics.md."""
        return self.max_displacement / MAX_DISPLACEMENT

    @property
    def winch_size(self) -> float:
        """Torque of all motors relative to that of eleven of these."""
        return self.motors * self.motor_size / 11.0

    @property
    def capacity(self) -> float:
        """Loads relative to those of the crane of docs/physics.md: the same pressure in the motors."""
        return self.winch_size * (self.gear / self.radii[-1]) / (GEAR / RADII[-1])

    @property
    def largest_static(self) -> float:
        """Torque at the shaft of the largest load of a test plan, N m."""
        return 107e3 * self.capacity * GRAVITY * self.radii[-1] / self.gear


SHIPPED = World()


def draw_world(rng: np.random.Generator) -> World:
    """Motors, gear, drum, rope, hydraulics and seed model, each drawn on its own."""
    size = float(rng.choice(MOTOR_SIZES)) * CM3_PER_REV
    motors = int(rng.integers(4, 15))
    active = int(np.clip(round(motors * rng.uniform(0.2, 0.45)), 1, motors - 2))
    rope = rng.uniform(0.036, 0.09)
    drum, layers = rng.uniform(8, 14) * rope, int(rng.integers(4, 9))
    radii = tuple(round(float(drum + k * 0.87 * rope), 4) for k in range(layers))
    gear = round(float(2000 * RPM * radii[-1] / rng.uniform(0.6, 1.4)), 1)
    ratio = size / MAX_DISPLACEMENT
    oil = motors * ratio / 11.0
    rotor = motors * ratio ** (5.0 / 3.0) / 11.0  # a motor's inertia grows with the 5/3rd power of its displacement
    return World(
        f"drawn_{rng.integers(1e6):06d}", gear, radii, size, active, motors - active,
        INERTIA * rotor * rng.uniform(0.6, 1.6), 4.1e3 * rope**2, ROPE_STRENGTH * rope**2 * rng.uniform(0.8, 1.2),
        LINE_VOLUME * active * ratio / 3.0 * rng.uniform(0.7, 1.4), PUMP_FLOW * oil * rng.uniform(0.9, 1.5),
        _draw_seed(rng, ratio, motors * gear),
    )  # fmt: skip


def _draw_seed(rng: np.random.Generator, ratio: float, shafts: float) -> Friction:
    """A seed model of plausible parts: motor losses grow with displacement, the system's share the load's torque."""

    def around(value: float, factor: float = 1.5) -> float:
        return float(value * factor ** rng.uniform(-1.0, 1.0))

    return Friction(
        around(CRANE2.K1) * ratio, around(CRANE2.K2), around(CRANE2.K3), around(CRANE2.K4) * ratio,
        around(CRANE2.K5) * ratio, rng.uniform(0.015, 0.06) / shafts, around(CRANE2.C3) * ratio,
        rng.uniform(120, 350) * RPM, around(CRANE2.C5) * ratio, rng.uniform(0.025, 0.06) / shafts,
    )  # fmt: skip


def largest_mass(world: World, layer: int, passive_pressure: float = 275 * BAR) -> float:
    """Mass that the passive motors alone can carry on a layer, kg."""
    return passive_pressure * world.passive * world.max_displacement * world.gear / world.radii[layer - 1] / GRAVITY
