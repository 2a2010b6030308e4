"""Candidates in the feedback of the displacement: its zero, what the oil's warmth adds, and a bow over the stroke.

And in what shows a signal unevenly: a transducer whose gain changes at a pressure, a feedback whose curve the data
draw.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    BALANCING,
    Candidate,
    Estimates,
    ParameterEstimate,
    Shape,
    Sides,
    Values,
    affected_groups,
    correction,
    group_columns,
    group_shapes,
    groups_of,
)
from winch_friction.discrepancy.candidates.signals import OIL, e_p, in_groups, scale_columns, to, warm_columns
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.corrections import s_shape
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter

LARGEST = "max_displacement"  # m^3/rad, of one motor
# displacements a tenth of the largest apart: a zero and a bow, or an S as well, and one that could contradict
FEWEST_STROKES, FEWEST_OF_AN_S = 3, 4

D_0 = Parameter(
    "D_0", "m^3/rad", CM3_PER_REV, lower=-20 * CM3_PER_REV, upper=20 * CM3_PER_REV, doc="displacement feedback offset"
)
D_T = Parameter(
    "D_T", "m^3/rad/K", 0.1 * CM3_PER_REV, lower=-2.0 * CM3_PER_REV, upper=2.0 * CM3_PER_REV,
    doc="thermal zero shift of the displacement feedback",
)  # fmt: skip
e_D = Parameter("e_D", "1", 0.01, lower=-0.2, upper=0.2, doc="gain error of the displacement feedback")
D_b = Parameter(
    "D_b", "m^3/rad", CM3_PER_REV, lower=-20 * CM3_PER_REV, upper=20 * CM3_PER_REV,
    doc="bow of the displacement feedback at half stroke, between ends at which it is right",
)  # fmt: skip
D_s = Parameter(
    "D_s", "m^3/rad", CM3_PER_REV, lower=-20 * CM3_PER_REV, upper=20 * CM3_PER_REV,
    doc="S of the displacement feedback: its error at a fifth of the stroke, the opposite at four fifths",
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


def parabola_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Zero and gain error of the feedback and its bow, N m, shape (samples, 3): wrong at both ends of the stroke."""
    gain = group_columns(lambda g: g.displacement * _swivel(g), run, values)
    zero_and_bow = bowed_columns(run, values)
    return np.hstack([zero_and_bow[:, :1], gain, zero_and_bow[:, 1:]])


def warm_parabola_columns(run: PreparedRun, values: Values) -> FloatArray:
    """The same, and what the oil's warmth adds to the zero, N m, shape (samples, 4)."""
    return np.column_stack([parabola_columns(run, values), warm_columns(_swivel, run, values)[:, 1]])


def s_shaped_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Zero error of the feedback, its bow and its S, N m, shape (samples, 3): the third order of a linkage's error."""
    largest = dict(run.constants)[LARGEST]

    def swing(g: GroupSignals) -> FloatArray:
        return s_shape(g.displacement / largest) * _swivel(g)

    return np.hstack([bowed_columns(run, values), group_columns(swing, run, values)])


def _few_strokes(runs: Sequence[PreparedRun], fewest: int = FEWEST_STROKES) -> tuple[str, str] | None:
    largest = max((dict(run.constants).get(LARGEST, 0.0) for run in runs), default=0.0)
    driven = [float(np.median(g.displacement)) for run in runs for g in run.groups if g.balances]
    if largest > 0.0 and len({round(each / largest, 1) for each in driven}) >= fewest:
        return None
    return "more displacements", f"a bow or an S shows between {fewest} displacements that lie apart"


