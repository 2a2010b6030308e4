"""Sensors and PLC: sampling, jitter, noise with colour, quantisation, delay, offset, gain."""

import numpy as np
from scipy.signal import lfilter

from campaign.rig.flavour import Flavour
from campaign.rig.plant import STEP
from campaign.rig.truth import BAR

Array = np.ndarray


def sampling(steps: int, period: float, jitter: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Indices of the plant's steps that the PLC takes, and their time stamps in s."""
    jitter = 0.0 if period < 4 * STEP else jitter  # the plant has no instants in between
    nominal = np.arange(period, steps * STEP - period, period)
    time = nominal + (np.clip(rng.normal(0, jitter, len(nominal)), -0.4 * period, 0.4 * period) if jitter else 0.0)
    index = np.round(time / STEP).astype(int)
    return index, index * STEP


def noise(size: int, sigma: float, color: float, rng: np.random.Generator) -> Array:
    """AR(1) noise of standard deviation `sigma`, half of its variance white where it is coloured."""
    white = rng.normal(0, 1, size)
    if not color:
        return sigma * white
    slow = lfilter([np.sqrt(1 - color**2)], [1, -color], rng.normal(0, 1, size))
    return sigma * np.sqrt(0.5) * (white + slow)


def pressure(
    true: Array,
    index: Array,
    flavour: Flavour,
    rng: np.random.Generator,
    offset: Array | float = 0.0,
    gain: Array | float = 0.0,
) -> Array:
    """A 600 bar transducer, Pa."""
    value = true[index] * (1.0 + gain) + offset
    color = flavour.noise_color ** (50.0 / flavour.rate)  # the flavour states it for 50 Hz
    value = value + noise(len(index), flavour.pressure_noise * BAR, color, rng)
    step = flavour.pressure_step * BAR
    return np.round(value / step) * step


def delayed(true: Array, index: Array, delay: float) -> Array:
    """A signal as it was `delay` seconds before, between the plant's steps linearly."""
    return np.interp(index - delay / STEP, np.arange(len(true)), true)


def encoder_speed(angle: Array, index: Array, delay: float, flavour: Flavour, rng: np.random.Generator) -> Array:
    """Counts of one PLC period about the instant of the sample, divided by it, rad/s."""
    period = 1.0 / flavour.rate
    half = period / 2
    pitch = 2 * np.pi / flavour.pulses
    phase = rng.uniform(0, pitch)
    ahead = np.floor((delayed(angle, index, delay - half) + phase) / pitch)
    behind = np.floor((delayed(angle, index, delay + half) + phase) / pitch)
    return (ahead - behind) * pitch / period + noise(len(index), flavour.speed_noise, 0.0, rng)


def filtered(true: Array, time_constant: float) -> Array:
    """A signal behind a first-order filter on the plant's time grid."""
    keep = np.exp(-STEP / time_constant)
    out, _ = lfilter([1.0 - keep], [1.0, -keep], true - true[0], zi=np.zeros(1))
    return out + true[0]
