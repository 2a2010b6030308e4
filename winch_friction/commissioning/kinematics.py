"""Do the other channels agree with the speed? Angle, reference, wire length and heave tell it again."""

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


@dataclass(frozen=True)
class Agreement:
    """One channel's speed over the logged one: `ratio` (negative: opposite sign), `correlation`, and the `score`."""

    channel: str
    ratio: float
    correlation: float
    score: float


def agreements(view: RunView) -> list[Agreement]:
    """How each channel that tells the speed agrees with it; channels that do not follow it at all are left out."""
    found = []
    for channel, rate in view.rates.items():
        told = rate / view.lever if channel in IN_METRES else rate
        ratio, correlation = _compared(view.speed, told)
        if abs(correlation) >= FOLLOWS:
            found.append(Agreement(channel, ratio, correlation, _score(ratio, ORDINARY[channel])))
    return found


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
