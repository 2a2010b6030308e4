"""Candidates in the signals: what a transducer, a clock or a feedback adds to the measured drive torque.

The true pressure stands for itself only through the base model's prediction; the noisy one never becomes a regressor.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    Candidate,
    Columns,
    Corrects,
    Estimates,
    GroupLaw,
    Shape,
    Shapes,
    Sides,
    Values,
    correction,
    group_columns,
    group_shapes,
    groups_of,
    spoken_of,
)
from winch_friction.discrepancy.candidates.lateness import late_signal
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.problem import of_base, shares_by_run
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction.correction import THERMAL_REFERENCE, Correction
from winch_friction.physics.friction.term import Parameter

RUNS_PER_CONSTANT = 2  # of a law of three constants or more: one decides, another can contradict
WEIGHT = "weight"  # the tolerance of the load
ZERO = "pressure_offset"
ZEROS = (ZERO, "torque_offset", "tare_load")  # of what tells a torque or a load; they act one way
OIL = ("oil_temperature",)
# K between the coldest run and the warmest: over less, what bends by typically 5 mbar/K^2 is within 0.15 bar of a line
WARMTH_TO_BEND = 15.0
p_T = Parameter(
    "p_T", "Pa/K", 0.1 * BAR, lower=-5.0 * BAR, upper=5.0 * BAR, doc="thermal zero shift of the transducers"
)
p_TT = Parameter(
    "p_TT", "Pa/K^2", 5e-3 * BAR, lower=-0.2 * BAR, upper=0.2 * BAR, doc="bow of the transducers' zero over the warmth"
)
p_0 = Parameter("p_0", "Pa", 1.5 * BAR, lower=-50 * BAR, upper=50 * BAR, doc="zero error of the transducers")
c_p = Parameter(
    "c_p", "1/Pa", 0.01 / (200 * BAR), lower=-0.1 / (200 * BAR), upper=0.1 / (200 * BAR),
    doc="gain error of the transducers per pressure",
)  # fmt: skip
e_p = Parameter("e_p", "1", 0.01, lower=-0.2, upper=0.2, doc="gain error of the transducers")
e_T = Parameter("e_T", "1/K", 5e-4, lower=-0.01, upper=0.01, doc="thermal span shift of the transducers")


def warm_columns(law: GroupLaw, run: PreparedRun, values: Values) -> FloatArray:
    """A zero error and what the oil's warmth adds to it, N m, shape (samples, 2)."""
    constant = group_columns(law, run, values)
    return np.column_stack([constant, constant * (run.channels["oil_temperature"] - THERMAL_REFERENCE)[:, None]])


def bowed_warm_columns(law: GroupLaw, run: PreparedRun, values: Values) -> FloatArray:
    """The same, and what the square of the oil's warmth adds, N m, shape (samples, 3)."""
    warm = warm_columns(law, run, values)
    return np.column_stack([warm, warm[:, 1] * (run.channels["oil_temperature"] - THERMAL_REFERENCE)])


