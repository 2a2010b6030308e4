"""What a run tells whatever the model says: how the shaft moves, what the motors' signals make.

Of the motion: smooth speed and acceleration, in which samples its direction is certain, and what its angle tells around
a reversal, which a noisy speed cannot.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.ndimage import binary_opening

from winch_friction.discrepancy.preparation.grid import (
    THIRD_DIFFERENCE,
    Grid,
    dilated,
    noise_level,
    samples_of,
    smooth,
    speed_window,
    uniform,
)
from winch_friction.discrepancy.preparation.motors import (
    Groups,
    GroupSignals,
    KnownGroups,
    drive_torque,
    measured_groups,
)
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

# -- how the shaft moves
CERTAIN = 7.0  # speed noise times sample time: about two steps of a counting encoder
FEWEST_STEADY = 50  # samples, for a mean and its noise
ONLY_NOISE = 1.5  # times the noise of the third differences: white noise has 1, a sine of ten samples 30
GUARD_SHARE = 0.008  # of the largest speed: below it the direction is uncertain
GUARD_NOISE = 4.0  # times what the smoothed speed keeps of its noise: by chance once in 16 000 samples
STANDS = 0.125  # of that speed: below it the shaft has no direction at all
GUARD_TIME = 0.08  # s kept away from a reversal on both sides, beyond half a smoothing window
SURELY_GONE = 1.5  # times the travel below which a change of direction may be the encoder's own
TOUCH_TIME = 0.1  # s: a touch of zero that short hides in the smoothed speed
FAR_SHARE, FAR_TIME = 0.03, 3.0  # travel per top speed (6 rad at 2000 rpm) and seconds after which a reversal is past


@dataclass(frozen=True)
class Motion:
    """Speed rad/s, acceleration rad/s^2 and angle rad of the motor shaft.

    `window` samples smoothed the speed and are to smooth what is compared with it. `state_speed` is what friction is
    reckoned with, 0 where the direction is unknown; `used` marks the samples of the regime.
    """

    window: int
    speed: FloatArray
    acceleration: FloatArray
    angle: FloatArray
    direction: FloatArray
    state_speed: FloatArray
    used: np.ndarray


def motion_of(grid: Grid, crane: Crane, name: str, turning: bool) -> Motion:
    """The moving samples, or with `turning` those just after reversals; `InputError` without a speed column."""
    raw = _motor_speed(grid, crane, name)
    window = speed_window(raw, grid.dt)
    if not turning and at_one_speed(raw):
        return _steady(raw, grid, window)
    speed = smooth(raw, window)
    angle = grid.columns.get("shaft_angle", _travelled(raw, grid.dt))
    left = noise_level(raw) / np.sqrt(window / 3.0)  # of its noise, once smoothed
    guard = max(GUARD_SHARE * np.percentile(np.abs(speed), 99.5), GUARD_NOISE * left)
    if turning:
        direction, state_speed, used = _just_reversed(angle, raw, speed, guard, grid.dt, window)
    else:
        direction = np.sign(np.where(np.abs(speed) > STANDS * guard, speed, 0.0))
        state_speed = np.where(direction != 0.0, speed, 0.0)
        still = _near_zero(speed, guard)
        still |= _near_zero(smooth(raw, samples_of(TOUCH_TIME, grid.dt, 3), 1), guard)  # a short touch hides in `speed`
        used = ~dilated(still, window // 2 + max(round(GUARD_TIME / grid.dt), 1))
    used &= _measured_around(grid.valid, window // 2 + 1)
    # the acceleration is that of the smoothed speed: the same kernel as the pressures'
    return Motion(window, speed, np.gradient(speed, grid.dt), angle, direction, state_speed, used)


def _measured_around(valid: np.ndarray, half: int) -> np.ndarray:
    """Samples with `half` a window of measured ones on both sides: beside a hole that is longer, and at the ends of a
    record that was cut out of a motion, a speed's slope is guessed, and the inertia makes tens of bar of it."""
    holes = binary_opening(np.pad(~valid, half, constant_values=True), np.ones(half, bool))
    return np.asarray(~dilated(holes, half)[half:-half])


