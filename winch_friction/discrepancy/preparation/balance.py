"""The torque balance at the motor shaft: what was measured and what the base model predicts.

Regressors are never built from the noisy pressure that is being explained: the pressure of the group that closes the
balance is predicted, only the passive group's is measured, smoothed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, dilated
from winch_friction.discrepancy.preparation.motors import Groups, GroupSignals
from winch_friction.discrepancy.preparation.own_simulation import REFERENCE, Stood, displacement_error, simulated_error
from winch_friction.discrepancy.preparation.seen import SPARSE, Motion, Seen
from winch_friction.discrepancy.preparation.suspended_load import SuspendedLoad, load_of
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane, group_point, group_roles, operating_point
from winch_friction.physics.winch.crane import hydraulic_torque
from winch_friction.physics.winch.operating_point import TELLING_STROKE

MOST_OF_STROKE = 0.5  # of a displacement, that an error may be of it: far more than any feedback is off
SPARSEST = 0.055  # s; up to such a period a sea of four seconds and more still shows its acceleration to half a percent
# least noises to which a slower log is followed, and so what it closes to at best: a step of a 12-bit transducer
SHOWS = 1.5
FIXED_POINT_STEPS = 3  # the next ones change the predicted pressure by a millibar at most (16 runs of four winches)
OPTIONAL = ("oil_temperature", "wire_layer", "wire_out")


def without_error(groups: Groups, error: FloatArray | float, of_stroke: FloatArray | float = 0.0) -> Groups:
    """Groups whose passive pressures are rid of an error that amounts to a torque (N m) at the shaft, and whose passive
    displacements are rid of one (`of_stroke`): the motors' own friction tells the two apart."""
    passive = sum(g.count * g.displacement for g in groups if not g.balances)
    torque = hydraulic_torque((g.count, g.displacement, g.pressure) for g in groups if not g.balances)
    share = np.clip(of_stroke / np.where(np.abs(torque) > 0.0, torque, np.inf), -MOST_OF_STROKE, MOST_OF_STROKE)
    return tuple(
        g
        if g.balances
        else replace(g, pressure=g.pressure - error / passive, displacement=g.displacement * (1.0 - share))
        for g in groups
    )


def with_predicted_pressure(groups: Groups, torque: FloatArray, least_stroke: float = 0.0) -> Groups:
    """Groups of which the balancing one has the pressure that a drive torque (N m) at the shaft takes; where its
    motors are swung below the `least_stroke` (m^3/rad), or past centre, the one that was measured."""
    rest = torque - hydraulic_torque((g.count, g.displacement, g.pressure) for g in groups if not g.balances)
    return tuple(_loaded(g, rest, least_stroke) if g.balances else g for g in groups)


def _loaded(group: GroupSignals, torque: FloatArray, least_stroke: float) -> GroupSignals:
    needed = torque / (group.count * np.maximum(group.displacement, 1e-9))
    pressure = np.where(group.displacement < least_stroke, group.logged, needed)
    return replace(group, pressure=pressure, pressure_sum=np.abs(pressure) + 2.0 * group.low_pressure)


def _filled(values: FloatArray) -> FloatArray:
    """Straight lines over what is not known."""
    good = np.isfinite(values)
    samples = np.arange(len(values))
    return np.interp(samples, samples[good], values[good]) if good.any() else np.zeros(len(values))


@dataclass(frozen=True)
class Accounted:
    """What effects found so far add along a run, N m at the shaft: load on the motors, and what the passive side's
    pressures and its displacements have too much.
    """

    missing_torque: FloatArray | float = 0.0
    passive_error: FloatArray | float = 0.0
    passive_stroke_error: FloatArray | float = 0.0


