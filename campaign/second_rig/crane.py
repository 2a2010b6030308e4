"""The winch as drawn, its supplier's friction, the friction it really has, and both as the owner's files."""

from dataclasses import dataclass

import numpy as np

RPM = 2 * np.pi / 60  # rad/s
CM3_PER_REV = 1e-6 / (2 * np.pi)  # m^3/rad
BAR = 1e5  # Pa
GRAVITY = 9.81  # m/s^2

ALL_ONE, BOTH, SPLIT = "main", "both", "split"  # how the motors are grouped: never, in a sea only, always

# relative standard deviation and unit of the supplier's figures
PARAMETERS = {
    "K1": (0.2, "N*m*s/rad"), "K2": (0.04, "N*s^2/m^8"), "K3": (0.05, '"1"'), "K4": (0.05, "N*m"),
    "K5": (0.22, "m^5/N"), "C1": (0.05, '"1"'), "C3": (1.0, "N*m"), "C4": (0.1, "rpm"),
    "C5": (0.2, "N*m*s/rad"), "C6": (0.03, '"1"'),
}  # fmt: skip

Friction = dict[str, float]  # the ten parameters in SI; C4 in rpm


@dataclass(frozen=True)
class Crane:
    """What is built, in SI."""

    name: str
    grouping: str  # ALL_ONE, BOTH or SPLIT
    max_displacement: float  # m^3/rad, of one motor
    motors: int
    gear: float  # motor turns per drum turn
    active: int  # motors that are driven in a sea
    rope: float  # m, diameter
    layers: int
    radii: np.ndarray  # m, of the wire layers
    rated_pressure: float  # Pa
    rated: float  # kg
    top_speed: float  # rad/s, of the motor shaft
    inertia: float  # kg m^2, at the motor shaft, without load
    wire_mass: float  # kg/m
    wire_stiffness: float  # N

    @property
    def passive(self) -> int:
        """Motors that hang on the gas."""
        return self.motors - self.active

    @property
    def size(self) -> float:
        """Of one motor, relative to 215 cm^3/rev."""
        return self.max_displacement / (215 * CM3_PER_REV)


def draw_crane(rng: np.random.Generator, grouping: str) -> Crane:
    """A winch of 80 to 355 cm^3/rev motors."""
    name = f"crane_{rng.integers(1000):03d}"
    max_displacement = rng.choice([80, 107, 160, 200, 250, 355]) * CM3_PER_REV
    motors = int(rng.integers(3, 15))
    gear = float(np.round(rng.uniform(60, 320), 1))
    motors = motors if grouping == ALL_ONE else max(motors, 6)
    active = max(2, int(round(motors * rng.uniform(0.25, 0.45))))
    rope = rng.uniform(0.028, 0.09)
    layers = int(rng.integers(3, 8))
    radii = rope * rng.uniform(9, 14) + 0.87 * rope * np.arange(layers)
    rated_pressure = rng.choice([315, 350, 400, 450]) * BAR
    rated = 0.62 * rated_pressure * motors * max_displacement * gear / (radii[-1] * GRAVITY) * 0.9
    top_speed = rng.uniform(110, 240) * (200 * CM3_PER_REV / max_displacement) ** 0.33
    of_a_motor = 0.03 * (max_displacement / (200 * CM3_PER_REV)) ** 1.5 + 0.02
    inertia = motors * of_a_motor + rng.uniform(0.2, 1.0) * motors / 10
    return Crane(
        name, grouping, max_displacement, motors, gear, active, rope, layers, radii, rated_pressure, rated, top_speed,
        inertia, 4000 * rope**2, 5e10 * rope**2,
    )  # fmt: skip


def draw_supplier(rng: np.random.Generator, crane: Crane) -> Friction:
    """What the supplier's sheet says of such a winch."""
    size = crane.size
    turned = crane.motors * crane.gear

    def spread(least: float = 0.75, most: float = 1.3) -> float:
        return rng.uniform(least, most)

    return {
        "K1": 0.00405 * size * spread(),
        "K2": 3.69e10 * size**-2 * spread(),
        "K3": 0.005 * spread(),
        "K4": 14 * size * spread(),
        "K5": 1.16e-14 * size * spread(),
        "C1": 0.0426 / turned * spread(0.6, 1.4),
        "C3": 0.562 * size * spread(),
        "C4": spread(130, 320),
        "C5": 0.00943 * size * spread(),
        "C6": 0.0446 / turned * spread(0.7, 1.4),
    }


def draw_truth(rng: np.random.Generator, supplier: Friction) -> Friction:
    """What the winch really has: within 1.5 standard deviations of the supplier, C3 anywhere above 0.1 of it."""
    truth = {}
    for name, value in supplier.items():
        deviation = rng.normal()
        if name == "C3":
            truth[name] = value * max(0.1, 1 + 0.6 * deviation)
        else:
            truth[name] = value * (1 + PARAMETERS[name][0] * np.clip(deviation, -1.5, 1.5))
    return truth


def crane_text(crane: Crane) -> str:
    """The crane file, in the documented format."""
    groups = {"main": crane.motors} if crane.grouping != SPLIT else {}
    if crane.grouping != ALL_ONE:
        groups |= {"active": crane.active, "passive": crane.passive}
    rows = "\n".join(f"  {name}: {count}" for name, count in groups.items())
    limit = round(0.5 * crane.motors * crane.max_displacement * crane.rated_pressure / 10) * 10
    return f"""schema: winch_friction.crane/1
name: {crane.name}
drive: hydraulic
gear_ratio: {crane.gear}
max_displacement: {{value: {crane.max_displacement / CM3_PER_REV:.6g}, unit: cm^3/rev}}
drum:
  layer_radii: [{", ".join(f"{radius:.4f}" for radius in crane.radii)}]
groups:
{rows}
inertia: {{value: {crane.inertia:.5g}, unit: kg*m^2}}
wire_mass: {{value: {crane.wire_mass:.4g}, unit: kg/m}}
wire_stiffness: {{value: {crane.wire_stiffness:.4g}, unit: N}}
absolute_torque_limit: {{value: {limit:g}, unit: N*m}}
rated_load: {{value: {crane.rated * 1.3 / 1000:.4g}, unit: t}}
rated_pressure: {{value: {crane.rated_pressure / BAR:g}, unit: bar}}
rated_speed: {{value: {crane.top_speed * 1.5 / RPM:.0f}, unit: rpm}}
"""


def model_text(crane: Crane, supplier: Friction) -> str:
    """The seed model's file, in the documented format."""
    rows = "\n".join(
        f"  {name}: {{value: {value:.6g}, unit: {PARAMETERS[name][1]}, std: {value * PARAMETERS[name][0]:.5g}}}"
        for name, value in supplier.items()
    )
    return f"""schema: winch_friction.model/1
name: seed_{crane.name}
crane: {crane.name}
terms: [motor_viscous, motor_turbulence, motor_load_loss, motor_coulomb, high_pressure_mixed, stribeck, viscous, \
gear_load_loss]
constants:
  max_displacement: {{value: {crane.max_displacement / CM3_PER_REV:.6g}, unit: cm^3/rev}}
  gear_ratio: {crane.gear}
parameters:
{rows}
provenance:
  source: supplier sheet and first sailing
"""
