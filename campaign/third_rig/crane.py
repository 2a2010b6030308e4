"""The winch as drawn, what its supplier states of its friction, what it really has, and both as the owner's files."""

import json
from dataclasses import dataclass, replace
from zlib import crc32

import numpy as np

GRAVITY = 9.80665  # m/s^2
BAR = 1e5  # Pa
CM3_PER_REV = 1e-6 / (2 * np.pi)  # m^3/rad

# unit and about the relative standard deviation of the supplier's figures
PARAMETERS = {
    "K1": ("N*m*s/rad", 0.20), "K2": ("N*s^2/m^8", 0.04), "K3": ("1", 0.05), "K4": ("N*m", 0.05),
    "K5": ("m^5/N", 0.22), "C1": ("1", 0.05), "C3": ("N*m", 1.0), "C4": ("rad/s", 0.10), "C5": ("N*m*s/rad", 0.20),
    "C6": ("1", 0.03),
}  # fmt: skip
TERMS = (
    "motor_viscous", "motor_turbulence", "motor_load_loss", "motor_coulomb", "high_pressure_mixed", "stribeck",
    "viscous", "gear_load_loss",
)  # fmt: skip
STRIBECK = ("C1", "C3", "C4")
FARTHEST = 1.8  # standard deviations that the truth may lie off

Friction = dict[str, float]  # the ten parameters in SI


def rng_of(*keys: object) -> np.random.Generator:
    """A random generator of its own for every combination of keys."""
    return np.random.default_rng([crc32(str(key).encode()) for key in keys])


@dataclass(frozen=True)
class Crane:
    """What is built, in SI."""

    motors: int
    cm3_per_rev: float  # of one motor
    gear: float  # motor turns per drum turn
    radii: tuple[float, ...]  # m, of the wire layers
    rated: float  # kg
    inertia: float  # kg m^2, at the motor shaft, without load
    wire_mass: float  # kg/m
    wire_stiffness: float  # N
    top_speed: float  # rad/s, of the motor shaft
    active: int  # motors that are driven in a sea, 0 if it never compensates

    @property
    def max_displacement(self) -> float:
        """Of one motor, m^3/rad."""
        return self.cm3_per_rev * CM3_PER_REV

    @property
    def passive(self) -> int:
        """Motors that hang on the gas."""
        return self.motors - self.active

    def radius(self, layer: int) -> float:
        """In m, of a layer counted from 1."""
        return self.radii[layer - 1]


@dataclass(frozen=True)
class Figures:
    """The friction as the supplier states it, its standard deviations, and as it is."""

    stated: Friction
    deviation: Friction
    true: Friction

    def tightened(self, share: float) -> "Figures":
        """Better known: deviations and errors at this share of what they were."""
        true = {name: value + (self.true[name] - value) * share for name, value in self.stated.items()}
        return replace(self, deviation={name: value * share for name, value in self.deviation.items()}, true=true)

    def without_stribeck(self) -> "Figures":
        """The falling part neither stated nor there."""
        return replace(self, stated=self.stated | {"C1": 0.0, "C3": 0.0}, true=self.true | {"C1": 1e-12, "C3": 0.0})


def draw_crane(rng: np.random.Generator, compensates: bool) -> Crane:
    """A winch of 80 to 355 cm^3/rev motors; one that compensates has some of them on the gas."""
    motors = int(rng.integers(5, 13)) if compensates else int(rng.integers(2, 11))
    cm3_per_rev = float(rng.choice([80, 107, 140, 160, 200, 215, 250, 355]))
    gear = float(np.round(rng.uniform(70, 290), 1))
    first = float(np.round(rng.uniform(0.35, 0.9), 3))
    layers = int(rng.integers(3, 7))
    wire = first * rng.uniform(0.06, 0.1)
    radii = tuple(round(first + 0.87 * wire * k, 4) for k in range(layers))
    rated = motors * cm3_per_rev * CM3_PER_REV * rng.uniform(230, 290) * BAR * gear / radii[-1] / GRAVITY
    return Crane(
        motors, cm3_per_rev, gear, radii,
        rated=float(round(rated, -2)),
        inertia=float(np.round(1.54 * motors * cm3_per_rev / 2365 * rng.uniform(0.7, 1.4), 4)),
        wire_mass=float(round(rated * 24.5 / 150e3 * rng.uniform(0.7, 1.2), 2)),
        wire_stiffness=float(np.round(rated * 2000 * rng.uniform(0.7, 1.3), -4)),
        top_speed=float(rng.uniform(170, 255)),
        active=max(1, int(round(motors * rng.uniform(0.33, 0.5)))) if compensates else 0,
    )  # fmt: skip


