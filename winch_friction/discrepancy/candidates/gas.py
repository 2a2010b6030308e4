"""Candidate of the calculated pressure of an accumulator: a gas that warms, cools, or follows another exponent."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Estimates, Shape, Sides, Values, correction
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.grid import lagged
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.seen import GroupSignals
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter

GAS = "accumulator_thermal"
TIME_CONSTANTS = (30.0, 60.0, 120.0, 240.0)  # s, of an accumulator's gas
SLOWER = 5.0  # times the fast time constant: further apart than that the fast one is over before the slow one shows
# Share of what the driving side's pressure drop varies by. Next to all of that is friction, which no law of a gas
# knows: the difference of the two sides varies as much. Motors on one line carry it alike, and it varies by noise.
OWN_PRESSURE = 0.5
AT_ONCE = 0.01  # s; heat that goes as fast as it comes is another exponent of the calculated law

e_T = Parameter(
    "e_T", "1", 0.02, lower=-0.2, upper=0.2, doc="relative excess temperature of the gas at the start of a run"
)
e_S = Parameter("e_S", "1", 0.02, lower=-0.2, upper=0.2, doc="a part of it that fades more slowly")
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


def _has_its_own_pressure(group: GroupSignals, run: PreparedRun) -> bool:
    if group.balances:
        return False
    driving = next(each.logged for each in run.groups if each.balances)
    return bool(np.std(group.logged - driving) >= OWN_PRESSURE * np.std(driving))


def _no_passive_group(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    # several motors on one line press alike, and no bottle stands on it
    several = any(_has_its_own_pressure(group, run) for run in runs for group in run.groups)
    return None if several else ("a passive motor group", "no run has one whose pressure is not the driving side's own")


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


def two_parts_columns(run: PreparedRun, values: Values) -> FloatArray:
    """The same with a second part of the warmth that fades more slowly, N m, shape (samples, 3)."""
    slow = accumulator_columns(run, {"tau": SLOWER * values["tau"]})[:, :1]
    return np.hstack([accumulator_columns(run, values), slow])


def _to_two_parts(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    slow = SLOWER * shape.values["tau"]
    warmth = correction("accumulator_slow_warmth", found[e_S.name], groups=sides.passive, time_constant=slow)
    return [*_to_gas(found, shape, sides), warmth]


def gas_candidates() -> list[Candidate]:
    """What a polytropic law that is logged for the passive pressure lacks."""
    # a PLC that logs the polytropic law p V^n for the passive pressure does not see the gas give its heat away: the
    # bottle's excess temperature at the start, fading, and the heat of each compression, relaxing
    gas = partial(Candidate, GAS, kind="signal", hydraulic=True, blind=_no_passive_group)
    torque = r"n_p D_p\,\Delta p_p\,"
    return [
        gas(torque + r"(e_T e^{-t/\tau} + g_T \langle\ln p\rangle_\tau)", (e_T, g_T), accumulator_columns,
            _time_constants, continuous=("tau",), corrects=_to_gas),
        gas(torque + r"(e_T e^{-t/\tau} + e_S e^{-t/5\tau} + g_T \langle\ln p\rangle_\tau)", (e_T, g_T, e_S),
            two_parts_columns, _time_constants, law_name="a fast part and a slow one", continuous=("tau",),
            corrects=_to_two_parts),
        gas(r"g_T\," + torque + r"\ln p", (g_T,), exponent_columns, _at_once, law_name="another exponent",
            corrects=_to_exponent),
    ]  # fmt: skip
