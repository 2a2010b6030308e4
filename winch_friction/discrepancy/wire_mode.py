"""The load on its elastic wire: the acceleration that the pressures feel, from the one that a rigid wire would give.

(m s^2 + c s + k) x_load = (c s + k) x_rigid. Stiffness k = EA / wire_out is known where the crane file and the log say
so; the damping is nobody's datum and is chosen by what leaves least swinging in the gap.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from winch_friction.discrepancy.smoothing import smooth
from winch_friction.physics.signals import FloatArray

DAMPING_RATIOS = (0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3)
WIRE_LENGTHS = (15.0, 22.0, 33.0, 50.0, 75.0, 110.0, 165.0, 250.0)  # m, tried where the log lacks it
LEAST_GAIN = 0.25  # of the swinging's variance; below it the wire is taken for rigid
SWING_PERIODS = 1.5  # longest swing that counts, in periods of the mode


@dataclass(frozen=True)
class Swing:
    """Load acceleration m/s^2 with the wire's mode, its frequency rad/s and damping ratio (0: rigid)."""

    acceleration: FloatArray
    frequency: float
    damping: float


def swinging_load(
    gap: FloatArray,
    counts: np.ndarray,
    rigid: FloatArray,
    dt: float,
    mass: float,
    lever: FloatArray,
    stiffnesses: Sequence[float],
) -> Swing:
    """The wire's mode that leaves least swinging in the gap.

    `gap` N m was made with the `rigid` acceleration m/s^2 of the load; `counts` marks the samples to judge by; `lever`
    m is drum radius over gear ratio, so that mass * lever * acceleration is a torque at the shaft.
    """
    best, swing = np.inf, Swing(rigid, 0.0, 0.0)
    for frequency in _frequencies(stiffnesses, mass, dt):
        before = _swing_variance(gap, counts, dt, frequency)
        for ratio in DAMPING_RATIOS:
            acceleration = on_the_wire(rigid, dt, frequency, ratio)
            left = _swing_variance(gap + mass * lever * (rigid - acceleration), counts, dt, frequency) / before
            if left < min(best, 1.0 - LEAST_GAIN):
                best, swing = left, Swing(acceleration, frequency, ratio)
    return swing


def on_the_wire(rigid: FloatArray, dt: float, frequency: float, ratio: float) -> FloatArray:
    """Load acceleration behind the wire's mode (frequency rad/s, damping ratio), bilinear and exact at the mode."""
    warped = frequency / np.tan(0.5 * frequency * dt)
    first = 2.0 * ratio * frequency * warped
    square, mode = warped**2, frequency**2
    numerator = np.array([mode + first, 2.0 * mode, mode - first])
    denominator = np.array([square + first + mode, 2.0 * (mode - square), square - first + mode])
    numerator, denominator = numerator / denominator[0], denominator / denominator[0]
    out, _ = lfilter(numerator, denominator, rigid, zi=lfilter_zi(numerator, denominator) * rigid[0])
    return np.asarray(out)


def _frequencies(stiffnesses: Sequence[float], mass: float, dt: float) -> Iterable[float]:
    for stiffness in stiffnesses:
        frequency = float(np.sqrt(stiffness / mass)) if mass > 0.0 and np.isfinite(stiffness) else np.inf
        if frequency * dt < 1.0:  # slower than the samples can follow is rigid to them
            yield frequency


def _swing_variance(gap: FloatArray, counts: np.ndarray, dt: float, frequency: float) -> float:
    samples = max(3, int(SWING_PERIODS * 2.0 * np.pi / (frequency * dt)))
    slow = smooth(gap, samples + 1 - samples % 2)
    return float(np.var((gap - slow)[counts])) + 1e-12


def wire_stiffnesses(elastic_modulus_area: float, wire_out: FloatArray | None) -> tuple[float, ...]:
    """Stiffness in N/m to try: from the wire paid out, or over usual lengths where the log lacks it."""
    if wire_out is not None:
        return (elastic_modulus_area / max(float(np.median(wire_out)), 1.0),)
    return tuple(elastic_modulus_area / length for length in WIRE_LENGTHS)
