"""Bootstrap over tests: how far the estimate moves when other tests had been driven."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.identification.joint_fit import JointFit, joint_fit, observations
from winch_friction.identification.plateaus import Plateau
from winch_friction.identification.prior import UnitSpread
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane


@dataclass(frozen=True)
class Bootstrap:
    """Estimates (resamples, parameters), and their standard deviations beside those of the linearised covariance."""

    names: tuple[str, ...]
    estimates: FloatArray
    linearised_std: FloatArray

    @property
    def std(self) -> FloatArray:
        """Spread over the resamples (parameters,): half the width of their central 68 %.

        A resample of light tests alone says nothing about load terms; quantiles keep such a one from deciding.
        """
        lower, upper = np.quantile(self.estimates, [0.1587, 0.8413], axis=0)
        return 0.5 * (upper - lower)


def bootstrap(
    tests: Sequence[Sequence[Plateau]],
    crane: Crane,
    fitted: JointFit,
    spread: UnitSpread,
    *,
    resamples: int = 40,
    seed: int = 0,
) -> Bootstrap:
    """Repeat the joint fit on tests drawn with replacement.

    The prior's centre is drawn anew from the prior each time, so that directions that only the prior knows spread too.
    """
    generator = np.random.default_rng(seed)
    rows = []
    for _ in range(resamples):
        chosen = [tests[k] for k in generator.integers(len(tests), size=len(tests))]
        prior = _drawn(fitted.prior, generator)
        rows.append(joint_fit(observations(chosen, crane), prior, spread).model.values)
    return Bootstrap(fitted.model.parameter_names, np.array(rows), fitted.model.std)


def _drawn(prior: FrictionModel, generator: np.random.Generator) -> FrictionModel:
    if prior.covariance is None:
        return prior
    # in units of the deviations: variances of 1e16 beside 1e-31 leave nothing of the smaller ones
    scale = np.where(prior.std > 0.0, prior.std, 1.0)
    steps = generator.multivariate_normal(np.zeros(len(scale)), prior.covariance / np.outer(scale, scale), method="svd")
    values = np.asarray(prior.values) + scale * steps
    bounds = np.array([prior.bounds_of(name) for name in prior.parameter_names])
    return prior.with_values(np.clip(values, bounds[:, 0], bounds[:, 1]).tolist())
