"""Candidates in the calculated pressure of an accumulator: a gas that warms, cools, or follows another exponent."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Estimates, Shape, Sides, Values, correction
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.preparation.recursion import lagged
from winch_friction.discrepancy.preparation.seen import GroupSignals
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter

TIME_CONSTANTS = (30.0, 60.0, 120.0, 240.0)  # s, of an accumulator's gas
AT_ONCE = 0.01  # s; heat that goes as fast as it comes is another exponent of the calculated law

e_T = Parameter(
    "e_T", "1", 0.02, lower=-0.2, upper=0.2, doc="relative excess temperature of the gas at the start of a run"
)
g_T = Parameter("g_T", "1", 1.0, lower=-10.0, upper=10.0, doc="share of the compression's heat that the wall takes")


def accumulator_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Torque of the passive motors per unit of warmth and of relaxing heat, N m, shape (samples, 2)."""
    passive = [group for group in run.groups if not group.balances]
    if not passive:
        return np.zeros((len(run.time), 2))
    parts = [_gas_torque(group, run, values["tau"]) for group in passive]
    return -np.sum(parts, axis=0)


def _gas_torque(group: GroupSignals, run: PreparedRun, tau: float) -> FloatArray:
    # of the calculated pressure, which the excess temperature scales
    port = 0.5 * (group.pressure_sum + group.logged)
    torque = group.count * group.displacement * port
    fading = np.exp(-run.time / tau)
    # the calculated ln p moves with ln V; what has relaxed of it is its low-passed change
    change = np.log(np.maximum(port, 1.0) / max(port[0], 1.0))
    relaxed = lagged(change, run.dt, tau)
    return np.column_stack([torque * fading, -torque * relaxed])


def _time_constants(runs: Sequence[PreparedRun]) -> list[Shape]:
    return [Shape(f"tau = {tau:g} s", {"tau": tau}, carried=True) for tau in TIME_CONSTANTS]


def _no_passive_group(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    several = any(len(run.groups) > 1 for run in runs)
    return None if several else ("a passive motor group", "no run has one")


def _to_gas(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    ties: dict[str, Any] = {"groups": sides.passive, "time_constant": shape.values["tau"]}
    return [
        correction("accumulator_warmth", found[e_T.name], **ties),
        correction("accumulator_heat", found[g_T.name], **ties),
    ]


def exponent_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Torque of the passive motors per unit of heat that goes at once, N m, shape (samples, 1)."""
    return accumulator_columns(run, values)[:, 1:]


def _at_once(runs: Sequence[PreparedRun]) -> list[Shape]:
    return [Shape("at once", {"tau": AT_ONCE}, carried=True)]


def _to_exponent(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    return [correction("accumulator_heat", found[g_T.name], groups=sides.passive, time_constant=AT_ONCE)]


def gas_candidates() -> list[Candidate]:
    """What a polytropic law that is logged for the passive pressure lacks."""
    return [
        # a PLC that logs the polytropic law p V^n for the passive pressure does not see the gas give its heat away: the
        # bottle's excess temperature at the start, fading, and the heat of each compression, relaxing
        Candidate(
            "accumulator_thermal",
            r"n_p D_p\,\Delta p_p\,(e_T e^{-t/\tau} + g_T \langle\ln p\rangle_\tau)",
            (e_T, g_T),
            accumulator_columns,
            _time_constants,
            kind="signal",
            hydraulic=True,
            continuous=("tau",),
            blind=_no_passive_group,
            corrects=_to_gas,
        ),
        Candidate(
            "accumulator_thermal",
            r"g_T\,n_p D_p\,\Delta p_p\,\ln p",
            (g_T,),
            exponent_columns,
            _at_once,
            kind="signal",
            law_name="another exponent",
            hydraulic=True,
            blind=_no_passive_group,
            corrects=_to_exponent,
        ),
    ]
