"""Torque that repeats with the shaft's angle: a spectrum over angle of the drive torque, at the full sampling rate.

Block means average a ripple away, and in time it is smeared by every change of speed; over angle it is one line. Each
run keeps its own phase, because an angle counted from the start of a record has no common zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter
from scipy.special import gammaincc

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.preparation.grid import samples_of, smooth
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.crane import run_drive_torque

TERM = "torque_ripple"
WINDOW = 0.3  # s; slower than this is friction, not ripple
# family-wise, for white noise; encoder steps and friction make real backgrounds lumpier: of 600 data sets without a
# ripple one had a line of 1.2e-9, at 10 Hz; the faintest ripple at 0.3 of its size had 3e-25
SIGNIFICANT = 1e-10
# an angle added up from the speed carries the encoder's steps itself
SIGNIFICANT_WITHOUT_ANGLE = 1e-12
# share of the known amplitude that its estimate may leave: pressure lines and the sampling take more of it the faster
# the shaft turns, and one amplitude for all speeds leaves up to itself
LEFT_OF_KNOWN = 0.8
FEWEST = 200  # moving samples of a run
# what turns with the shaft has whole orders, a later gear's mesh and shaft have others, and so has an encoder's beat
# with the sampling: in 4 of 560 data sets without a ripple, down to 7e-14; of 20 ripples the faintest such had 5e-20
BETWEEN_ORDERS, WHOLE = 1e-16, 0.03  # family-wise; of an order
# share of T_d/i: half of what no balance closes better than, 0.1 bar of 150; the same cycle driven in every run had a
# "ripple" of 2.7e-4, and the faintest true ones were 5.6e-4
SMALLEST = 4e-4

Table = tuple[FloatArray, FloatArray, FloatArray, FloatArray]  # of a run: angle rad, torque N m, T_d/i N m, speed


@dataclass(frozen=True)
class Ripple:
    """The strongest line: periods per revolution, amplitude as a share of T_d/i (at most
    what the sampling lets through), family-wise p-value."""

    order: float
    amplitude: float
    std: float
    p_value: float
    prominence: float  # of the line's power over its neighbours'
    angle_is_measured: bool = True
    with_inertia: bool = False  # seen once the shaft's own inertia was taken out

    @property
    def found(self) -> bool:
        """A line that stands out surely and is large enough to matter."""
        least = SIGNIFICANT if self.angle_is_measured else SIGNIFICANT_WITHOUT_ANGLE
        between = abs(self.order - round(self.order)) > WHOLE
        return self.p_value < (min(least, BETWEEN_ORDERS) if between else least) and self.amplitude > SMALLEST

    @property
    def effect(self) -> Effect:
        """The ripple as an entry of the result; its phase differs from record to record and is not given."""
        parameters = {
            "a_r": ParameterEstimate(self.amplitude, self.std, "1"),
            "k_r": ParameterEstimate(self.order, 0.0, "1"),
        }
        gain = 1.0 - 1.0 / np.sqrt(max(self.prominence, 1.0))
        return Effect(
            TERM, (), f"{self.order:.3g} periods per revolution", term_named(TERM).latex,
            parameters, self.p_value, float(gain), 1.0, "over the shaft's angle",
        )  # fmt: skip


def detect(runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane, model: FrictionModel) -> Ripple | None:
    """A ripple over the shaft's angle that is there for sure, beside the one that the model has."""
    found = angle_ripple(runs, prepared, crane, model)
    return found if found is not None and found.found and not _known(found, model) else None


def holds_on(
    found: Ripple, runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane, model: FrictionModel
) -> bool:
    """Whether the same line stands out in runs that it was not found in, whatever its phase there."""
    tables = _tables(runs, prepared, crane, model, found.with_inertia)
    return bool(tables) and line_holds(found.order, tables)


def _known(found: Ripple, model: FrictionModel) -> bool:
    """Whether it is what the model's own ripple leaves: its estimate is never perfect, and a line stands out by far."""
    if TERM not in model.term_names:
        return False
    size = float(np.hypot(model.value("a_r"), model.value("b_r")))
    near = abs(found.order - model.value("k_r")) < SAME_ORDER * max(model.value("k_r"), LOWEST_ORDER)
    return near and found.amplitude < LEFT_OF_KNOWN * size


def angle_ripple(
    runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane, model: FrictionModel
) -> Ripple | None:
    """The strongest line over the shaft's angle; None where no run moves or carries a load."""
    # a fast ripple is swallowed by the inertia before it reaches the oil, a slow one drowns in the differentiated speed
    # what of a known ripple the inertia swallows is known only where the inertia's torque is taken out
    ways = (True,) if TERM in model.term_names else (False, True)
    tables = [(_tables(runs, prepared, crane, model, inertia), inertia) for inertia in ways]
    lines = [(strongest_line(own), inertia) for own, inertia in tables if own]
    if not lines:
        return None
    line, inertia = min(lines, key=lambda pair: (pair[0].p_value, -pair[0].prominence))
    measured = all("shaft_angle" in run for run in runs)
    return Ripple(line.order, line.amplitude, line.std, line.p_value, line.prominence, measured, inertia)


def _tables(
    runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane, model: FrictionModel, with_inertia: bool
) -> list[Table]:
    """The runs that move enough and carry a load."""
    tables = [_moving(run, p, crane, model, with_inertia) for run, p in zip(runs, prepared, strict=True)]
    return [table for table in tables if len(table[0]) > FEWEST and np.any(table[2])]


def _moving(
    run: Run, prepared: PreparedRun, crane: Crane, model: FrictionModel, with_inertia: bool
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Angle, fast part of the drive torque, T_d/i and speed of the moving samples."""
    own = AsLogged(run, prepared, crane)
    torque = own.torque
    if TERM in model.term_names:
        torque = torque - own.of(model.subset((TERM,)).torque(prepared.point))
    if with_inertia:
        torque = torque - own.inertia * own.acceleration
    fast = torque - smooth(torque, samples_of(WINDOW, prepared.dt))
    return tuple(each[own.moving] for each in (own.of(prepared.angle), fast, own.static, own.of(prepared.speed)))


class AsLogged:
    """A run at the instants at which it was logged, before any smoothing, which takes a part of a ripple.

    `torque` of the drive N m, `acceleration` of the shaft rad/s^2 from its speed, the whole `inertia` at it kg m^2,
    T_d/i as `static` N m, and which samples are `moving`.
    """

    def __init__(self, run: Run, prepared: PreparedRun, crane: Crane) -> None:
        good = np.isfinite(run.time)
        self.time, self._grid = run.time[good], prepared.time + prepared.start
        self.torque = np.nan_to_num(np.asarray(run_drive_torque(run, crane))[good])
        speed = run["motor_speed"] if "motor_speed" in run else run["drum_speed"] * crane.gear_ratio
        self.acceleration = np.gradient(np.nan_to_num(speed)[good], self.time)
        self.inertia = crane.inertia + self.of(prepared.load * (prepared.radius / prepared.gear_ratio) ** 2)
        self.static = self.of(prepared.drum_torque) / prepared.gear_ratio
        self.moving = prepared.used_at(self.time)

    def of(self, values: FloatArray) -> FloatArray:
        """What was prepared on the uniform grid, at these instants."""
        return np.interp(self.time, self._grid, values)


# -- lines in a spectrum: which stands out, how surely, and whether it is one of the sampling's
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
