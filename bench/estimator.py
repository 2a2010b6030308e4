"""What one estimator step costs, beside filterpy's own extended Kalman filter of the same size.

python bench/estimator.py
"""

from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from pairs import figure, paired
from seas import sea

from winch_friction.estimation import EstimatorConfig, FrictionEstimator


def measure() -> dict[str, Any]:
    """Step time in us over a simulated sea, and its ratio to `predict` and `update` of a bare filter."""
    crane, model, _, samples = sea()
    size = FrictionEstimator(crane, model, EstimatorConfig())._filter.dim_x

    def steps() -> None:
        estimator = FrictionEstimator(crane, model, EstimatorConfig())
        for sample in samples:
            estimator.step(sample)

    def bare() -> None:
        row = np.zeros((1, size))
        row[0, 0] = 1.0
        kalman = ExtendedKalmanFilter(dim_x=size, dim_z=1)
        for sample in samples:
            kalman.predict()
            kalman.update(np.array([[sample.motor_speed]]), lambda _: row, lambda x: row @ x)

    ours, theirs, ratio = paired(steps, bare)
    against = f"bare filterpy EKF of {size} states, {1e6 * theirs / len(samples):.0f} us"
    return {"estimator: one step": figure(1e6 * ours / len(samples), "us", against, ratio, "ratio <= 1.3")}


if __name__ == "__main__":
    print(measure())
