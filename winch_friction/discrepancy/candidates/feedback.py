"""Candidates in the feedback of the displacement: its zero, what the oil's warmth adds, and a bow over the stroke."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Estimates, Shape, Sides, Values, correction
from winch_friction.discrepancy.candidates.signals import (
    OIL,
    group_columns,
    group_shapes,
    groups_of,
    in_groups,
    to,
    warm_columns,
)
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.preparation.seen import GroupSignals
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter
from winch_friction.physics.units import CM3_PER_REV

LARGEST = "max_displacement"  # m^3/rad, of one motor
FEWEST_STROKES = 3  # displacements a tenth of the largest apart: a zero and a bow, and one that could contradict

D_0 = Parameter(
    "D_0", "m^3/rad", CM3_PER_REV, lower=-20 * CM3_PER_REV, upper=20 * CM3_PER_REV, doc="displacement feedback offset"
)
D_T = Parameter(
    "D_T", "m^3/rad/K", 0.1 * CM3_PER_REV, lower=-2.0 * CM3_PER_REV, upper=2.0 * CM3_PER_REV,
    doc="thermal zero shift of the displacement feedback",
)  # fmt: skip
D_b = Parameter(
    "D_b", "m^3/rad", CM3_PER_REV, lower=-20 * CM3_PER_REV, upper=20 * CM3_PER_REV,
    doc="bow of the displacement feedback at half stroke, between ends at which it is right",
)  # fmt: skip


def _swivel(g: GroupSignals) -> FloatArray:
    return g.count * g.pressure


def bowed_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Zero error of the feedback and its bow at half stroke, N m, shape (samples, 2)."""
    largest = dict(run.constants)[LARGEST]

    def bow(g: GroupSignals) -> FloatArray:
        stroke = g.displacement / largest
        return 4.0 * stroke * (1.0 - stroke) * _swivel(g)

    return np.hstack([group_columns(_swivel, run, values), group_columns(bow, run, values)])


def warm_bowed_columns(run: PreparedRun, values: Values) -> FloatArray:
    """The same, and what the oil's warmth adds to the zero, N m, shape (samples, 3)."""
    return np.column_stack([bowed_columns(run, values), warm_columns(_swivel, run, values)[:, 1]])


def _few_strokes(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    largest = max((dict(run.constants).get(LARGEST, 0.0) for run in runs), default=0.0)
    driven = [float(np.median(g.displacement)) for run in runs for g in run.groups if g.balances]
    if largest > 0.0 and len({round(each / largest, 1) for each in driven}) >= FEWEST_STROKES:
        return None
    return "more displacements", "a bow shows between three displacements that lie apart"


def _to_bow(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    """Zero, gain and curvature: what is right at both ends of the stroke has a gain against its bow."""
    groups, largest = groups_of(shape, sides), sides.crane.max_displacement
    gain = 4.0 / largest  # the curvature bends what the gain has made of the true value
    curvature = -gain / largest / (1.0 + gain * found[D_b.name].value) ** 2
    corrections = [
        correction("displacement_offset", found[D_0.name], groups=groups),
        correction("displacement_scale", found[D_b.name], gain, groups=groups),
        correction("displacement_curvature", found[D_b.name], curvature, groups=groups),
    ]
    if D_T.name in found:
        corrections.append(correction("displacement_thermal_zero", found[D_T.name], groups=groups))
    return corrections


def feedback_candidates() -> list[Candidate]:
    """A zero error, one that shifts with the oil, and a bow between ends at which the feedback is right."""
    swivel = r"\sum_g n_g\,\Delta p_g\,"
    found = [
        in_groups("swivel_offset", "D_0" + swivel, (D_0,), partial(group_columns, _swivel), group_shapes,
                  to(("displacement_offset", D_0))),
        in_groups("swivel_offset", swivel + r"(D_0 + D_T(\vartheta-40))", (D_0, D_T), partial(warm_columns, _swivel),
                  group_shapes, to(("displacement_offset", D_0), ("displacement_thermal_zero", D_T)),
                  law_name="thermal zero shift of the feedback", needs=OIL),
        in_groups("swivel_offset", swivel + r"(D_0 + 4 D_b\,x(1-x))", (D_0, D_b), bowed_columns, group_shapes, _to_bow,
                  law_name="bows over the stroke", blind=_few_strokes),
        in_groups("swivel_offset", swivel + r"(D_0 + 4 D_b\,x(1-x) + D_T(\vartheta-40))", (D_0, D_b, D_T),
                  warm_bowed_columns, group_shapes, _to_bow, law_name="bows and shifts with the oil", needs=OIL,
                  blind=_few_strokes),
    ]  # fmt: skip
    return [replace(each, of_stroke=True) for each in found]
