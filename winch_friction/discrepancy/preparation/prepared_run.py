"""A measured run as the candidates read it."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from winch_friction.discrepancy.preparation.seen import GroupSignals, Seen
from winch_friction.discrepancy.preparation.wire_mode import Mode
from winch_friction.physics.signals import FloatArray


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
