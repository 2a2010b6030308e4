"""The online estimator: an extended Kalman filter around the seed (filterpy: in `reference` alone)."""

from winch_friction.estimation.answers import Estimate, ParameterEstimate
from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.estimator import FrictionEstimator

__all__ = ["Estimate", "EstimatorConfig", "FrictionEstimator", "ParameterEstimate"]
