"""The states that move, as they are taken from one sample after a gap, and the load as the first sample shows it."""

from winch_friction.estimation import prediction
from winch_friction.estimation.accepted import heave_velocity
from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.prediction import (
    DISTURBANCE,
    ENCODER,
    ENCODER_CHANGE,
    LOAD_SPEED,
    SPEED,
    STRETCH,
)
from winch_friction.physics.signals import FloatArray, Sample
from winch_friction.physics.winch.crane import Crane

UNKNOWN_STRETCH = 1e-3  # m, of a wire whose past was not seen
UNKNOWN_LOAD_SPEED = 0.02  # m/s, of the load on it

FreshState = tuple[int, float, float]  # which state, its value, its variance


def fresh_motion(sample: Sample, crane: Crane, config: EstimatorConfig, speed_variance: float) -> list[FreshState]:
    """Everything that moves, with the load following the wire; `speed_variance` in (rad/s)^2."""
    r = crane.drum.radius(sample.wire_layer) / crane.gear_ratio
    speed = sample.motor_speed
    variance = speed_variance + 2.0 * prediction.rounding_variance(config)
    return [
        (SPEED, speed, variance),
        (STRETCH, 0.0, UNKNOWN_STRETCH**2),
        (LOAD_SPEED, heave_velocity(sample) + r * speed, r * r * variance + UNKNOWN_LOAD_SPEED**2),
        (DISTURBANCE, 0.0, config.disturbance_std**2),
        (ENCODER, 0.0, prediction.rounding_variance(config)),
        (ENCODER_CHANGE, 0.0, 0.0),
    ]


def replaced(x: FloatArray, covariance: FloatArray, fresh: list[FreshState]) -> tuple[FloatArray, FloatArray]:
    """State (n, 1) and covariance (n, n) with these states taken anew, correlated with nothing; the rest is kept."""
    x, covariance = x.copy(), covariance.copy()
    for state, value, variance in fresh:
        covariance[state, :] = covariance[:, state] = 0.0
        covariance[state, state] = variance
        x[state, 0] = value
    return x, covariance
