"""The Kalman filter itself: filterpy's, with a considered update beside the ordinary one (both in Joseph form)."""

from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from winch_friction.physics.signals import FloatArray


class SpeedFilter(ExtendedKalmanFilter):
    """An extended Kalman filter whose one measurement is its first state.

    `predict_with` takes the propagated state and its Jacobian; filterpy multiplies x by F, which would linearise the
    motion.
    """

    x: FloatArray
    P: FloatArray

    def __init__(self, size: int) -> None:
        super().__init__(dim_x=size, dim_z=1)
        self._next: FloatArray = np.zeros((size, 1))
        self._measured = np.zeros((1, size))
        self._measured[0, 0] = 1.0

    def predict_x(self, u: Any = 0) -> None:
        """The state that `predict_with` was given."""
        self.x = self._next

    def predict_with(self, x: FloatArray, jacobian: FloatArray, noise: FloatArray) -> None:
        """Propagate to `x` (n, 1) with Jacobian and process noise (n, n)."""
        self._next, self.F, self.Q = x, jacobian, noise
        self.predict()

    def innovation(self, speed: float, variance: float) -> tuple[float, float]:
        """Difference between a measured speed and the predicted one, rad/s, and its variance."""
        return speed - float(self.x[0, 0]), float(self.P[0, 0]) + variance

    def correct(self, speed: float, variance: float, considered: int) -> None:
        """Take a measured speed; the last `considered` states keep their values and variances.

        Schmidt's consider filter: their gain is zero, while their uncertainty and their correlation with the others
        stay in the account (Schmidt 1966; Simon, Optimal State Estimation, section 10.1).
        """
        if not considered:
            self.update(np.array([[speed]]), lambda _: self._measured, lambda x: x[:1], R=variance)
            return
        gain = self.P[:, :1] / (self.P[0, 0] + variance)
        gain[-considered:] = 0.0
        self.x = self.x + gain * (speed - self.x[0, 0])
        left = np.eye(self.dim_x) - gain @ self._measured
        frozen = self.P[-considered:, -considered:].copy()
        self.P = left @ self.P @ left.T + variance * gain @ gain.T
        self.P[-considered:, -considered:] = frozen
