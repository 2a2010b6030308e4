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
    if "wire_out" in columns and np.isfinite(columns["wire_out"]).sum() > _FEWEST:
        found = _slope(_summed(columns["time"], hoisted), -columns["wire_out"])
        if found is not None:
            return Ratio(found, "wire_out")
    if "heave_velocity" in columns:
        found = _slope(hoisted, -columns["heave_velocity"])  # crane tip up: the winch pays out
        if found is not None:
            return Ratio(found, "heave_velocity")
    return None


def along_speed(columns: Mapping[str, FloatArray], name: str) -> float | None:
    """What another channel of the shaft, a command or an angle, counts per motor speed; None where they do not move
    together."""
    if not {"motor_speed", "time", name} <= set(columns):
        return None
    speed = columns["motor_speed"]
    return _slope(_summed(columns["time"], speed) if name == "shaft_angle" else speed, columns[name])


def _summed(time: FloatArray, speed: FloatArray) -> FloatArray:
    time = time - time[0]
    steps = np.where(np.isfinite(speed), speed, 0.0)[1:] * np.maximum(np.diff(np.nan_to_num(time)), 0.0)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _slope(x: FloatArray, y: FloatArray) -> float | None:
    usable = np.isfinite(x) & np.isfinite(y)
    if usable.sum() < _FEWEST or np.std(x[usable]) == 0.0 or np.std(y[usable]) == 0.0:
        return None
    a, b = x[usable] - np.mean(x[usable]), y[usable] - np.mean(y[usable])
    correlation = float(np.dot(a, b) / np.sqrt(np.dot(a, a) * np.dot(b, b)))
    return (
        float(np.sqrt(np.dot(b, b) / np.dot(a, a)) * np.sign(correlation)) if abs(correlation) > _CORRELATED else None
    )
