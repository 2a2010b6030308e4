"""The hidden effects by name: how each changes plant, sensors or friction at a multiple of its typical size."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.channels import BAR, CM3_PER_REV
from winch_friction.physics.errors import InputError
from winch_friction.simulation.hidden.torque import HIDDEN, HIDDEN_FIELDS
from winch_friction.simulation.plant.parameters import record
from winch_friction.simulation.sensors.channels import Channels

DEGREE = np.pi / 180.0
MONTH = 30.0 * 86400.0  # s
WEAR_EPOCH = 1_704_067_200.0  # Unix time of 1 January 2024, when the wear starts


@dataclass(frozen=True)
class Target:
    """What an effect may change: the records of the plant and of the extra torques, the channels, the layers' radii."""

    plant: Any
    torque: Any
    channels: Channels
    layer_radii: tuple[float, ...]

    def sensor(self, *endings: str) -> list[Any]:
        """Settings of the channels whose names end so."""
        found = zip(self.channels.names, self.channels.settings, strict=True)
        return [row for name, row in found if name.endswith(endings)]


@dataclass(frozen=True)
class HiddenEffect:
    """One effect: its size in words and what it does to the plant; `either_sign`: it may be less than nothing as well.

    What only takes (a brake, a bristle, a leak) is no such effect: below zero it would drive the winch.
    """

    name: str
    typical: str
    apply: Callable[[Target, float], None]
    either_sign: bool = False

    def refuse(self, size: float, where: str) -> None:
        """Raise `InputError` for a size that the effect cannot have."""
        if size < 0.0 and not self.either_sign:
            raise InputError(f"{where}: {self.name} only takes and cannot be negative; give a size from 0 on")


EFFECTS: dict[str, HiddenEffect] = {}


def effect(
    name: str, typical: str, either_sign: bool = False
) -> Callable[[Callable[[Target, float], None]], Callable[[Target, float], None]]:
    """Declare an effect."""

    def declare(function: Callable[[Target, float], None]) -> Callable[[Target, float], None]:
        EFFECTS[name] = HiddenEffect(name, typical, function, either_sign)
        return function

    return declare


def apply_effects(
    hidden: Sequence[tuple[str, float]] | Mapping[str, float],
    plant: np.ndarray,
    channels: Channels,
    layer_radii: tuple[float, ...],
) -> np.ndarray:
    """Put effects into a plant and its sensors, in place; returns the record of the extra torques."""
    from winch_friction.simulation.hidden import effects  # noqa: F401  (the declarations register themselves)

    torque = record(HIDDEN)
    target = Target(plant[0], torque[0], channels, layer_radii)
    pairs = hidden.items() if isinstance(hidden, Mapping) else hidden
    for name, size in pairs:
        if name not in EFFECTS:
            raise InputError(f"hidden effect '{name}' is not known; known effects are {', '.join(sorted(EFFECTS))}")
        EFFECTS[name].refuse(size, f"hidden effect '{name}={size:g}'")
        EFFECTS[name].apply(target, float(size))
    torque["present"] = float(any(torque[0][name] != 0.0 for name in HIDDEN_FIELDS))
    return torque


def effect_names() -> tuple[str, ...]:
    """Names of all effects that can be hidden."""
    from winch_friction.simulation.hidden import effects  # noqa: F401

    return tuple(EFFECTS)


__all__ = ["BAR", "CM3_PER_REV", "DEGREE", "EFFECTS", "HiddenEffect", "Target", "apply_effects", "effect_names"]
