"""A measured run as the candidates read it, and a user's own simulation in place of the built-in model.

The gap is then measured minus simulated. The friction model that is given along still says how its parameters and the
candidates act, and what is added to it is what the simulation lacks.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, uniform
from winch_friction.discrepancy.preparation.seen import GroupSignals, Seen
from winch_friction.discrepancy.preparation.wire_mode import Mode
from winch_friction.physics.corrections import corrected
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane


@dataclass(frozen=True)
class PreparedRun:
    """A run on a uniform grid; SI. `gap` is measured minus predicted drive torque at the shaft in N m."""

    name: str
    start: float  # absolute time of the first sample, s
    dt: float
    time: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    angle: FloatArray
    load: FloatArray
    tension_measured: bool  # the load is a measured force, which has its mass's inertia in it
    load_acceleration: FloatArray
    radius: FloatArray
    drum_torque: FloatArray
    groups: tuple[GroupSignals, ...]
    point: tuple[Any, ...]
    gap: FloatArray
    wire_mode: Mode  # of the load on its wire
    swing_left: tuple[float, ...]  # share of what may swing that a swing of each damping ratio would leave
    swing_noise: bool  # whether what swings in the load's acceleration is in the sensors alone
    swing_variance: float  # of what may swing, in the gap's unit squared; 0 where the mode was given
    load_friction: FloatArray  # friction torque per relative change of the drum torque, N m
    predicted: FloatArray  # drive torque of the base model, N m
    from_speed: FloatArray  # what of it the shaft's speed tells, N m: all but the acceleration of the heaving crane
    jacobian: FloatArray
    corrections: FloatArray  # change of the gap in N m per unit of each correction of the model, (samples, corrections)
    gear_ratio: float
    inertia: float
    constants: tuple[tuple[str, float], ...]  # for the candidates' equations
    unit_torque: float  # N m per bar of the balancing group (1 for an electric drive)
    used: np.ndarray  # samples of the regime: moving, or just reversed
    spikes: np.ndarray
    present: frozenset[str]  # columns that the file had; `hook_load` also where a measured force stands for it
    channels: Mapping[str, FloatArray]  # what a gap may depend on, for locating it
    seen: Seen | None = None  # for preparing the same run once more; None where nobody will

    @property
    def mode(self) -> tuple[str, ...]:
        """Names of the motor groups: which kind of run this is."""
        return tuple(group.name for group in self.groups)

    def sharing(self, other: "PreparedRun") -> "PreparedRun":
        """The same run, with the arrays of another that hold the same to the bit: most do not depend on the model, and
        an hour of all of them is 90 MB."""
        return replace(self, **{each.name: _shared(getattr(self, each.name), getattr(other, each.name))
                                for each in fields(self)})  # fmt: skip


def _shared(own: Any, other: Any) -> Any:
    if isinstance(own, np.ndarray):
        return other if _same(own, other) else own
    if type(own) is tuple and isinstance(other, tuple) and len(own) == len(other):
        return tuple(map(_shared, own, other))
    if isinstance(own, Mapping) and isinstance(other, Mapping):
        return {name: _shared(value, other.get(name)) for name, value in own.items()}
    if isinstance(own, GroupSignals) and isinstance(other, GroupSignals):
        return replace(own, **{f.name: _shared(getattr(own, f.name), getattr(other, f.name)) for f in fields(own)})
    return own


def _same(own: np.ndarray, other: Any) -> bool:
    """Whether two arrays are the same to the bit, NaN and the sign of zero included."""
    alike = isinstance(other, np.ndarray) and (own.shape, own.dtype) == (other.shape, other.dtype)
    return alike and own.tobytes() == other.tobytes()


# -- a user's own simulation
REFERENCE = "simulation_stands_for"  # key of a run's metadata: the `Stood` of its simulation
DROP, TORQUE, FORCE = "pressure_drop_simulated", "motor_torque_simulated", "rope_force_simulated"
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
