"""Effects that the block means of the torque balance cannot show: ripple over the angle and speed lost to leakage."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.discrepancy.flow_balance import lost_speed
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.repair import Estimate
from winch_friction.discrepancy.result import Effect
from winch_friction.discrepancy.ripple import Ripple, angle_ripple
from winch_friction.physics.friction import term_named
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane


def find_ripple(runs: Sequence[Run], prepared: Sequence[PreparedRun], crane: Crane) -> Ripple | None:
    """A ripple over the shaft's angle that is there for sure."""
    found = angle_ripple(runs, prepared, crane)
    return found if found is not None and found.found else None


def ripple_waves(runs: Sequence[PreparedRun], ripple: Ripple) -> dict[str, FloatArray]:
    """Sine and cosine share of T_d/i that each run's gap has of the ripple; the phase is the run's own."""
    return {run.name: _wave_of(run, ripple) for run in runs}


def _wave_of(run: PreparedRun, ripple: Ripple) -> FloatArray:
    if not run.moving.any() or not np.any(run.drum_torque):
        return np.zeros(2)
    beta, *_ = np.linalg.lstsq(_waves(run, ripple)[run.moving], run.gap[run.moving], rcond=None)
    return np.asarray(beta)


def _waves(run: PreparedRun, ripple: Ripple) -> FloatArray:
    static = run.drum_torque / run.gear_ratio
    return static[:, None] * np.column_stack([np.sin(ripple.order * run.angle), np.cos(ripple.order * run.angle)])


def without_ripple(run: PreparedRun, ripple: Ripple, wave: FloatArray) -> PreparedRun:
    """The run with a ripple of these shares taken out of its gap."""
    return replace(run, gap=run.gap - _waves(run, ripple) @ wave)


def ripple_effect(ripple: Ripple) -> Effect:
    """The ripple as an entry of the result; its phase differs from record to record and is not given."""
    parameters = {
        "a_r": Estimate(ripple.amplitude, ripple.std, "1"),
        "k_r": Estimate(ripple.order, 0.0, "1"),
    }
    gain = 1.0 - 1.0 / np.sqrt(max(ripple.prominence, 1.0))
    return Effect(
        "torque_ripple", (), f"{ripple.order:.3g} periods per revolution", term_named("torque_ripple").latex,
        parameters, ripple.p_value, float(gain), 1.0, "over the shaft's angle",
    )  # fmt: skip


def leakage_effect(runs: Sequence[Run], prepared: Sequence[PreparedRun]) -> Effect | None:
    """Speed lost in proportion to pressure over viscosity, where a command is logged."""
    found = lost_speed(runs, prepared)
    if found is None or not found.found:
        return None
    return Effect(
        "slip_leakage", (), "per driving motor at 40 degC", r"\omega_{ref}-\omega = C\,\Delta p/(D\,\mu)",
        {"C_leak": Estimate(found.leakage, found.std, "m^3/s/Pa")}, found.p_value, found.gain, 1.0,
        "commanded against reached speed",
    )  # fmt: skip
