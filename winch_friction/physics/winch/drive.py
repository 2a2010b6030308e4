"""How the torque of a winch's motors is known: from pressures, a torque, a power, or a current.

A drive says which channels it needs and what torque they mean; nothing else in the package asks what kind it is beyond
whether it is hydraulic, which decides whether there are motor groups.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from winch_friction.physics.channels import GROUP_CHANNELS
from winch_friction.physics.errors import InputError
from winch_friction.physics.plausible import plausible
from winch_friction.physics.signals import Run, Sample

if TYPE_CHECKING:
    from winch_friction.physics.winch.crane import Crane

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
