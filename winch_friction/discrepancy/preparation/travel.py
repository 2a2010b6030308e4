"""Direction and travel from the shaft's angle: what happens around a reversal is decided there, not by a noisy
speed."""

import numpy as np

from winch_friction.discrepancy.preparation.smoothing import noise_level
from winch_friction.physics.signals import FloatArray

CERTAIN = 7.0  # speed noise times sample time: about two steps of a counting encoder


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
