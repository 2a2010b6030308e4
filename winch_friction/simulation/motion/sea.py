"""Heave of the crane tip: regular waves and irregular seas from a JONSWAP spectrum. Up positive; m, m/s, m/s^2."""

import math
from dataclasses import dataclass

import numpy as np

from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import FloatArray


@dataclass(frozen=True)
class Waves:
    """A sum of harmonics: amplitudes m, angular frequencies rad/s, phases rad."""

    amplitudes: FloatArray
    frequencies: FloatArray
    phases: FloatArray

    def motion(self, time: FloatArray) -> FloatArray:
        """Height, speed and acceleration at evenly spaced times, shape (times, 3).

        exp(i w t) is the product of one factor for a block's start and one for the place in the block, so that a block
        of k times takes k, and k blocks k, of each harmonic's sines instead of k^2.
        """
        step = (time[-1] - time[0]) / max(len(time) - 1, 1)
        size = max(math.isqrt(len(time)), 1)
        starts = time[0] + np.arange(0, len(time), size) * step
        heights = self.amplitudes * np.exp(1j * (np.outer(starts, self.frequencies) + self.phases))
        places = np.exp(1j * np.outer(self.frequencies, np.arange(size) * step))
        rate = 1j * self.frequencies
        blocks = [((heights * rate**order) @ places).imag.reshape(-1)[: len(time)] for order in range(3)]
        return np.column_stack(blocks)


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
