"""A user's own simulation in place of the built-in model.

The gap is then measured minus simulated. The friction model that is given along still says how its parameters and the
candidates act, and what is added to it is what the simulation lacks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, uniform
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.physics.corrections import corrected
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

REFERENCE = "simulation_stands_for"  # key of a run's metadata: the `Stood` of its simulation
DROP, TORQUE, FORCE = "pressure_drop_simulated", "motor_torque_simulated", "rope_force_simulated"
SIMULATED = (DROP, TORQUE, FORCE)  # how the name of such a column ends
MEASURED = {TORQUE: "motor_torque", FORCE: "rope_force"}


@dataclass(frozen=True)
class Stood:
    """What a user's simulation stands for: a model with the log and the crane file as the simulation knew them.

    A correction that is found later changes what is right for the winch, and not what was simulated.
    """

    model: FrictionModel
    run: Run
    crane: Crane

    @cached_property
    def grid(self) -> Grid:
        """The log on its uniform grid."""
        return uniform(self.run)


def simulated_column(run: Run) -> str:
    """The column that a user's simulation has filled, '' without one."""
    names = [name for name in run.columns if name in MEASURED or name.rpartition(".")[2] == DROP]
    return names[0] if names else ""


def against_simulations(runs: Sequence[Run], model: FrictionModel, crane: Crane) -> list[Run]:
    """The runs, told which model stands for their simulation where they have one.

    Raises `InputError` when some runs have a simulated column and others not: their gaps are not of one kind.
    """
    without = [run.name for run in runs if not simulated_column(run)]
    if not without:
        known = [Stood(model, *corrected(run, crane, model)) for run in runs]
        return [replace(r, metadata={**r.metadata, REFERENCE: each}) for r, each in zip(runs, known, strict=True)]
    if len(without) < len(runs):
        raise InputError(
            f"{without[0]} has no simulated column though other runs have one; give it to all runs or to none "
            f"(<group>.{DROP}, {TORQUE} or {FORCE})"
        )
    return list(runs)


def simulated_error(
    columns: Mapping[str, FloatArray], run: Run, groups: Sequence[GroupSignals], crane: Crane, radius: FloatArray
) -> FloatArray:
    """Measured minus simulated torque of the drive at the shaft, N m.

    A simulated rope force that is too large means a drive torque that was too small. Raises `InputError` where the
    measurement beside the simulated column is missing.
    """
    name = simulated_column(run)
    if name in MEASURED and MEASURED[name] not in columns:
        raise InputError(f"{run.name}: column '{name}' needs '{MEASURED[name]}' beside it, which is missing or empty")
    if name == TORQUE:
        return np.asarray((columns["motor_torque"] - columns[TORQUE]) * crane.motor_total(()))
    if name == FORCE:
        return np.asarray((columns[FORCE] - columns["rope_force"]) * radius / crane.gear_ratio)
    simulated = [(each, columns[f"{each.name}.{DROP}"]) for each in groups if f"{each.name}.{DROP}" in columns]
    if not simulated:
        raise InputError(f"{run.name}: column '{name}' is of no motor group that the run has")
    return np.asarray(sum(_drop_error(columns, group, drop) for group, drop in simulated))


def displacement_error(
    columns: Mapping[str, FloatArray], groups: Sequence[GroupSignals], known: Sequence[GroupSignals]
) -> FloatArray | float:
    """What a simulated drop means as torque with the right displacements, less with those that the simulation knew."""
    pairs = [(g, k, columns.get(f"{g.name}.{DROP}")) for g, k in zip(groups, known, strict=True)]
    return sum((g.count * (g.displacement - k.displacement) * drop for g, k, drop in pairs if drop is not None), 0.0)


def _drop_error(columns: Mapping[str, FloatArray], group: GroupSignals, simulated: FloatArray) -> FloatArray:
    measured = columns[f"{group.name}.pressure_a"] - columns[f"{group.name}.pressure_b"]
    return np.asarray(group.count * group.displacement * (measured - simulated))
