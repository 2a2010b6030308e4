"""A step of the filter as two loops over its own structure, for numba: `kernels` compiles them.

The matrix of a step is three dense rows (shaft and wire), one thing that each further state becomes, and noises that
enter at one place each; NumPy's products of whole matrices cost ten times as much. The covariance is calculated once
above its diagonal and mirrored. `test_parts` holds both ways against each other and against filterpy.
"""

from functools import lru_cache
from pathlib import Path
from typing import Any

from winch_friction.estimation.dynamics import (
    DAMPING,
    DISTURBANCE,
    DISTURBANCE_NOISE,
    ENCODER,
    ENCODER_CHANGE,
    FIRST_PARAMETER,
    HEAVE,
    HEAVE_NOISE,
    LOAD,
    LOAD_NOISE,
    LOAD_SPEED,
    LOAD_SPEED_NOISE,
    NOISES,
    ROUNDING_NOISE,
    SPEED,
    STRETCH,
    TORQUE,
    TORQUE_NOISE,
)
from winch_friction.physics.friction.sources import cache_root, compiled_in, source_digest

# what a step is given as one array: what acts, the noises' variances, and behind them the gradient and the sensors
GIVEN_TORQUE, GIVEN_HEAVE, GIVEN_FADING, GIVEN_NOISES = range(4)
GIVEN_GRADIENT = GIVEN_NOISES + NOISES


def look_ahead(now, ahead, seen, wire, given, free, scale, damping, by, half):
    """P, sensitivities and state one step on, into `ahead`; what the measured speed shows of each row, into `seen`.

    `now`, `ahead`, `seen` as in `filter.StateFilter`; `wire` (3, 6); `given` as named above; `free` (m,), `scale` (m,);
    which of the considered errors is the wire's `damping`, -1 for none;
    room for the torque's derivatives by the states, `by` (n,), and for three rows of F P, `half` (3, n).
    """
    n, parameters = ahead.shape[1], len(scale)
    sensors = ahead.shape[0] - n - 1
    fading, first_sensor = given[GIVEN_FADING], len(given) - sensors
    by[LOAD] = by[DISTURBANCE] = -1.0
    for k in range(parameters):
        by[FIRST_PARAMETER + k] = -given[GIVEN_GRADIENT + free[k]] * scale[k]
    for j in range(n):
        torque = 0.0
        for k in range(LOAD, n):
            torque += by[k] * now[k, j]
        for i in range(LOAD):
            half[i, j] = (
                wire[i, 0] * now[0, j] + wire[i, 1] * now[1, j] + wire[i, 2] * now[2, j] + wire[i, TORQUE] * torque
            )
    for i in range(LOAD):
        torque = 0.0
        for k in range(LOAD, n):
            torque += by[k] * half[i, k]
        torque += given[GIVEN_NOISES + TORQUE_NOISE] * wire[i, TORQUE]
        heave = given[GIVEN_NOISES + HEAVE_NOISE] * wire[i, HEAVE]
        for j in range(i, LOAD):
            ahead[i, j] = (
                half[i, 0] * wire[j, 0] + half[i, 1] * wire[j, 1] + half[i, 2] * wire[j, 2]
                + torque * wire[j, TORQUE] + heave * wire[j, HEAVE]
            )  # fmt: skip
        for j in range(LOAD, n):
            ahead[i, j] = half[i, j]
        ahead[i, DISTURBANCE] *= fading
        ahead[i, ENCODER] = 0.0
        ahead[i, ENCODER_CHANGE] = -half[i, ENCODER]
    for i in range(LOAD, n):
        for j in range(i, n):
            ahead[i, j] = now[i, j]
    for j in range(n):  # what the others share with disturbance and encoder
        if j == LOAD or j >= FIRST_PARAMETER:
            ahead[min(j, DISTURBANCE), max(j, DISTURBANCE)] = fading * now[DISTURBANCE, j]
            ahead[min(j, ENCODER), max(j, ENCODER)] = 0.0
            ahead[min(j, ENCODER_CHANGE), max(j, ENCODER_CHANGE)] = -now[ENCODER, j]
    rounding = given[GIVEN_NOISES + ROUNDING_NOISE]
    ahead[LOAD_SPEED, LOAD_SPEED] += given[GIVEN_NOISES + LOAD_SPEED_NOISE]
    ahead[LOAD, LOAD] += given[GIVEN_NOISES + LOAD_NOISE]
    ahead[DISTURBANCE, DISTURBANCE] = fading * fading * now[DISTURBANCE, DISTURBANCE]
    ahead[DISTURBANCE, DISTURBANCE] += given[GIVEN_NOISES + DISTURBANCE_NOISE]
    ahead[DISTURBANCE, ENCODER] = 0.0
    ahead[DISTURBANCE, ENCODER_CHANGE] = -fading * now[DISTURBANCE, ENCODER]
    ahead[ENCODER, ENCODER] = ahead[ENCODER, ENCODER_CHANGE] = rounding
    ahead[ENCODER_CHANGE, ENCODER_CHANGE] = now[ENCODER, ENCODER] + rounding
    for i in range(n):
        for j in range(i):
            ahead[i, j] = ahead[j, i]
    for row in range(n, n + sensors + 1):
        carried = now[NOISES + row]
        if row < n + sensors:
            torque, heave = given[first_sensor + row - n], 0.0
            for k in range(LOAD, n):
                torque += by[k] * carried[k]
        else:  # the state: the friction is that of the parameters as they are, nothing linear about it
            torque, heave = given[GIVEN_TORQUE] - carried[LOAD] - carried[DISTURBANCE], given[GIVEN_HEAVE]
        for i in range(LOAD):
            ahead[row, i] = (
                wire[i, 0] * carried[0] + wire[i, 1] * carried[1] + wire[i, 2] * carried[2]
                + wire[i, TORQUE] * torque + wire[i, HEAVE] * heave
            )  # fmt: skip
        for k in range(LOAD, n):
            ahead[row, k] = carried[k]
        ahead[row, DISTURBANCE] *= fading
        ahead[row, ENCODER], ahead[row, ENCODER_CHANGE] = 0.0, -carried[ENCODER]
    if damping >= 0:
        opened = ahead[n + sensors, STRETCH] - now[NOISES + n + sensors, STRETCH]
        for i in range(LOAD):
            ahead[n + damping, i] += wire[i, DAMPING] * opened
    for row in range(n + sensors + 1):
        seen[row] = ahead[row, SPEED] + ahead[row, ENCODER_CHANGE]


