"""What one estimator step costs, beside filterpy's own extended Kalman filter of the same size."""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from bench.measuring import Row, paired, sea, sea_seconds
from winch_friction.estimation import EstimatorConfig, FrictionEstimator

NOTE = (
    "the filter itself (predict, innovation, correct), compiled, is about a sixth of a step; the rest reads and checks "
    "samples, evaluates the friction with its gradient and the wire, and keeps the statuses, in 180 calls of Python"
)


def measure(smoke: bool = False) -> list[Row]:
    """Step time over a simulated sea, and its ratio to `predict` and `update` of a bare filter."""
    crane, model, _, samples = sea(sea_seconds(smoke))
    size = FrictionEstimator(crane, model, EstimatorConfig()).size

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

    found, each = paired(steps, bare, smoke), 1e6 / len(samples)
    return [
        Row(
            f"estimator: one step, {size} states", found.ours * each, "us", "bare filterpy EKF of that size",
            found.theirs * each, found.ratio, found.spread, at_most=1.3, note=NOTE,
        )
    ]  # fmt: skip
