"""Candidates in the signals: what a transducer, a clock or a feedback adds to the measured drive torque.

The true pressure stands for itself only through the base model's prediction; the noisy one never becomes a regressor.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Columns, Shape, Shapes, Variant
from winch_friction.discrepancy.preparation.prepared_run import GroupSignals, PreparedRun
from winch_friction.physics.friction.term import Parameter
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.units import BAR, CM3_PER_REV

DELAYS = (0.05, 0.1)  # s
# what is shifted: all that is predicted, as when the pressures come late, or what the speed tells of it
PRESSURES, SPEED = 1.0, 0.0
SMALL_DELAY = {"ahead": 0.03, "behind": 0.03, "late": SPEED}  # s
ALL, BALANCING, OTHER = 0.0, 1.0, 2.0

_GroupLaw = Callable[[GroupSignals], FloatArray]

p_0 = Parameter("p_0", "Pa", 1.5 * BAR, lower=-50 * BAR, upper=50 * BAR, doc="zero error of the transducers")
e_p = Parameter("e_p", "1", 0.01, lower=-0.2, upper=0.2, doc="gain error of the transducers")
D_0 = Parameter(
    "D_0", "m^3/rad", CM3_PER_REV, lower=-20 * CM3_PER_REV, upper=20 * CM3_PER_REV, doc="displacement feedback offset"
)
tau = Parameter("tau", "s", 0.05, lower=-0.5, upper=0.5, doc="delay of the speed behind the pressures")


def _which(run: PreparedRun, shape: Shape) -> list[GroupSignals]:
    which = shape["groups"]
    return [g for g in run.groups if which == ALL or g.balances == (which == BALANCING)]


def group_columns(law: _GroupLaw, run: PreparedRun, shape: Shape) -> FloatArray:
    """Sum of a law over the affected motor groups, N m at the shaft, shape (samples, 1)."""
    return sum((law(g) for g in _which(run, shape)), np.zeros(len(run.time)))[:, None]


def group_shapes(runs: Sequence[PreparedRun]) -> list[Variant]:
    """Which transducers are off: all alike, or, with several groups about, those of one side alone."""
    shapes = [Variant("all groups", {"groups": ALL})]
    if any(len(run.groups) > 1 for run in runs):
        shapes.append(Variant("the driving group", {"groups": BALANCING}))
        shapes.append(Variant("the passive group", {"groups": OTHER}, carried=True))
    return shapes


def _offset(g: GroupSignals) -> FloatArray:
    return g.count * g.displacement


def _scale(g: GroupSignals) -> FloatArray:
    return g.count * g.displacement * g.pressure


def _scale_a(g: GroupSignals) -> FloatArray:
    return g.count * g.displacement * 0.5 * (g.pressure_sum + g.pressure)


def scale_columns(run: PreparedRun, shape: Shape) -> FloatArray:
    """Gain error of both transducers of a group, or of that at port A alone."""
    return group_columns(_scale_a if shape["port_a"] else _scale, run, shape)


def _scale_shapes(runs: Sequence[PreparedRun]) -> list[Variant]:
    return [
        Variant(f"{each.label}, {label}", {**each.shape, "port_a": port}, carried=each.carried)
        for each in group_shapes(runs)
        for port, label in ((0.0, "both ports"), (1.0, "port A"))
    ]


def _swivel(g: GroupSignals) -> FloatArray:
    return g.count * g.pressure


def delay_columns(run: PreparedRun, shape: Shape) -> FloatArray:
    """Change of the predicted drive torque per second of delay, N m/s: a speed that comes late makes pressures come
    early.

    A difference over the delay itself, since friction turns over faster than a derivative could follow. A late speed
    leaves the heave as it is logged.
    """
    shifted = run.predicted if shape["late"] == PRESSURES else run.from_speed
    ahead = np.interp(run.time + shape["ahead"], run.time, shifted)
    behind = np.interp(run.time - shape["behind"], run.time, shifted)
    return ((ahead - behind) / (shape["ahead"] + shape["behind"]))[:, None]


def _delay_shapes(runs: Sequence[PreparedRun]) -> list[Variant]:
    shapes = [Variant("small, of the speed", SMALL_DELAY, (-0.8, 0.8))]
    if any("heave_velocity" in run.channels for run in runs):
        shapes.append(Variant("small, of the pressures", {**SMALL_DELAY, "late": PRESSURES}, (-0.8, 0.8)))
    for step in DELAYS:
        near, far = 0.6 * step / tau.typical, 1.6 * step / tau.typical
        late = {"ahead": step, "behind": 0.0, "late": SPEED}
        shapes.append(Variant(f"speed late, about {1e3 * step:g} ms", late, (near, far)))
        early = {"ahead": 0.0, "behind": step, "late": PRESSURES}
        shapes.append(Variant(f"pressures late, about {1e3 * step:g} ms", early, (-far, -near)))
    return shapes


def signal_candidates() -> list[Candidate]:
    """Offset, gain, delay and displacement feedback."""
    scale, delay = r"e_p\sum_g n_g D_g\,\Delta p_g", r"\tau\,\dot M"
    return [
        _in_groups("pressure_offset", r"\sum_g n_g D_g\,p_0", p_0, partial(group_columns, _offset), group_shapes),
        _in_groups("pressure_scale", scale, e_p, scale_columns, _scale_shapes),
        _in_groups("swivel_offset", r"D_0\sum_g n_g\,\Delta p_g", D_0, partial(group_columns, _swivel), group_shapes),
        Candidate("signal_delay", delay, (tau,), delay_columns, _delay_shapes, kind="signal"),
    ]


def _in_groups(name: str, law: str, parameter: Parameter, columns: Columns, shapes: Shapes) -> Candidate:
    return Candidate(name, law, (parameter,), columns, shapes, kind="signal", hydraulic=True)
