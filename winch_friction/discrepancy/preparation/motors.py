"""What the signals of a run's motors make: smoothed pressures and displacements, and the torque of the drive."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from winch_friction.discrepancy.preparation.grid import digit_of, noise_level, smooth, smooth_between_steps
from winch_friction.physics.channels import BAR
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import GROUP_CHANNELS, FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.crane import driving_group, hydraulic_torque

# of the crane's largest displacement; a motor that is swung in further would need twenty times the usual pressure
MIN_DISPLACEMENT_SHARE = 0.05


@dataclass(frozen=True)
class GroupSignals:
    """One motor group along a run: motors, predicted or smoothed pressures Pa, displacement of each motor m^3/rad."""

    name: str
    count: int
    pressure: FloatArray  # drop p_A - p_B
    pressure_sum: FloatArray
    low_pressure: FloatArray  # of the two ports
    displacement: FloatArray
    balances: bool  # closes the torque balance: its pressure is predicted
    logged: FloatArray  # the drop as it was measured, smoothed
    digit: float = 0.0  # Pa by which the coarser of its pressures is written; 0 where that cannot be told

    def of_zero(self, step: float) -> FloatArray:
        """Torque at the shaft in N m of an error of both transducers of 1 bar, or by as much more as their digit is
        coarser than a `step` of so many bar."""
        return self.count * self.displacement * max(BAR, self.digit / step)


Groups = tuple[GroupSignals, ...]


@dataclass(frozen=True)
class KnownGroups:
    """Groups as they were measured before, from these columns over a `window` of so many samples."""

    groups: Groups = ()
    columns: Mapping[str, FloatArray] = field(default_factory=dict)
    window: int = 0

    def of(self, name: str, columns: Mapping[str, FloatArray], channels: Sequence[str]) -> GroupSignals | None:
        """The group of this name, where these of its channels are the very same columns; None otherwise."""
        own = (f"{name}.{channel}" for channel in channels)
        same = all(columns[each] is self.columns.get(each) for each in own)
        return next((group for group in self.groups if group.name == name), None) if same else None


def measured_groups(
    columns: Mapping[str, FloatArray], run: Run, crane: Crane, window: int,
    known: KnownGroups | None = None,
) -> Groups:  # fmt: skip
    """All groups with their smoothed pressures; `InputError` where one lacks a channel or has no displacement. What is
    `known` of the same columns already is not smoothed again."""
    if not (names := run.groups):
        raise InputError(f"{run.name}: no motor group's pressures and displacement; they close the torque balance")
    balancing = driving_group(names)
    known = known if known is not None and known.window == window else KnownGroups()
    return tuple(_measured(columns, run, crane, name, name == balancing, window, known) for name in names)


def _measured(
    columns: Mapping[str, FloatArray], run: Run, crane: Crane, name: str, balances: bool, window: int,
    known: KnownGroups,
) -> GroupSignals:  # fmt: skip
    for channel in GROUP_CHANNELS:
        if f"{name}.{channel}" not in columns:
            raise InputError(f"{run.name}: column '{name}.{channel}' is missing or empty; the torque balance needs it")
    a, b = columns[f"{name}.pressure_a"], columns[f"{name}.pressure_b"]
    fed_back = columns[f"{name}.displacement"]
    stroked = known.of(name, columns, ("displacement",))
    displacement = stroked.displacement if stroked else _set_to(fed_back, window)
    if float(np.median(displacement)) < MIN_DISPLACEMENT_SHARE * crane.max_displacement and balances:
        raise InputError(f"{run.name}: '{name}.displacement' is nearly zero; its pressure cannot carry the load")
    if pressed := known.of(name, columns, ("pressure_a", "pressure_b")):
        return replace(pressed, count=crane.motor_count(name), displacement=displacement, balances=balances)
    drop, total, low = (smooth(each, 2 * window) for each in (a - b, a + b, np.minimum(a, b)))
    digit = max(digit_of(run[f"{name}.{port}"]) for port in ("pressure_a", "pressure_b"))
    return GroupSignals(name, crane.motor_count(name), drop, total, low, displacement, balances, drop, digit)


def _set_to(fed_back: FloatArray, window: int) -> FloatArray:
    """What the motors are set to, by its feedback."""
    displacement = smooth_between_steps(fed_back, window, 5 * window)
    if np.std(displacement) <= noise_level(fed_back):  # the feedback's noise alone: the motors are set and stay
        return np.full(len(displacement), float(np.median(displacement)))
    return displacement


def drive_torque(columns: Mapping[str, FloatArray], groups: Groups) -> FloatArray:
    """Measured torque of all motors at the shaft, N m, from the pressures as they were logged."""
    drops = (columns[f"{g.name}.pressure_a"] - columns[f"{g.name}.pressure_b"] for g in groups)
    return np.asarray(hydraulic_torque((g.count, g.displacement, d) for g, d in zip(groups, drops, strict=True)))
