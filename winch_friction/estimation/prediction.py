"""One step of the filter's states: shaft speed, load torque, disturbance, scaled friction parameters."""

import math
from dataclasses import dataclass

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.friction import Friction
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.physics.signals import FloatArray

SPEED, LOAD, DISTURBANCE, FIRST_PARAMETER = 0, 1, 2, 3


@dataclass(frozen=True, slots=True)
class Step:
    """What acts between two samples: `drive` minus the measured load, N m; its variance; inertia kg m^2; duration s."""

    torque: float
    variance: float
    inertia: float
    duration: float
    friction: Friction
    stick: bool


def propagate(x: FloatArray, step: Step, config: EstimatorConfig) -> FloatArray:
    """The states (n, 1) one step on.

    J domega/dt = drive - load - disturbance - friction; the load torque is constant, the disturbance fades, the
    parameters stay.
    """
    following = x.copy()
    unexplained = x[LOAD, 0] + x[DISTURBANCE, 0]
    following[SPEED, 0] += step.duration / step.inertia * (step.torque - unexplained - step.friction.torque)
    following[DISTURBANCE, 0] *= fading(step.duration, config)
    return following


def jacobian(size: int, step: Step, config: EstimatorConfig, parameters: ScaledParameters) -> FloatArray:
    """Derivatives of `propagate` by the states, (n, n)."""
    matrix = np.eye(size)
    rate = step.duration / step.inertia
    matrix[SPEED, LOAD] = matrix[SPEED, DISTURBANCE] = -rate
    gradient = np.asarray(step.friction.by_parameters, float)[parameters.free]
    matrix[SPEED, FIRST_PARAMETER:] = -rate * gradient * parameters.scale
    matrix[DISTURBANCE, DISTURBANCE] = fading(step.duration, config)
    return matrix


def fading(duration: float, config: EstimatorConfig) -> float:
    """What remains of a disturbance after `duration` s."""
    return math.exp(-duration / config.disturbance_time)


def process_noise(size: int, step: Step, config: EstimatorConfig, load_known: bool) -> FloatArray:
    """Process noise of speed, load torque and disturbance, (n, n); the parameters' is `forgotten`.

    In stick the friction is anywhere within its level, so the step says nothing about torques.
    """
    noise = np.zeros((size, size))
    rate = step.duration / step.inertia
    unknown = step.friction.magnitude**2 if step.stick else 0.0
    noise[SPEED, SPEED] = rate * rate * (step.variance + unknown)
    noise[LOAD, LOAD] = 0.0 if load_known else config.load_noise**2 * step.duration
    noise[DISTURBANCE, DISTURBANCE] = config.disturbance_std**2 * (1.0 - fading(step.duration, config) ** 2)
    return noise


def forgotten(covariance: FloatArray, duration: float, config: EstimatorConfig, prior: FloatArray) -> FloatArray:
    """Process noise of the parameters: what takes their covariance towards the seed's, and never beyond it.

    (1 - share) P + share P_seed: a direction that was not learned has P = P_seed and gets no noise.
    """
    share = min(1.0, duration / config.forgetting_time)
    return share * (prior - covariance[FIRST_PARAMETER:, FIRST_PARAMETER:])
