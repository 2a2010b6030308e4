"""What was learned, for others: as a model, and parameter by parameter."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.estimation.estimate import ParameterEstimate
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray


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
    seed_std = np.sqrt(np.diag(parameters.covariance(parameters.prior)))
    return [
        ParameterEstimate(
            p.name, p.unit, model.values[k], float(model.std[k]), seed.values[k], float(seed_std[k]), text
        )
        for k, (p, text) in enumerate(zip(seed.parameters, statuses, strict=True))
    ]
