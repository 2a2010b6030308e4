"""An estimator's state as plain types: what a checkpoint file carries, and its check when it comes back."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

VERSION = 1


def filter_state(
    crane: Crane, seed: FrictionModel, x: FloatArray, covariance: FloatArray, mass: float, levels: list[str]
) -> dict[str, Any]:
    """The state as lists, floats and strings, with the crane and the seed that it belongs to."""
    return {
        "version": VERSION,
        **_key(crane, seed),
        "state": [float(value) for value in x[:, 0]],
        "covariance": [[float(value) for value in row] for row in covariance],
        "mass": float(mass) if np.isfinite(mass) else None,
        "levels": list(levels),
    }


def restored_state(
    content: Mapping[str, Any], crane: Crane, seed: FrictionModel, size: int
) -> tuple[FloatArray, FloatArray, float, list[str]]:
    """State (n, 1), covariance (n, n), mass in kg (NaN: none) and status levels.

    Raises `InputError` for another version, crane or seed, and for numbers that are not a state and its covariance.
    """
    for name, expected in {"version": VERSION, **_key(crane, seed)}.items():
        if content.get(name) != expected:
            raise InputError(
                f"checkpoint: {name} is {content.get(name)!r}, but this estimator has {expected!r}; "
                "delete it to start over"
            )
    try:
        x = np.array(content["state"], float).reshape(size, 1)
        covariance = np.array(content["covariance"], float).reshape(size, size)
        mass = float("nan") if content["mass"] is None else float(content["mass"])
        levels = [str(level) for level in content["levels"]]
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"checkpoint: damaged ({error}); delete it to start over") from error
    if not _sound(x, covariance) or len(levels) != len(seed.values):
        raise InputError("checkpoint: state and covariance are not those of a filter; delete it to start over")
    return x, 0.5 * (covariance + covariance.T), mass, levels


def _key(crane: Crane, seed: FrictionModel) -> dict[str, Any]:
    return {"crane": crane.name, "seed": seed.name, "terms": list(seed.term_names), "seed_values": list(seed.values)}


def _sound(x: FloatArray, covariance: FloatArray) -> bool:
    if not (np.isfinite(x).all() and np.isfinite(covariance).all()):
        return False
    scale = np.sqrt(np.clip(np.diag(covariance), 1e-300, None))
    return bool(np.linalg.eigvalsh(0.5 * (covariance + covariance.T) / np.outer(scale, scale)).min() > -1e-6)
