"""Zero-phase smoothing of measured channels: speed, acceleration, and the noise that a channel carries."""

import numpy as np
from scipy.signal import savgol_filter

from winch_friction.physics.signals import FloatArray

SMOOTHING_SAMPLES = 15  # 0.3 s at 50 Hz: short against a wave, long against an encoder's step
MAX_WIDENING = 3.0
FINE_NOISE = 2e-3  # share of the largest speed that the shortest window copes with


def noise_level(values: FloatArray) -> float:
    """Standard deviation of the fast noise of a record, from its third differences (robust against steps)."""
    if len(values) < 8:
        return 0.0
    third = np.diff(values, 3)
    return float(1.4826 * np.median(np.abs(third - np.median(third))) / np.sqrt(20.0))


def smooth(values: FloatArray, window: int = SMOOTHING_SAMPLES, order: int = 2) -> FloatArray:
    """Savitzky-Golay over a uniform grid; records shorter than the window get a shorter one."""
    window = min(window, len(values) - (1 - len(values) % 2))
    return savgol_filter(values, window | 1, min(order, (window | 1) - 1))


def speed_window(speed: FloatArray) -> int:
    """Window for a speed record in samples: longer where the encoder is coarse."""
    scale = float(np.percentile(np.abs(speed), 99)) or 1.0
    relative = max(noise_level(speed), float(np.std(np.diff(speed, 2))) * 0.1) / scale
    widening = min(max((relative / FINE_NOISE) ** (2.0 / 3.0), 1.0), MAX_WIDENING)
    return int(SMOOTHING_SAMPLES * widening) | 1


def dilated(mask: np.ndarray, samples: int) -> np.ndarray:
    """A mask that also covers `samples` neighbours on both sides."""
    if samples <= 0 or not mask.any():
        return mask
    count = np.convolve(mask.astype(float), np.ones(2 * samples + 1), mode="same")
    return count > 0.5
