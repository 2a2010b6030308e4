"""The filter: an extended Kalman filter over shaft, wire, load, disturbance, encoder and scaled parameters.

It is filterpy's filter by interface (`x`, `P`, `dim_x`, `dim_z`) and by its numbers: `reference` is filterpy's own
class on the same F, Q, H and R, and a test holds every step against it. Its predict and update take four products of
whole matrices, an inverse and a dozen small arrays. Here the noises stand beside the states in one covariance, so
that a prediction is one congruence, and the single speed that is measured makes the correction a change of rank one;
the states and their sensitivities to sensor errors go through the same two products as further rows. `compiled_filter`
does the same by loops.
"""

from collections.abc import Callable, Sequence

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.considered import ConsideredErrors
from winch_friction.estimation.dynamics import (
    DAMPING,
    ENCODER_CHANGE,
    FIRST_PARAMETER,
    HEAVE_NOISE,
    LOAD,
    NOISES,
    SPEED,
    STRETCH,
    TORQUE_NOISE,
    FreshState,
    Propagation,
    Step,
    noise_variances,
)
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.trust import VarianceFactor
from winch_friction.physics.signals import FloatArray

FADE_PERIOD = 1.0  # s between two steps of forgetting, which goes over hours
EVEN_EVERY = 50  # steps; the rounding of one step is 1e-16 of the covariance