def at_one_speed(raw: FloatArray) -> bool:
    """Whether a record's speed varies by no more than its own noise, about a mean that is surely not zero.

    A slow shaft's encoder counts none, one or two steps a sample: what it turns is known from the whole record only.
    """
    if len(raw) < FEWEST_STEADY or not np.isfinite(raw).all():
        return False
    spread, noise = float(np.std(raw)), float(np.std(np.diff(raw, 3))) / THIRD_DIFFERENCE
    return spread <= ONLY_NOISE * noise and abs(float(np.mean(raw))) > CERTAIN * spread / np.sqrt(len(raw))


def _steady(raw: FloatArray, grid: Grid, window: int) -> Motion:
    speed = np.full(len(raw), float(np.mean(raw)))
    still = np.zeros(len(raw))
    angle = grid.columns.get("shaft_angle", speed * grid.time)
    return Motion(window, speed, still, angle, np.sign(speed), speed, np.ones(len(raw), bool))


def _near_zero(speed: FloatArray, guard: float) -> np.ndarray:
    """Samples at zero, and those beside a reversal that fell between two of them."""
    still = np.abs(speed) <= guard
    turns = speed[1:] * speed[:-1] < 0.0
    still[1:] |= turns
    still[:-1] |= turns
    return still


def _motor_speed(grid: Grid, crane: Crane, name: str) -> FloatArray:
    if "motor_speed" in grid.columns:
        return grid.columns["motor_speed"]
    if "drum_speed" in grid.columns:
        return grid.columns["drum_speed"] * crane.gear_ratio
    raise InputError(f"{name}: neither 'motor_speed' nor 'drum_speed' holds values; one of them is needed")


def _travelled(speed: FloatArray, dt: float) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])) * dt])


def _just_reversed(
    angle: FloatArray, raw: FloatArray, speed: FloatArray, guard: float, dt: float, window: int
) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Direction, speed of the travel and the samples whose contact has begun to slide but not gone far."""
    least = resolution(raw, dt)
    direction, travel, progress = travel_of(angle, least)
    top = float(np.percentile(np.abs(speed), 99))
    turned = np.concatenate([[0], np.flatnonzero(np.diff(direction) != 0.0) + 1])
    samples = np.arange(len(angle))
    since = samples - turned[np.searchsorted(turned[1:], samples, "right")]
    near = (travel > SURELY_GONE * least) & (travel < FAR_SHARE * top) & (since < FAR_TIME / dt)
    # sooner, most of the kernel reaches across the reversal: what is measured is smeared, what is predicted is not
    near &= since > window // 4
    # the smoothed speed swings below zero before a start; then the angle has not moved on
    advances = np.minimum(direction * speed, progress / dt)
    near &= (direction != 0.0) & (advances > STANDS * guard)
    return direction, direction * progress / dt, near


def resolution(raw_speed: FloatArray, dt: float) -> float:
    """Travel in rad below which a change of direction may be the encoder's own."""
    return max(CERTAIN * noise_level(raw_speed) * dt, 1e-12)


