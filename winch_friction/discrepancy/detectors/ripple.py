"""Torque that repeats with the shaft's angle: a spectrum over angle of the drive torque, at the full sampling rate.

Block means average a ripple away, and in time it is smeared by every change of speed; over angle it is one line. Each
run keeps its own phase, because an angle counted from the start of a record has no common zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.detectors.angle_spectrum import (
    LOWEST_ORDER,
    SAME_ORDER,
    Table,
    line_holds,
    strongest_line,
)
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
SHARED_PHASE = 0.7  # of what own phases explain, that one phase for all must
FEWEST = 200  # moving samples of a run
# what turns with the shaft has whole orders, a later gear's mesh and shaft have others, and so has an encoder's beat
# with the sampling: in 4 of 560 data sets without a ripple, down to 7e-14; of 20 ripples the faintest such had 5e-20
BETWEEN_ORDERS, WHOLE = 1e-16, 0.03  # family-wise; of an order
# share of T_d/i: half of what no balance closes better than, 0.1 bar of 150; the same cycle driven in every run had a
# "ripple" of 2.7e-4, and the faintest true ones were 5.6e-4
SMALLEST = 4e-4

_Wave = tuple[FloatArray, FloatArray, FloatArray]


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
    from scipy.optimize import minimize_scalar  # a fifth of a second, for few runs come here

    near = minimize_scalar(lambda k: -_shared(tables, k)[0], bounds=(best - step, best + step), method="bounded")
    order = float(near.x)
    explained, amplitude, std = _shared(tables, order)
    # of the ripple, wherever a run has it: where the runs cancel, one wave for all is best at an order that none has
    own = sum(max(_shared([table], each)[0] for each in (order, *orders)) for table in tables)
    if explained < SHARED_PHASE * own:
        return None
    a, b = (ParameterEstimate(float(value), std, "1") for value in amplitude)
    return {"a_r": a, "b_r": b, "k_r": ParameterEstimate(order, float(0.1 * step), "1")}


def _unsmoothed(run: Run, prepared: PreparedRun, crane: Crane, with_inertia: bool) -> _Wave:
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


def _shared(tables: Sequence[_Wave], order: float) -> tuple[float, FloatArray, float]:
    """What one wave for all of them explains (N m)^2, its shares of T_d/i, and their standard deviation."""
    waves = [s[:, None] * np.column_stack([np.sin(order * x), np.cos(order * x)]) for x, _, s in tables]
    h = np.sum([w.T @ w for w in waves], axis=0)
    g = np.sum([w.T @ gap for w, (_, gap, _) in zip(waves, tables, strict=True)], axis=0)
    beta = np.linalg.solve(h + 1e-9 * np.trace(h) * np.eye(2), g)
    left = sum(float(((gap - w @ beta) ** 2).sum()) for w, (_, gap, _) in zip(waves, tables, strict=True))
    count = sum(len(gap) for _, gap, _ in tables)
    return float(g @ beta), beta, float(np.sqrt(2.0 * left / count / np.trace(h)))
