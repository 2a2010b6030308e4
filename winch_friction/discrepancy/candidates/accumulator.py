"""The passive side's gas: what a warm bottle adds to a passive pressure that is calculated and not measured.

A PLC that logs the polytropic law p V^n for the passive pressure does not see the gas give its heat away. The error is
the bottle's excess temperature at the start, fading, and the heat of each compression, relaxing.
"""

from collections.abc import Sequence

import numpy as np
from scipy.signal import lfilter

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape, Variant
from winch_friction.discrepancy.preparation.prepared_run import GroupSignals, PreparedRun
from winch_friction.physics.friction.term import Parameter
from winch_friction.physics.signals import FloatArray

TIME_CONSTANTS = (30.0, 60.0, 120.0, 240.0)  # s

e_T = Parameter(
    "e_T", "1", 0.02, lower=-0.2, upper=0.2, doc="relative excess temperature of the gas at the start of a run"
)
g_T = Parameter("g_T", "1", 1.0, lower=-10.0, upper=10.0, doc="share of the compression's heat that the wall takes")


def accumulator_columns(run: PreparedRun, shape: Shape) -> FloatArray:
    """Torque of the passive motors per unit of warmth and of relaxing heat, N m, shape (samples, 2)."""
    passive = [group for group in run.groups if not group.balances]
    if not passive:
        return np.zeros((len(run.time), 2))
    parts = [_one_side(group, run, shape["tau"]) for group in passive]
    return -np.sum(parts, axis=0)


def _one_side(group: GroupSignals, run: PreparedRun, tau: float) -> FloatArray:
    # of the calculated pressure, which the excess temperature scales
    port = 0.5 * (group.pressure_sum + group.logged)
    torque = group.count * group.displacement * port
    fading = np.exp(-run.time / tau)
    # the calculated ln p moves with ln V; what has relaxed of it is its low-passed change
    change = np.log(np.maximum(port, 1.0) / max(port[0], 1.0))
    keep = np.exp(-run.dt / tau)
    relaxed = lfilter([1.0 - keep], [1.0, -keep], change)
    return np.column_stack([torque * fading, -torque * relaxed])


def _shapes(runs: Sequence[PreparedRun]) -> list[Variant]:
    return [Variant(f"tau = {tau:g} s", {"tau": tau}, carried=True) for tau in TIME_CONSTANTS]


def accumulator_candidates() -> list[Candidate]:
    """The gas of the passive side."""
    return [
        Candidate(
            "accumulator_thermal", r"n_p D_p\,\Delta p_p\,(e_T e^{-t/\tau} + g_T \langle\ln p\rangle_\tau)", (e_T, g_T),
            accumulator_columns, _shapes, kind="signal", hydraulic=True, continuous=("tau",),
        )
    ]  # fmt: skip