def _one_warmth(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    oil = [float(np.median(run.channels["oil_temperature"])) for run in runs if "oil_temperature" in run.channels]
    if len(oil) < 2 or np.ptp(oil) > WARMTH_TO_BEND:
        return None
    return "runs of colder and warmer oil", f"a zero that bends with the warmth shows over {WARMTH_TO_BEND:g} K"


def offset_law(g: GroupSignals) -> FloatArray:
    return g.count * g.displacement


def _scale(g: GroupSignals) -> FloatArray:
    return g.count * g.displacement * g.pressure


def _scale_a(g: GroupSignals) -> FloatArray:
    return g.count * g.displacement * 0.5 * (g.pressure_sum + g.pressure)


def scale_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Gain error of both transducers of a group, or of that at port A alone."""
    return group_columns(_scale_a if values["port_a"] else _scale, run, values)


def curved_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Gain error that grows with the pressure, of both transducers of a group or of that at port A alone."""
    return group_columns(_curve_a if values["port_a"] else _curve, run, values)


def warm_scale_columns(run: PreparedRun, values: Values) -> FloatArray:
    """A gain error and what the oil's warmth adds to it, N m, shape (samples, 2)."""
    return warm_columns(_scale_a if values["port_a"] else _scale, run, values)


def bent_columns(run: PreparedRun, values: Values) -> FloatArray:
    """A gain error and what it gains with the pressure, N m, shape (samples, 2)."""
    return np.hstack([scale_columns(run, values), curved_columns(run, values)])


def _curve(g: GroupSignals) -> FloatArray:
    return _scale(g) * g.pressure_sum


def _curve_a(g: GroupSignals) -> FloatArray:
    return _scale_a(g) * 0.5 * (g.pressure_sum + g.pressure)


def _scale_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    return by_port(group_shapes(runs))


def by_port(shapes: Sequence[Shape]) -> list[Shape]:
    """The same, of both transducers of a group and of that at port A alone."""
    return [
        Shape(f"{each.label}, {label}", {**each.values, "port_a": port}, carried=each.carried)
        for each in shapes
        for port, label in ((0.0, "both ports"), (1.0, "port A"))
    ]


def to(*found_as: tuple[str, Parameter]) -> Corrects:
    """To one correction for each estimate: its name, or of what is wrong at port A alone that with `_a`, and the
    parameter."""

    def corrects(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
        at, groups = "_a" if shape.values.get("port_a") else "", groups_of(shape, sides)
        return [correction(f"{name}{at}", found[p.name], groups=groups) for name, p in found_as]

    return corrects


def signal_candidates() -> list[Candidate]:
    """Offset, gain and delay; the feedback of the displacement stands in a file of its own."""
    offset = r"\sum_g n_g D_g\,"
    return [
        in_groups(ZERO, offset + "p_0", (p_0,), partial(group_columns, offset_law), group_shapes,
                  to(("pressure_offset", p_0))),
        in_groups(ZERO, offset + r"(p_0 + p_T(\vartheta-40))", (p_0, p_T), partial(warm_columns, offset_law),
                  group_shapes, to(("pressure_offset", p_0), ("pressure_thermal_zero", p_T)),
                  law_name="thermal zero shift", needs=OIL),
        # a bridge is compensated at two temperatures: what is left between and beyond them is a bow
        in_groups(ZERO, offset + r"(p_0 + p_T(\vartheta-40) + p_{TT}(\vartheta-40)^2)", (p_0, p_T, p_TT),
                  partial(bowed_warm_columns, offset_law), group_shapes,
                  to(("pressure_offset", p_0), ("pressure_thermal_zero", p_T), ("pressure_thermal_bow", p_TT)),
                  law_name="thermal zero that bends", needs=OIL, blind=_one_warmth),
        in_groups("pressure_scale", r"e_p" + offset + r"\Delta p_g", (e_p,), scale_columns, _scale_shapes,
                  to(("pressure_scale", e_p))),
        in_groups("pressure_scale", offset + r"\Delta p_g(e_p + e_T(\vartheta-40))", (e_p, e_T), warm_scale_columns,
                  _scale_shapes, to(("pressure_scale", e_p), ("pressure_thermal_span", e_T)),
                  law_name="thermal span shift", needs=OIL),
        in_groups("pressure_scale", r"c_p" + offset + "p_g^2", (c_p,), curved_columns, _scale_shapes,
                  to(("pressure_curvature", c_p)), law_name="grows with the pressure"),
        in_groups("pressure_scale", offset + r"(e_p\,\Delta p_g + c_p\,p_g^2)", (e_p, c_p), bent_columns,
                  _scale_shapes, to(("pressure_scale", e_p), ("pressure_curvature", c_p)),
                  law_name="bends with the pressure"),
        late_signal(),
    ]  # fmt: skip


def in_groups(
    name: str,
    law: str,
    linear: tuple[Parameter, ...],
    columns: Columns,
    shapes: Shapes,
    corrects: Corrects,
    **more: Any,
) -> Candidate:
    """A candidate in the signals of motor groups, of those that enough runs have for its constants."""
    shapes = partial(_told_apart, shapes, len(linear))
    return Candidate(name, law, linear, columns, shapes, kind="signal", hydraulic=True, corrects=corrects, **more)


def _told_apart(shapes: Shapes, linear: int, runs: Sequence[PreparedRun]) -> list[Shape]:
    """Shapes of groups that enough runs have: load, stroke and oil hardly change within one, so that three constants
    which as many levels decide sort runs, whatever is wrong in them. A place where a law bends is a constant too."""

    def told(shape: Shape) -> bool:
        constants = linear + sum(name.startswith("beyond") for name in shape.values)
        return constants < 3 or sum(any(spoken_of(run, shape.values)) for run in runs) >= RUNS_PER_CONSTANT * constants

    return [each for each in shapes(runs) if told(each)]


# -- what a transducer may add without being wrong
def within_load_cells(cross: CrossFit, fitted: Sequence[Explanation], least: float) -> str:
    """Why a name is none that adds to each run's load what its cell is off by, one of these; empty where none does.

    Together with what the base grants it is within a calibrated cell's tolerance in the mean of the runs, about which
    it scatters by no more than cells repeat to (of a dozen draws the root mean square is beyond 1.5 sigma once in a
    hundred), such levels are most of it, and beside them it is less than no balance closes, `least`, in the gap's unit.
    Of a dozen runs whose cells are off by so much some signal of one value in each tells the order.
    """
    problem, blocks = cross.problem, cross.problem.blocks
    if (weight := of_base(problem, WEIGHT)) is None:
        return ""
    at, count = problem.base.names.index(WEIGHT), len(problem.base.names)
    repeats = LIMITS.at_the_floor * LIMITS.least_share_of_load
    for each in (one for one in fitted if one.slots):
        torque = blocks.x[:, list(problem.columns(each.slots)[count:])] @ each.beta[count:]
        shares, beside = shares_by_run(torque, weight, blocks.run)
        scatter = float(np.std(shares))
        level = abs(float(np.mean(shares)) + float(each.beta[at]) * problem.base.scale[at])
        most = float(problem.base.upper[at] * problem.base.scale[at])
        of_levels = 2.0 * float(np.mean(beside**2)) <= float(np.mean(torque**2))
        if of_levels and scatter <= repeats and level <= most and float(np.sqrt(np.mean(beside**2))) <= least:
            return f"{100 * scatter:.2g} % of the load from run to run is what load cells repeat to, and no name"
    return ""
