"""The filter: filterpy's, over shaft, wire, load, disturbance, encoder and scaled parameters as one state."""

from typing import Any

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from winch_friction.estimation import dynamics
from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.dynamics import FIRST_PARAMETER, LOAD, SPEED, FreshState, Step, replaced
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.trust import VarianceFactor
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


class StateFilter:
    """Predicts by steps, takes speeds in; with `learning` off the parameters are considered, not updated (Schmidt).

    All noise variances share one factor, which `adapt` lets follow the innovations. SI throughout.
    """

    def __init__(self, config: EstimatorConfig, parameters: ScaledParameters) -> None:
        self._config, self._parameters = config, parameters
        self._filter = SpeedFilter(dynamics.measurement(FIRST_PARAMETER + parameters.size))
        self._filter.P = np.zeros_like(self._filter.P)
        self._filter.P[FIRST_PARAMETER:, FIRST_PARAMETER:] = parameters.prior
        self._factor = VarianceFactor(config.adaptation_time)

    # -- what is estimated
    @property
    def state(self) -> tuple[FloatArray, FloatArray]:
        """State (n, 1) and covariance (n, n); never changed in place by a step."""
        return self._filter.x, self._filter.P

    @state.setter
    def state(self, state: tuple[FloatArray, FloatArray]) -> None:
        self._filter.x, self._filter.P = state

    @property
    def size(self) -> int:
        """Number n of the states."""
        return int(self._filter.dim_x)

    @property
    def speed(self) -> float:
        """Shaft speed, rad/s."""
        return float(self._filter.x[SPEED, 0])

    @property
    def load_torque(self) -> float:
        """Load torque at the shaft beyond the measured load's, N m."""
        return float(self._filter.x[LOAD, 0])

    @property
    def phi(self) -> FloatArray:
        """The scaled parameters (m,)."""
        return self._filter.x[FIRST_PARAMETER:, 0]

    @property
    def phi_covariance(self) -> FloatArray:
        """Their covariance (m, m)."""
        return self._filter.P[FIRST_PARAMETER:, FIRST_PARAMETER:]

    @property
    def theta(self) -> list[float]:
        """All parameter values in the seed's order."""
        return self._parameters.values(self.phi).tolist()

    @property
    def noise_factor(self) -> float:
        """Common factor of all noise variances."""
        return self._factor.value

    @property
    def speed_variance(self) -> float:
        """Variance of a measured speed's white noise, (rad/s)^2."""
        return self._factor.value * self._config.speed_noise**2

    # -- one step
    def predict(self, step: Step, learning: bool, load_known: bool) -> None:
        """Go one step on."""
        x, covariance = self._filter.x, self._filter.P
        noise = dynamics.process_noise(len(x), step, self._config, self._factor.value, load_known)
        if learning:
            forgotten = dynamics.forgotten(covariance, step.duration, self._config, self._parameters.prior)
            noise[FIRST_PARAMETER:, FIRST_PARAMETER:] = forgotten
        transition = dynamics.jacobian(len(x), step, self._config, self._parameters)
        self._filter.predict_with(dynamics.propagate(x, step, self._config), transition, noise)

    def innovation(self, measured: float) -> tuple[float, float]:
        """Difference between a measured speed and the predicted one, rad/s, and its variance."""
        return self._filter.innovation(measured, self.speed_variance)

    def correct(self, measured: float, learning: bool) -> None:
        """Take a measured speed in; learned parameters stay inside their range."""
        considered = 0 if learning else self._parameters.size
        self._filter.correct(measured, self.speed_variance, considered)
        self._filter.P = 0.5 * (self._filter.P + self._filter.P.T)
        if learning:
            self._filter.x = self._parameters.projected(self._filter.x, self._filter.P)

    def adapt(self, nis: float, dt: float) -> None:
        """Let the noise factor follow one normalised innovation squared, `dt` s after the last."""
        self._factor.step(nis, dt)

    # -- beginning anew
    def begin_load(self, variance: float, torque: float = 0.0) -> None:
        """The load torque beyond the measured load's at the start, N m, and its variance."""
        self._filter.x[LOAD, 0] = torque
        self._filter.P[LOAD, LOAD] = variance

    def take_anew(self, fresh: list[FreshState]) -> None:
        """Replace these states; everything else is kept."""
        self.state = replaced(self._filter.x, self._filter.P, fresh)
