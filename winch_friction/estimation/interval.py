"""What acts between two samples: torque balance, wire and friction at the mean point of the interval."""

import math
from collections.abc import Sequence

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.estimation.dynamics import STICK_IGNORANCE, Step, Wire, wire_step
from winch_friction.estimation.sample import Accepted, HangingLoad, torque_variance
from winch_friction.estimation.sensor_errors import Point, SensorErrors
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import CompiledTerms, advance_all
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.operating_point import sample_operating_point

# the friction of a step is taken at its middle; between samples that are far apart its mean is anywhere within plus and
# minus what it changes by, whichever way drive and shaft went from one to the other: of that change squared
WITHIN = 1.0 / 3.0
# its drive torque is taken on a straight line from one sample to the next; where it bends the mean is anywhere within
# plus and minus half of the second difference, of which squared: a pump's pressure swings against the oil and the load
# faster than a slow PLC looks
BENT = 1.0 / 12.0


class FrictionFunctions:
    """Evaluates the seed's terms at an operating point with whatever parameter values; keeps their memory."""

    def __init__(self, seed: FrictionModel) -> None:
        self._seed = seed
        self._compiled: dict[int, CompiledTerms] = {}
        self.memory: tuple[float, ...] | None = None

    def at(self, x: Point, theta: Sequence[float], groups: int) -> tuple[float, Sequence[float]]:
        """Friction torque, N m, and its derivatives by the parameters."""
        functions = self._functions(groups)
        found = functions.scalar_torque_and_gradient(x, theta, self._memory(functions))
        return found[0], found[2:]

    def torque(self, x: Point, theta: Sequence[float], groups: int) -> float:
        """Friction torque alone, N m."""
        functions = self._functions(groups)
        return functions.scalar_torque(x, theta, self._memory(functions))

    def magnitude(self, x: Point, theta: Sequence[float], groups: int) -> float:
        """What a full direction would make of the friction, N m."""
        return abs(self.torque((1.0, *x[1:]), theta, groups) - self.torque((0.0, *x[1:]), theta, groups))

    def advance(self, x: Point, theta: Sequence[float], groups: int, dt: float) -> None:
        """Let `dt` s pass for the terms that have a memory."""
        functions = self._functions(groups)
        if functions.initial_states:
            self.memory = advance_all(functions, x, theta, self._memory(functions), dt)

    def _memory(self, functions: CompiledTerms) -> tuple[float, ...]:
        if self.memory is None or len(self.memory) != len(functions.initial_states):
            return functions.initial_states
        return self.memory

    def _functions(self, groups: int) -> CompiledTerms:
        found = self._compiled.get(groups)
        if found is None:
            found = self._compiled[groups] = self._seed.compile(groups)
        return found


def mean_direction(before: float, after: float) -> float:
    """Mean of the sign of a speed that goes linearly from `before` to `after`, between -1 and 1."""
    if before * after >= 0.0:
        total = before + after
        return float(total > 0.0) - float(total < 0.0)
    return (abs(after) - abs(before)) / (after - before)


class Intervals:
    """Makes the filter's steps from samples, with the load and the friction functions as they stand.

    `extra` is the load torque at the shaft beyond the measured load's, N m; `theta` the parameter values, SI, in the
    seed's order.
    """

    def __init__(
        self,
        crane: Crane,
        config: EstimatorConfig,
        load: HangingLoad,
        friction: FrictionFunctions,
        errors: SensorErrors,
    ) -> None:
        self._crane, self._config, self._load, self._friction = crane, config, load, friction
        self._errors = errors

    def between(
        self, last: Accepted, now: Accepted, sample: Sample, theta: Sequence[float], extra: float
    ) -> tuple[Step, Point]:
        """The step from the last accepted sample to this one, and its mean operating point."""
        config, duration = self._config, now.time - last.time
        measured_load = self._load.shaft_torque(now.layer)
        point = self.point(sample, 0.5 * (last.speed + now.speed), last.speed, measured_load, extra)
        friction, gradient = self._friction.at(point, theta, len(sample.groups))
        drive, heave = last.means(now, config.speed_delay)
        stick = min(abs(last.speed), abs(now.speed)) < config.stick_speed
        unknown = 0.0
        if stick:
            unknown = (STICK_IGNORANCE * self._friction.magnitude(point, theta, len(sample.groups))) ** 2
        elif abs(now.speed - last.speed) > config.stick_speed:
            unknown = WITHIN * self._change(point, last.speed, now.speed, theta, len(sample.groups)) ** 2
        unknown += BENT * last.bend(now) ** 2
        groups = len(sample.groups)
        errors = self._errors.by(
            sample, drive, now.drive - last.drive, point, friction, lambda x: self._friction.torque(x, theta, groups)
        )
        step = Step(
            drive - measured_load, torque_variance(sample, self._crane, config), unknown, friction, gradient, errors,
            self._wire(sample, extra, duration), heave, duration, stick, self._load.doubted,
        )  # fmt: skip
        return step, point

    def _change(self, point: Point, before: float, after: float, theta: Sequence[float], groups: int) -> float:
        """By how much the friction differs between two speeds, rad/s, at an operating point otherwise, N m."""
        ends = [(math.copysign(1.0, speed), abs(speed), speed, *point[3:]) for speed in (before, after)]
        one, other = (self._friction.torque(end, theta, groups) for end in ends)
        return other - one

    def point(self, sample: Sample, speed: float, before: float, measured_load: float, extra: float) -> Point:
        """Operating point of a sample, taken at `speed` after the speed `before`, rad/s; loads in N m at the shaft."""
        load_torque = measured_load if self._load.measured else extra
        drum_torque = self._crane.gear_ratio * load_torque
        point = sample_operating_point(sample, self._crane, drum_torque=drum_torque, speed=speed)
        magnitude = 0.5 * (abs(before) + abs(sample.motor_speed))
        return (mean_direction(before, sample.motor_speed), magnitude, *point[2:])

    def _wire(self, sample: Sample, extra: float, duration: float) -> Wire:
        length = sample.wire_out if math.isfinite(sample.wire_out) else self._config.wire_length
        mass = self._load.mass_by(extra, sample.wire_layer)
        damping = self._config.wire_damping
        return wire_step(self._crane, mass, sample.wire_layer, max(1.0, length), damping, duration)
