"""What a crane is, as far as friction is concerned, and how the torque of its motors is known.

A drive says which channels it needs, pressures, a torque, a power, or a current, and what torque they mean; nothing
else in the package asks what kind it is beyond whether it is hydraulic, which decides whether there are motor groups.

The torque balance at the motor shaft (docs/physics.md §1), summed over the motor groups:

sum_g n_g D_g dp_g = T_d / i + J domega/dt + T_friction

with T_friction = sgn(omega) (sum_g n_g T_fm,g + N T_fs) + torques of fixed direction. Electric drive: the left side is
N times the measured torque.
"""

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache
from operator import attrgetter
from typing import Any, TypeVar

import numpy as np

from winch_friction.physics.channels import GRAVITY, GROUP_CHANNELS, plausible
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run, Sample, held

# -- the drive
HYDRAULIC, ELECTRIC, POWER, CURRENT = "hydraulic", "electric", "power", "current"
# rad/s; a power says nothing of the torque of a shaft that hardly turns: 1 % of 100 kW there is 200 N m. A crane file
# says otherwise where its shaft is a slow one
SLOWEST_FOR_POWER = 5.0

_group_values = attrgetter(*GROUP_CHANNELS)
_Read = Callable[[str], Any]  # a channel's name -> its value, or its column


@dataclass(frozen=True)
class Drive:
    """A kind of drive.

    `kind`: 'hydraulic' (pressures and displacement of every motor group), 'electric' (`motor_torque` per motor),
    'power' (`mechanical_power` of all motors over the speed) or 'current' (`motor_current` per motor times
    `torque_constant`, N m/A, gear and efficiency of the motor in it). Raises `InputError` for another kind, and for a
    constant that is missing, not positive, or given to a drive that has none. `slowest_speed` rad/s: below it a power
    is not taken for a torque.
    """

    kind: str = HYDRAULIC
    torque_constant: float = 0.0
    slowest_speed: float = SLOWEST_FOR_POWER

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"drive must be one of {', '.join(KINDS)}, found '{self.kind}'")
        if (self.kind == CURRENT) != (self.torque_constant > 0.0):
            raise InputError("a drive of kind 'current', and no other, needs a torque_constant above 0 N*m/A")
        if not self.slowest_speed > 0.0:
            raise InputError(f"a drive's slowest_speed must be above 0 rad/s, found {self.slowest_speed:g}")

    @cached_property
    def hydraulic(self) -> bool:
        """Whether motor groups with pressures and displacements make the torque."""
        return self.kind == HYDRAULIC

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels, without a group, that the torque is known by; empty for a hydraulic drive."""
        return KINDS[self.kind]

    @property
    def unit(self) -> str:
        """The unit in which people read how hard it works: bar, or N*m per motor."""
        return "bar" if self.hydraulic else "N*m"

    def of_sample(self, sample: Sample, crane: "Crane") -> float:
        """Torque of all motors at the shaft from one sample, N m; NaN where it lacks what that takes."""
        if self.hydraulic:
            total = 0.0
            for name, group in sample.groups.items():
                total += crane.motor_count(name) * group.displacement * (group.pressure_a - group.pressure_b)
            return total
        speed = sample.motor_speed
        if self.kind == POWER and not abs(speed) >= self.slowest_speed:
            return math.nan
        return float(self._torque(lambda name: getattr(sample, name), crane, speed))

    def of_run(self, run: Run, crane: "Crane") -> Any:
        """`of_sample` along a run, N m; raises `InputError` where it lacks a column that this takes."""
        if self.hydraulic:
            return hydraulic_torque(
                (crane.motor_count(g), run[f"{g}.displacement"], run[f"{g}.pressure_a"] - run[f"{g}.pressure_b"])
                for g in run.groups
            )
        speed = run["motor_speed"]
        if self.kind == POWER:
            speed = np.where(np.abs(speed) >= self.slowest_speed, speed, np.nan)
        return self._torque(run.__getitem__, crane, speed)

    def lacking(self, sample: Sample, plausible: Callable[[str, float], bool] = plausible) -> tuple[str, ...]:
        """Channels that the torque of a sample needs and that it does not have, or has implausible (by default: for any
        winch)."""
        if self.kind == POWER and abs(sample.motor_speed) < self.slowest_speed:
            return ("speed enough to tell a torque from the power",)
        if not self.hydraulic:
            return tuple(name for name in self.channels if not plausible(name, getattr(sample, name)))
        if not sample.groups:
            return ("motor groups",)
        lost: tuple[str, ...] = ()
        for name, group in sample.groups.items():
            a, b, displacement = _group_values(group)
            if plausible("pressure_a", a) and plausible("pressure_b", b) and plausible("displacement", displacement):
                continue
            values = zip(GROUP_CHANNELS, _group_values(group), strict=True)
            lost += tuple(f"{name}.{channel}" for channel, value in values if not plausible(channel, value))
        return lost

    def _torque(self, read: _Read, crane: "Crane", speed: Any) -> Any:
        if self.kind == POWER:
            return read("mechanical_power") / speed
        if self.kind == CURRENT:
            return read("motor_current") * self.torque_constant * crane.motor_total(())
        return read("motor_torque") * crane.motor_total(())


KINDS: Mapping[str, tuple[str, ...]] = {
    HYDRAULIC: (),
    ELECTRIC: ("motor_torque",),
    POWER: ("mechanical_power",),
    CURRENT: ("motor_current",),
}


def hydraulic_torque(groups: Iterable[tuple[float, Any, Any]]) -> Any:
    """Sum of n D dp in N m over groups of (motors, displacement m^3/rad, pressure drop Pa); floats or arrays alike."""
    return sum([count * displacement * drop for count, displacement, drop in groups])


# -- the crane
FAST_MOTOR = 100.0  # rad/s; axial piston motors turn several times faster, radial ones on the drum at 2 to 20
_Settings = TypeVar("_Settings", bound=Any)


@dataclass(frozen=True)
class Drum:
    """Rope radius of each wire layer in m, innermost first."""

    layer_radii: tuple[float, ...]

    def has(self, layer: float) -> bool:
        """Whether this is one of the drum's layers, counted from 1, or none is said (NaN)."""
        return (
            layer in self._by_layer
            or layer != layer
            or (math.isfinite(layer) and 1 <= round(layer) <= len(self.layer_radii))
        )

    def radius(self, layer: float) -> float:
        """Rope radius in m of a wire layer counted from 1; without a layer (NaN) the outer one is assumed."""
        found = self._by_layer.get(layer)  # as a PLC says it; a node asks five times per sample
        if found is not None:
            return found
        if layer != layer:
            return self.layer_radii[-1]
        if not self.has(layer):
            raise InputError(f"wire_layer {layer:g} does not exist: the drum has layers 1 ... {len(self.layer_radii)}")
        return self.layer_radii[round(layer) - 1]

    @cached_property
    def _by_layer(self) -> dict[float, float]:
        return {float(layer): radius for layer, radius in enumerate(self.layer_radii, start=1)}


