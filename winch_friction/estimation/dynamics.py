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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.sample import heave_velocity
from winch_friction.physics.signals import FloatArray, Sample
from winch_friction.physics.winch.crane import Crane

# the states; behind them stand the scaled parameters
SPEED, STRETCH, LOAD_SPEED, LOAD, DISTURBANCE, ENCODER, ENCODER_CHANGE, FIRST_PARAMETER = range(8)
# what drives shaft and wire over a step: their own three states, the torque at the shaft, the heave velocity; and the
# wire's damping, were it larger by its whole, for each metre that the wire opens meanwhile
TORQUE, HEAVE, DAMPING, ACTING = 3, 4, 5, 6
# the noises of a step, behind the states
TORQUE_NOISE, HEAVE_NOISE, LOAD_SPEED_NOISE, LOAD_NOISE, DISTURBANCE_NOISE, ROUNDING_NOISE, NOISES = range(7)

DOUBTED_LOAD = 20.0  # times the load's random walk: what a slow load cell makes up for is followed in half a second
STICK_IGNORANCE = 30.0  # times the friction level
UNKNOWN_STRETCH = 1e-3  # m, of a wire whose past was not seen
UNKNOWN_LOAD_SPEED = 0.02  # m/s, of the load on it
STIFFEST = 40.0  # rad/s; a wire of unknown stiffness is taken as this stiff against the hanging mass

FreshState = tuple[int, float, float]  # which state, its value, its variance
Wire = Sequence[Sequence[float]]  # (3, 6) in plain floats: half of its use is one number at a time


class Step(NamedTuple):
    """What acts between two samples.

    `torque`: drive minus measured load, N m, its noise `variance` and what stick leaves unknown of it, (N m)^2;
    `friction`: N m, with its derivatives by all parameters; `by_sensors`: derivatives of the torque by the considered
    sensor errors; `wire` as from `wire_step`; heave velocity m/s; duration s; `doubted`: another load than the measured
    one hangs there.
    """

    torque: float
    variance: float
    unknown: float
    friction: float
    by_parameters: Sequence[float]
    by_sensors: Sequence[float]
    wire: Wire
    heave: float
    duration: float
    stick: bool
    doubted: bool = False


