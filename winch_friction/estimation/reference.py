"""filterpy's extended Kalman filter on the matrices of a `StateFilter`: what both fast ways must agree with.

Nothing else needs filterpy: its import brings scipy.stats, and takes as long as a node may take to start.
"""

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from winch_friction.estimation.dynamics import (
    ENCODER_CHANGE,
    FIRST_PARAMETER,
    HEAVE_NOISE,
    SPEED,
    TORQUE_NOISE,
    Propagation,
    Step,
    noise_variances,
)
from winch_friction.estimation.filter import StateFilter
from winch_friction.physics.signals import FloatArray


class ReferenceFilter(ExtendedKalmanFilter):
    """Begins where a `StateFilter` is and learns by filterpy's own predict and update.

    Left out is what filterpy does not know: considered sensor errors, the parameters' forgetting, rest and range.
    """

    def __init__(self, start: StateFilter) -> None:
        super().__init__(dim_x=start.size, dim_z=1)
        self.x, self.P = start.state
        self._config, self._noise_factor, self.R = start.config, start.noise_factor, np.array([[start.speed_variance]])
        self._propagation = Propagation(start.config, start.parameters.free, start.parameters.scale)
        self._seen = np.zeros((1, start.size))
        self._seen[0, [SPEED, ENCODER_CHANGE]] = 1.0

    def take(self, step: Step, measured: float, load_known: bool = False) -> None:
        """One step of motion, and the speed in rad/s that was measured at its end."""
        self._acting = np.zeros(len(noise_variances(step, self._config, 1.0, load_known)))
        torque, heave = self._propagation.take(step, self.x[FIRST_PARAMETER:, 0])
        self._acting[TORQUE_NOISE], self._acting[HEAVE_NOISE] = torque, heave
        matrix, size = self._propagation.matrix, self.dim_x
        noise = np.diag(noise_variances(step, self._config, self._noise_factor, load_known))
        self.F, self._by_noises = matrix[:, :size].copy(), matrix[:, size:].copy()
        self.Q = self._by_noises @ noise @ self._by_noises.T
        self.predict()
        self.update(np.array([[measured]]), lambda _: self._seen, lambda x: self._seen @ x)

    def predict_x(self, u: FloatArray | float = 0.0) -> None:
        """The states one step on; what is known to act enters where its noise does."""
        self.x = self.F @ self.x + (self._by_noises @ self._acting)[:, None]
