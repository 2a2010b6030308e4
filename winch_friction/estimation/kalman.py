"""The Kalman filter itself: filterpy's, with a considered update beside the ordinary one (both in Joseph form)."""

from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from winch_friction.physics.signals import FloatArray


class SpeedFilter(ExtendedKalmanFilter):
    """An extended Kalman filter with one measurement that is linear in the states.

    `predict_with` takes the propagated state and its Jacobian; filterpy multiplies x by F, which would linearise the
    motion.
    """

    x: FloatArray
    P: FloatArray

    def __init__(self, measurement: FloatArray) -> None:
        super().__init__(dim_x=measurement.shape[1], dim_z=1)
        self._next: FloatArray = np.zeros((self.dim_x, 1))
        self._measurement = measurement

    def predict_x(self, u: Any = 0) -> None:
        """The state that `predict_with` was given."""
        self.x = self._next

    def predict_with(self, x: FloatArray, jacobian: FloatArray, noise: FloatArray) -> None:
        """Propagate to `x` (n, 1) with Jacobian and process noise (n, n)."""
        self._next, self.F, self.Q = x, jacobian, noise
        self.predict()

    def innovation(self, measured: float, variance: float) -> tuple[float, float]:
        """Difference between a measured speed and the predicted one, rad/s, and its variance."""
        row = self._measurement
        return measured - float((row @ self.x)[0, 0]), float((row @ self.P @ row.T)[0, 0]) + variance

    def correct(self, measured: float, variance: float, considered: int) -> None:
        """Take a measured speed; the last `considered` states keep their values and variances.

        Schmidt's consider filter: their gain is zero, while their uncertainty and their correlation with the others
        stay in the
        account (Schmidt 1966; Simon, Optimal State Estimation, section 10.1).
        """
        row = self._measurement
        if not considered:
            self.update(np.array([[measured]]), lambda _: row, lambda x: row @ x, R=variance)
            return
        innovation, total = self.innovation(measured, variance)
        gain = self.P @ row.T / total
        gain[-considered:] = 0.0
        self.x = self.x + gain * innovation
        left = np.eye(self.dim_x) - gain @ row
        frozen = self.P[-considered:, -considered:].copy()
        self.P = left @ self.P @ left.T + variance * gain @ gain.T
        self.P[-considered:, -considered:] = frozen
