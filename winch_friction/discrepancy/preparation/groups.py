"""Motor groups along a run. Regressors are never built from the noisy pressure that is being explained: the pressure of
the group that closes the torque balance is predicted, only the passive group's is measured, smoothed.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from winch_friction.discrepancy.preparation.prepared_run import GroupSignals
from winch_friction.discrepancy.preparation.smoothing import smooth
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.torque_balance import hydraulic_torque

MIN_DISPLACEMENT_SHARE = 0.05
BALANCING = ("active", "main")  # the groups that close the balance where they run
CHANNELS = ("pressure_a", "pressure_b", "displacement")

Groups = tuple[GroupSignals, ...]


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
    displacement = smooth(columns[f"{name}.displacement"], 5 * window)
    steady = float(np.median(displacement))
    if np.std(displacement) <= 0.02 * steady:
        displacement = np.full(len(displacement), steady)
    if steady < MIN_DISPLACEMENT_SHARE * crane.max_displacement and balances:
        raise InputError(f"{run.name}: '{name}.displacement' is nearly zero; its pressure cannot carry the load")
    drop, total, low = (smooth(each, 2 * window) for each in (a - b, a + b, np.minimum(a, b)))
    return GroupSignals(name, crane.motor_count(name), drop, total, low, displacement, balances, drop)


def drive_torque(columns: Mapping[str, FloatArray], groups: Groups) -> FloatArray:
    """Measured torque of all motors at the shaft, N m, from the pressures as they were logged."""
    drops = (columns[f"{g.name}.pressure_a"] - columns[f"{g.name}.pressure_b"] for g in groups)
    return np.asarray(hydraulic_torque((g.count, g.displacement, d) for g, d in zip(groups, drops, strict=True)))


def corrected(groups: Groups, error: FloatArray | float) -> Groups:
    """Groups whose passive pressures are rid of an error that amounts to a torque (N m) at the shaft."""
    passive = sum(g.count * g.displacement for g in groups if not g.balances)
    return tuple(g if g.balances else replace(g, pressure=g.pressure - error / passive) for g in groups)


def with_predicted_pressure(groups: Groups, torque: FloatArray) -> Groups:
    """Groups of which the balancing one has the pressure that a drive torque (N m) at the shaft takes."""
    rest = torque - hydraulic_torque((g.count, g.displacement, g.pressure) for g in groups if not g.balances)
    return tuple(_loaded(g, rest) if g.balances else g for g in groups)


def _loaded(group: GroupSignals, torque: FloatArray) -> GroupSignals:
    pressure = torque / (group.count * np.maximum(group.displacement, 1e-9))
    return replace(group, pressure=pressure, pressure_sum=np.abs(pressure) + 2.0 * group.low_pressure)