@dataclass(frozen=True)
class Balance:
    """Measured and predicted drive torque N m, groups with predicted pressures, operating point."""

    measured: FloatArray
    predicted: FloatArray
    groups: Groups
    point: tuple[Any, ...]
    states: tuple[FloatArray, ...]  # of the model's terms with memory
    unit_torque: float  # N m per bar of the balancing group; per N m of a motor for an electric drive
    simulated: FloatArray | None = None  # the drive torque of a user's simulation

    @property
    def simulated_torque(self) -> FloatArray:
        """Drive torque of what is compared with, N m: the user's simulation, else the model."""
        return self.predicted if self.simulated is None else self.simulated

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
    seen: Seen
    accounted: Accounted

    @property
    def grid(self) -> Grid:
        """The run's columns on a uniform time."""
        return self.seen.grid

    @property
    def motion(self) -> Motion:
        """How the shaft moves."""
        return self.seen.motion

    def of(self, load: SuspendedLoad) -> Balance:
        """The balance with this load; raises `InputError` where the run lacks what closes it."""
        balance = self._modelled(load)
        known: Stood | None = self.run.metadata.get(REFERENCE)
        if known is None:
            return balance
        # a user's simulation stands where the reference model stood: what it is off by is the gap
        stood = balance if known.model is self.model else self._as_simulated(known, load)
        error = simulated_error(self.grid.columns, self.run, balance.groups, self.crane, load.radius)
        error = error + displacement_error(self.grid.columns, balance.groups, stood.groups)
        off = self.seen.smoothed(error)
        return replace(balance, measured=stood.predicted + off, simulated=balance.measured - off)

    def _as_simulated(self, known: Stood, load: SuspendedLoad) -> Balance:
        """By the model that the simulation stands for, with load, displacement, radius and inertia that it knew."""
        if len(known.grid.time) != len(self.grid.time):  # a delay was taken out and has shortened the run
            return replace(self, model=known.model)._modelled(load)
        told = load_of(known.grid, self.motion, known.crane, float(np.median(load.mass)))
        moved = load.acceleration + (told.lever - load.lever) * self.motion.acceleration
        hung = told if told.tension_measured else replace(told, acceleration=moved, heave=load.heave)
        seen = Seen(known.run, known.crane, self.seen.turning, known.grid, self.motion)
        return replace(self, run=known.run, crane=known.crane, model=known.model, seen=seen)._modelled(hung)

    def _modelled(self, load: SuspendedLoad) -> Balance:
        inertial = self.crane.inertia * self.motion.acceleration + load.inertial_torque
        frictionless = load.drum_torque / self.crane.gear_ratio + inertial
        if not self.crane.drive.hydraulic:
            return self._electric(load, frictionless)
        return self._hydraulic(load, frictionless)

    def _electric(self, load: SuspendedLoad, frictionless: FloatArray) -> Balance:
        total = self.crane.motor_total(())
        point = self._point(load, ())
        states = self._states(point, 0)
        predicted = frictionless + self.model.torque(point, states)
        measured = self.seen.smoothed(_filled(self._logged_torque))
        return Balance(measured, predicted, (), point, states, float(total))

    def _hydraulic(self, load: SuspendedLoad, frictionless: FloatArray) -> Balance:
        groups, measured = self.seen.measured
        groups = without_error(groups, self.accounted.passive_error, self.accounted.passive_stroke_error)
        predicted, least_stroke = frictionless, TELLING_STROKE * self.crane.max_displacement
        for _ in range(FIXED_POINT_STEPS):
            groups = with_predicted_pressure(groups, predicted + self.accounted.missing_torque, least_stroke)
            point = self._point(load, groups)
            states = self._states(point, len(groups))
            predicted = frictionless + self.model.torque(point, states)
        own = next(g for g in groups if g.balances)
        unit = BAR * own.count * float(np.median(own.displacement))
        return Balance(measured, predicted, groups, point, states, unit)

    @cached_property
    def _logged_torque(self) -> FloatArray:
        """Torque of all motors of a drive without pressures, N m; NaN where it is not known, as of a power at rest."""
        return np.asarray(self.crane.drive.of_run(Run(self.run.name, self.grid.columns), self.crane), float)

    @cached_property
    def known(self) -> np.ndarray:
        """Samples in which the drive's torque is known, and with it all that smoothing takes it from."""
        if self.crane.drive.hydraulic:
            return np.ones(len(self.grid.time), bool)
        sparse = int(self.grid.dt >= SPARSE)  # the mean over two periods reaches one further
        return ~dilated(~np.isfinite(self._logged_torque), self.motion.window // 2 + sparse)

    def _states(self, point: tuple[Any, ...], groups: int) -> tuple[FloatArray, ...]:
        return model_states(self.model, point, groups, self.grid.dt)

    def _point(self, load: SuspendedLoad, groups: Groups) -> tuple[Any, ...]:
        columns, motion = self.grid.columns, self.motion
        size = len(self.grid.time)
        optional = {name: columns[name] for name in OPTIONAL if name in columns}
        roles = group_roles(tuple(g.name for g in groups))
        signals = [
            group_point(np.full(size, float(g.count)), g.pressure, g.displacement, g.pressure_sum, roles[g.name])
            for g in groups
        ]
        return operating_point(
            direction=motion.direction, speed=motion.state_speed, drum_torque=load.drum_torque,
            acceleration=motion.acceleration, groups=signals,
            motor_total=np.full(size, float(self.crane.motor_total(self.run.groups))),
            time=self.grid.time + self.run.time[0], shaft_angle=motion.angle, **optional,
        )  # fmt: skip


def model_states(model: FrictionModel, point: tuple[Any, ...], groups: int, dt: float) -> tuple[FloatArray, ...]:
    """The states of a model's terms with memory along a record."""
    return state_history(model.compile(groups), point, model.values, dt)


def state_history(
    functions: CompiledTerms, point: Sequence[Any], theta: Sequence[float], dt: float
) -> tuple[FloatArray, ...]:
    """States dz/dt = gain - decay z from rest, exact for signals frozen over a step; one array per state.

    The equations of the shipped terms have rates that do not depend on the state, so one pass of a scalar recursion
    over precomputed coefficients is all it takes.
    """
    if not functions.initial_states:
        return ()
    size = np.broadcast(*point).size
    zeros = tuple(0.0 for _ in functions.initial_states)
    rates = functions.vector_state_rates(tuple(point), tuple(theta), zeros)
    out = []
    for k, initial in enumerate(functions.initial_states):
        gain, decay = (np.broadcast_to(rates[2 * k + j], size) for j in (0, 1))
        exponent = decay * dt
        keep = np.exp(-exponent)
        weight = np.where(exponent > 1e-9, -np.expm1(-exponent) / np.maximum(exponent, 1e-9), 1.0)
        out.append(_recursion(initial, keep, gain * dt * weight))
    return tuple(out)


def _recursion(z: float, keep: FloatArray, add: FloatArray) -> FloatArray:
    """z_k = keep_k z_{k-1} + add_k by doubling: after step m each entry has 2^m steps behind it."""
    reach, out = keep.copy(), add.copy()
    out[0] += keep[0] * z
    step = 1
    while step < len(out):
        out[step:] += reach[step:] * out[:-step]
        reach[step:] *= reach[:-step]
        step *= 2
    return out
