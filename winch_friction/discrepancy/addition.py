"""What a simulation lacks, as a table that any tool can interpolate: torque over the points that were run.

For a user's own simulation the repaired model is only a carrier: what has to be added over there is the repaired
model's torque minus that of the model that stood for the simulation.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.records.atomic import write_text

SPEED_BINS = 40
MOST_LEVELS = 6  # of load and displacement; more are grouped by quantiles
FEWEST = 10  # samples in a cell, below which it is left out
ALIKE = 0.03  # relative; loads and displacements closer than this are one level


def write_addition(path: Path, runs: Sequence[PreparedRun], given: FrictionModel, repaired: FrictionModel) -> Path:
    """Write the table as CSV: speed, load, displacement, samples, torque at the motor shaft to add to the friction."""
    head = "motor_speed [rpm],hook_load [t],displacement [cm^3/rev],samples [1],torque_to_add [N*m]"
    rows = [",".join(f"{value:.6g}" for value in row) for row in addition_table(runs, given, repaired)]
    return write_text(path, "\n".join([head, *rows]) + "\n")


def addition_table(
    runs: Sequence[PreparedRun], given: FrictionModel, repaired: FrictionModel
) -> list[tuple[float, float, float, float, float]]:
    """Rows (rpm, t, cm^3/rev, samples, N m) over the cells that the runs' moving samples fill."""
    parts = [_samples(run, given, repaired) for run in runs]
    speed, load, displacement, torque = (np.concatenate(each) for each in zip(*parts, strict=True))
    top = float(np.abs(speed).max())
    cell = np.clip(((speed + top) / (2.0 * top) * SPEED_BINS).astype(int), 0, SPEED_BINS - 1)
    keys = np.column_stack([_levels(displacement), _levels(load), cell])
    rows = []
    for key in np.unique(keys, axis=0):
        own = (keys == key).all(axis=1)
        if own.sum() >= FEWEST:
            means = (float(each[own].mean()) for each in (speed, load, displacement, torque))
            rpm, tonnes, swept, add = next(means) / RPM, next(means) / 1e3, next(means) / CM3_PER_REV, next(means)
            rows.append((rpm, tonnes, swept, float(own.sum()), add))
    return rows


def _samples(
    run: PreparedRun, given: FrictionModel, repaired: FrictionModel
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Speed rad/s, load kg, displacement m^3/rad of the driving group and the torque to add, of moving samples."""
    size = len(run.time)
    add = np.broadcast_to(repaired.torque(run.point), (size,)) - np.broadcast_to(given.torque(run.point), (size,))
    own = next((group.displacement for group in run.groups if group.balances), np.zeros(size))
    return run.speed[run.used], run.load[run.used], own[run.used], add[run.used]


def _levels(values: FloatArray) -> np.ndarray:
    """Index of the level of each value: values that are alike are one level."""
    order = np.sort(values)
    borders = order[1:][np.diff(order) > ALIKE * max(float(np.abs(order).max()), 1e-12)]
    if len(borders) >= MOST_LEVELS:
        borders = np.quantile(values, np.linspace(0.0, 1.0, MOST_LEVELS + 1)[1:-1])
    return np.searchsorted(borders, values, side="right")
