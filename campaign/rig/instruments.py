"""Sensors and PLC: sampling, jitter, noise with colour, quantisation, delay, offset, gain."""

import numpy as np
from scipy.signal import lfilter

from campaign.rig.flavour import Flavour
from campaign.rig.plant import STEP
from campaign.rig.truth import BAR

Array = np.ndarray
PERIOD = 0.02  # s


def sampling(steps: int, jitter: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Indices of the plant's steps that the PLC takes, and their time stamps in s."""
    nominal = np.arange(PERIOD, steps * STEP - PERIOD, PERIOD)
    time = nominal + (np.clip(rng.normal(0, jitter, len(nominal)), -0.008, 0.008) if jitter else 0.0)
    index = np.round(time / STEP).astype(int)
    return index, index * STEP


def noise(size: int, sigma: float, color: float, rng: np.random.Generator) -> Array:
    """AR(1) noise of standard deviation `sigma`, half of its variance white where it is coloured."""
    white = rng.normal(0, 1, size)
    if not color:
        return sigma * white
    slow = lfilter([np.sqrt(1 - color**2)], [1, -color], rng.normal(0, 1, size))
    return sigma * np.sqrt(0.5) * (white + slow)


def pressure(true: Array, index: Array, flavour: Flavour, rng: np.random.Generator, offset=0.0, gain=0.0) -> Array:
    """A 600 bar transducer, Pa."""
    value = true[index] * (1.0 + gain) + offset
    value = value + noise(len(index), flavour.pressure_noise * BAR, flavour.noise_color, rng)
    step = flavour.pressure_step * BAR
    return np.round(value / step) * step


def delayed(true: Array, index: Array, delay: float) -> Array:
    """A signal as it was `delay` seconds before, between the plant's steps linearly."""
    return np.interp(index - delay / STEP, np.arange(len(true)), true)


def encoder_speed(angle: Array, index: Array, delay: float, flavour: Flavour, rng: np.random.Generator) -> Array:
    """Counts of one PLC period about the instant of the sample, divided by it, rad/s."""
    half = PERIOD / 2
    pitch = 2 * np.pi / flavour.pulses
    phase = rng.uniform(0, pitch)
    ahead = np.floor((delayed(angle, index, delay - half) + phase) / pitch)
    behind = np.floor((delayed(angle, index, delay + half) + phase) / pitch)
    return (ahead - behind) * pitch / PERIOD + noise(len(index), flavour.speed_noise, 0.0, rng)
