"""How the filter's states go from one sample to the next, with what noise, and how they begin.

Shaft, elastic wire and hanging mass are one linear system, stepped by the trapezoidal (Tustin) rule:

    J domega/dt = torque - r (k stretch + c rate)
    dstretch/dt = rate = v_heave + r omega - v_load
    m dv_load/dt = k stretch + c rate

with r = R/i the rope speed per shaft speed and stretch counted from the static one. A payload taken as rigid with the
shaft would leave the wire's mode (1.5 to 3 Hz), which every reversal excites, to be explained by friction.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.sample import heave_velocity
from winch_friction.physics.signals import FloatArray, Sample
from winch_friction.physics.winch.crane import Crane

SPEED, STRETCH, LOAD_SPEED, LOAD, DISTURBANCE, ENCODER, ENCODER_CHANGE, FIRST_PARAMETER = range(8)

STICK_IGNORANCE = 30.0  # times the friction level
UNKNOWN_STRETCH = 1e-3  # m, of a wire whose past was not seen
UNKNOWN_LOAD_SPEED = 0.02  # m/s, of the load on it
STIFFEST = 40.0  # rad/s; a wire of unknown stiffness is taken as this stiff against the hanging mass

FreshState = tuple[int, float, float]  # which state, its value, its variance


@dataclass(frozen=True, slots=True)
class WireStep:
    """One step of [omega, stretch, v_load]: transition (3, 3), and what torque (N m) and heave velocity (m/s) add
    (3,)."""

    transition: FloatArray
    by_torque: FloatArray
    by_heave: FloatArray


def wire_step(crane: Crane, mass: float, layer: float, length: float, damping: float, dt: float) -> WireStep:
    """The step for a hanging mass in kg on `length` m of wire, damped by `damping` N s/m; without a mass the shaft is
    alone."""
    if mass <= 0.0:
        return WireStep(np.eye(3), np.array([dt / crane.inertia, 0.0, 0.0]), np.zeros(3))
    r = crane.drum.radius(layer) / crane.gear_ratio
    k = min(crane.wire_stiffness / length, mass * STIFFEST**2)
    shaft = r / crane.inertia
    rates = np.array(
        [
            [-damping * r * shaft, -k * shaft, damping * shaft],
            [r, 0.0, -1.0],
            [damping * r / mass, k / mass, -damping / mass],
        ]
    )
    solved = np.linalg.inv(np.eye(3) - 0.5 * dt * rates)
    by_torque = np.asarray(dt / crane.inertia * solved[:, 0], float)
    by_heave = np.asarray(dt * (solved @ np.array([-damping * shaft, 1.0, damping / mass])), float)
    return WireStep(solved @ (np.eye(3) + 0.5 * dt * rates), by_torque, by_heave)


@dataclass(frozen=True, slots=True)
class Friction:
    """Friction at one operating point, N m: torque, its derivatives by the parameters, and what a full direction
    would make of it."""

    torque: float
    by_parameters: Sequence[float]
    magnitude: float


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


def fresh_motion(sample: Sample, crane: Crane, config: EstimatorConfig, speed_variance: float) -> list[FreshState]:
    """Everything that moves, with the load following the wire; `speed_variance` in (rad/s)^2."""
    r = crane.drum.radius(sample.wire_layer) / crane.gear_ratio
    speed = sample.motor_speed
    variance = speed_variance + 2.0 * rounding_variance(config)
    return [
        (SPEED, speed, variance),
        (STRETCH, 0.0, UNKNOWN_STRETCH**2),
        (LOAD_SPEED, heave_velocity(sample) + r * speed, r * r * variance + UNKNOWN_LOAD_SPEED**2),
        (DISTURBANCE, 0.0, config.disturbance_std**2),
        (ENCODER, 0.0, rounding_variance(config)),
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
