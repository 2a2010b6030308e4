"""Torque that repeats with the shaft's angle: a spectrum over angle of the drive torque, at the full sampling rate.

Block means average a ripple away, and in time it is smeared by every change of speed; over angle it is one line. Each
run keeps its own phase, because an angle counted from the start of a record has no common zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter
from scipy.optimize import minimize_scalar
from scipy.stats import gamma

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.preparation.grid import samples_of, smooth
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.torque_balance import run_drive_torque

TERM = "torque_ripple"
BINS_PER_REVOLUTION = 64
LOWEST_ORDER, HIGHEST_ORDER = 0.1, 20.0  # periods per revolution of the motor shaft
LONGEST_SPECTRUM = 1 << 18
NEIGHBOURHOOD = 401  # lines whose median is the background
WINDOW = 0.3  # s; slower than this is friction, not ripple
SPEED_CLASSES = 3  # parts of a run
MOST_OF_ONE_PART, MOST_OF_ONE_RUN = 5.0, 12.0  # of a line's power over its background
# family-wise significance of a line in the whole runs, whose background is lumpy, and its own in their parts
IN_RUNS, IN_PARTS = 1e-10, 1e-3
SIGNIFICANT = 1e-6  # family-wise, for white noise; encoder steps and friction make real backgrounds lumpier
# an angle added up from the speed carries the encoder's steps itself
SIGNIFICANT_WITHOUT_ANGLE = 1e-12
# lines of as much power, of other orders, that make a comb of the sampling and not a ripple; far stronger ones than
# chance has (0.78 of the weakest that is significant) must be about
COMB_SHARE, COMB_LINES = 0.85, 3
SAME_ORDER = 0.05  # relative; a spectrum over short runs has no finer lines
LEFT_OF_KNOWN = 0.4  # share of the known amplitude that its estimate may leave
SHARED_PHASE = 0.7  # of what own phases explain, that one phase for all must
SMALLEST = 2e-4  # share of T_d/i; a smaller ripple is of no use to anybody


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
        return self.p_value < least and self.amplitude > SMALLEST

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
    tables = [_moving(run, p, crane, model, found.with_inertia) for run, p in zip(runs, prepared, strict=True)]
    tables = [table for table in tables if len(table[0]) > 200 and np.any(table[2])]
    if not tables:
        return False
    size, orders, use = _lines(tables)
    power = np.sum([_prominence(angle, torque * static, size, use) for angle, torque, static, _ in tables], axis=0)
    near = np.abs(orders[use] - found.order) < SAME_ORDER * max(found.order, LOWEST_ORDER)
    chance = gamma.sf(power[near].max(initial=0.0), len(tables)) * max(int(near.sum()), 1)
    return bool(chance <= IN_PARTS)  # a lumpy background has a line of one in a hundred near any order


def _lines(tables: Sequence[tuple[FloatArray, ...]]) -> tuple[int, FloatArray, np.ndarray]:
    """Length of the spectrum, the orders of its lines and which of them are looked at."""
    bins = max(float(np.ptp(angle)) for angle, *_ in tables) * BINS_PER_REVOLUTION / (2 * np.pi)
    size = min(1 << int(np.ceil(np.log2(2 * bins + 2))), LONGEST_SPECTRUM)
    orders = np.arange(size // 2 + 1) * BINS_PER_REVOLUTION / size
    return size, orders, (orders >= LOWEST_ORDER) & (orders <= HIGHEST_ORDER)


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
    found = [(_search(runs, prepared, crane, model, inertia), inertia) for inertia in ways]
    lines = [replace(line, with_inertia=inertia) for line, inertia in found if line is not None]
    if not lines:
        return None
    strongest = min(lines, key=lambda line: (line.p_value, -line.prominence))
    return replace(strongest, angle_is_measured=all("shaft_angle" in run for run in runs))


def _search(
    runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane, model: FrictionModel, with_inertia: bool
) -> Ripple | None:
    tables = [_moving(run, p, crane, model, with_inertia) for run, p in zip(runs, prepared, strict=True)]
    tables = [table for table in tables if len(table[0]) > 200 and np.any(table[2])]
    if not tables:
        return None
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
    whole[gamma.sf(power, parts) > IN_PARTS] = 0.0
    own = [table[:3] for table in tables]
    of_runs = _strongest(orders[use], whole, len(tables), own)
    return of_runs if of_runs.p_value < IN_RUNS else _strongest(orders[use], power, parts, own)


def _prominence(angle: FloatArray, torque: FloatArray, size: int, use: np.ndarray) -> FloatArray:
    """Power of each line over its neighbours', exponentially distributed with mean 1 where there is nothing."""
    line = _power(angle, torque, size)[use]
    background = np.maximum(median_filter(line, NEIGHBOURHOOD, mode="nearest") / np.log(2.0), 1e-300)
    return np.asarray(line / background)


