"""One step of the filter's states: shaft, wire and load, what is not explained, the encoder, the parameters."""

import math
from dataclasses import dataclass

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.friction import Friction
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.wire import WireStep
from winch_friction.physics.signals import FloatArray

SPEED, STRETCH, LOAD_SPEED, LOAD, DISTURBANCE, ENCODER, ENCODER_CHANGE, FIRST_PARAMETER = range(8)

STICK_IGNORANCE = 30.0  # times the friction level


@dataclass(frozen=True, slots=True)
class Step:
    """What acts between two samples: `torque` drive minus measured load, N m, and its variance; heave velocity m/s;
    duration s."""

    torque: float
    variance: float
    heave: float
    duration: float
    wire: WireStep
    friction: Friction
    stick: bool


def propagate(x: FloatArray, step: Step, config: EstimatorConfig) -> FloatArray:
    """The states (n, 1) one step on: load torque and parameters stay, the disturbance fades."""
    following = x.copy()
    torque = step.torque - x[LOAD, 0] - x[DISTURBANCE, 0] - step.friction.torque
    wire = step.wire
    following[:LOAD, 0] = wire.transition @ x[:LOAD, 0] + wire.by_torque * torque + wire.by_heave * step.heave
    following[DISTURBANCE, 0] *= fading(step.duration, config)
    following[ENCODER, 0], following[ENCODER_CHANGE, 0] = 0.0, -x[ENCODER, 0]
    return following


def measurement(size: int) -> FloatArray:
    """What the measured speed shows of the states, (1, n).

    A speed that is the difference of two encoder angles carries the difference of their roundings: what one speed
    shows too much, the
    next one shows too little. Taken as white it would hide most of what the speed says about a torque.
    """
    matrix = np.zeros((1, size))
    matrix[0, SPEED] = matrix[0, ENCODER_CHANGE] = 1.0
    return matrix


def jacobian(size: int, step: Step, config: EstimatorConfig, parameters: ScaledParameters) -> FloatArray:
    """Derivatives of `propagate` by the states, (n, n)."""
    matrix = np.eye(size)
    matrix[:LOAD, :LOAD] = step.wire.transition
    matrix[:LOAD, LOAD] = matrix[:LOAD, DISTURBANCE] = -step.wire.by_torque
    gradient = np.asarray(step.friction.by_parameters, float)[parameters.free] * parameters.scale
    matrix[:LOAD, FIRST_PARAMETER:] = -np.outer(step.wire.by_torque, gradient)
    matrix[DISTURBANCE, DISTURBANCE] = fading(step.duration, config)
    matrix[ENCODER, ENCODER] = matrix[ENCODER_CHANGE, ENCODER_CHANGE] = 0.0
    matrix[ENCODER_CHANGE, ENCODER] = -1.0
    return matrix


def fading(duration: float, config: EstimatorConfig) -> float:
    """What remains of a disturbance after `duration` s."""
    return math.exp(-duration / config.disturbance_time)


def process_noise(size: int, step: Step, config: EstimatorConfig, factor: float, load_known: bool) -> FloatArray:
    """Process noise of all but the parameters, (n, n), its variances times `factor`; the parameters' is `forgotten`.

    In stick the friction is anywhere within its level and stays there as long as the winch does: taken as white noise
    of
    its own size it would average out over many steps and pull at the load, so that such steps count for next to
    nothing.
    """
    noise = np.zeros((size, size))
    unknown = (STICK_IGNORANCE * step.friction.magnitude) ** 2 if step.stick else 0.0
    wire = step.wire
    noise[:LOAD, :LOAD] = (step.variance + unknown / factor) * np.outer(wire.by_torque, wire.by_torque)
    noise[:LOAD, :LOAD] += config.heave_noise**2 * np.outer(wire.by_heave, wire.by_heave)
    noise[LOAD_SPEED, LOAD_SPEED] += config.payload_noise**2 * step.duration
    noise[LOAD, LOAD] = 0.0 if load_known else config.load_noise**2 * step.duration
    noise[DISTURBANCE, DISTURBANCE] = config.disturbance_std**2 * (1.0 - fading(step.duration, config) ** 2)
    noise[ENCODER : ENCODER_CHANGE + 1, ENCODER : ENCODER_CHANGE + 1] = rounding_variance(config)
    return factor * noise


def rounding_variance(config: EstimatorConfig) -> float:
    """Variance of one encoder angle's rounding, as a speed over one sample, (rad/s)^2."""
    return config.speed_step**2 / 12.0


def forgotten(covariance: FloatArray, duration: float, config: EstimatorConfig, prior: FloatArray) -> FloatArray:
    """Process noise of the parameters: what takes their covariance towards the seed's, and never beyond it.

    (1 - share) P + share P_seed: a direction that was not learned has P = P_seed and gets no noise.
    """
    share = min(1.0, duration / config.forgetting_time)
    return share * (prior - covariance[FIRST_PARAMETER:, FIRST_PARAMETER:])
