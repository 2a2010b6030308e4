"""Can the values be this crane's at all? How far each quantity lies beyond what its machine can do."""

import numpy as np

from winch_friction.commissioning.balance import static_torque
from winch_friction.commissioning.view import RunView
from winch_friction.physics.signals import FloatArray

# what no winch of this kind does; generous, so that only a wrong unit or a wrong crane passes them
FASTEST = 650.0  # rad/s at the motor shaft, 6200 rpm: above the limit of any piston motor of this size
HIGHEST = 600e5  # Pa, above any relief valve
LARGEST_DISPLACEMENT = 1.06  # of the crane's largest: the feedback's error
HEAVIEST = 1.5  # of what all motors hold at 450 bar
RATED_TO_LIMIT = 450.0 / 300.0
LOWEST_SUM = 8e5  # Pa: p_A + p_B of any loop in use lies above; the boost alone is several times that
SMALLEST_DISPLACEMENT = 0.03  # of the crane's largest, at the run's largest
ROUGHEST = 15.0  # m/s of crane tip
STEEP = 0.1  # a ratio of e^0.1 beyond the limit costs one sigma
MOST = 400.0


def excesses(view: RunView) -> dict[str, float]:
    """By channel: its 99th percentile over the upper limit, or the lower limit over it, where that is above 1."""
    found = {"heave_velocity": _top(view.heave) / ROUGHEST if view.heave is not None else 0.0}
    if view.groups:
        found["motor_speed"] = _top(view.speed) / FASTEST
        heaviest = HEAVIEST * RATED_TO_LIMIT * view.rated_torque
        found["hook_load"] = _top(static_torque(view)) / heaviest if heaviest > 0.0 else 0.0
    for name, group in view.groups.items():
        too_low = LOWEST_SUM / max(_top(group.pressure_sum), 1e-300)
        found[f"{name}.pressure"] = max(_top(group.drop) / HIGHEST, too_low)
        if view.max_displacement > 0.0:
            largest = _top(group.displacement)
            too_small = SMALLEST_DISPLACEMENT * view.max_displacement / max(largest, 1e-300)
            too_large = largest / (LARGEST_DISPLACEMENT * view.max_displacement)
            found[f"{name}.displacement"] = max(too_small, too_large)
    return {name: ratio for name, ratio in found.items() if ratio > 1.0}


def range_score(view: RunView) -> float:
    """The excesses as one score."""
    return sum(min((np.log(ratio) / STEEP) ** 2, MOST) for ratio in excesses(view).values())


def _top(values: FloatArray) -> float:
    good = np.abs(values[np.isfinite(values)])
    return float(np.percentile(good, 99)) if good.size else 0.0