def travel_of(angle: FloatArray, least: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Direction (-1, 0, 1), travel since the last reversal in rad, and progress per sample in rad.

    A reversal counts once the shaft has come back by `least` from its farthest point; progress is the advance of
    that point, so that a trembling angle does not travel.
    """
    direction, travel, progress = [], [], []
    heading, origin, far = 0.0, float(angle[0]), float(angle[0])
    for position in angle.tolist():
        before, ahead = far, (position - far) * heading
        if heading == 0.0:
            if abs(position - origin) > least:
                heading, far = (1.0 if position > origin else -1.0), position
        elif ahead >= 0.0:
            far = position
        elif ahead < -least:
            heading, origin, far = -heading, far, position
            before = origin
        direction.append(heading)
        travel.append(abs(position - origin))
        progress.append(abs(far - before))
    return np.array(direction), np.array(travel), np.array(progress)


# -- one run as it is seen
SPARSE = 0.03  # s; from such a period on a central difference smears what it differentiates
MOTION = ("motor_speed", "drum_speed", "shaft_angle")  # columns that tell how the shaft moves


@dataclass(frozen=True)
class Seen:
    """What a run tells whatever the model says: its grid, how the shaft moves, what the motors' signals make.

    The same run is balanced some dozen times in a search, and half of that was smoothing the same again."""

    run: Run
    crane: Crane
    turning: bool
    grid: Grid
    motion: Motion
    known: list[KnownGroups] = field(default_factory=list, repr=False, compare=False)  # as seen before, till asked
    load: dict[str, Any] = field(default_factory=dict, init=False, repr=False, compare=False)  # as it was asked last

    def is_of(self, run: Run, crane: Crane, turning: bool) -> bool:
        """Whether it is of this very run, seen in the same way on a crane whose motors and gear are the same."""
        own = (self.turning, self.crane.gear_ratio, self.crane.drive)
        return self.run is run and own == (turning, crane.gear_ratio, crane.drive)

    @cached_property
    def measured(self) -> tuple[Groups, FloatArray]:
        """Groups with their measured pressures and the drive torque that these make, whatever the load does."""
        known = self.known.pop() if self.known else None
        groups = measured_groups(self.grid.columns, self.run, self.crane, self.motion.window, known)
        return groups, self.smoothed(drive_torque(self.grid.columns, groups))

    def smoothed(self, torque: FloatArray) -> FloatArray:
        """With the acceleration's kernel: what that takes out of one side must not stay in the other."""
        smoothed = smooth(torque, self.motion.window)
        if self.grid.dt < SPARSE:
            return smoothed
        # the acceleration is a difference over two periods: the mean over them, which the torque must be as well; by
        # Simpson's rule, for the trapezium's takes a tenth too much out of a swing of ten samples
        padded = np.pad(smoothed, 1, mode="edge")
        return np.asarray((padded[:-2] + 4.0 * padded[1:-1] + padded[2:]) / 6.0)


def see(run: Run, crane: Crane, turning: bool = False, before: Seen | None = None) -> Seen:
    """What a run tells whatever the model says; `turning` as in `motion_of`, whose errors it raises. Of a run that was
    seen `before`, in another way or with other errors taken out, what hangs on the same columns is held once."""
    if before is None:
        grid = uniform(run)
        return Seen(run, crane, turning, grid, motion_of(grid, crane, run.name, turning))
    if before.is_of(run, crane, turning):
        return before
    grid = before.grid if before.run is run else uniform(run, (before.run, before.grid))
    how = (before.turning, before.crane.gear_ratio, before.grid.dt) == (turning, crane.gear_ratio, grid.dt)
    moves = all(grid.columns.get(name) is before.grid.columns.get(name) for name in MOTION)
    same = how and moves and np.array_equal(grid.valid, before.grid.valid)
    motion = before.motion if same else motion_of(grid, crane, run.name, turning)
    known = []
    if "measured" in before.__dict__:  # else nothing is known, and its columns need not be held
        known = [KnownGroups(before.measured[0], before.grid.columns, before.motion.window)]
    return Seen(run, crane, turning, grid, motion, known)


def shared(own: Any, other: Any) -> Any:
    """The same values, in the arrays of another wherever these hold the same to the bit."""
    if isinstance(own, np.ndarray):
        return other if _same(own, other) else own
    if type(own) is tuple and isinstance(other, tuple) and len(own) == len(other):
        return tuple(map(shared, own, other))
    if isinstance(own, Mapping) and isinstance(other, Mapping):
        return {name: shared(value, other.get(name)) for name, value in own.items()}
    if isinstance(own, GroupSignals) and isinstance(other, GroupSignals):
        return replace(own, **{f.name: shared(getattr(own, f.name), getattr(other, f.name)) for f in fields(own)})
    return own


def _same(own: np.ndarray, other: Any) -> bool:
    """Whether two arrays are the same to the bit, NaN and the sign of zero included."""
    alike = isinstance(other, np.ndarray) and (own.shape, own.dtype) == (other.shape, other.dtype)
    return own is other or alike and np.array_equal(np.ravel(own).view(np.uint8), np.ravel(other).view(np.uint8))
