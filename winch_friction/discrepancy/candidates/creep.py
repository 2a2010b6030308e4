"""What comes over days: a transducer's zero that creeps, and a load that gathers."""

from collections.abc import Sequence
from functools import partial

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
