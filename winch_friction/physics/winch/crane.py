"""What a crane is, as far as friction is concerned."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from winch_friction.physics.errors import InputError
from winch_friction.physics.units import GRAVITY
from winch_friction.physics.winch.drive import Drive


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
    >>> round(crane.drum_torque(55e3) / 1e3), round(crane.load_inertia(55e3), 2)  # kN m, kg m^2
    (613, 1.14)
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