def wire_step(crane: Crane, mass: float, layer: float, length: float, damping: float, dt: float) -> Wire:
    """What [omega, stretch, v_load, torque, heave velocity, opening] make of the first three after `dt` s, (3, 6).

    For a hanging mass in kg on `length` m of wire, damped by `damping` N s/m; without a mass the shaft is alone. The
    trapezoidal rule is the mid-point rule here: the force in the wire at mid-step follows from the states at its
    start, and everything else from that force. The last column is what a damping that is larger by its whole does to
    first order, per m that the wire opens in this step.
    """
    inertia = crane.inertia
    if mass <= 0.0:
        return (1.0, 0.0, 0.0, dt / inertia, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    r = crane.drum.radius(layer) / crane.gear_ratio
    k = min(crane.wire_stiffness / length, mass * STIFFEST**2)
    half = 0.5 * dt
    # force = k stretch + stiff rate, rate = (v_heave + r omega - v_load + r half torque / J) - soft force, at mid-step
    stiff, soft = damping + k * half, half * (r * r / inertia + 1.0 / mass)
    whole = 1.0 / (1.0 + soft * stiff)
    rate = dt * whole  # of the stretch per m/s of what opens the wire
    pull = rate * stiff  # N s of force per m/s
    push = r * half / inertia  # m/s per N m
    at_shaft, at_load, spring = r / inertia, 1.0 / mass, dt * whole * k
    shaft, load, more = at_shaft * pull, at_load * pull, whole * damping
    return (
        (1.0 - shaft * r, -at_shaft * spring, shaft, dt / inertia - shaft * push, -shaft, -at_shaft * more),
        (rate * r, 1.0 - spring * soft, -rate, rate * push, rate, -soft * more),
        (load * r, at_load * spring, 1.0 - load, load * push, load, at_load * more),
    )


class Propagation:
    """The motion between two samples, with scaled parameters: their `scale` in SI, and which of all are `free`.

    `matrix` is [F | G], (n, n + NOISES): derivatives of the next states by the states and by the noises. Only the rows
    of shaft and wire change from step to step: they are `wire` times what each state and noise does to the five
    quantities that act.
    """

    def __init__(self, config: EstimatorConfig, free: NDArray[np.intp], scale: FloatArray) -> None:
        self._config, self._scales = config, (-scale).tolist()
        self._free = free.tolist()
        self.size = size = FIRST_PARAMETER + len(scale)
        self.matrix = np.zeros((size, size + NOISES))
        np.fill_diagonal(self.matrix, 1.0)
        self.matrix[ENCODER, ENCODER] = self.matrix[ENCODER_CHANGE, ENCODER_CHANGE] = 0.0
        self.matrix[ENCODER_CHANGE, ENCODER] = -1.0
        for state, noise in ((LOAD, LOAD_NOISE), (DISTURBANCE, DISTURBANCE_NOISE), (ENCODER, ROUNDING_NOISE)):
            self.matrix[state, size + noise] = 1.0
        self.matrix[ENCODER_CHANGE, size + ROUNDING_NOISE] = 1.0
        self._acting = np.zeros((ACTING, size + NOISES))
        self._acting[:TORQUE, :TORQUE] = np.eye(TORQUE)
        self._acting[TORQUE, [LOAD, DISTURBANCE]] = -1.0
        self._acting[TORQUE, size + TORQUE_NOISE] = 1.0
        self._acting[HEAVE, size + HEAVE_NOISE] = 1.0
        self._rows = self.matrix[:LOAD]
        self._by_parameters = self._acting[TORQUE, FIRST_PARAMETER:size]

    def take(self, step: Step, phi: FloatArray) -> tuple[float, float]:
        """Make `matrix` that of this step from the scaled parameters (m,).

        Returns what takes the place of the torque's and the heave's noise where the states themselves go through the
        matrix: the torque in N m at states and parameters of zero, such that at `phi` the friction is the step's, and
        the heave velocity in m/s.
        """
        gradient, wire = step.by_parameters, step.wire
        self._by_parameters[:] = [gradient[k] * scale for k, scale in zip(self._free, self._scales, strict=True)]
        np.array((*wire[0], *wire[1], *wire[2])).reshape(LOAD, ACTING).dot(self._acting, out=self._rows)
        self._rows[LOAD_SPEED, self.size + LOAD_SPEED_NOISE] = 1.0
        self.matrix[DISTURBANCE, DISTURBANCE] = fading(step.duration, self._config)
        return step.torque - step.friction - float(self._by_parameters.dot(phi)), step.heave


def fading(duration: float, config: EstimatorConfig) -> float:
    """What remains of a disturbance after `duration` s."""
    return math.exp(-duration / config.disturbance_time)


def noise_variances(step: Step, config: EstimatorConfig, factor: float, load_known: bool) -> tuple[float, ...]:
    """Variances of the noises of one step, (NOISES,), all but what stick leaves unknown times `factor`.

    In stick the friction is anywhere within its level and stays there as long as the winch does: taken as white noise
    of its own size it would average out over many steps and pull at the load, so that such steps count for next to
    nothing.
    """
    kept = fading(step.duration, config)
    walk = config.load_noise * (DOUBTED_LOAD if step.doubted else 1.0)
    return (
        factor * step.variance + step.unknown,
        factor * config.heave_noise**2,
        factor * config.payload_noise**2 * step.duration,
        0.0 if load_known else factor * walk * walk * step.duration,
        factor * config.disturbance_std**2 * (1.0 - kept * kept),
        factor * rounding_variance(config),
    )


def rounding_variance(config: EstimatorConfig) -> float:
    """Variance of one encoder angle's rounding, as a speed over one sample, (rad/s)^2."""
    return config.speed_step**2 / 12.0


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
