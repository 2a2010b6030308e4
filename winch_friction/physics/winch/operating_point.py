"""From measured signals to the operating point that every friction function takes (`compiled.operating_point`), now or
at the speed ahead, and what of them this crane can show at all.

The ranges, and the largest rate of each channel, come from the crane itself. They are tighter than the
limits of `physics.channels`, which say only what any winch's sensor could mean: a value outside is a broken sensor, a
wrong unit or somebody else's message.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY, LIMITS, RPM, WINCH, limits_of
from winch_friction.physics.friction.compiled import DEFAULTS, ORDER, group_point, operating_point
from winch_friction.physics.signals import FloatArray, Run, Sample
from winch_friction.physics.winch.crane import Crane, group_roles


# -- the direction of motion
def smooth_sign(speed: float, width: float) -> float:
    """tanh(speed/width); the sign itself for width 0. Both in rad/s."""
    if width > 0.0:
        return math.tanh(speed / width)
    return float(speed > 0.0) - float(speed < 0.0)


def smooth_signs(speed: Any, width: Any) -> np.ndarray:
    """`smooth_sign` over arrays; `width` may be an array of the same shape."""
    speed = np.asarray(speed, float)
    safe = np.where(np.asarray(width) > 0.0, width, 1.0)
    return np.where(np.asarray(width) > 0.0, np.tanh(speed / safe), np.sign(speed))


# -- the speed ahead
class PredictedSpeed(NamedTuple):
    """Speed and acceleration `lead` seconds ahead, rad/s and rad/s^2."""

    speed: float
    acceleration: float


class SpeedPredictor:
    """Extrapolates a sampled speed: omega + a t + j t^2 / 2, with a and j from backward differences.

    A backward difference is the acceleration half a step ago; the jerk brings it up to date. The jerk is low-passed,
    for it is the second difference of what may be a quantised signal.
    """

    def __init__(self, lead: float, acceleration_filter: float, jerk_filter: float) -> None:
        self._lead = lead
        self._acceleration_filter = acceleration_filter
        self._jerk_filter = jerk_filter
        self.reset()

    def reset(self) -> None:
        """Forget the past; the next speed is taken as constant."""
        self._time = math.nan
        self._speed = 0.0
        self._acceleration = math.nan
        self._jerk = self._half = 0.0

    def step(self, time: float, speed: float) -> PredictedSpeed:
        """Take the speed in rad/s at `time` s; a time that does not advance leaves the derivatives as they are."""
        dt = time - self._time
        if dt > 0.0:
            self._differentiate(dt, (speed - self._speed) / dt)
        if not dt <= 0.0:
            self._time, self._speed = time, speed
        acceleration = 0.0 if math.isnan(self._acceleration) else self._acceleration
        age = self._lead + self._half
        ahead = acceleration + self._jerk * age
        mean = acceleration + self._jerk * (age - 0.5 * self._lead)
        return PredictedSpeed(speed + mean * self._lead, ahead)

    def _differentiate(self, dt: float, slope: float) -> None:
        self._half = 0.5 * dt
        if math.isnan(self._acceleration):
            self._acceleration = slope
            return
        acceleration = self._acceleration + (slope - self._acceleration) * dt / (dt + self._acceleration_filter)
        jerk = (acceleration - self._acceleration) / dt
        self._jerk += (jerk - self._jerk) * dt / (dt + self._jerk_filter)
        self._acceleration = acceleration


def time_to_reversal(ahead: PredictedSpeed) -> float:
    """Seconds until the motion turns if the acceleration stays."""
    return -ahead.speed / ahead.acceleration if ahead.speed * ahead.acceleration < 0.0 else math.inf


# -- the command beside the speed
# a winch follows within its lag (0.1 s at 130 rad/s^2 is 13 rad/s): command and speed that are further apart than this
# share of the larger one and this share of the largest speed contradict each other
SPEED_SHARE, SPEED_APART = 0.3, 0.1


def fastest_command(speed: float, largest: float) -> float:
    """The fastest command, rad/s, that a measured speed does not contradict, of a winch whose `largest` is this."""
    return (abs(speed) + SPEED_APART * largest) / (1.0 - SPEED_SHARE)


# -- the operating point of a sample, or of each of a run
# m^3/rad; the feedback of a motor that is swung out reads about zero, of which a power law has no logarithm, and below
LEAST_DISPLACEMENT = 1e-12
# of the largest displacement, from which on a torque tells the pressure: at 300 bar each step of the fixed point leaves
# a fifth of what was wrong (2 K5 p/D); at a fiftieth of the stroke it leaves all, and below it makes more
TELLING_STROKE = 0.1
# what of them is a channel of its own: taken from a sample or run as it is, where it is there
CHANNEL_SIGNALS = tuple(name for name in DEFAULTS if name in WINCH)
# places for the one point of a sample, which a node needs at every step
_TEMPLATE: list[Any] = [DEFAULTS.get(name) for name in ORDER]
_PLACES = tuple(ORDER.index(name) for name in CHANNEL_SIGNALS)
_channels_of = attrgetter(*CHANNEL_SIGNALS)
_DIRECTION, _MAGNITUDE, _SPEED, _DRUM_TORQUE, _ACCELERATION, _MOTOR_TOTAL, _WIRE_LAYER = (
    ORDER.index(name)
    for name in ("direction", "speed_magnitude", "speed", "drum_torque", "acceleration", "motor_total", "wire_layer")
)


def sample_operating_point(
    sample: Sample, crane: Crane, *, drum_torque: float, speed: float, width: float = 0.0, acceleration: float = 0.0
) -> tuple[float, ...]:
    """The operating point of one sample at a given speed; `width` smooths the direction, rad/s."""
    x: list[Any] = _TEMPLATE.copy()
    x[_WIRE_LAYER] = float(len(crane.drum.layer_radii))
    for index, value in zip(_PLACES, _channels_of(sample), strict=True):
        if value == value:
            x[index] = value
    x[_DIRECTION], x[_MAGNITUDE], x[_SPEED] = smooth_sign(speed, width), abs(speed), speed
    x[_DRUM_TORQUE], x[_ACCELERATION] = drum_torque, acceleration
    total = 0
    roles = group_roles(tuple(sample.groups))
    for name, g in sample.groups.items():
        a, b, count = g.pressure_a, g.pressure_b, crane.motor_count(name)
        total += count
        x += count, abs(a - b), a + b, max(g.displacement, LEAST_DISPLACEMENT), -1.0 if a < b else 1.0, roles[name]
    x[_MOTOR_TOTAL] = total if sample.groups else crane.motor_total(())
    return tuple(x)


def run_operating_points(
    run: Run, crane: Crane, *, drum_torque: FloatArray, width: float = 0.0, acceleration: Any = 0.0
) -> tuple[Any, ...]:
    """The operating points of a whole run as arrays of one length."""
    speed = run["motor_speed"]
    outer = np.full(len(run), float(len(crane.drum.layer_radii)))
    optional = {"wire_layer": outer} | {name: run[name] for name in CHANNEL_SIGNALS if name in run}
    return operating_point(
        direction=smooth_signs(speed, width),
        speed=speed,
        drum_torque=drum_torque,
        groups=[run_group(run, crane, group) for group in run.groups],
        motor_total=np.full(len(run), crane.motor_total(run.groups)),
        acceleration=acceleration,
        **optional,
    )


def run_group(run: Run, crane: Crane, group: str) -> tuple[Any, ...]:
    """`group_point` of one group along a run."""
    a, b = run[f"{group}.pressure_a"], run[f"{group}.pressure_b"]
    displacement = np.maximum(run[f"{group}.displacement"], LEAST_DISPLACEMENT)
    role = group_roles(tuple(run.groups))[group]
    return group_point(np.full(len(run), crane.motor_count(group)), a - b, displacement, a + b, role)


# -- what this crane can show

# where the crane file does not say (docs/safety.md)
RATED_PRESSURE = 450.0 * BAR  # peak of the usual axial-piston motors (nominal 400 bar)
RATED_SPEED, RATED_SIZE = 4800.0 * RPM, 215.0 * CM3_PER_REV  # a 215 cm^3 motor swung back; smaller ones turn faster
SIZE_EXPONENT = -1.0 / 3.0  # of a motor series: the same velocity of its pistons
# factors over the rated value
PRESSURE_MARGIN = 4.0 / 3.0  # 600 bar, the usual transducer's full scale
LOWEST_PRESSURE = -100.0 * BAR  # a zero error is far above; a broken 4 ... 20 mA loop says -150 bar
SPEED_MARGIN = 1.25
LOAD_MARGIN = 2.0  # dynamic amplification of a lift through the splash zone
LIGHTEST_LOAD = -0.05  # of the rated one: a load cell's zero error
DISPLACEMENT_MARGIN = 0.05  # of D_max: feedback of 1-3 %
MOST_HEAVE = 10.0  # m/s, crane tip


@dataclass(frozen=True, slots=True)
class Change:
    """The most that a channel changes: `per_second`, and `at_once` for noise, quantisation and skew."""

    per_second: float
    at_once: float


class ChannelRanges:
    """Ranges and rates of a crane's channels, SI; `groups` are the motor groups on the shaft (default: all)."""

    def __init__(self, crane: Crane, groups: Sequence[str] = ()) -> None:
        self.crane = crane
        self.pressure = (crane.rated_pressure or RATED_PRESSURE) * PRESSURE_MARGIN
        self.speed = self._speed()
        self.load = self._load(groups)
        self._ranges = {**LIMITS, **self._of_crane()}
        self._changes = self._largest_changes()

    def _speed(self) -> float:
        if self.crane.rated_speed:
            return self.crane.rated_speed * SPEED_MARGIN
        if not self.crane.max_displacement:
            return LIMITS["motor_speed"][1]
        return RATED_SPEED * SPEED_MARGIN * (self.crane.max_displacement / RATED_SIZE) ** SIZE_EXPONENT

    def _load(self, groups: Sequence[str]) -> float:
        """kg: the rated load with its margin, else what the motors can hold at all."""
        crane = self.crane
        if crane.rated_load:
            return crane.rated_load * LOAD_MARGIN
        torque = crane.motor_total(tuple(groups)) * crane.max_displacement * (crane.rated_pressure or RATED_PRESSURE)
        held = torque * crane.gear_ratio / (GRAVITY * crane.drum.layer_radii[0])
        return held or LIMITS["hook_load"][1]

    def _of_crane(self) -> dict[str, tuple[float, float]]:
        ranges = {
            "motor_speed": (-self.speed, self.speed),
            "speed_reference": (-self.speed, self.speed),
            "hook_load": (LIGHTEST_LOAD * self.load, self.load),
            "rope_force": (LIGHTEST_LOAD * self.load * GRAVITY, self.load * GRAVITY),
            "heave_velocity": (-MOST_HEAVE, MOST_HEAVE),
            "wire_layer": (0.5, len(self.crane.drum.layer_radii) + 0.5),
            "pressure_a": (LOWEST_PRESSURE, self.pressure),
            "pressure_b": (LOWEST_PRESSURE, self.pressure),
        }
        if self.crane.max_displacement:
            tolerance = DISPLACEMENT_MARGIN * self.crane.max_displacement
            ranges["displacement"] = (-tolerance, self.crane.max_displacement + tolerance)
        return ranges

    def range(self, channel: str) -> tuple[float, float]:
        """Smallest and largest value of a channel (a run's column or its short name)."""
        return self._ranges.get(channel.rpartition(".")[2]) or limits_of(channel)

    def plausible(self, channel: str, value: float) -> bool:
        """Whether this crane's channel can show this value; False for NaN."""
        lower, upper = self._ranges.get(channel) or self.range(channel)
        return lower <= value <= upper

    def change(self, channel: str) -> Change | None:
        """The largest change of a channel; None where none is known."""
        return self._changes.get(channel.rpartition(".")[2])

    def _largest_changes(self) -> dict[str, Change]:
        # speed: ten times what heave asks for (130 rad/s^2), and an encoder's step; a command may step, a pressure
        # rises at most as fast as relief valves and waves make it (1e4 bar/s); a swash plate needs 0.1 s for its stroke
        pressure = Change(1.0e4 * BAR, 0.1 * self.pressure)
        changes = {
            "motor_speed": Change(4.0 * self.speed, 0.05 * self.speed),
            "speed_reference": Change(20.0 * self.speed, 0.2 * self.speed),
            "hook_load": Change(10.0 * self.load, 0.1 * self.load),
            "heave_velocity": Change(30.0, 1.0),
            "oil_temperature": Change(5.0, 5.0),
            "pressure_a": pressure,
            "pressure_b": pressure,
        }
        if self.crane.max_displacement:
            full = self.crane.max_displacement
            changes["displacement"] = Change(10.0 * full, 0.1 * full)
        return changes


# -- what a sample shows
def shown_by(sample: Sample) -> str:
    """What says the load of this sample, in words."""
    if sample.hook_load == sample.hook_load:
        return "hook_load"
    return "rope_force" if sample.rope_force == sample.rope_force else "load (the parameter)"


def has_torque(sample: Sample) -> bool:
    """Whether a sample tells anything of the drive's torque."""
    known = (sample.motor_torque, sample.mechanical_power, sample.motor_current)
    return bool(sample.groups) or any(math.isfinite(each) for each in known)


def readings_of(sample: Sample) -> tuple[object, ...]:
    """All that was measured, so that equal ones compare equal where some are missing."""
    scalars = (
        sample.motor_torque, sample.mechanical_power, sample.motor_current, sample.hook_load, sample.rope_force,
        sample.heave_velocity, sample.wire_out, sample.shaft_angle, sample.load_torque,
    )  # fmt: skip
    groups = [(each.pressure_a, each.pressure_b, each.displacement) for each in sample.groups.values()]
    return tuple(None if each != each else each for values in (scalars, *groups) for each in values)
