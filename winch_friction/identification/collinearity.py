"""Directions in parameter space that the data at hand cannot tell apart (docs/physics.md §3): found, and said."""

from dataclasses import dataclass

import numpy as np

from winch_friction.identification.friction_curve import winch_points
from winch_friction.identification.joint_fit import JointFit, Observations
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray

_TIED = 0.99  # cosine between two columns of the Jacobian
_NAMED = 0.3  # components smaller than this are left out of a direction's name


@dataclass(frozen=True)
class Direction:
    """One direction that the data say less about than the spread between units does.

    `components` by parameter in units of that spread, unit length; `seen` is the ratio of what the data determine to
    that spread (0: nothing, 1: as much).
    """

    components: dict[str, float]
    seen: float

    def __str__(self) -> str:
        """The large components, e.g. 0.71 K1 - 0.70 C5."""
        named = [(name, value) for name, value in self.components.items() if abs(value) >= _NAMED]
        return " ".join(f"{'+' if value > 0 else '-'} {abs(value):.2f} {name}" for name, value in named).lstrip("+ ")


@dataclass(frozen=True)
class Tie:
    """Two parameters whose effects on the data are parallel to within `cosine`."""

    first: str
    second: str
    cosine: float


def unseen_directions(result: JointFit) -> list[Direction]:
    """Eigenvectors of the data's information that are below 1 in units of the unit spread, least seen first."""
    values, vectors = np.linalg.eigh(result.information)
    names = result.model.parameter_names
    return [
        Direction(dict(zip(names, _signed(vector).tolist(), strict=True)), float(np.sqrt(max(value, 0.0))))
        for value, vector in zip(values, vectors.T, strict=True)
        if value < 1.0
    ]


def _signed(vector: FloatArray) -> FloatArray:
    return vector * np.sign(vector[np.abs(vector).argmax()])


def ties(model: FrictionModel, data: Observations) -> list[Tie]:
    """Pairs of parameters that act alike at the plateaus, most alike first."""
    points = winch_points(data.speed, data.drop, data.displacement, data.drum_torque, data.motors)
    columns = model.jacobian(points)
    lengths = np.linalg.norm(columns, axis=0)
    unit = columns / np.where(lengths > 0.0, lengths, 1.0)
    cosines = unit.T @ unit
    names = model.parameter_names
    found = [
        Tie(names[j], names[k], float(cosines[j, k]))
        for j in range(len(names))
        for k in range(j + 1, len(names))
        if abs(cosines[j, k]) > _TIED
    ]
    return sorted(found, key=lambda tie: -abs(tie.cosine))


def identifiable(model: FrictionModel, gear_ratio: float, motors: int) -> dict[str, FloatArray]:
    """What normal-mode tests do determine, as coefficients (n,) over the parameters: tied ones summed."""
    names = model.parameter_names
    sums = {
        "K1 + C5": {"K1": 1.0, "C5": 1.0},
        "K4 + C2": {"K4": 1.0, "C2": 1.0},
        "C6 + K3/(i N)": {"C6": 1.0, "K3": 1.0 / (gear_ratio * motors)},
        **{name: {name: 1.0} for name in ("K2", "K5", "C1", "C3", "C4")},
    }
    return {title: np.array([parts.get(name, 0.0) for name in names]) for title, parts in sums.items()}
