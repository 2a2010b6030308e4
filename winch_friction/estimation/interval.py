"""What acts between two samples: torque balance, wire and friction at the mean point of the interval."""

import math
from collections.abc import Sequence

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.dynamics import Friction, Step, WireStep, wire_step
from winch_friction.estimation.sample import Accepted, HangingLoad, heave_velocity, torque_variance
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import CompiledTerms
from winch_friction.physics.friction.state import advance_all
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import sample_operating_point
from winch_friction.physics.winch.torque_balance import sample_drive_torque


class FrictionFunctions:
    """Evaluates the seed's terms; keeps the memory of those that have one."""

    def __init__(self, seed: FrictionModel) -> None:
        self._seed = seed
        self._compiled: dict[int, CompiledTerms] = {}
        self.memory: tuple[float, ...] | None = None

    def at(self, x: Sequence[float], theta: Sequence[float], groups: int) -> Friction:
        """Friction at the operating point `x` with the parameter values `theta`."""
        functions = self._functions(groups)
        memory = self._memory(functions)
        torque, _, *gradient = functions.scalar_torque_and_gradient(x, theta, memory)
        full = functions.scalar_torque((1.0, *x[1:]), theta, memory)
        return Friction(torque, gradient, abs(full - functions.scalar_torque((0.0, *x[1:]), theta, memory)))

    def advanced(self, x: Sequence[float], theta: Sequence[float], groups: int, dt: float) -> tuple[float, ...]:
        """The memory `dt` s later."""
        functions = self._functions(groups)
        return advance_all(functions, x, theta, self._memory(functions), dt)

    def _memory(self, functions: CompiledTerms) -> tuple[float, ...]:
        if self.memory is None or len(self.memory) != len(functions.initial_states):
            return functions.initial_states
        return self.memory

    def _functions(self, groups: int) -> CompiledTerms:
        if groups not in self._compiled:
            self._compiled[groups] = self._seed.compile(groups)
        return self._compiled[groups]


def mean_direction(before: float, after: float) -> float:
    """Mean of the sign of a speed that goes linearly from `before` to `after`, between -1 and 1."""
    if before * after >= 0.0:
        total = before + after
        return float(total > 0.0) - float(total < 0.0)
    return (abs(after) - abs(before)) / (after - before)


Point = tuple[float, ...]  # an operating point in the order of `symbols.layout`


class Intervals:
    """Makes the filter's steps from samples, with the load and the friction functions as they stand.

    `extra` is the load torque at the shaft beyond the measured load's, N m; `theta` the parameter values, SI, in the
    seed's order.
    """

    def __init__(self, crane: Crane, config: EstimatorConfig, load: HangingLoad, friction: FrictionFunctions) -> None:
        self._crane, self._config, self._load, self._friction = crane, config, load, friction

    def between(self, last: Accepted, sample: Sample, theta: Sequence[float], extra: float) -> tuple[Step, Point]:
        """The step from the last accepted sample to this one, and its mean operating point."""
        point, friction = self.at(sample, 0.5 * (last.speed + sample.motor_speed), last.speed, theta, extra)
        drive = 0.5 * (last.drive + sample_drive_torque(sample, self._crane))
        heave = 0.5 * (last.heave + heave_velocity(sample))
        stick = min(abs(last.speed), abs(sample.motor_speed)) < self._config.stick_speed
        variance = torque_variance(sample, self._crane, self._config)
        duration = sample.time - last.time
        torque = drive - self._load.shaft_torque(sample.wire_layer)
        return Step(torque, variance, heave, duration, self._wire(sample, extra, duration), friction, stick), point

    def at(
        self, sample: Sample, speed: float, before: float, theta: Sequence[float], extra: float
    ) -> tuple[Point, Friction]:
        """Operating point and friction of a sample, taken at `speed` after the speed `before`, rad/s."""
        load_torque = self._load.shaft_torque(sample.wire_layer) if self._load.measured else extra
        drum_torque = self._crane.gear_ratio * load_torque
        point = sample_operating_point(sample, self._crane, drum_torque=drum_torque, speed=speed)
        magnitude = 0.5 * (abs(before) + abs(sample.motor_speed))
        mean = (mean_direction(before, sample.motor_speed), magnitude, *point[2:])
        return mean, self._friction.at(mean, theta, len(sample.groups))

    def _wire(self, sample: Sample, extra: float, duration: float) -> WireStep:
        length = sample.wire_out if math.isfinite(sample.wire_out) else self._config.wire_length
        mass = self._load.mass_by(extra, sample.wire_layer)
        damping = self._config.wire_damping
        return wire_step(self._crane, mass, sample.wire_layer, max(1.0, length), damping, duration)
