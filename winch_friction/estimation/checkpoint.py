"""An estimator's state as plain types: what a checkpoint file carries, and its check when it comes back."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

VERSION = 5


@dataclass(frozen=True)
class Kept:
    """What is kept: state (n, 1), covariance (n, n), sensitivity to the considered sensor errors (errors, n), mass in
    kg (NaN: none), the parameters' status levels, and the names of those whose sigma was taken back."""

    x: FloatArray
    covariance: FloatArray
    sensitivity: FloatArray
    mass: float
    levels: Sequence[str]
    widened: Sequence[str]


def filter_state(crane: Crane, seed: FrictionModel, kept: Kept) -> dict[str, Any]:
    """The state as lists, floats and strings, with the crane and the seed that it belongs to."""
    return {
        "version": VERSION,
        **_key(crane, seed),
        "state": kept.x[:, 0].tolist(),
        "covariance": kept.covariance.tolist(),
        "sensitivity": kept.sensitivity.tolist(),
        "mass": float(kept.mass) if np.isfinite(kept.mass) else None,
        "levels": list(kept.levels),
        "widened": list(kept.widened),
    }


def restored_state(content: Mapping[str, Any], crane: Crane, seed: FrictionModel, size: int, sensors: int) -> Kept:
    """What was kept, for a filter of `size` states that considers `sensors` errors.

    Raises `InputError` for another version, crane or seed, and for numbers that are not a state and its covariance.
    """
    for name, expected in {"version": VERSION, **_key(crane, seed)}.items():
        if content.get(name) != expected:
            raise InputError(f"checkpoint: {name} is {content.get(name)!r}, but this estimator has {expected!r}")
    try:
        x = np.array(content["state"], float).reshape(size, 1)
        covariance = np.array(content["covariance"], float).reshape(size, size)
        sensitivity = np.array(content["sensitivity"], float).reshape(sensors, size)
        mass = float("nan") if content["mass"] is None else float(content["mass"])
        levels, widened = ([str(each) for each in content[key]] for key in ("levels", "widened"))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"checkpoint: damaged ({error})") from error
    sound = _sound(x, covariance) and bool(np.isfinite(sensitivity).all()) and not mass < 0.0 and abs(mass) != np.inf
    if not sound or len(levels) != len(seed.values) or not set(widened) <= set(seed.parameter_names):
        raise InputError("checkpoint: state and covariance are not those of a filter")
    return Kept(x, 0.5 * (covariance + covariance.T), sensitivity, mass, levels, widened)


def _key(crane: Crane, seed: FrictionModel) -> dict[str, Any]:
    """What the state means: what was learned with another gear, drum or prior would be wrong friction, surely known."""
    machine = {
        "crane": crane.name, "drive": crane.drive.kind, "gear_ratio": crane.gear_ratio, "inertia": crane.inertia,
        "layer_radii": list(crane.drum.layer_radii), "groups": dict(crane.groups),
        "max_displacement": crane.max_displacement,
    }  # fmt: skip
    prior = {"terms": list(seed.term_names), "seed_values": list(seed.values), "seed_std": seed.std.tolist()}
    return {**machine, "seed": seed.name, **prior}


def _sound(x: FloatArray, covariance: FloatArray) -> bool:
    if not (np.isfinite(x).all() and np.isfinite(covariance).all()):
        return False
    scale = np.sqrt(np.clip(np.diag(covariance), 1e-300, None))
    return bool(np.linalg.eigvalsh(0.5 * (covariance + covariance.T) / np.outer(scale, scale)).min() > -1e-6)
