"""The estimator's filter: shaft, wire, load, disturbance, encoder and the scaled parameters as one state."""

import numpy as np

from winch_friction.estimation import prediction
from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.consistency import VarianceFactor
from winch_friction.estimation.kalman import SpeedFilter
from winch_friction.estimation.motion import FreshState, replaced
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.prediction import FIRST_PARAMETER, LOAD, SPEED, Step
from winch_friction.physics.signals import FloatArray


class StateFilter:
    """Predicts by steps, takes speeds in; with `learning` off the parameters are considered, not updated (Schmidt).

    All noise variances share one factor, which `adapt` lets follow the innovations. SI throughout.
    """

    def __init__(self, config: EstimatorConfig, parameters: ScaledParameters) -> None:
        self._config, self._parameters = config, parameters
        self._filter = SpeedFilter(prediction.measurement(FIRST_PARAMETER + parameters.size))
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
        noise = prediction.process_noise(len(x), step, self._config, self._factor.value, load_known)
        if learning:
            forgotten = prediction.forgotten(covariance, step.duration, self._config, self._parameters.prior)
            noise[FIRST_PARAMETER:, FIRST_PARAMETER:] = forgotten
        transition = prediction.jacobian(len(x), step, self._config, self._parameters)
        self._filter.predict_with(prediction.propagate(x, step, self._config), transition, noise)

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
