"""What a model is fitted to: torques at operating points, and the counting of how often a model was evaluated."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.signals import FloatArray


@dataclass(frozen=True)
class FitData:
    """Measured friction torques per motor and the operating points at which a model must explain them.

    `points` is an operating point over arrays of length `copies * n`, with direction +1: an observation is the mean
    over its copies (hoisting and lowering: two), divided by the motors on the shaft. `torque` (n,) N m per motor;
    `weight` (n,) multiplies squared errors; `group` (n,) is held out together (displacement, test), `cluster` (n,) or
    (n, m) what shares errors, in m ways (the displacement, the pressure; a test).
    """

    name: str
    points: tuple[Any, ...]
    torque: FloatArray
    weight: FloatArray
    group: Any
    cluster: Any
    copies: int = 1
    motors: float = 1.0

    def __post_init__(self) -> None:
        if not len(self.torque) == len(self.weight) == len(self.group) == len(self.cluster):
            raise InputError(f"{self.name}: torque, weight, group and cluster must have one entry per observation")

    def __len__(self) -> int:
        return len(self.torque)

    def where(self, keep: FloatArray) -> "FitData":
        """The observations of a mask (n,)."""
        kept = np.asarray(keep, bool)
        mask = np.tile(kept, self.copies)
        points = tuple(np.broadcast_to(column, mask.shape)[mask] for column in self.points)
        columns = {name: np.asarray(getattr(self, name))[kept] for name in ("torque", "weight", "group", "cluster")}
        return replace(self, points=points, **columns)

    def without(self, locked: FrictionModel | None) -> "FitData":
        """What is left to explain when a locked part of the friction is subtracted (paper 2 eq 7)."""
        return self if locked is None else replace(self, torque=self.torque - modelled(locked, self))

    def per_observation(self, torque_at_points: Any) -> FloatArray:
        """Shaft torque at the points -> torque per motor and observation; the first axis is the points'."""
        values = np.asarray(torque_at_points, float)
        if values.ndim == 0:
            return np.full(len(self), float(values) / self.motors)
        return values.reshape(self.copies, len(self), *values.shape[1:]).mean(axis=0) / self.motors


class CountedModel:
    """A model on one data set that counts its evaluations: one per torque vector, one per column of a Jacobian."""

    def __init__(self, model: FrictionModel, data: FitData) -> None:
        self.model = model
        self.data = data
        self.evaluations = 0

    def torque(self, values: Sequence[float]) -> FloatArray:
        """Modelled torque per observation (n,), N m per motor."""
        self.evaluations += 1
        functions = self.model.compile(_groups(self.data.points))
        return self.data.per_observation(functions.vector_torque(self.data.points, tuple(values), ()))

    def cost(self, values: Sequence[float]) -> float:
        """Weighted squared error, sum w (T - T_model)^2."""
        error = self.data.torque - self.torque(values)
        return float(self.data.weight @ (error * error))

    def columns(self) -> FloatArray:
        """Partial derivatives by every parameter at the model's own (n, parameters), N m per motor and unit."""
        self.evaluations += len(self.model.values)
        return self.data.per_observation(self.model.jacobian(self.data.points))


def _groups(points: tuple[Any, ...]) -> int:
    return (len(points) - len(WINCH_SIGNALS)) // len(GROUP_SIGNALS)


def modelled(model: FrictionModel, data: FitData) -> FloatArray:
    """Modelled torque per observation (n,), N m per motor."""
    return data.per_observation(model.torque(data.points))


def contributions(model: FrictionModel, data: FitData) -> dict[str, FloatArray]:
    """Torque of every term per observation, N m per motor."""
    return {name: data.per_observation(part) for name, part in model.contributions(data.points).items()}
