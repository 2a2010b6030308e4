"""How the shaft moves: smooth speed and acceleration, in which samples its direction is certain, and what its angle
tells around a reversal, which a noisy speed cannot.
"""

from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.preparation.grid import Grid, dilated, noise_level, samples_of, smooth, speed_window
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane

CERTAIN = 7.0  # speed noise times sample time: about two steps of a counting encoder
FEWEST_STEADY = 50  # samples, for a mean and its noise
ONLY_NOISE = 1.5  # times the noise of the third differences: white noise has 1, a sine of ten samples 30
GUARD_SHARE = 0.008  # of the largest speed: below it the direction is uncertain
GUARD_TIME = 0.08  # s kept away from a reversal on both sides, beyond half a smoothing window
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
    guard = max(GUARD_SHARE * np.percentile(np.abs(speed), 99.5), 4.0 * noise_level(raw) / np.sqrt(window / 3.0))
    if turning:
        direction, state_speed, used = _just_reversed(angle, raw, speed, guard, grid.dt, window)
    else:
        direction = np.sign(np.where(np.abs(speed) > guard / 8.0, speed, 0.0))
        state_speed = np.where(direction != 0.0, speed, 0.0)
        still = _near_zero(speed, guard)
        still |= _near_zero(smooth(raw, samples_of(TOUCH_TIME, grid.dt, 3), 1), guard)  # a short touch hides in `speed`
        used = ~dilated(still, window // 2 + max(round(GUARD_TIME / grid.dt), 1))
    # the acceleration is that of the smoothed speed: the same kernel as the pressures'
    return Motion(window, speed, np.gradient(speed, grid.dt), angle, direction, state_speed, used)


def at_one_speed(raw: FloatArray) -> bool:
    """Whether a record's speed varies by no more than its own noise, about a mean that is surely not zero.

    A slow shaft's encoder counts none, one or two steps a sample: what it turns is known from the whole record only.
    """
    if len(raw) < FEWEST_STEADY or not np.isfinite(raw).all():
        return False
    spread, noise = float(np.std(raw)), float(np.std(np.diff(raw, 3))) / np.sqrt(20.0)
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
    near = (travel > 1.5 * least) & (travel < FAR_SHARE * top) & (since < FAR_TIME / dt)
    # sooner, most of the kernel reaches across the reversal: what is measured is smeared, what is predicted is not
    near &= since > window // 4
    # the smoothed speed swings below zero before a start; then the angle has not moved on
    advances = np.minimum(direction * speed, progress / dt)
    near &= (direction != 0.0) & (advances > guard / 8.0)
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