def _speed_classes(speed: FloatArray) -> list[np.ndarray]:
    """Indices of the slow, middle and fast thirds of a run; a ripple of the shaft is in all of them."""
    return np.array_split(np.argsort(np.abs(speed), kind="stable"), SPEED_CLASSES)


def _moving(
    run: Run, prepared: PreparedRun, crane: Crane, model: FrictionModel, with_inertia: bool
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Angle, fast part of the drive torque, T_d/i and speed of the moving samples."""
    good = np.isfinite(run["time"])
    time = run.time[good]
    torque = np.nan_to_num(np.asarray(run_drive_torque(run, crane))[good])
    grid = prepared.time + prepared.start
    moving = np.interp(time, grid, prepared.used.astype(float)) > 0.99
    angle = np.interp(time, grid, prepared.angle)
    static = np.interp(time, grid, prepared.drum_torque) / prepared.gear_ratio
    if TERM in model.term_names:
        torque = torque - np.interp(time, grid, model.subset((TERM,)).torque(prepared.point))
    if with_inertia:
        inertia = crane.inertia + np.interp(time, grid, prepared.load * (prepared.radius / prepared.gear_ratio) ** 2)
        torque = torque - inertia * np.gradient(_speed(run, crane)[good], time)
    fast = torque - smooth(torque, samples_of(WINDOW, prepared.dt))
    return angle[moving], fast[moving], static[moving], np.interp(time, grid, prepared.speed)[moving]


def _speed(run: Run, crane: Crane) -> FloatArray:
    speed = run["motor_speed"] if "motor_speed" in run else run["drum_speed"] * crane.gear_ratio
    return np.nan_to_num(speed)


def _power(angle: FloatArray, torque: FloatArray, size: int) -> FloatArray:
    """|F|^2 over angle, shape (size // 2 + 1,)."""
    cell = np.floor((angle - angle.min()) * BINS_PER_REVOLUTION / (2 * np.pi)).astype(int) % size
    folded = np.bincount(cell, weights=torque, minlength=size)
    return np.abs(np.fft.rfft(folded)) ** 2


def _strongest(
    orders: FloatArray, power: FloatArray, parts: int, tables: Sequence[tuple[FloatArray, FloatArray, FloatArray]]
) -> Ripple:
    best = int(np.argmax(power))
    order = float(orders[best])
    alone = 1.0 if one_of_a_comb(orders, power, best, parts) else gamma.sf(power[best], parts)
    amplitude, std = _amplitude(order, tables)
    prominence = float(power[best] / parts)
    return Ripple(order, amplitude, std, float(min(1.0, 2 * alone * len(orders))), prominence)


def one_of_a_comb(orders: FloatArray, power: FloatArray, best: int, parts: int) -> bool:
    """Whether lines of other orders, harmonics apart, stand out nearly as far: an encoder's steps at a high rate beat
    with the sampling in many places, and a shaft's ripple has an order of its own. Nothing is said of a line that is as
    strong as counts, for then the others may be."""
    if power[best] >= COMB_SHARE * MOST_OF_ONE_RUN * parts:
        return False
    strong = np.flatnonzero(power >= COMB_SHARE * power[best])
    seen = [float(orders[best])]
    for order in orders[strong[np.argsort(-power[strong])]]:
        ratios = [max(order, each) / min(order, each) for each in seen]
        if all(abs(ratio - round(ratio)) > SAME_ORDER for ratio in ratios):
            seen.append(float(order))
    return len(seen) > COMB_LINES


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


def waves_of(runs: Sequence[PreparedRun], ripple: Ripple) -> dict[str, FloatArray]:
    """Sine and cosine share of T_d/i that each run's gap has of the ripple; the phase is the run's own."""
    return {run.name: _wave_of(run, ripple) for run in runs}


def _wave_of(run: PreparedRun, ripple: Ripple) -> FloatArray:
    if not run.used.any() or not np.any(run.drum_torque):
        return np.zeros(2)
    beta, *_ = np.linalg.lstsq(_waves(run, ripple)[run.used], run.gap[run.used], rcond=None)
    return np.asarray(beta)


def _waves(run: PreparedRun, ripple: Ripple) -> FloatArray:
    static = run.drum_torque / run.gear_ratio
    return static[:, None] * np.column_stack([np.sin(ripple.order * run.angle), np.cos(ripple.order * run.angle)])


def without_ripple(run: PreparedRun, ripple: Ripple, wave: FloatArray) -> PreparedRun:
    """The run with a ripple of these shares taken out of its gap."""
    return replace(run, gap=run.gap - _waves(run, ripple) @ wave)


def in_phase(
    runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane, ripple: Ripple
) -> dict[str, ParameterEstimate] | None:
    """Amplitudes a_r, b_r and order k_r of the one ripple that all runs share; None where each has a phase of its own.

    Runs share a phase only if their angle is measured from one mark. The order is sharpened first: over a long run a
    spectrum's step is many radians of phase.
    """
    pairs = [(run, p) for run, p in zip(runs, prepared, strict=True) if p.used.any() and np.any(p.drum_torque)]
    if not pairs or any("shaft_angle" not in p.present for _, p in pairs):
        return None
    tables = [_unsmoothed(run, p, crane, ripple.with_inertia) for run, p in pairs]
    step = np.pi / max(float(np.ptp(angle)) for angle, *_ in tables)  # a quarter of a line's width
    orders = ripple.order + step * np.arange(-8, 9) / 2.0
    best = max(orders, key=lambda order: _shared(tables, order)[0])
    near = minimize_scalar(lambda k: -_shared(tables, k)[0], bounds=(best - step, best + step), method="bounded")
    order = float(near.x)
    explained, amplitude, std = _shared(tables, order)
    if explained < SHARED_PHASE * sum(_shared([table], order)[0] for table in tables):
        return None
    a, b = (ParameterEstimate(float(value), std, "1") for value in amplitude)
    return {"a_r": a, "b_r": b, "k_r": ParameterEstimate(order, float(0.1 * step), "1")}


Table = tuple[FloatArray, FloatArray, FloatArray]


def _unsmoothed(run: Run, prepared: PreparedRun, crane: Crane, with_inertia: bool) -> Table:
    """Angle, gap before any smoothing and T_d/i of the moving samples: a smoothed gap has lost part of a ripple."""
    grid = prepared.time + prepared.start
    good = np.isfinite(run.time)
    time = run.time[good]
    gap = np.nan_to_num(np.asarray(run_drive_torque(run, crane))[good]) - np.interp(time, grid, prepared.predicted)
    if with_inertia:
        inertia = crane.inertia + np.interp(time, grid, prepared.load * (prepared.radius / prepared.gear_ratio) ** 2)
        fast = np.gradient(_speed(run, crane)[good], time) - np.interp(time, grid, prepared.acceleration)
        gap = gap - inertia * fast
    moving = np.interp(time, grid, prepared.used.astype(float)) > 0.99
    static = np.interp(time, grid, prepared.drum_torque) / prepared.gear_ratio
    return np.interp(time, grid, prepared.angle)[moving], gap[moving] - gap[moving].mean(), static[moving]


def _shared(tables: Sequence[Table], order: float) -> tuple[float, FloatArray, float]:
    """What one wave for all of them explains (N m)^2, its shares of T_d/i, and their standard deviation."""
    waves = [s[:, None] * np.column_stack([np.sin(order * x), np.cos(order * x)]) for x, _, s in tables]
    h = np.sum([w.T @ w for w in waves], axis=0)
    g = np.sum([w.T @ gap for w, (_, gap, _) in zip(waves, tables, strict=True)], axis=0)
    beta = np.linalg.solve(h + 1e-9 * np.trace(h) * np.eye(2), g)
    left = sum(float(((gap - w @ beta) ** 2).sum()) for w, (_, gap, _) in zip(waves, tables, strict=True))
    count = sum(len(gap) for _, gap, _ in tables)
    return float(g @ beta), beta, float(np.sqrt(2.0 * left / count / np.trace(h)))
