"""A run's columns on one uniform grid of time, holes marked."""

from dataclasses import dataclass

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run

MIN_SAMPLES = 100
HOLE = 5.0  # sampling periods without a sample


@dataclass(frozen=True)
class Grid:
    """Columns over a uniform time from 0, the sampling period in s, and which samples were measured."""

    columns: dict[str, FloatArray]
    dt: float
    valid: np.ndarray

    @property
    def time(self) -> FloatArray:
        """Seconds from the first sample."""
        return self.columns["time"]


def uniform(run: Run) -> Grid:
    """The run between its samples linearly; raises `InputError` for a run that is too short or out of order."""
    time = run.time - run.time[0]
    if len(time) < MIN_SAMPLES:
        raise InputError(f"{run.name}: only {len(time)} samples; at least {MIN_SAMPLES} are needed")
    steps = np.diff(time)
    if not np.isfinite(time).all() or steps.min() <= 0.0:
        raise InputError(f"{run.name}: column 'time' is not increasing; sort or repair the file")
    dt = float(np.median(steps))
    grid = np.arange(0.0, time[-1] + 0.5 * dt, dt)
    even = len(grid) == len(time) and np.abs(grid - time).max() < 1e-3 * dt
    valid = np.ones(len(grid), bool)
    columns: dict[str, FloatArray] = {"time": grid}
    for name, values in run.columns.items():
        good = np.isfinite(values)
        if name == "time" or not good.any():
            continue
        columns[name] = values if even and good.all() else np.interp(grid, time[good], values[good])
        if not good.all():
            valid &= np.interp(grid, time, (~good).astype(float)) < 0.5
    for k in np.flatnonzero(steps > HOLE * dt):
        valid &= ~((grid > time[k]) & (grid < time[k + 1]))
    return Grid(columns, dt, valid)
