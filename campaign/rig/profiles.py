"""What the operator and the sea make the winch do: shaft speed wanted and heave, on the plant's time grid."""

import numpy as np

from campaign.rig.flavour import Flavour
from campaign.rig.plant import STEP

Array = np.ndarray


def cycle(flavour: Flavour, top_speed: float, duration: float, rng: np.random.Generator) -> Array:
    """A constant-speed test: plateaus with ramps and rests between them, rad/s."""
    plateaus = np.array(flavour.plateaus) * top_speed
    rests = rng.uniform(1.0, 6.0, len(plateaus) + 1)
    ramps = np.maximum(np.abs(np.array(flavour.plateaus)) * flavour.ramp * rng.uniform(0.7, 1.3), 0.4)
    hold = (duration - rests.sum() - 2 * ramps.sum()) / len(plateaus)
    knots, levels = [0.0, rests[0]], [0.0, 0.0]
    for plateau, ramp, rest in zip(plateaus, ramps, rests[1:], strict=True):
        for span, level in ((ramp, plateau), (hold, plateau), (ramp, 0.0), (rest, 0.0)):
            knots.append(knots[-1] + span)
            levels.append(level)
    time = np.arange(0.0, duration, STEP)
    speed = np.interp(time, knots, levels)
    return _smooth(speed, 0.5) if flavour.smooth_ramps else speed


def _smooth(speed: Array, width: float) -> Array:
    half = max(int(width / STEP), 1)
    window = np.hanning(half + 2)[1:-1]
    return np.convolve(np.pad(speed, half, mode="edge"), window / window.sum(), mode="same")[half:-half]


def sea(irregular: bool, duration: float, peak_speed: float, rng: np.random.Generator) -> Array:
    """Heave velocity with about the given peak, m/s, calm for the first seconds."""
    time = np.arange(0.0, duration, STEP)
    heave = _jonswap(time, rng) if irregular else np.sin(2 * np.pi * time / rng.uniform(8, 14))
    heave *= peak_speed / np.abs(heave).max()
    return heave * np.clip((time - 3.0) / 10.0, 0.0, 1.0)


def _jonswap(time: Array, rng: np.random.Generator) -> Array:
    peak = rng.uniform(7.5, 12.0)
    frequency = np.sort(rng.uniform(0.05, 0.25, 40))
    ratio = frequency * peak
    width = np.where(ratio < 1, 0.07, 0.09)
    spectrum = frequency**-5 * np.exp(-1.25 * ratio**-4) * 3.3 ** np.exp(-0.5 * ((ratio - 1) / width) ** 2)
    amplitude = frequency * np.sqrt(spectrum)  # of the velocity
    total = np.zeros_like(time)
    for a, f, phase in zip(amplitude, frequency, rng.uniform(0, 2 * np.pi, 40), strict=True):
        total += a * np.cos(2 * np.pi * f * time + phase)
    return total


def calm_end(reference: Array, seconds: float = 8.0) -> Array:
    """Let a motion die out at the end, so that the run also rests."""
    steps = int(seconds / STEP)
    fade = np.ones_like(reference)
    fade[-2 * steps : -steps] = np.linspace(1.0, 0.0, steps)
    fade[-steps:] = 0.0
    return reference * fade