def draw_figures(rng: np.random.Generator, crane: Crane) -> Figures:
    """What a supplier's sheet says of such a winch, and a truth within 1.8 of its standard deviations."""
    size = crane.cm3_per_rev / 215
    turned = crane.motors * crane.gear
    stated = {
        "K1": 0.00405 * size * rng.uniform(0.6, 1.5),
        "K2": 3.69e10 / size**2 * rng.uniform(0.6, 1.3),
        "K3": 0.005 * rng.uniform(0.6, 1.8),
        "K4": 14 * size * rng.uniform(0.6, 1.3),
        "K5": 1.16e-14 * size * rng.uniform(0.5, 1.6),
        "C1": 0.0426 / turned * rng.uniform(0.5, 1.5),
        "C3": 0.562 * size * rng.uniform(0.5, 2),
        "C4": 23.98 * rng.uniform(0.6, 1.6),
        "C5": 0.00943 * size * rng.uniform(0.6, 1.4),
        "C6": 0.0445 / turned * rng.uniform(0.6, 1.3),
    }
    deviation = {name: value * PARAMETERS[name][1] * rng.uniform(0.7, 1.4) for name, value in stated.items()}
    deviation["C3"] = min(deviation["C3"], stated["C3"])
    true = {name: _drawn_about(rng, value, deviation[name]) for name, value in stated.items()}
    return Figures(stated, deviation, true)


def _drawn_about(rng: np.random.Generator, value: float, deviation: float) -> float:
    """A positive figure."""
    while True:
        off = rng.normal()
        if abs(off) <= FARTHEST and value + off * deviation > 0:
            return value + off * deviation


def crane_text(name: str, crane: Crane, elastic: bool) -> str:
    """The crane file, in the documented format; without the wire's stiffness if that is not `elastic`."""
    groups = {"main": crane.motors}
    if crane.active:
        groups |= {"active": crane.active, "passive": crane.passive}
    stiffness = f"wire_stiffness: {{value: {crane.wire_stiffness:.4e}, unit: N}}"
    return f"""schema: winch_friction.crane/1
name: {name}
drive: hydraulic
gear_ratio: {crane.gear}
max_displacement: {{value: {crane.cm3_per_rev:g}, unit: cm^3/rev}}
drum:
  layer_radii: {list(crane.radii)}
groups: {json.dumps(groups).replace('"', "")}
inertia: {{value: {crane.inertia}, unit: kg*m^2}}
wire_mass: {{value: {crane.wire_mass}, unit: kg/m}}
{stiffness if elastic else "# the stiffness of this wire is not known"}
absolute_torque_limit: {{value: {crane.motors * crane.max_displacement * 90 * BAR:.0f}, unit: N*m}}
rated_load: {{value: {crane.rated / 1e3:.1f}, unit: t}}
"""


def model_text(name: str, crane: Crane, figures: Figures, stribeck: bool, zeros: dict[str, float]) -> str:
    """The seed model's file, in the documented format; `zeros` are the transducers' tolerances by group, bar."""
    terms = [term for term in TERMS if stribeck or term != "stribeck"]
    rows = "".join(
        f'  {each}: {{value: {figures.stated[each]:.6g}, unit: "{unit}", std: {figures.deviation[each]:.4g}}}\n'
        for each, (unit, _) in PARAMETERS.items()
        if stribeck or each not in STRIBECK
    )
    offsets = "".join(
        f"    - {{value: 0.0, unit: bar, std: {std}, source: data sheet, groups: [{group}]}}\n"
        for group, std in zeros.items()
    )
    corrections = f"corrections:\n  pressure_offset:\n{offsets}" if zeros else ""
    return f"""schema: winch_friction.model/1
name: seed_{name}
crane: {name}
terms: [{", ".join(terms)}]
constants:
  max_displacement: {{value: {crane.cm3_per_rev:g}, unit: cm^3/rev}}
  gear_ratio: {crane.gear}
parameters:
{rows}{corrections}provenance:
  source: third examiner
"""