class StateFilter:
    """Predicts by steps, takes speeds in; a prediction that is not taken in changes nothing.

    `x` (n, 1) and `P` (n, n) are named as filterpy's. When not learning the parameters are considered, and in stick the
    load: their gain is zero, while their uncertainty and their correlation with the others stay in the account (Schmidt
    1966; Simon, Optimal State Estimation, section 10.1). Constant sensor errors (standard deviations `sensors`) are
    considered always, and by the gain of a filter that does not know them: `sensitivity` (errors, n) is what one of
    each does to the state's error (Tapley, Schutz and Born, Statistical Orbit Determination, chapter 6), so that the
    covariance of the error is P + sensitivity' diag(sensors^2) sensitivity. Their own states would share the
    innovation's variance with the noises, and its check would no longer tell. All noise variances share one factor,
    which `adapt` lets follow the innovations. SI throughout.
    """

    def __init__(self, config: EstimatorConfig, parameters: ScaledParameters, sensors: Sequence[float] = ()) -> None:
        self.config, self.parameters = config, parameters
        self._propagation = Propagation(config, parameters.free, parameters.scale)
        size = self._propagation.size
        self.dim_x, self.dim_z = size, 1
        self._factor = VarianceFactor(config.adaptation_time)
        self._phi = slice(FIRST_PARAMETER, size)
        self._sensors = np.array(sensors, float)
        self._damping = len(sensors) - 1 if sensors and config.wire_damping_std > 0.0 else -1  # which of them
        self.considered = ConsideredErrors(self._sensors.tolist(), config.speed_delay_std > 0.0)
        # rows that go through the same linear steps: P with W on the diagonal behind it, the sensitivities, what the
        # parameters' range has moved, x; a sensor error and what is known to act enter where the noises do
        noisy, carried = size + NOISES, len(sensors) + 2
        self._now = np.zeros((noisy + carried, noisy))
        self._noises = np.einsum("ii->i", self._now[:noisy])[size:]
        self.P, self.sensitivity = self._now[:size, :size], self._now[noisy:-2, :size]
        self._moved, self._flat, self._carried = self._now[-2, :size], self._now[-1, :size], self._now[noisy:, :size]
        self._acting = self._now[noisy:, size:]
        self.x = self._flat.reshape(size, 1)
        self.phi: FloatArray = self._flat[self._phi]  # the scaled parameters (m,)
        self.P[self._phi, self._phi] = parameters.prior
        # the same rows, predicted, until they are taken in: P, then what is carried; and room to calculate in
        self._ahead, self._half = np.zeros((size + carried, size)), np.zeros((noisy + carried, size))
        self._ahead_P, self._ahead_carried = self._ahead[:size], self._ahead[size:]
        self._half_of_P, self._half_carried = self._half[:noisy], self._half[noisy:]
        self._seen, self._change = np.zeros(size + carried), np.zeros_like(self._ahead)
        self._since_even = 0
        self._learned_for = self._unfaded = 0.0  # s of learning since the parameters' covariance last faded

    # -- what is estimated
    @property
    def state(self) -> tuple[FloatArray, FloatArray]:
        """State (n, 1) and covariance (n, n), copied."""
        return self.x.copy(), self.P.copy()

    @state.setter
    def state(self, state: tuple[FloatArray, FloatArray]) -> None:
        self.x[:], self.P[:] = state

    @property
    def size(self) -> int:
        """Number n of the states."""
        return self.dim_x

    @property
    def speed(self) -> float:
        """Shaft speed, rad/s."""
        return self._flat.item(SPEED)

    @property
    def load_torque(self) -> float:
        """Load torque at the shaft beyond the measured load's, N m."""
        return self._flat.item(LOAD)

    @property
    def phi_covariance(self) -> FloatArray:
        """Their covariance (m, m)."""
        return self.P[self._phi, self._phi]

    @property
    def considered_covariance(self) -> FloatArray:
        """The same with what the considered sensor errors add (m, m)."""
        if not len(self._sensors):
            return self.phi_covariance
        root = self.sensitivity[:, self._phi] * self._sensors[:, None]
        return self.phi_covariance + root.T @ root

    @property
    def considered_variances(self) -> FloatArray:
        """The diagonal of `considered_covariance` (m,)."""
        own = self.phi_covariance.diagonal()
        return own + self._sensors**2 @ self.sensitivity[:, self._phi] ** 2 if len(self._sensors) else own

    @property
    def noise_factor(self) -> float:
        """Common factor of all noise variances."""
        return self._factor.value

    @property
    def speed_variance(self) -> float:
        """Variance of a measured speed's white noise, (rad/s)^2."""
        return self._factor.value * self.config.speed_noise**2

    # -- one step
    def predict_step(self, step: Step, learning: bool, load_known: bool) -> None:
        """Look one step ahead: P = F P F' + G W G' with the noises' variances W; parameters also fade to the prior."""
        self._predict(step, load_known)
        self._unfaded = self._learned_for + step.duration if learning else self._learned_for
        if self._unfaded >= FADE_PERIOD:
            self._ahead_P[self._phi, self._phi] += self.parameters.faded(self.phi_covariance, self._unfaded)
            self._unfaded = 0.0

    def _predict(self, step: Step, load_known: bool) -> None:
        """All rows one step on, without what fades."""
        matrix, acting = self._propagation.matrix, self._acting
        acting[-1, TORQUE_NOISE], acting[-1, HEAVE_NOISE] = self._propagation.take(step, self.phi)
        for k, each in enumerate(step.by_sensors):
            acting[k, TORQUE_NOISE] = each
        self._noises[:] = noise_variances(step, self.config, self._factor.value, load_known)
        self._now.dot(matrix.T, out=self._half)
        matrix.dot(self._half_of_P, out=self._ahead_P)
        self._ahead_carried[:] = self._half_carried
        if self._damping >= 0:
            opened = self._ahead_carried.item(-1, STRETCH) - self._flat.item(STRETCH)
            self._ahead_carried[self._damping, :LOAD] += [row[DAMPING] * opened for row in step.wire]

    def innovation(self, measured: float) -> tuple[float, float]:
        """Difference between a measured speed and the predicted one, rad/s, and its variance.

        A speed that is the difference of two encoder angles carries the difference of their roundings: what one speed
        shows too much, the next one shows too little. Taken as white it would hide most of what the speed says about a
        torque, so the measured speed is the sum of two states.
        """
        speed, variance = self._see()
        return measured - speed, variance + self.speed_variance

    def _see(self) -> tuple[float, float]:
        """The predicted measurement, and its variance without the noise of the sensor."""
        seen = np.add(self._ahead[:, SPEED], self._ahead[:, ENCODER_CHANGE], out=self._seen)
        return seen.item(-1), seen.item(SPEED) + seen.item(ENCODER_CHANGE)

    def correct(self, innovation: float, variance: float, learning: bool, stick: bool = False) -> None:
        """Take the prediction and its measured speed in; learned parameters stay inside their range.

        In `stick` the load is considered as well: a brake may carry it, and for as long as it likes.
        """
        if learning and not stick:
            self.considered.step(self._seen[self.size : -2], innovation, variance)
        inside = self._take_in(innovation, variance, learning, stick)
        self._learned_for = self._unfaded
        if learning and not inside:
            self._into_range()

    def _into_range(self) -> None:
        """Move the parameters inside their range, and keep in mind by how much that moved every state: it is nothing
        that the data told."""
        moved = self.parameters.projected(self._flat, self.P, FIRST_PARAMETER)
        self._moved += moved - self._flat
        self._flat[:] = moved

    def _take_in(self, innovation: float, variance: float, learning: bool, stick: bool) -> bool:
        """The prediction becomes what is; whether the learned parameters are inside their range."""
        gain, seen, size = self._seen[: self.size] / variance, self._seen, self.size
        if not learning:
            gain[self._phi] = 0.0
        if stick:
            gain[LOAD] = 0.0
        # every row gives up what the measurement shows of it times the gain, x what it does not show yet; with the
        # optimal gain of the free states Joseph's form of P is that too, and P itself among the considered
        seen[-1] = -innovation
        np.multiply(seen[:, None], gain, out=self._change)
        np.subtract(self._ahead_P, self._change[:size], out=self.P)
        np.subtract(self._ahead_carried, self._change[size:], out=self._carried)
        if stick:
            self.P[:, LOAD] = self.P[LOAD, :]
        if not learning:
            self.P[:FIRST_PARAMETER, FIRST_PARAMETER:] = self.P[FIRST_PARAMETER:, :FIRST_PARAMETER].T
            return True
        self._even()
        return self.parameters.contains(self.phi)

    def _even(self) -> None:
        """Now and then, take away what rounding left unequal between the halves of P."""
        self._since_even += 1
        if self._since_even >= EVEN_EVERY:
            np.add(self.P, self.P.T, out=self._ahead_P)
            np.multiply(self._ahead_P, 0.5, out=self.P)
            self._since_even = 0

    def adapt(self, nis: float, dt: float) -> None:
        """Let the noise factor follow one normalised innovation squared, `dt` s after the last."""
        self._factor.step(nis, dt)

    def change_prior(self, change: Callable[[], None]) -> None:
        """Judge the same data by another prior of the parameters, which `change` makes.

        With the prior's mean at the seed (phi = 0) and dJ the change of its precision:
        P' = (P^-1 + dJ)^-1, x' = x - P' dJ phi, here without the inverse of P. What the range had moved under the prior
        before is taken back first: the other prior would take it for told by the data, and go beyond it.
        """
        before = np.linalg.inv(self.parameters.prior)
        change()
        change_of_precision = np.linalg.inv(self.parameters.prior) - before
        across = self.P[:, self._phi]
        factor = change_of_precision @ np.linalg.inv(np.eye(len(before)) + self.phi_covariance @ change_of_precision)
        self._flat -= self._moved
        self._moved[:] = 0.0
        self._flat -= across @ (factor @ self.phi)
        self.sensitivity -= self.sensitivity[:, self._phi] @ factor.T @ across.T
        covariance = self.P - across @ factor @ across.T
        self.P[:] = 0.5 * (covariance + covariance.T)
        if not self.parameters.contains(self.phi):
            self._into_range()

    # -- beginning anew
    def begin_load(self, variance: float, torque: float = 0.0) -> None:
        """Another load: its torque beyond the measured load's, N m, and its variance."""
        self.take_anew([(LOAD, torque, variance)])

    def take_parameters(self, x: FloatArray, covariance: FloatArray, sensitivity: FloatArray) -> None:
        """Other parameters, out of a state (n,) with its covariance (n, n) and sensitivity (errors, n); the states that
        move are kept, correlated with none of them; what the innovations since have told of sensor errors is not."""
        phi, self.considered = self._phi, self.considered.anew()
        self.P[:, phi] = self.P[phi, :] = 0.0
        self.P[phi, phi], self.sensitivity[:, phi] = covariance[phi, phi], sensitivity[:, phi]
        self._flat[phi], self._moved[phi] = self.parameters.projected(x, covariance, FIRST_PARAMETER)[phi], 0.0

    def take_anew(self, fresh: Sequence[FreshState]) -> None:
        """Take these states as given, correlated with nothing; the rest is kept."""
        for state, value, variance in fresh:
            self.P[state, :] = self.P[:, state] = 0.0
            self.P[state, state] = variance
            self.sensitivity[:, state] = self._moved[state] = 0.0
            self._flat[state] = value