@dataclass(frozen=True)
class Crane:
    """A winch seen from its motor shaft.

    `groups` maps a motor group's name to its number of motors for every group that may appear (normal mode: `main`;
    AHC: `active`, `passive`); `inertia` is the whole inertia at the motor shaft without the load, kg m^2; `wire_mass`
    kg/m and `wire_stiffness` (EA) N describe the rope; `max_displacement` m^3/rad per motor; `drive`: how the torque of
    the motors is known; `rated_pressure` Pa, `rated_speed` rad/s of the motor shaft and `rated_load` kg bound what its
    sensors can show (`ranges`), 0: not said.

    >>> import winch_friction as wf
    >>> crane = wf.load_crane("crane_150t")
    >>> crane.motor_count("active"), crane.motor_total(["active", "passive"])
    (3, 11)
    >>> round(crane.drum_torque(55e3) / 1e3), round(crane.load_inertia(55e3), 2), crane.speed_scale  # kN m, kg m^2
    (613, 1.14, 1.0)
    """

    name: str
    gear_ratio: float
    drum: Drum
    groups: Mapping[str, int]
    inertia: float
    max_displacement: float = 0.0
    drive: Drive = field(default_factory=Drive)
    wire_mass: float = 0.0
    wire_stiffness: float = float("inf")
    absolute_torque_limit: float = float("inf")
    rated_pressure: float = 0.0
    rated_speed: float = 0.0
    rated_load: float = 0.0

    @property
    def speed_scale(self) -> float:
        """Factor of the speeds that tell motion from rest: below 1 where `rated_speed` calls the motors slow."""
        return min(1.0, self.rated_speed / FAST_MOTOR) if self.rated_speed else 1.0

    def _repr_html_(self) -> str:
        from winch_friction.physics.frames import html_table

        layers = ", ".join(f"{radius:.4g}" for radius in self.drum.layer_radii)
        rows = [
            ("drive", self.drive.kind, ""),
            ("motors by group", ", ".join(f"{name} {count}" for name, count in self.groups.items()) or "1", ""),
            ("gear ratio", self.gear_ratio, "-"), ("rope radius by layer", layers, "m"),
            ("inertia at the motor shaft", self.inertia, "kg*m^2"),
            ("largest displacement", self.max_displacement, "m^3/rad"),
            ("torque limit", self.absolute_torque_limit, "N*m"),
        ]  # fmt: skip
        return html_table(f"Crane '{self.name}'", ("", "value", "unit"), rows)

    def motor_total(self, groups: Collection[str]) -> int:
        """Number of motors on the shaft when these groups drive it."""
        return sum(map(self.motor_count, groups)) if groups else sum(self.groups.values()) or 1

    def motor_count(self, group: str) -> int:
        """Motors in one group; an unknown name raises `InputError`."""
        if group not in self.groups:
            raise InputError(
                f"crane '{self.name}' has no motor group '{group}'; it has {', '.join(self.groups) or 'none'}"
            )
        return self.groups[group]

    def drum_torque(self, load: float, layer: float = float("nan")) -> float:
        """T_d = m g R in N m for a hanging mass in kg (hook included) on a wire layer (NaN: outer)."""
        return load * GRAVITY * self.drum.radius(layer)

    def load_inertia(self, load: float, layer: float = float("nan")) -> float:
        """Inertia of the hanging mass at the motor shaft, kg m^2."""
        return load * (self.drum.radius(layer) / self.gear_ratio) ** 2


