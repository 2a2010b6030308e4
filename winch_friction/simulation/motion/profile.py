"""The operator's profile: shaft speed over time, piecewise linear."""

from collections.abc import Sequence

import numpy as np

from winch_friction.physics.signals import FloatArray


def plateau_points(speeds: Sequence[float], hold: float, ramp: float, rest: float) -> list[tuple[float, float]]:
    """Corner points (time s, speed rad/s) of plateaus, each hoisted and then lowered, as in paper 2 Fig 6."""
    time, points = rest, [(0.0, 0.0), (rest, 0.0)]
    for speed in speeds:
        for signed in (speed, -speed):
            points += [(time + ramp, signed), (time + ramp + hold, signed)]
            time += ramp + hold
        points.append((time + ramp, 0.0))
        points.append((time + ramp + rest, 0.0))
        time += ramp + rest
    return points


def profile_reference(points: Sequence[tuple[float, float]], time: FloatArray) -> FloatArray:
    """Angle, speed and acceleration of the shaft along corner points, shape (times, 3)."""
    if not points:
        return np.zeros((len(time), 3))
    corners, values = (np.array(column, float) for column in zip(*points, strict=True))
    speed = np.interp(time, corners, values)
    steps = np.diff(time)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * steps)])
    acceleration = np.append(np.diff(speed) / steps, 0.0)
    return np.column_stack([angle, speed, acceleration])
