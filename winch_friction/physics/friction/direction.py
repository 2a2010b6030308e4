"""The direction of motion as a number between -1 and 1."""

import math
from typing import Any

import numpy as np


def smooth_sign(speed: float, width: float) -> float:
    """tanh(speed/width); the sign itself for width 0. Both in rad/s."""
    if width > 0.0:
        return math.tanh(speed / width)
    return float(speed > 0.0) - float(speed < 0.0)


def smooth_signs(speed: Any, width: Any) -> np.ndarray:
    """`smooth_sign` over arrays; `width` may be an array of the same shape."""
    speed = np.asarray(speed, float)
    safe = np.where(np.asarray(width) > 0.0, width, 1.0)
    return np.where(np.asarray(width) > 0.0, np.tanh(speed / safe), np.sign(speed))
