"""What of a run's gap a ripple over the shaft's angle is, and whether all runs share its phase."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.detectors.ripple import AsLogged, Ripple
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

SHARED_PHASE = 0.7  # of what own phases explain, that one phase for all must

_Wave = tuple[FloatArray, FloatArray, FloatArray]


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
    """Angle, gap before any smoothing and T_d/i of the moving samples."""
    own = AsLogged(run, prepared, crane)
    gap = own.torque - own.of(prepared.predicted)
    if with_inertia:
        gap = gap - own.inertia * (own.acceleration - own.of(prepared.acceleration))
    gap = gap[own.moving] - gap[own.moving].mean()
    return own.of(prepared.angle)[own.moving], gap, own.static[own.moving]


def _shared(tables: Sequence[_Wave], order: float) -> tuple[float, FloatArray, float]:
    """What one wave for all of them explains (N m)^2, its shares of T_d/i, and their standard deviation."""
    waves = [s[:, None] * np.column_stack([np.sin(order * x), np.cos(order * x)]) for x, _, s in tables]
    h = np.sum([w.T @ w for w in waves], axis=0)
    g = np.sum([w.T @ gap for w, (_, gap, _) in zip(waves, tables, strict=True)], axis=0)
    beta = np.linalg.solve(h + 1e-9 * np.trace(h) * np.eye(2), g)
    left = sum(float(((gap - w @ beta) ** 2).sum()) for w, (_, gap, _) in zip(waves, tables, strict=True))
    count = sum(len(gap) for _, gap, _ in tables)
    return float(g @ beta), beta, float(np.sqrt(2.0 * left / count / np.trace(h)))
