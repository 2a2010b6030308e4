"""Does the motor's speed agree with the rope's, as gear and drum join them? It tells sign, unit and gear."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

_CORRELATED = 0.9  # below it the two do not move together, and the ratio means nothing
_FEWEST = 50  # samples


@dataclass(frozen=True)
class Ratio:
    """Logged motion of the rope over the motor's: 1 when unit, sign, gear and drum are right; `by` the channel."""

    value: float
    by: str


def rope_over_motor(columns: Mapping[str, FloatArray], crane: Crane) -> Ratio | None:
    """The ratio from the wire paid out, else from the heave that the winch follows; None when the log does not tell."""
    if "motor_speed" not in columns or "time" not in columns:
        return None
    hoisted = columns["motor_speed"] * crane.drum.layer_radii[-1] / crane.gear_ratio  # m/s, rope coming in
    time = columns["time"] - columns["time"][0]
    if "wire_out" in columns and np.isfinite(columns["wire_out"]).sum() > _FEWEST:
        steps = np.where(np.isfinite(hoisted), hoisted, 0.0)[1:] * np.maximum(np.diff(np.nan_to_num(time)), 0.0)
        coming_in = np.concatenate([[0.0], np.cumsum(steps)])
        found = _slope(coming_in, -columns["wire_out"])
        if found is not None:
            return Ratio(found, "wire_out")
    if "heave_velocity" in columns:
        found = _slope(hoisted, -columns["heave_velocity"])  # crane tip up: the winch pays out
        if found is not None:
            return Ratio(found, "heave_velocity")
    return None


def _slope(x: FloatArray, y: FloatArray) -> float | None:
    usable = np.isfinite(x) & np.isfinite(y)
    if usable.sum() < _FEWEST or np.std(x[usable]) == 0.0 or np.std(y[usable]) == 0.0:
        return None
    a, b = x[usable] - np.mean(x[usable]), y[usable] - np.mean(y[usable])
    correlation = float(np.dot(a, b) / np.sqrt(np.dot(a, a) * np.dot(b, b)))
    return (
        float(np.sqrt(np.dot(b, b) / np.dot(a, a)) * np.sign(correlation)) if abs(correlation) > _CORRELATED else None
    )