def take_in(now, ahead, seen, innovation, variance, learning, stick, lower, upper):
    """The prediction and its measured speed into `now`; whether the parameters are still within `lower`, `upper` (m,).

    Every row gives up what the measurement shows of it times the gain; what is considered, the parameters unless
    `learning` and the load in `stick`, has none, and shares with the others what those lost.
    """
    n = ahead.shape[1]
    first = n if learning else FIRST_PARAMETER
    seen[-1] = -innovation
    for i in range(n):
        gain = seen[i] / variance
        free = i < first and not (stick and i == LOAD)
        for j in range(i, n):
            taken = free or (j < first and not (stick and j == LOAD))
            now[i, j] = ahead[i, j] - gain * seen[j] if taken else ahead[i, j]
            now[j, i] = now[i, j]
        for row in range(n, ahead.shape[0]):
            now[NOISES + row, i] = ahead[row, i] - gain * seen[row] if free else ahead[row, i]
    inside = True
    for k in range(len(lower)):
        value = now[now.shape[0] - 1, FIRST_PARAMETER + k]
        inside = inside and lower[k] <= value <= upper[k]
    return inside


_VECTOR, _MATRIX = "float64[::1]", "float64[:,::1]"


@lru_cache(maxsize=1)
def kernels() -> tuple[Any, Any]:
    """`look_ahead` and `take_in`, compiled or read from the cache: seconds once, a quarter of one after that.

    Raises `ImportError` without numba, `RuntimeError` or `OSError` where nothing can be kept.
    """
    directory = str(cache_root() / f"filter_{source_digest(sorted(Path(__file__).parent.glob('*.py')))}")
    rows, room = f"{_MATRIX}, {_MATRIX}, {_VECTOR}", f"{_VECTOR}, {_MATRIX}"
    ahead = f"void({rows}, {_MATRIX}, {_VECTOR}, int64[::1], {_VECTOR}, int64, {room})"
    taken = f"boolean({rows}, float64, float64, boolean, boolean, {_VECTOR}, {_VECTOR})"
    return compiled_in(directory, look_ahead, ahead), compiled_in(directory, take_in, taken)
