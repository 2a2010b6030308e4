"""What a gap may depend on, for locating it: every logged signal, unknown columns included."""

from collections.abc import Mapping

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid
from winch_friction.discrepancy.preparation.groups import Groups
from winch_friction.discrepancy.preparation.motion import Motion
from winch_friction.discrepancy.preparation.suspended_load import SuspendedLoad
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

AS_LOGGED = ("oil_temperature", "wire_layer", "wire_out", "heave_velocity")


def channels_of(
    run: Run, grid: Grid, motion: Motion, load: SuspendedLoad, groups: Groups, crane: Crane
) -> Mapping[str, FloatArray]:
    """Signals over the grid by name; predicted pressures stand for the measured ones, the angle is the drum's, rad."""
    found: dict[str, FloatArray] = {"motor_speed": np.abs(motion.speed), "acceleration": motion.acceleration}
    if not crane.electric or "hook_load" in grid.columns:
        found["hook_load"] = load.mass
    for group in groups:
        found[f"{group.name}.pressure"] = group.pressure
        found[f"{group.name}.displacement"] = group.displacement
    found |= {name: grid.columns[name] for name in AS_LOGGED if name in grid.columns}
    found["shaft_angle"] = np.mod(motion.angle / crane.gear_ratio, 2.0 * np.pi)
    found["time"] = grid.time
    return found | _aside(run, grid)


def _aside(run: Run, grid: Grid) -> dict[str, FloatArray]:
    """Numeric columns that the package does not know."""
    columns = {name: np.asarray(values) for name, values in run.aside.items()}
    return {
        name: np.interp(grid.time, run.time - run.time[0], np.nan_to_num(values.astype(float)))
        for name, values in columns.items()
        if values.dtype.kind in "fiu" and len(values) == len(run)
    }
