"""Prescribed speeds of the shaft, the sea, and the memories of contact, wire and clocks; `step` is in s throughout."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from campaign.third_rig.plan import RAMP, REGULAR, STEPS

Series = NDArray[np.float64]
SHARES = (0.03, 0.06, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0)  # of the top speed, in steps
WAVES = 40  # of an irregular sea
PEAKEDNESS = 3.3  # of its JONSWAP spectrum


def smooth(signal: Series, count: float) -> Series:
    """A mean over about `count` values with a bell's weights; the ends are held."""
    weights = np.hanning(max(3, int(count)) + 2)
    weights /= weights.sum()
    width = len(weights)
    return np.convolve(np.pad(signal, (width // 2, width - 1 - width // 2), mode="edge"), weights, "valid")


def hoisting(
    rng: np.random.Generator, kind: str, seconds: float, step: float, top: float, steepest: float
) -> Series:  # fmt: skip
    """Speed of the shaft, rad/s, up to `top`; changes by at most `steepest` rad/s^2."""
    plan = _ramps if kind == RAMP else _held
    speed = plan(rng, kind, seconds, step, top, steepest)[: int(seconds / step)]
    speed = smooth(speed, rng.uniform(0.25, 0.6) / step)
    speed[np.abs(speed) < 1e-9] = 0
    return speed


def _ramps(rng: np.random.Generator, kind: str, seconds: float, step: float, top: float, steepest: float) -> Series:
    rise = min(rng.uniform(6, 25), steepest)
    parts, last = [np.zeros(int(1 / step))], 0.0
    sign = rng.choice([-1, 1])
    while sum(map(len, parts)) < int(seconds / step):
        wanted = sign * top * rng.uniform(0.4, 1)
        parts.append(np.linspace(last, wanted, max(2, int(abs(wanted - last) / rise / step))))
        last, sign = wanted, -sign
    return np.concatenate(parts)


def _held(rng: np.random.Generator, kind: str, seconds: float, step: float, top: float, steepest: float) -> Series:
    rise = min(rng.uniform(25, 110), steepest)
    parts, last = [], 0.0
    for wanted, hold in (_steps if kind == STEPS else _joystick)(rng, seconds, top):
        rising = np.linspace(last, wanted, max(1, int(abs(wanted - last) / rise / step)))
        parts += [rising, np.full(int(hold / step), wanted)]
        last = wanted
    return np.concatenate(parts)


def _steps(rng: np.random.Generator, seconds: float, top: float) -> list[tuple[float, float]]:
    """Speed and how long it is held, s: to and fro, with rests of 1 to 12 s between."""
    wanted = [(0.0, rng.uniform(0.8, 2))]
    passed = wanted[0][1]
    while passed < seconds:
        for sign in (1, -1) if rng.random() < 0.7 else (-1, 1):
            speed, hold = top * rng.choice(SHARES), rng.uniform(3, 9)
            wanted.append((sign * speed, hold))
            passed += hold + speed / 40
            if rng.random() < 0.4:
                rest = rng.choice([1.0, 2.0, 5.0, 12.0]) * rng.uniform(0.7, 1.3)
                wanted.append((0.0, rest))
                passed += rest
    return wanted


def _joystick(rng: np.random.Generator, seconds: float, top: float) -> list[tuple[float, float]]:
    """Speed and how long it is held, s, as a nervous hand gives it."""
    wanted = [(0.0, rng.uniform(0.8, 2))]
    passed = wanted[0][1]
    while passed < seconds:
        speed, hold = top * np.clip(rng.normal(0, 0.5), -1, 1), rng.uniform(0.5, 4)
        wanted.append((speed, hold))
        passed += hold + abs(speed) / 50
        if rng.random() < 0.25:
            rest = rng.uniform(0.8, 6)
            wanted.append((0.0, rest))
            passed += rest
    return wanted


def compensating(
    rng: np.random.Generator, kind: str, seconds: float, step: float, top: float, turns: float
) -> tuple[Series, Series]:
    """Speed of the shaft, rad/s, and velocity of the tip, m/s, which it follows nearly; `turns` in rad/m of wire."""
    time = np.arange(int(seconds / step)) * step
    largest = top / turns * rng.uniform(0.4, 0.85)
    heave = _regular(rng, time) if kind == REGULAR else _irregular(rng, time)
    heave /= np.abs(heave).max()
    grown = np.clip(time / 3, 0, 1)
    grown = 3 * grown**2 - 2 * grown**3
    heave = heave * grown * largest
    followed = rng.uniform(0.97, 1.0)
    paid = smooth((time > seconds * 0.4).astype(float), 0.8 / step)
    drift = top * 0.03 * rng.choice([0, 0, 1, -1]) * paid
    error = top * 0.004 * np.sin(2 * np.pi * time / rng.uniform(2.5, 5) + rng.uniform(0, 6)) * grown
    return -followed * heave * turns + drift + error, heave


def _regular(rng: np.random.Generator, time: Series) -> Series:
    frequency = 2 * np.pi / rng.uniform(6, 14)
    return np.sin(frequency * time + rng.uniform(0, 6.3))


def _irregular(rng: np.random.Generator, time: Series) -> Series:
    peak = 2 * np.pi / rng.uniform(6, 13)
    frequencies = peak * np.sort(rng.uniform(0.6, 2.2, WAVES))
    width = np.where(frequencies < peak, 0.07, 0.09)
    peaked = PEAKEDNESS ** np.exp(-((frequencies / peak - 1) ** 2) / 2 / width**2)
    spectrum = frequencies**-5.0 * np.exp(-1.25 * (frequencies / peak) ** -4) * peaked
    amplitudes = np.sqrt(spectrum) * frequencies
    phases = rng.uniform(0, 6.3, WAVES)
    waves = zip(amplitudes, frequencies, phases, strict=True)
    return sum((a * np.sin(f * time + p) for a, f, p in waves), np.zeros_like(time))


@njit(cache=True)
def turned_over(speed: Series, step: float, slip: float) -> Series:
    """Deflection in -1 to 1 of a contact that turns over within `slip` rad of the shaft; `speed` in rad/s."""
    out = np.empty_like(speed)
    deflection = 0.0
    for k in range(len(speed)):
        sign = np.sign(speed[k])
        deflection = sign + (deflection - sign) * np.exp(-np.abs(speed[k]) * step / slip)
        out[k] = deflection
    return out


@njit(cache=True)
def stuck(speed: Series, step: float, breakaway: float) -> Series:
    """Force in -1 to 1 of an elastic element that slips after `breakaway` rad of the shaft to and fro."""
    out = np.empty_like(speed)
    force = 0.0
    for k in range(len(speed)):
        force = min(1.0, max(-1.0, force + 2 * (speed[k] * step) / breakaway))
        out[k] = force
    return out


@njit(cache=True)
def swinging(above: Series, spring: Series, damping: float, step: float) -> Series:
    """Acceleration of a load on its wire whose upper end has the acceleration `above`, m/s^2.

    `spring` is stiffness over mass, 1/s^2, at each moment; `damping` 1 is critical.
    """
    out = np.empty_like(above)
    stretch, rate = 0.0, 0.0
    for k in range(len(above)):
        pulled = spring[k] * stretch + 2 * damping * np.sqrt(spring[k]) * rate
        out[k] = pulled
        rate += step * (above[k] - pulled)
        stretch += step * rate
    return out


@njit(cache=True)
def clocks(speed: Series, step: float) -> tuple[Series, Series, Series]:
    """Seconds since the last reversal, seconds of the last rest, rad travelled since the last start or reversal."""
    reversed_since, rested, travelled = np.empty_like(speed), np.empty_like(speed), np.empty_like(speed)
    last, since, rest, dwell, travel = 0.0, 0.0, 0.0, 0.0, 1e3
    for k in range(len(speed)):
        if abs(speed[k]) > 0.05:
            if np.sign(speed[k]) != last:
                since, travel = 0.0, 0.0
                last = np.sign(speed[k])
            if rest > 0:
                dwell, travel = rest, 0.0
            rest = 0.0
            travel += abs(speed[k]) * step
        else:
            rest += step
        since += step
        reversed_since[k], rested[k], travelled[k] = since, dwell, travel
    return reversed_since, rested, travelled
