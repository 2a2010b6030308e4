"""Lines in a spectrum over the shaft's angle: which stands out, how surely, and whether it is one of the sampling's."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter
from scipy.special import gammaincc

from winch_friction.physics.signals import FloatArray

BINS_PER_REVOLUTION = 64
LOWEST_ORDER, HIGHEST_ORDER = 0.1, 20.0  # periods per revolution of the motor shaft
LONGEST_SPECTRUM = 1 << 18
NEIGHBOURHOOD = 401  # lines whose median is the background
SPEED_CLASSES = 3  # parts of a run
MOST_OF_ONE_PART, MOST_OF_ONE_RUN = 5.0, 12.0  # of a line's power over its background
# family-wise significance of a line in the whole runs, whose background is lumpy, and its own in their parts
IN_RUNS, IN_PARTS = 1e-10, 1e-3
# lines of as much power, of other orders, that make a comb of the sampling and not a ripple; far stronger ones than
# chance has (0.78 of the weakest that is significant) must be about
COMB_SHARE, COMB_LINES = 0.85, 3
SAME_ORDER = 0.05  # relative; a spectrum over short runs has no finer lines

Table = tuple[FloatArray, FloatArray, FloatArray, FloatArray]  # of a run: angle rad, torque N m, T_d/i N m, speed


@dataclass(frozen=True)
class Line:
    """Periods per revolution, amplitude as a share of T_d/i (at most what the sampling lets through) and its deviation,
    family-wise p-value, power over the neighbours'."""

    order: float
    amplitude: float
    std: float
    p_value: float
    prominence: float


def strongest_line(tables: Sequence[Table]) -> Line:
    """The line that stands out most in these runs."""
    size, orders, use = _lines(tables)
    whole, power, parts = np.zeros(use.sum()), np.zeros(use.sum()), 0
    for angle, torque, static, speed in tables:
        weighted = torque * static
        whole += np.minimum(_prominence(angle, weighted, size, use), MOST_OF_ONE_RUN)
        for part in _speed_classes(speed):
            # an encoder's steps beat with the sampling at one speed, in every run that has it: no part may decide alone
            power += np.minimum(_prominence(angle[part], weighted[part], size, use), MOST_OF_ONE_PART)
            parts += 1
    # whole runs see a small ripple better, but it must be in their parts as well
    whole[gammaincc(parts, power) > IN_PARTS] = 0.0
    own = [table[:3] for table in tables]
    of_runs = _strongest(orders[use], whole, len(tables), own)
    return of_runs if of_runs.p_value < IN_RUNS else _strongest(orders[use], power, parts, own)


def line_holds(order: float, tables: Sequence[Table]) -> bool:
    """Whether a line of that order stands out in other runs, whatever its phase there."""
    size, orders, use = _lines(tables)
    power = np.sum([_prominence(angle, torque * static, size, use) for angle, torque, static, _ in tables], axis=0)
    near = np.abs(orders[use] - order) < SAME_ORDER * max(order, LOWEST_ORDER)
    chance = gammaincc(len(tables), power[near].max(initial=0.0)) * max(int(near.sum()), 1)
    return bool(chance <= IN_PARTS)  # a lumpy background has a line of one in a hundred near any order


def _lines(tables: Sequence[Table]) -> tuple[int, FloatArray, np.ndarray]:
    """Length of the spectrum, the orders of its lines and which of them are looked at."""
    bins = max(float(np.ptp(angle)) for angle, *_ in tables) * BINS_PER_REVOLUTION / (2 * np.pi)
    size = min(1 << int(np.ceil(np.log2(2 * bins + 2))), LONGEST_SPECTRUM)
    orders = np.arange(size // 2 + 1) * BINS_PER_REVOLUTION / size
    return size, orders, (orders >= LOWEST_ORDER) & (orders <= HIGHEST_ORDER)


def _prominence(angle: FloatArray, torque: FloatArray, size: int, use: np.ndarray) -> FloatArray:
    """Power of each line over its neighbours', exponentially distributed with mean 1 where there is nothing."""
    line = _power(angle, torque, size)[use]
    background = np.maximum(median_filter(line, NEIGHBOURHOOD, mode="nearest") / np.log(2.0), 1e-300)
    return np.asarray(line / background)


def _speed_classes(speed: FloatArray) -> list[np.ndarray]:
    """Indices of the slow, middle and fast thirds of a run; a ripple of the shaft is in all of them."""
    return np.array_split(np.argsort(np.abs(speed), kind="stable"), SPEED_CLASSES)


def _power(angle: FloatArray, torque: FloatArray, size: int) -> FloatArray:
    """|F|^2 over angle, shape (size // 2 + 1,)."""
    cell = np.floor((angle - angle.min()) * BINS_PER_REVOLUTION / (2 * np.pi)).astype(int) % size
    folded = np.bincount(cell, weights=torque, minlength=size)
    return np.abs(np.fft.rfft(folded)) ** 2


def _strongest(
    orders: FloatArray, power: FloatArray, parts: int, tables: Sequence[tuple[FloatArray, FloatArray, FloatArray]]
) -> Line:
    best = int(np.argmax(power))
    order = float(orders[best])
    alone = 1.0 if one_of_a_comb(orders, power, best, parts) else gammaincc(parts, power[best])
    amplitude, std = _amplitude(order, tables)
    prominence = float(power[best] / parts)
    return Line(order, amplitude, std, float(min(1.0, 2 * alone * len(orders))), prominence)


def one_of_a_comb(orders: FloatArray, power: FloatArray, best: int, parts: int) -> bool:
    """Whether lines of other orders, harmonics apart, stand out nearly as far: an encoder's steps at a high rate beat
    with the sampling in many places, and a shaft's ripple has an order of its own. Nothing is said of a line that is as
    strong as counts, for then the others may be."""
    if power[best] >= COMB_SHARE * MOST_OF_ONE_RUN * parts:
        return False
    strong = np.flatnonzero(power >= COMB_SHARE * power[best])
    others, seen = orders[strong[np.argsort(-power[strong])]], orders[best]
    for _ in range(COMB_LINES):  # the strongest that is no harmonic of those before, of up to 80 000 lines
        ratio = np.maximum(others, seen) / np.minimum(others, seen)
        others = others[np.abs(ratio - np.round(ratio)) > SAME_ORDER]
        if not len(others):
            return False
        seen = others[0]
    return True


def _amplitude(order: float, tables: Sequence[tuple[FloatArray, FloatArray, FloatArray]]) -> tuple[float, float]:
    """Amplitude as a share of T_d/i, the phase free in each run, weighted by the runs' certainty."""
    values, weights = [], []
    for angle, torque, static in tables:
        wave = static[:, None] * np.column_stack([np.sin(order * angle), np.cos(order * angle)])
        beta, *_ = np.linalg.lstsq(wave, torque, rcond=None)
        noise = torque - wave @ beta
        variance = noise.var() / max((wave**2).sum() / 2.0, 1e-300)
        # the square of an amplitude is biased by its noise
        values.append(max(float(beta @ beta) - 2.0 * variance, 0.0))
        weights.append(1.0 / max(variance, 1e-300))
    total = float(np.sum(weights))
    return float(np.sqrt(np.dot(values, weights) / total)), float(np.sqrt(1.0 / total))