def at_its_speeds(settings: _Settings, crane: Crane, *names: str) -> _Settings:
    """The settings with those in rad/s that were left at their defaults in proportion to a slow motor's speeds."""
    usual: Mapping[str, Any] = {each.name: each.default for each in fields(settings) if each.name in names}
    slower = {name: v * crane.speed_scale for name, v in usual.items() if getattr(settings, name) == v}
    return replace(settings, **slower) if crane.speed_scale < 1.0 else settings


# -- the balance of torques
DRIVING = ("active", "main")  # the groups that carry what the others leave, where they run


def driving_group(groups: Sequence[str]) -> str:
    """The motor group that closes the torque balance, of the names of those that run."""
    return next((name for name in DRIVING if name in groups), groups[0])


@lru_cache(maxsize=64)
def group_roles(groups: tuple[str, ...]) -> Mapping[str, float]:
    """The signal `role` of each of the motor groups that run, by its name."""
    if len(groups) < 2:
        return dict.fromkeys(groups, 0.0)
    return {name: 1.0 if name == driving_group(groups) else -1.0 for name in groups}


def sample_drive_torque(sample: Sample, crane: Crane) -> float:
    """Torque of all motors at the shaft in N m from one sample, as the crane's drive makes it known."""
    return crane.drive.of_sample(sample, crane)


def sample_load(sample: Sample) -> float:
    """The hanging mass that a sample shows in kg: hook load, else what the rope force carries; NaN without both."""
    return sample.hook_load if math.isfinite(sample.hook_load) else sample.rope_force / GRAVITY


def run_drive_torque(run: Run, crane: Crane) -> Any:
    """`sample_drive_torque` along a run, N m."""
    return crane.drive.of_run(run, crane)


def pressure_feedforward(friction_torque: float, motor_count: int, displacement: float) -> float:
    """Pressure in Pa by which the active group carries all the friction: T_f / (n_active D_active)."""
    return friction_torque / (motor_count * displacement)


def run_drum_torque(run: Run, crane: Crane, load: float = float("nan")) -> FloatArray:
    """T_d in N m along a run from `hook_load`, or from a given load in kg where the run has none."""
    return run.column("hook_load", load) * GRAVITY * run_rope_radius(run, crane)


def run_rope_radius(run: Run, crane: Crane) -> FloatArray:
    """Rope radius in m along a run, by `wire_layer`, which holds until another one is said; of the outer layer where
    none is."""
    layers = held(run.column("wire_layer"))
    radii = {layer: crane.drum.radius(layer) for layer in np.unique(layers[~np.isnan(layers)])}
    return np.array([radii.get(layer, crane.drum.radius(float("nan"))) for layer in layers])
