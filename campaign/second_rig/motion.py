"""Prescribed speeds of the shaft and the sea, and the three memories of first and second order. Time step `STEP`."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from campaign.second_rig.crane import GRAVITY

STEP = 0.0025  # s
START_OF_SEA = 8.0  # s until the sea has its full height

Series = NDArray[np.float64]


@njit(cache=True)
def followed(wanted: Series, bandwidth: float, damping: float) -> Series:
    """A second order that follows `wanted`; `bandwidth` in Hz, `damping` 1 is critical."""
    out = np.empty(len(wanted))
    value, rate = wanted[0], 0.0
    natural = 2 * np.pi * bandwidth  # rad/s
    for k in range(len(wanted)):
        rate += STEP * (natural * natural * (wanted[k] - value) - 2 * damping * natural * rate)
        value += STEP * rate
        out[k] = value
    return out


@njit(cache=True)
def low_passed(signal: Series, time_constant: float) -> Series:
    """A first order with `time_constant` in s."""
    out = np.empty(len(signal))
    share = 1 - np.exp(-STEP / time_constant)
    value = signal[0]
    for k in range(len(signal)):
        value += share * (signal[k] - value)
        out[k] = value
    return out


@njit(cache=True)
def bristle(speed: Series, slip: float) -> Series:
    """Deflection in -1 to 1 of a contact that turns over within `slip` rad of the shaft; `speed` in rad/s."""
    out = np.empty(len(speed))
    deflection = 0.0
    for k in range(len(speed)):
        share = 1 - np.exp(-np.abs(speed[k]) * STEP / slip)
        deflection += (np.sign(speed[k]) - deflection) * share
        out[k] = deflection
    return out


@njit(cache=True)
def rope_force(above: Series, weight: Series, extra: Series, mass: float, spring: float, damper: float) -> Series:
    """Force in N of a rope that never pushes, its upper end at speed `above` (m/s, up), a load at its lower end.

    `weight` and `extra` in N hang at the load, `mass` in kg, `spring` in N/m, `damper` in N s/m.
    """
    out = np.empty(len(above))
    stretch, load_speed = mass * GRAVITY / spring, 0.0
    for k in range(len(above)):
        difference = above[k] - load_speed
        stretch += STEP * difference
        force = max(spring * stretch + damper * difference, 0.0)
        load_speed += STEP * (force - weight[k] - extra[k]) / mass
        out[k] = force
    return out


def _through(corners: list[tuple[float, float]], seconds: float) -> tuple[Series, Series]:
    time = np.arange(0, seconds, STEP)
    points = np.array(corners)
    return time, np.interp(time, points[:, 0], points[:, 1])


def staircase(top: float, seconds: float, steps: tuple[float, ...]) -> tuple[Series, Series]:
    """Time (s) and wanted speed (rad/s): up and down at each share of the `top` speed, a rest between."""
    ramp = 2.0
    hold = ((seconds - 6) / len(steps) - 4 * ramp - 4) / 2
    corners, now = [(0.0, 0.0), (3.0, 0.0)], 3.0
    for share in steps:
        for sign in (1, -1):
            speed = sign * share * top
            corners += [(now, 0), (now + ramp, speed), (now + ramp + hold, speed), (now + 2 * ramp + hold, 0)]
            corners += [(now + 2 * ramp + hold + 2, 0)]
            now += 2 * ramp + hold + 2
    return _through(corners, seconds)


def joystick(rng: np.random.Generator, top: float, seconds: float) -> tuple[Series, Series]:
    """Time (s) and wanted speed (rad/s) of a hand at the lever."""
    corners, now, speed = [(0.0, 0.0), (2.0, 0.0)], 2.0, 0.0
    while now < seconds - 8:
        goal = rng.uniform(-1, 1) * top if rng.random() > 0.2 else 0.0
        if abs(speed) > 1 and np.sign(speed) == np.sign(goal) and rng.random() < 0.5:
            goal = -goal
        ramp = rng.uniform(0.7, 3)
        hold = rng.uniform(3, 9)
        corners += [(now + ramp, goal), (now + ramp + hold, goal)]
        now += ramp + hold
        speed = goal
    corners += [(now + 2, 0.0)]
    return _through(corners, seconds)


def creep(rng: np.random.Generator, seconds: float) -> tuple[Series, Series]:
    """Time (s) and wanted speed (rad/s): slow moves between rests of 1 to 15 s."""
    corners, now = [(0.0, 0.0), (2.0, 0.0)], 2.0
    while now < seconds - 12:
        speed = rng.choice([1.5, 3, 6, 12, 20, 35])
        for sign in (1, -1):
            rest = rng.choice([1, 3, 8, 15])
            hold = rng.uniform(5, 9)
            corners += [(now + 1.2, sign * speed), (now + 1.2 + hold, sign * speed), (now + 2.4 + hold, 0)]
            corners += [(now + 2.4 + hold + rest, 0)]
            now += 2.4 + hold + rest
    return _through([corner for corner in corners if corner[0] < seconds], seconds)


def sea(
    rng: np.random.Generator, seconds: float, regular: bool, amplitude: float, period: float
) -> tuple[Series, Series]:
    """Time (s) and velocity (m/s, up) of the crane's tip; `amplitude` in m, `period` in s (of the spectrum's peak)."""
    time = np.arange(0, seconds, STEP)
    start = np.clip(time / START_OF_SEA, 0, 1)
    if regular:
        return time, amplitude * 2 * np.pi / period * np.cos(2 * np.pi * time / period + rng.uniform(0, 6)) * start
    frequency = np.linspace(0.5 / period, 2.2 / period, 40)
    frequency += rng.uniform(-0.3, 0.3, 40) * (frequency[1] - frequency[0])
    spectrum = frequency**-5 * np.exp(-1.25 * (period * frequency) ** -4)
    spectrum = spectrum * 3.3 ** np.exp(-0.5 * ((period * frequency - 1) / 0.08) ** 2)
    heights = np.sqrt(spectrum)
    heights *= amplitude / np.sqrt(0.5 * np.sum(heights**2)) / 1.6
    velocity = np.zeros_like(time)
    for each, height in zip(frequency, heights, strict=True):
        velocity += height * 2 * np.pi * each * np.cos(2 * np.pi * each * time + rng.uniform(0, 6.28))
    return time, velocity * start
