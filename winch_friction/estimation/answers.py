"""What an estimator says: at one instant, about one parameter, and how far a parameter may be believed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.filter import StateFilter
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray

STATUS_PERIOD = 0.1  # s between two looks at the statuses, which move over seconds


class Estimate(NamedTuple):
    """Outcome of one step.

    `accepted`: the sample changed the filter; `innovation` rad/s, its variance and `nis`, the squared ratio (NaN when
    nothing was predicted); `state`: learning, or why not: waiting, disabled, rejected, stick, saturation, no
    excitation, another load (than the measured one), restarted;
    `friction_torque`: N m at the shaft by the learned mean, NaN where the sample does not show it; `speed` rad/s;
    `drum_torque` N m.
    """

    time: float
    accepted: bool
    state: str
    innovation: float
    innovation_variance: float
    nis: float
    speed: float
    drum_torque: float
    friction_torque: float

    @property
    def valid(self) -> bool:
        """Whether the sample was taken in and shows a friction."""
        return self.accepted and math.isfinite(self.friction_torque)


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One parameter: SI value, standard deviation, and status seed / learning / learned / frozen / invalid.

    `prior_std` is the seed's sigma, or the wider one that took its place when the data refuted it.
    """

    name: str
    unit: str
    value: float
    std: float
    seed_value: float
    seed_std: float
    status: str
    prior_std: float = math.nan


def learned_model(parameters: ScaledParameters, phi: FloatArray, scaled: FloatArray, **origin: object) -> FrictionModel:
    """The seed's terms with the values of `phi` (n,) and the scaled covariance (n, n); `origin` goes into the
    provenance."""
    seed = parameters.seed
    provenance = {"method": "online estimate (extended Kalman filter)", "seed": seed.name, **origin}
    values = tuple(parameters.values(phi).tolist())
    return replace(seed, values=values, covariance=parameters.covariance(scaled), provenance=provenance)


def parameter_estimates(
    parameters: ScaledParameters, model: FrictionModel, statuses: Sequence[str]
) -> list[ParameterEstimate]:
    """Value, standard deviation and status of every parameter of the learned model."""
    seed = parameters.seed
    std, seed_std, prior_std = (
        model.std.tolist(),
        parameters.std(parameters.seed_prior),
        parameters.std(parameters.prior),
    )
    return [
        ParameterEstimate(p.name, p.unit, model.values[k], std[k], seed.values[k], seed_std[k], text, prior_std[k])
        for k, (p, text) in enumerate(zip(seed.parameters, statuses, strict=True))
    ]


class ParameterStatus:
    """Status of one parameter.

    `seed`: the data have not said anything about it; `learning`, `learned`: its sigma has fallen below a share of the
    seed's;
    `frozen`: it was learning, but learning rests; `invalid`: it stands at the edge of its range around the seed.
    A level is left only when the sigma has risen a hysteresis beyond it; frozen and invalid need to last.
    """

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self.level = "seed"
        self.frozen_for = 0.0
        self.limit_for = 0.0

    def step(self, share: float, frozen: bool, at_limit: bool, dt: float) -> None:
        """Take the sigma as a share of the seed's, and what was the case for the last `dt` s."""
        self.level = self._level(share)
        settle = self._config.settle_time
        self.frozen_for = min(self.frozen_for + dt, max(settle, dt)) if frozen else 0.0
        if at_limit:
            self.limit_for = min(self.limit_for + dt, max(2.0 * settle, dt))
        elif self.limit_for:
            self.limit_for = max(self.limit_for - dt, 0.0)

    @property
    def text(self) -> str:
        """The status to say."""
        if self._lasts(self.limit_for):
            return "invalid"
        if self.level != "seed" and self._lasts(self.frozen_for):
            return "frozen"
        return self.level

    def _lasts(self, seconds: float) -> bool:
        return seconds > 0.0 and seconds >= self._config.settle_time

    def _level(self, share: float) -> str:
        config = self._config
        learned = config.learned_below + (config.hysteresis if self.level == "learned" else 0.0)
        learning = config.learning_below + (config.hysteresis if self.level != "seed" else 0.0)
        if share < learned:
            return "learned"
        return "learning" if share < learning else "seed"


class ParameterStatuses:
    """The statuses of all parameters of a seed."""

    def __init__(self, config: EstimatorConfig, parameters: ScaledParameters) -> None:
        self._parameters = parameters
        self._each = [ParameterStatus(config) for _ in parameters.seed.values]
        self._since, self._frozen = 0.0, True

    def step(self, state: StateFilter, frozen: bool, dt: float) -> None:
        """Take the filter, and whether learning rested for `dt` s."""
        self._since += dt
        self._frozen = self._frozen and frozen
        if self._since < STATUS_PERIOD:
            return
        shares = np.sqrt(state.considered_variances / self._parameters.prior.diagonal()).tolist()
        limits = self._parameters.at_limit(state.phi).tolist()
        for index, share, limit in zip(self._parameters.free.tolist(), shares, limits, strict=True):
            self._each[index].step(share, self._frozen, limit, self._since)
        self._since, self._frozen = 0.0, True

    @property
    def texts(self) -> list[str]:
        """The statuses to say, in the seed's order."""
        return [each.text for each in self._each]

    @property
    def levels(self) -> list[str]:
        """Seed, learning or learned, in the seed's order: what a checkpoint keeps."""
        return [each.level for each in self._each]

    @levels.setter
    def levels(self, levels: Sequence[str]) -> None:
        for each, level in zip(self._each, levels, strict=True):
            each.level = level
