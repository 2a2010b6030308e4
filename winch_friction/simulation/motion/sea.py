"""Heave of the crane tip: regular waves and irregular seas from a JONSWAP spectrum. Up positive; m, m/s, m/s^2."""

import math
from dataclasses import dataclass

import numpy as np

from winch_friction.physics.signals import FloatArray
from winch_friction.physics.units import GRAVITY


@dataclass(frozen=True)
class Waves:
    """A sum of harmonics: amplitudes m, angular frequencies rad/s, phases rad."""

    amplitudes: FloatArray
    frequencies: FloatArray
    phases: FloatArray

    def motion(self, time: FloatArray) -> FloatArray:
        """Height, speed and acceleration, shape (times, 3)."""
        out = np.zeros((len(time), 3))
        for amplitude, frequency, phase in zip(self.amplitudes, self.frequencies, self.phases, strict=True):
            angle = frequency * time + phase
            sine, cosine = amplitude * np.sin(angle), amplitude * np.cos(angle)
            out[:, 0] += sine
            out[:, 1] += frequency * cosine
            out[:, 2] -= frequency**2 * sine
        return out


def regular_wave(amplitude: float, period: float) -> Waves:
    """One harmonic."""
    return Waves(np.array([amplitude]), np.array([2.0 * math.pi / period]), np.zeros(1))


def jonswap_sea(significant_height: float, peak_period: float, gamma: float, seed: int, components: int = 80) -> Waves:
    """An irregular sea of long-crested waves (Hasselmann et al. 1973).

    One frequency is drawn in each of equally wide bands, so that the sea does not repeat; the amplitudes are scaled so
    that the significant height 4 sigma is met exactly.
    """
    generator = np.random.default_rng(seed)
    peak = 2.0 * math.pi / peak_period
    edges = np.linspace(0.55 * peak, 3.0 * peak, components + 1)
    frequencies = edges[:-1] + generator.random(components) * np.diff(edges)
    amplitudes = np.sqrt(2.0 * jonswap_spectrum(frequencies, peak, gamma) * np.diff(edges))
    sigma = math.sqrt(0.5 * float(np.sum(amplitudes**2)))
    amplitudes *= 0.25 * significant_height / sigma
    return Waves(amplitudes, frequencies, generator.random(components) * 2.0 * math.pi)


def jonswap_spectrum(frequency: FloatArray, peak: float, gamma: float) -> FloatArray:
    """JONSWAP spectral shape up to a constant factor; frequencies in rad/s."""
    width = np.where(frequency <= peak, 0.07, 0.09)
    enhancement = gamma ** np.exp(-((frequency / peak - 1.0) ** 2) / (2.0 * width**2))
    return GRAVITY**2 * frequency**-5.0 * np.exp(-1.25 * (peak / frequency) ** 4) * enhancement


def fade(motion: FloatArray, time: FloatArray, begin: float, length: float, out: bool = False) -> FloatArray:
    """Blend the motion in (or out) over `length` s from `begin`, speed and acceleration consistent with the height."""
    u = np.clip((time - begin) / length, 0.0, 1.0)
    window = u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    slope = 30.0 * u**2 * (1.0 - u) ** 2 / length
    bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / length**2
    if out:
        window, slope, bend = 1.0 - window, -slope, -bend
    height, speed, acceleration = motion.T
    return np.column_stack(
        [
            window * height,
            window * speed + slope * height,
            window * acceleration + 2.0 * slope * speed + bend * height,
        ]
    )