def _to_bow(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    """Zero, gain and curvature: what is right at both ends of the stroke has a gain against its bow."""
    groups, largest = groups_of(shape, sides), sides.crane.max_displacement
    gain, bow = 4.0 / largest, found[D_b.name]
    own = found.get(e_D.name, ParameterEstimate(0.0, 0.0, e_D.unit))
    scale = ParameterEstimate(own.value + gain * bow.value, float(np.hypot(own.std, gain * bow.std)), e_D.unit)
    # the curvature bends what the gain has made of the true value
    curvature = -gain / largest / (1.0 + scale.value) ** 2
    corrections = [
        correction("displacement_offset", found[D_0.name], groups=groups),
        correction("displacement_scale", scale, groups=groups),
        correction("displacement_curvature", bow, curvature, groups=groups),
    ]
    if D_s.name in found:
        corrections.append(correction("displacement_s_shape", found[D_s.name], groups=groups, beyond=largest))
    if D_T.name in found:
        corrections.append(correction("displacement_thermal_zero", found[D_T.name], groups=groups))
    return corrections


def feedback_candidates() -> list[Candidate]:
    """A zero error, one that shifts with the oil, and a bow or an S between ends at which the feedback is right."""
    swivel = r"\sum_g n_g\,\Delta p_g\,"
    found = [
        in_groups("swivel_offset", "D_0" + swivel, (D_0,), partial(group_columns, _swivel), group_shapes,
                  to(("displacement_offset", D_0))),
        in_groups("swivel_offset", swivel + r"(D_0 + D_T(\vartheta-40))", (D_0, D_T), partial(warm_columns, _swivel),
                  group_shapes, to(("displacement_offset", D_0), ("displacement_thermal_zero", D_T)),
                  law_name="thermal zero shift of the feedback", needs=OIL),
        in_groups("swivel_offset", swivel + r"(D_0 + 4 D_b\,x(1-x))", (D_0, D_b), bowed_columns, group_shapes, _to_bow,
                  law_name="bows over the stroke", blind=_few_strokes),
        in_groups("swivel_offset", swivel + r"(D_0 + 4 D_b\,x(1-x) + 6\sqrt{3} D_s\,x(1-x)(1-2x))", (D_0, D_b, D_s),
                  s_shaped_columns, group_shapes, _to_bow, law_name="bends twice over the stroke",
                  blind=partial(_few_strokes, fewest=FEWEST_OF_AN_S)),
        in_groups("swivel_offset", swivel + r"(D_0 + 4 D_b\,x(1-x) + D_T(\vartheta-40))", (D_0, D_b, D_T),
                  warm_bowed_columns, group_shapes, _to_bow, law_name="bows and shifts with the oil", needs=OIL,
                  blind=_few_strokes),
        # a calibration wrong at both its strokes: with a gain in it, which others have alone, it is a curve beside them
        in_groups("swivel_offset", swivel + r"(D_0 + e_D D_g + 4 D_b\,x(1-x))", (D_0, e_D, D_b), parabola_columns,
                  group_shapes, _to_bow, law_name="a parabola over the stroke", free=True,
                  blind=partial(_few_strokes, fewest=FEWEST_OF_AN_S)),
        in_groups("swivel_offset", swivel + r"(D_0 + e_D D_g + 4 D_b\,x(1-x) + D_T(\vartheta-40))",
                  (D_0, e_D, D_b, D_T), warm_parabola_columns, group_shapes, _to_bow,
                  law_name="a parabola that shifts with the oil", needs=OIL, free=True,
                  blind=partial(_few_strokes, fewest=FEWEST_OF_AN_S)),
    ]  # fmt: skip
    return [replace(each, of_stroke=True) for each in found]


# -- signals shown unevenly
# where the gain may change, of the way from the lowest to the highest pressure covered: a transducer bends at one
# pressure as likely as at another, however many samples were taken below it
PRESSURES = tuple(k / 8.0 for k in range(1, 8))
CLOSER = (-0.75, -0.5, -0.25, 0.25, 0.5, 0.75)  # of the way to its neighbours, once one is found
SEEN_BEYOND = 0.1  # share of a run's samples beyond a pressure that make it one of those that tell of the gain there
FEWEST_BEYOND = 2  # runs; one alone tells its own load as well
STROKES = (0.1, 0.4, 0.7)  # the same of the displacement, at which the feedback's curve bends
FEWEST_OF_A_CURVE = (
    6  # displacements a twentieth of the largest apart: a zero, three bends, and two that could contradict
)

b_p = Parameter("b_p", "1", 0.02, lower=-0.5, upper=0.5, doc="gain error of the transducers beyond a pressure")
# a bow of an offset's typical height, 1 of 250 cm^3, up and down again over a quarter of the stroke each
TURN = 2.0 * (1.0 / 250.0) / 0.25
BENDS = tuple(
    Parameter(f"b_D{k}", "1", TURN, lower=-0.5, upper=0.5, doc=f"change {k} of the feedback's gain over the stroke")
    for k in range(1, len(STROKES) + 1)
)


def _high(g: GroupSignals) -> FloatArray:
    return 0.5 * (g.pressure_sum + np.abs(g.pressure))


def _covered(runs: Sequence[PreparedRun], values: Values) -> list[FloatArray]:
    """The high pressures that the moving samples of the groups have seen that a shape speaks of, of each run's own."""
    own = [[np.broadcast_to(_high(g), run.time.shape)[run.used] for g in affected_groups(run, values)] for run in runs]
    return [np.concatenate(parts) for parts in own if sum(map(len, parts))]


def bent_pressure_columns(run: PreparedRun, values: Values) -> FloatArray:
    """A gain error, and what is added beyond a pressure, N m, shape (samples, 2)."""

    def beyond(g: GroupSignals) -> FloatArray:
        ports = (0.5 * (g.pressure_sum + sign * g.pressure) for sign in (1.0, -1.0))
        a, b = (np.maximum(port - values["beyond"], 0.0) for port in ports)
        return g.count * g.displacement * (a - b)

    return np.hstack([scale_columns(run, {**values, "port_a": 0.0}), group_columns(beyond, run, values)])


def _pressure_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    """The pressures at which each side's transducers may bend, with runs on both sides of them."""
    shapes = []
    for each in group_shapes(runs):
        covered = _covered(runs, each.values)
        if covered:
            low, high = np.quantile(np.concatenate(covered), (0.01, 0.99))
            places = [low + way * (high - low) for way in PRESSURES]
            shapes += [_bent(each, at) for at in places if _told_on_both_sides(covered, at)]
    return shapes


def _told_on_both_sides(covered: Sequence[FloatArray], at: float) -> bool:
    above = np.array([np.mean(own > at) for own in covered])
    return min((above >= SEEN_BEYOND).sum(), (above <= 1.0 - SEEN_BEYOND).sum()) >= FEWEST_BEYOND


def _bent(side: Shape, at: float) -> Shape:
    own = {**side.values, "beyond": float(at)}
    return Shape(f"{side.label.split(', beyond')[0]}, beyond {at / 1e5:.0f} bar", own, carried=side.carried)


def _bent_at(shapes: Sequence[Shape]) -> Candidate:
    law = r"\sum_g n_g D_g\,(e_p\,\Delta p_g + b_p\,(p_g - p_b)_+)"
    return in_groups("pressure_scale", law, (e_p, b_p), bent_pressure_columns, lambda _: list(shapes), _to_pressure,
                     law_name="bends at a pressure")  # fmt: skip


def _closer(shapes: Sequence[Shape], found: Shape) -> Candidate:
    """The same with places between the one found and its neighbours."""
    own = [each.values["beyond"] for each in shapes if each.values["groups"] == found.values["groups"]]
    step = min(np.diff(own), default=0.0)
    return _bent_at([*shapes, *(_bent(found, found.values["beyond"] + way * step) for way in CLOSER if step)])


def _to_pressure(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    groups = groups_of(shape, sides)
    return [
        correction("pressure_scale", found[e_p.name], groups=groups),
        correction("pressure_bend", found[b_p.name], groups=groups, beyond=shape.values["beyond"]),
    ]


def curve_columns(run: PreparedRun, values: Values) -> FloatArray:
    """Zero error of the feedback and its changes of gain over the stroke, N m, shape (samples, 1 + bends)."""

    def column(g: GroupSignals, at: float) -> FloatArray:
        return _swivel(g) * np.maximum(g.displacement - at, 0.0)

    zero = group_columns(_swivel, run, values)
    bends = [group_columns(partial(column, at=values[f"beyond_{k}"]), run, values) for k in range(1, len(BENDS) + 1)]
    return np.hstack([zero, *bends])


def _curve_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    shapes = []
    for each in group_shapes(runs):
        at = np.quantile(_strokes(runs, each.values), STROKES)
        if np.diff(at).min() > 0.0:
            own = {f"beyond_{k}": float(v) for k, v in enumerate(at, start=1)}
            shapes.append(Shape(each.label, {**each.values, **own}, carried=each.carried))
    return shapes


def _strokes(runs: Sequence[PreparedRun], values: Values) -> FloatArray:
    """One displacement for every run and group: what a run holds counts once, however long it is."""
    own = [float(np.median(g.displacement)) for run in runs for g in affected_groups(run, values)]
    return np.array(own or [0.0])


def _few_bends(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    largest = max((dict(run.constants).get(LARGEST, 0.0) for run in runs), default=0.0)
    if (
        largest > 0.0
        and len(set(np.round(20.0 * _strokes(runs, {"groups": BALANCING}) / largest))) >= FEWEST_OF_A_CURVE
    ):
        return None
    return "more displacements", "a curve over the stroke shows between many displacements"


def _to_curve(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    groups = groups_of(shape, sides)
    return [
        correction("displacement_offset", found[D_0.name], groups=groups),
        *(
            correction("displacement_bend", found[p.name], groups=groups, beyond=shape.values[f"beyond_{k}"])
            for k, p in enumerate(BENDS, start=1)
        ),
    ]


def bends_over(runs: Sequence[PreparedRun]) -> list[Candidate]:
    """A transducer that bends at a pressure, and a feedback whose curve over the stroke the data draw; where they may
    bend is what these runs have covered, and stays so while the pressures are reckoned anew around what was found.
    """
    pressures, strokes = _pressure_shapes(runs), _curve_shapes(runs)
    curve = in_groups(
        "swivel_offset", r"\sum_g n_g\,\Delta p_g\,(D_0 + \sum_k b_{Dk}\,(D_g - D_k)_+)", (D_0, *BENDS), curve_columns,
        lambda _: strokes, _to_curve, law_name="a curve over the stroke", blind=_few_bends, free=True, of_stroke=True,
    )  # fmt: skip
    bent = replace(_bent_at(pressures), finer=partial(_closer, pressures))
    return [each for each, shapes in ((bent, pressures), (curve, strokes)) if shapes]
