"""Is the seed's sigma true: prior-data conflict found online, and what the filter believes after it.

A seed says where the parameters are and how surely. Along what the data tell, the filter leaves the seed by more than
that sigma allows when it was wrong; along what they do not tell, nothing moves, and a sigma that was refuted in sum
would stand on every single parameter (half a sigma of ten parameters is five of one). So the claim is tested, and
where it fails it is taken back: for every parameter, since the seed made one claim. A loss that a small sea hardly
shows stays where the seed has it, but no longer with the sigma of a seed that was wrong about the others.
"""

from dataclasses import dataclass

import numpy as np

from winch_friction.estimation import chi_squared
from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.filter import StateFilter
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.physics.signals import FloatArray

LOOK_PERIOD = 5.0  # s of learning between two looks: about half a wave
LOOKS = 3  # in a row that must refute: a seed far off is first blamed on the load, until both directions were seen
TOLD = 0.5  # share of a direction's prior variance that the data must have taken for its shift to count


@dataclass(frozen=True, slots=True)
class Shift:
    """How far the estimate has gone from the seed: chi^2 of the shift along `directions` that the data told, and the
    probability of that much or more under the claim."""

    chi2: float
    directions: int
    probability: float


def shift_of(phi: FloatArray, covariance: FloatArray, considered: FloatArray, prior: FloatArray) -> Shift:
    """The shift of scaled parameters (m,) with the filter's covariance (m, m), with and without sensor errors.

    The estimate of a linear problem moves from its prior mean by prior minus posterior covariance (Evans and Moshonov
    2006, checking for prior-data conflict); what constant sensor errors add moves it as well.
    """
    whitening = np.linalg.inv(np.linalg.cholesky(prior))
    taken, directions = np.linalg.eigh(np.eye(len(phi)) - whitening @ covariance @ whitening.T)
    told = taken > TOLD
    along = directions[:, told].T @ whitening
    by_sensors = np.einsum("ij,jk,ik->i", along, considered - covariance, along)
    squares = float(((along @ phi) ** 2 / (taken[told] + np.clip(by_sensors, 0.0, None))).sum())
    count = int(told.sum())
    return Shift(squares, count, chi_squared.survival(squares, count) if count else 1.0)


class SeedConflict:
    """Looks at the shift while the estimator learns; widens the prior once it is refuted."""

    def __init__(self, config: EstimatorConfig, parameters: ScaledParameters) -> None:
        self._level, self._parameters = config.conflict_level, parameters
        self._since = 0.0
        self._in_a_row = 0
        self.shift = Shift(0.0, 0, 1.0)

    def step(self, state: StateFilter, dt: float) -> None:
        """Take `dt` s of learning."""
        self._since += dt
        if self._since < LOOK_PERIOD or not self._level:
            return
        self._since = 0.0
        prior = self._parameters.prior
        self.shift = shift_of(state.phi, state.phi_covariance, state.considered_covariance, prior)
        refuted = self.shift.probability < self._level
        self._in_a_row = self._in_a_row + 1 if refuted else 0
        if self._in_a_row >= LOOKS and not self._parameters.widened:
            state.change_prior(lambda: self._parameters.widen(range(self._parameters.size)))

    def status(self) -> dict[str, float | str]:
        """For diagnostics: whether the seed's sigmas hold, and where they were taken back."""
        widened = self._parameters.widened_names
        return {
            "seed": "refuted" if widened else "holds",
            "seed_shift_chi2": self.shift.chi2,
            "seed_shift_directions": self.shift.directions,
            "seed_shift_probability": self.shift.probability,
            "seed_widened": ", ".join(widened),
        }
