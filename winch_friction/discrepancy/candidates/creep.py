"""What comes or fades with time alone: over days a zero that creeps and a load that gathers, in a run a gas that warms.

The gas is that of an accumulator whose pressure is calculated; it may also cool, or follow another exponent."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    Candidate,
    Estimates,
    Shape,
    Shapes,
    Sides,
    Values,
    correction,
    group_columns,
    group_shapes,
    groups_of,
    single_shape,
)
from winch_friction.discrepancy.candidates.geometry import hanging, m_h
from winch_friction.discrepancy.candidates.signals import ZERO, in_groups, offset_law, p_0
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.grid import lagged
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter

SETTLED = (0.3, 0.6, 1.0)  # of the time between the first run and the last, after which nothing comes any more
# s between the first run and the last: electronics warm up within an hour, and creep over days; mud and growth gather
# over days, and what seven runs of an afternoon have in their order is anything
SHORTEST_CREEP, SHORTEST_GATHERING = 3600.0, 86400.0

p_d = Parameter("p_d", "Pa", 3.0 * BAR, lower=-50 * BAR, upper=50 * BAR, doc="how far the zero creeps over the runs")
m_d = Parameter("m_d", "kg", 2000.0, lower=-2e4, upper=2e4, doc="mass that comes over the runs, which no cell tells")


def creeping_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Zero error of the transducers at first, and what comes in proportion to the time, N m, shape (samples, 2)."""
    constant = group_columns(offset_law, run, values)
    return np.column_stack([constant, constant * _grown(run, values)[:, None]])


def gathering_columns(run: PreparedRun, values: Values) -> FloatArray:
    """A mass that the load signal lacks at first, and what comes in proportion to the time, N m, shape (samples, 2)."""
    constant = hanging(run, 1.0)
    return np.column_stack([constant, constant * _grown(run, values)])


def _grown(run: PreparedRun, values: Values) -> FloatArray:
    """The share that has come by each sample."""
    return np.clip((run.start + run.time - values["from"]) / (values["to"] - values["from"]), 0.0, 1.0)


def _creeping_shapes(of: Shapes, runs: Sequence[PreparedRun]) -> list[Shape]:
    """What creeps, from the first run on, to the end or until it has settled before."""
    begin, end = min(run.start for run in runs), max(run.start + float(run.time[-1]) for run in runs)
    return [
        Shape(
            f"{each.label}, within {share:.0%} of the time",
            {**each.values, "from": begin, "to": begin + share * (end - begin)},
            carried=each.carried,
        )
        for each in of(runs)
        for share in SETTLED
    ]


def _one_date(runs: Sequence[PreparedRun], shortest: float = SHORTEST_CREEP) -> tuple[str, str] | None:
    starts = [run.start for run in runs]
    if len(runs) >= LIMITS.fewest_levels and max(starts) - min(starts) > shortest:
        return None
    return "runs of several days", "what creeps shows between runs that lie apart"


def _to_creep(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    groups, during = groups_of(shape, sides), ((shape.values["from"], shape.values["to"]),)
    return [
        correction("pressure_offset", found[p_0.name], groups=groups),
        correction("pressure_creep", found[p_d.name], groups=groups, during=during),
    ]


def _to_gather(found: Estimates, shape: Shape, _: Sides) -> list[Correction]:
    during = ((shape.values["from"], shape.values["to"]),)
    return [correction("tare_load", found[m_h.name]), correction("tare_creep", found[m_d.name], during=during)]


def creeping_candidates() -> list[Candidate]:
    """Of the pressures' zero and of the load."""
    return [
        in_groups(ZERO, r"\sum_g n_g D_g\,(p_0 + p_d\,t/t_{end})", (p_0, p_d), creeping_columns,
                  partial(_creeping_shapes, group_shapes), _to_creep, law_name="creeping zero", blind=_one_date),
        # mud and growth gather on a block, and a cell's zero moves over the months (OIML R 60, zero return)
        Candidate("tare_load", r"(m_h+m_d\,t/t_{end})\,(g+\ddot x)\,R/i", (m_h, m_d), gathering_columns,
                  partial(_creeping_shapes, single_shape), kind="load", needs=("hook_load",),
                  law_name="gathers over the days", blind=partial(_one_date, shortest=SHORTEST_GATHERING),
                  corrects=_to_gather),
    ]  # fmt: skip


# -- the gas of an accumulator
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
