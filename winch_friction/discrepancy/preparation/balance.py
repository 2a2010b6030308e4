"""The torque balance at the motor shaft: what was measured and what the base model predicts."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid
from winch_friction.discrepancy.preparation.groups import (
    Groups,
    corrected,
    drive_torque,
    measured_groups,
    with_predicted_pressure,
)
from winch_friction.discrepancy.preparation.motion import Motion
from winch_friction.discrepancy.preparation.smoothing import smooth
from winch_friction.discrepancy.preparation.suspended_load import SuspendedLoad
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.units import BAR
from winch_friction.physics.winch import Crane, operating_point

FIXED_POINT_STEPS = 3
OPTIONAL = ("oil_temperature", "wire_layer", "wire_out")


@dataclass(frozen=True)
class Found:
    """What effects found so far add along a run, N m at the shaft: load on the motors, and what the passive side's
    signals have too much.
    """

    missing_torque: FloatArray | float = 0.0
    passive_error: FloatArray | float = 0.0


@dataclass(frozen=True)
class Balance:
    """Measured and predicted drive torque N m, groups with predicted pressures, operating point, Jacobian."""

    measured: FloatArray
    predicted: FloatArray
    groups: Groups
    point: tuple[Any, ...]
    jacobian: FloatArray
    unit_torque: float  # N m per bar of the balancing group; per N m of a motor for an electric drive

    @property
    def gap(self) -> FloatArray:
        """Measured minus predicted, N m."""
        return self.measured - self.predicted


@dataclass(frozen=True)
class Balancing:
    """One run with its model, ready to be balanced for any load acceleration."""

    run: Run
    crane: Crane
    model: FrictionModel
    grid: Grid
    motion: Motion
    found: Found

    def of(self, load: SuspendedLoad) -> Balance:
        """The balance with this load; raises `InputError` where the run lacks what closes it."""
        inertial = self.crane.inertia * self.motion.acceleration + load.inertial_torque
        frictionless = load.drum_torque / self.crane.gear_ratio + inertial
        if self.crane.electric:
            return self._electric(load, frictionless)
        return self._hydraulic(load, frictionless)

    def _electric(self, load: SuspendedLoad, frictionless: FloatArray) -> Balance:
        if "motor_torque" not in self.grid.columns:
            raise InputError(f"{self.run.name}: column 'motor_torque' is missing; an electric drive needs it")
        total = self.crane.motor_total(())
        point = self._point(load, ())
        predicted = frictionless + self.model.torque(point)
        measured = self._smoothed(self.grid.columns["motor_torque"] * total)
        return Balance(measured, predicted, (), point, self.model.jacobian(point), float(total))

    def _hydraulic(self, load: SuspendedLoad, frictionless: FloatArray) -> Balance:
        groups, measured = self._measured
        groups = corrected(groups, self.found.passive_error)
        predicted = frictionless
        for _ in range(FIXED_POINT_STEPS):
            groups = with_predicted_pressure(groups, predicted + self.found.missing_torque)
            point = self._point(load, groups)
            predicted = frictionless + self.model.torque(point)
        own = next(g for g in groups if g.balances)
        unit = BAR * own.count * float(np.median(own.displacement))
        return Balance(measured, predicted, groups, point, self.model.jacobian(point), unit)

    @cached_property
    def _measured(self) -> tuple[Groups, FloatArray]:
        """Groups with their measured pressures and the drive torque that these make, whatever the load does."""
        groups = measured_groups(self.grid.columns, self.run, self.crane, self.motion.window)
        return groups, self._smoothed(drive_torque(self.grid.columns, groups))

    def _smoothed(self, torque: FloatArray) -> FloatArray:
        """With the acceleration's kernel: what that takes out of one side must not stay in the other."""
        return smooth(torque, self.motion.window)

    def _point(self, load: SuspendedLoad, groups: Groups) -> tuple[Any, ...]:
        columns, motion = self.grid.columns, self.motion
        size = len(self.grid.time)
        optional = {name: columns[name] for name in OPTIONAL if name in columns}
        signals = [(np.full(size, float(g.count)), np.abs(g.pressure), g.pressure_sum, g.displacement) for g in groups]
        return operating_point(
            direction=motion.direction, speed=motion.state_speed, drum_torque=load.drum_torque,
            acceleration=motion.acceleration, groups=signals,
            motor_total=np.full(size, float(self.crane.motor_total(self.run.groups))),
            time=self.grid.time + self.run.time[0], shaft_angle=motion.angle, **optional,
        )  # fmt: skip
