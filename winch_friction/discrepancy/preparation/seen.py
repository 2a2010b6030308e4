"""What a run tells whatever the model says: how the shaft moves, what the motors' signals make."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, noise_level, smooth, smooth_between_steps, uniform
from winch_friction.discrepancy.preparation.motion import Motion, motion_of
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.torque_balance import hydraulic_torque

SPARSE = 0.03  # s; from such a period on a central difference smears what it differentiates
MIN_DISPLACEMENT_SHARE = 0.05
BALANCING = ("active", "main")  # the groups that close the balance where they run
CHANNELS = ("pressure_a", "pressure_b", "displacement")


@dataclass(frozen=True)
class GroupSignals:
    """One motor group along a run: motors, predicted or smoothed |dp|, sum of pressures, displacement; Pa, m^3/rad."""

    name: str
    count: int
    pressure: FloatArray  # signed drop
    pressure_sum: FloatArray
    low_pressure: FloatArray
    displacement: FloatArray
    balances: bool  # closes the torque balance: its pressure is predicted
    logged: FloatArray  # signed drop as it was measured, smoothed


Groups = tuple[GroupSignals, ...]


@dataclass(frozen=True)
class Seen:
    """What a run tells whatever the model says: its grid, how the shaft moves, what the motors' signals make.

    The same run is balanced some dozen times in a search, and half of what that took was smoothing the same again.
    """

    run: Run
    crane: Crane
    turning: bool
    grid: Grid
    motion: Motion

    def is_of(self, run: Run, crane: Crane, turning: bool) -> bool:
        """Whether it is of this very run, seen in the same way on a crane whose motors and gear are the same."""
        own = (self.turning, self.crane.gear_ratio, self.crane.drive)
        return self.run is run and own == (turning, crane.gear_ratio, crane.drive)

    @cached_property
    def measured(self) -> tuple[Groups, FloatArray]:
        """Groups with their measured pressures and the drive torque that these make, whatever the load does."""
        groups = measured_groups(self.grid.columns, self.run, self.crane, self.motion.window)
        return groups, self.smoothed(drive_torque(self.grid.columns, groups))

    def smoothed(self, torque: FloatArray) -> FloatArray:
        """With the acceleration's kernel: what that takes out of one side must not stay in the other."""
        smoothed = smooth(torque, self.motion.window)
        if self.grid.dt < SPARSE:
            return smoothed
        # the acceleration is a difference over two periods: the mean over them, which the torque must be as well; by
        # Simpson's rule, for the trapezium's takes a tenth too much out of a swing of ten samples
        padded = np.pad(smoothed, 1, mode="edge")
        return np.asarray((padded[:-2] + 4.0 * padded[1:-1] + padded[2:]) / 6.0)


def see(run: Run, crane: Crane, turning: bool = False) -> Seen:
    """What a run tells whatever the model says; `turning` as in `motion_of`, whose errors it raises."""
    grid = uniform(run)
    return Seen(run, crane, turning, grid, motion_of(grid, crane, run.name, turning))


def measured_groups(columns: Mapping[str, FloatArray], run: Run, crane: Crane, window: int) -> Groups:
    """All groups with their smoothed pressures; `InputError` where one lacks a channel or has no displacement."""
    names = run.groups
    if not names:
        raise InputError(f"{run.name}: no motor group's pressures and displacement; they close the torque balance")
    balancing = next((name for name in BALANCING if name in names), names[0])
    return tuple(_measured(columns, run, crane, name, name == balancing, window) for name in names)


def _measured(
    columns: Mapping[str, FloatArray], run: Run, crane: Crane, name: str, balances: bool, window: int
) -> GroupSignals:
    for channel in CHANNELS:
        if f"{name}.{channel}" not in columns:
            raise InputError(f"{run.name}: column '{name}.{channel}' is missing or empty; the torque balance needs it")
    a, b = columns[f"{name}.pressure_a"], columns[f"{name}.pressure_b"]
    fed_back = columns[f"{name}.displacement"]
    displacement = smooth_between_steps(fed_back, window, 5 * window)
    steady = float(np.median(displacement))
    if np.std(displacement) <= noise_level(fed_back):  # the feedback's noise alone: the motors are set and stay
        displacement = np.full(len(displacement), steady)
    if steady < MIN_DISPLACEMENT_SHARE * crane.max_displacement and balances:
        raise InputError(f"{run.name}: '{name}.displacement' is nearly zero; its pressure cannot carry the load")
    drop, total, low = (smooth(each, 2 * window) for each in (a - b, a + b, np.minimum(a, b)))
    return GroupSignals(name, crane.motor_count(name), drop, total, low, displacement, balances, drop)


def drive_torque(columns: Mapping[str, FloatArray], groups: Groups) -> FloatArray:
    """Measured torque of all motors at the shaft, N m, from the pressures as they were logged."""
    drops = (columns[f"{g.name}.pressure_a"] - columns[f"{g.name}.pressure_b"] for g in groups)
    return np.asarray(hydraulic_torque((g.count, g.displacement, d) for g, d in zip(groups, drops, strict=True)))
