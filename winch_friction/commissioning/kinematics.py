"""Do the other channels agree with the speed? Angle, reference, wire length and heave tell it again."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.commissioning.view import RunView
from winch_friction.physics.signals import FloatArray

# channel -> relative error that is ordinary, 1 sigma: an encoder counts, a wire lies on a layer or slips, a sea drifts
ORDINARY = {"shaft_angle": 0.03, "speed_reference": 0.12, "wire_out": 0.12, "heave_velocity": 0.15}
IN_METRES = ("wire_out", "heave_velocity")  # these tell the wire's speed
FOLLOWS = 0.8  # correlation below which a channel does not tell the speed (heave with the compensation off)
MOST = 150.0  # score of one channel in one run: one flat contradiction suffices
FEWEST = 20  # blocks
LAGS = (2, 3, 5, 8, 12, 20)  # blocks of a fifth of a second that one channel may be late by
LEAST_MISFIT, SHARPER = 0.004, 0.25  # 1 - correlation of ordinary sensors; share of it that a right shift leaves
LATE = 40.0  # score of a channel that fits only when shifted: two of them contradict, one is a hint


@dataclass(frozen=True)
class Agreement:
    """One channel's speed over the logged one: `ratio` (negative: opposite sign), `correlation`, and the `score`."""

    channel: str
    ratio: float
    correlation: float
    score: float


def agreements(view: RunView, must_follow: Sequence[str] = ()) -> list[Agreement]:
    """How each channel that tells the speed agrees with it; channels that do not follow it at all are left out.

    Those that `must_follow` count as contradictions when they do not.
    """
    found = []
    for channel, rate in view.rates.items():
        told = rate / view.lever if channel in IN_METRES else rate
        ratio, correlation = _compared(view.speed, told)
        if abs(correlation) >= FOLLOWS:
            late = LATE if _is_late(view.speed, told, correlation) else 0.0
            found.append(Agreement(channel, ratio, correlation, _score(ratio, ORDINARY[channel]) + late))
        elif channel in must_follow:
            found.append(Agreement(channel, ratio, correlation, MOST))
    return found


def _is_late(speed: FloatArray, told: FloatArray, correlation: float) -> bool:
    """Whether the two agree much better with one of them shifted in time."""
    misfit = 1.0 - abs(correlation)
    if misfit < LEAST_MISFIT:
        return False
    shifted = (_compared(speed[lag:], told[:-lag])[1] for lag in LAGS)
    back = (_compared(speed[:-lag], told[lag:])[1] for lag in LAGS)
    best = max((abs(each) for each in (*shifted, *back)), default=0.0)
    return 1.0 - best < SHARPER * misfit


def _compared(speed: FloatArray, told: FloatArray) -> tuple[float, float]:
    good = np.isfinite(speed) & np.isfinite(told)
    if good.sum() < FEWEST:
        return 1.0, 0.0
    a, b = speed[good], told[good]
    size = float(np.sqrt(np.sum(a * a) * np.sum(b * b)))
    if size == 0.0:
        return 1.0, 0.0
    return float(np.sqrt(np.sum(b * b) / np.sum(a * a)) * np.sign(np.sum(a * b))), float(np.sum(a * b)) / size


def _score(ratio: float, ordinary: float) -> float:
    if ratio <= 0.0:
        return MOST
    return min(float(np.log(ratio) / ordinary) ** 2, MOST)
