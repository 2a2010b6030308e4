"""Families of laws: the same cause by other equations, and by a curve that the data draw.

A cause is named, whatever its law: every member bears the cause's name, competes by held-out loss, and goes into the
repaired model as a term of its own. Shapes are grids over decades of what is physically possible.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from winch_friction.discrepancy.candidates import friction
from winch_friction.discrepancy.candidates.candidate import Candidate, Possible, Shape, Shapes
from winch_friction.discrepancy.candidates.friction import COULOMB, POSSIBLE, Grid, friction_candidate, term_columns
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.motors import GroupSignals
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import quotient_unit
from winch_friction.physics.friction import FrictionModel, Scope, Term, term_named
from winch_friction.physics.friction.symbols import WINCH_SIGNALS
from winch_friction.physics.friction.table import FACTORS, Table, outlined, tabulated

TEMPERATURES = (15.0, 30.0, 50.0)  # degC, at which a model's viscous terms may hold
STRIBECK, DECAYS = (4.0, 8.0, 16.0, 32.0), (3.0, 8.0, 20.0)  # rad/s, the first in octaves from 40 to 300 rpm
AGEING = (0.1, 0.4, 1.6)  # 1/s, from a second to ten of rest
ONSETS = (60e5, 100e5, 150e5, 200e5)  # Pa, from a third of a motor's nominal pressure to beyond its half
POWERS, FLOWS, EACH_WAY = (0.5, 1.5, 2.0, 3.0), (1.0, 1.75, 2.0), (-1.0, -0.5, 0.0, 0.5, 1.0)
ONE_WAY, PORT = tuple(b for b in EACH_WAY if b), ("n_po", "m_po")  # as a line: the three are one at one displacement
FAR = 30.0  # typical sizes: normalised powers have the size of the machine, which differs by more than ten
OIL, HUNG, CARRYING = ("oil_temperature",), ("hook_load", "wire_out"), ("gear_load_loss",)
RESOLVED = {"oil_temperature": 1.0, "time": 1.0}  # K and s, of signals whose zero means nothing


def literature() -> list[Candidate]:
    """The other laws of the literature, under the names of their causes."""
    oil, line = partial(_of, "viscosity_temperature", needs=OIL), partial(_of, "line_pressure_drop")
    wear, since = partial(_of, "wear_drift", presumes=COULOMB), friction.between_runs
    worn = partial(_of, "wear_drift", presumes=CARRYING, blind=friction.one_load)
    layers = partial(_of, "layer_radius", needs=("hook_load", "wire_layer"), blind=friction.one_load)
    return [
        oil("viscosity_reference", {"T_vw": TEMPERATURES}, continuous=("T_vw",)),
        oil("viscosity_vogel", {"T_vv": TEMPERATURES, "B_vv": (550.0, 1100.0)}),
        oil("viscosity_exponential", {"T_ve": TEMPERATURES, "b_ve": (0.022, 0.045)}),
        oil("viscosity_hersey", {"T_vh": TEMPERATURES, "C4_h": STRIBECK[1:]}),
        oil("viscosity_each_way", {"T_vu": TEMPERATURES}, continuous=("T_vu",)),
        *(_of("stribeck", f"stribeck_{curve}", {f"v_{curve[0]}": STRIBECK}) for curve in ("gauss", "lorentz")),
        _of("dwell_stiction", "dwell_by_speed", {"g_dv": AGEING, "v_dv": DECAYS}, reversal_gain=0.1,
            reversal_rival=True),
        _of("presliding", "presliding", {"d_z": (0.3, 1.0, 3.0)}, law_name="over a long travel", plausible=6.0),
        wear("wear_saturating", shapes=friction.lags("t_ws", "tau_ws", (0.08, 0.25, 0.7))),
        *(_of(x, "wear_sudden", presumes=COULOMB, shapes=since("t_wd")) for x in ("wear_drift", "brake_drag")),
        worn("wear_under_load", shapes=friction.observed_time("t_wt", "tau_wt", 2)),  # gears and sheaves, as seals do
        worn("wear_under_load_run_in", shapes=friction.lags("t_wr", "tau_wr", (0.1, 0.2, 0.4, 0.8))),
        worn("wear_under_load_sudden", shapes=since("t_we")),
        _of("brake_drag", "brake_each_way", presumes=COULOMB),
        wear("wear_logarithmic", shapes=friction.lags("t_wl", "tau_wl", (0.003, 0.03, 0.2))),
        wear("wear_bathtub", shapes=friction.lags("t_wb", "tau_wb", (0.1, 0.2, 0.4))),
        _of("low_displacement_loss", "low_displacement_power", {"a_lp": (0.0, 0.5, 1.0), "b_lp": (1.0, 2.0, 3.0)}),
        _of("low_displacement_loss", "low_displacement_each_way", {"a_lu": (0.5, 1.0), "b_lu": (1.0, 2.0, 3.0)}),
        _of("port_turbulence", "port_power", {"n_pp": (1.5, 2.0, 3.0), "m_pp": (1.0, 2.0, 3.0, 4.0)}),
        _of("port_turbulence", "port_one_way", {"n_po": (2.0,), "m_po": (1.0, 3.0), "b_po": ONE_WAY}, continuous=PORT),
        _of("churning", "churning_viscous", {"n_cv": (1.3, 1.75, 2.3, 3.0)}, needs=OIL),
        _of("churning", "churning_one_way", {"n_cw": (1.5, 2.0, 3.0), "b_cw": ONE_WAY}, continuous=("n_cw",)),
        *(_of("high_pressure_mixed", law, {n: (1.5, 3.0, 4.0)})
          for law, n in (("high_pressure_power", "n_hp"), ("high_pressure_each_way", "n_hu"))),
        # at lower speeds and in proportion to the pressure it is a Stribeck curve
        _of("high_pressure_mixed", "high_pressure_film", {"n_hf": (1.5, 2.0, 3.0), "w_hf": (20.0, 60.0, 180.0)}),
        # that does not fade within the speeds of a motor is the convex curve's: it took up what two runs differ by
        _of("high_pressure_mixed", "high_pressure_onset", {"p_ho": ONSETS, "w_ho": (20.0, 60.0, 180.0)}),
        _of("notch_loss", "notch_power", {"w_np": (10.0, 40.0, 160.0), "a_np": (0.7, 1.0, 1.5)}),
        _of("notch_loss", "notch_any_stroke", {"w_na": (10.0, 40.0, 160.0), "a_na": (0.7, 1.0, 1.5)}),
        line("line_pressure_power", {"n_l": FLOWS, "b_l": EACH_WAY}, continuous=("n_l",)),
        # of the flow through each motor it is a port's loss as well, by whatever exponent
        *(_of(cause, "line_each_motor", {"n_le": powers, "b_le": EACH_WAY}, continuous=("n_le",), own_size=True)
          for cause, powers in (("line_pressure_drop", FLOWS), ("port_turbulence", (*FLOWS, 2.6)))),
        # a spring holds a check valve shut: hardly more pressure is lost at a larger flow, and none the other way
        line("line_pressure_power", {"n_l": (0.25,), "b_l": (-1.0, 1.0)}, law_name="cracking pressure one way",
             continuous=("n_l",)),
        line("line_laminar", needs=OIL), line("line_turbulent", {"n_lt": (1.3, 1.75, 2.3)}, needs=OIL),
        *(line(f"line_{side}", {f"n_l{side[0]}": FLOWS}) for side in ("driving", "active", "passive")),
        *(_of("case_pressure", term) for term in ("case_high_port", "case_ports")),
        *_by_load("gear_load_loss", "gear_load", "g"),
        *_by_load("sheave_bending", "sheave", "s", presumes=("gear_load_loss",)),
        _of("sheave_bending", "sheave_stiffness", presumes=COULOMB),
        _of("gear_asymmetry", "gear_asymmetry_power", {"n_ep": POWERS}, blind=friction.no_load),
        _of("gear_asymmetry", "gear_one_way", {"n_gw": (0.5, 2.0), "b_gw": (-1.0, 1.0)}, continuous=("n_gw",),
            blind=friction.one_load),
        # under its tension the rope sinks into the layers below: a torque of the load alone, the same both ways
        _of("layer_radius", "gear_asymmetry_power", {"n_ep": (1.5, 2.0)}, law_name="sinks in with the load",
            needs=("hook_load",), blind=friction.one_load),
        layers("layer_bedding", {"n_lb": (1.5, 2.0)}),
        layers("layer_yielding", {"n_ly": (1.0, 1.5, 2.0), "m_ly": (0.5, 2.0)}),
        _of("gear_asymmetry", "gear_asymmetry", {"b_g": (-1.0, 1.0)}, law_name="one direction alone", continuous=(),
            blind=friction.no_load),
    ]  # fmt: skip


def _by_load(cause: str, stem: str, x: str, **more: Any) -> list[Candidate]:
    """A cause that reads the load alone: a power, a film of it, a contact that closes, an onset."""
    of: Callable[..., Candidate] = partial(_of, cause, blind=friction.no_load, **more)
    points = {f"T_{x}s": ("saturating", friction.SATURATED), f"T_{x}o": ("onset", friction.ONSET)}
    films = of(f"{stem}_film", {f"w_{x}f": (40.0, 100.0, 250.0)}, continuous=())  # of shorter Stribeck's curve speaks
    bent = [of(f"{stem}_{law}", shapes=friction.loads(at, own), continuous=(at,)) for at, (law, own) in points.items()]
    return [of(f"{stem}_power", {f"n_{x}p": POWERS}), films, *bent]


def _of(cause: str, term: str, grid: Grid | None = None, **more: object) -> Candidate:
    member = friction_candidate(term_named(term), grid or {}, **{"law_name": term, "plausible": FAR, **more})
    if cause == "viscosity_temperature":  # the term is a difference and has no sign, but thick oil never drags less
        own = member.shapes
        member = replace(member, shapes=lambda runs: [replace(shape, bounds=(0.0, FAR)) for shape in own(runs)])
    if (possible := POSSIBLE.get(cause)) is not None:
        member = replace(member, possible=possible, shapes=partial(_possible, possible, member.shapes))
    return replace(member, name=cause)


def _possible(possible: Possible, shapes: Shapes, runs: Sequence[PreparedRun]) -> list[Shape]:
    return [shape for shape in shapes(runs) if possible(shape.values, runs)]


# -- free members
class Free(NamedTuple):
    """A curve or surface: the cause, its signals, what multiplies it, where it acts, and what it may look like."""

    cause: str
    signals: tuple[str, ...]
    times: tuple[str, ...] = ()
    scope: Scope = Scope.SYSTEM
    shape: str = "rising"
    anchor: str = "low"
    opposing: bool = True
    needs: tuple[str, ...] = ()
    presumes: tuple[str, ...] = ()
    side: str = "both"
    knots: tuple[float, ...] = LIMITS.free_knots  # quantiles of the signal, where there is one


SPEED, PRESSURE, SWASH, LOAD, FLOW = "speed_magnitude", "pressure", "displacement", "drum_torque", "flow"
LEFT = "displacement_left"  # a test seldom holds many displacements: how a loss falls with it is given, not drawn
CURVES = (
    Free("viscosity_temperature", ("oil_temperature",), (SPEED,), shape="falling", anchor="high", needs=OIL),
    Free("stribeck", (SPEED,), (LOAD,), shape="falling", anchor="high", knots=LIMITS.stribeck_knots),
    *(Free("wear_drift", ("time",), shape=each, presumes=COULOMB) for each in ("rising", "falling", "convex_rising")),
    *(Free("wear_drift", ("time",), (LOAD,), shape=each, presumes=CARRYING) for each in ("rising", "falling")),
    Free("low_displacement_loss", (SWASH,), (PRESSURE,), Scope.MOTOR, "falling", "high"),
    Free("low_displacement_loss", (SWASH,), (), Scope.MOTOR, "falling", "high"),
    Free("low_displacement_loss", (PRESSURE,), (LEFT,), Scope.MOTOR, "convex_rising"),
    Free("high_pressure_mixed", (PRESSURE,), (), Scope.MOTOR, "convex_rising"),
    Free("churning", (SPEED,), shape="convex_rising"),
    Free("port_turbulence", (SPEED,), (SWASH,), Scope.MOTOR, "convex_rising"),
    Free("line_pressure_drop", (FLOW,), (SWASH,), Scope.MOTOR),
    Free("gear_load_loss", (LOAD,)),
    Free("sheave_bending", (LOAD,), scope=Scope.SHAFT, presumes=("gear_load_loss",)),
    Free("case_pressure", ("pressure_sum",), (LEFT,), Scope.MOTOR, "convex_rising", "none"),
    Free("gear_asymmetry", (LOAD,), scope=Scope.SHAFT, opposing=False),
)
ONE_SIDE = ("hoisting", "lowering")
STEADY = ("convex_rising", "rising")  # a length adds to what hangs, ever more or by steps, and takes nothing of it
# more freedom, for what neither a law nor a curve explains: surfaces over two signals, and one way alone
SURFACES = (
    Free("low_displacement_loss", (SWASH, PRESSURE), (), Scope.MOTOR, "falling rising", "high low"),
    Free("low_displacement_loss", (SWASH, SPEED), (PRESSURE,), Scope.MOTOR, "falling rising", "high none"),
    Free("high_pressure_mixed", (PRESSURE, SPEED), (), Scope.MOTOR, "rising falling", "low none"),
    Free("notch_loss", (PRESSURE, SPEED), (SWASH,), Scope.MOTOR, "rising falling", "low high"),
    Free("notch_loss", (PRESSURE, SPEED), (), Scope.MOTOR, "rising falling", "low high"),
    Free("port_turbulence", (SPEED, SWASH), (), Scope.MOTOR, "convex_rising rising", "low low"),
    Free("churning", (SPEED, "oil_temperature"), (), Scope.SYSTEM, "convex_rising falling", "low none", needs=OIL),
    *(Free("line_pressure_drop", (SPEED,), (SWASH,), Scope.MOTOR, "rising", "none", side=each) for each in ONE_SIDE),
    *(Free("stribeck", (SPEED,), (LOAD,), shape="falling", anchor="high", side=each) for each in ONE_SIDE),
    Free("gear_load_loss", (LOAD, SPEED), (), Scope.SYSTEM, "rising falling", "low none"),
    Free("gear_asymmetry", (LOAD, SPEED), (), Scope.SHAFT, "rising", "low none", opposing=False),
    Free("sheave_bending", (LOAD, SPEED), (), Scope.SHAFT, "rising falling", "low none", presumes=("gear_load_loss",)),
    *(Free("tare_load", ("wire_out",), (), Scope.SHAFT, each, opposing=False, needs=HUNG) for each in STEADY),
)


def free_members(runs: Sequence[PreparedRun], model: FrictionModel, rows: Sequence[Free] = CURVES) -> list[Candidate]:
    """Of each family the curves that the data draw, bent at quantiles of what these runs have covered."""
    found = [_free(row, runs) for row in rows]
    return [own for own in found if own is not None and own.term is not None and own.term.name not in model.term_names]


def _free(row: Free, runs: Sequence[PreparedRun], fine: bool = False) -> Candidate | None:
    curve, shares = len(row.signals) == 1, _shares(row, fine)
    knots = [_knots(_covered(signal, runs), shares) for signal in row.signals]
    if any(len(at) < 3 or np.ptp(at) <= _resolved(name, runs) for name, at in zip(row.signals, knots, strict=True)):
        return None
    size = np.prod([max(float(np.median(np.abs(_covered(each, runs)))), 1e-12) for each in row.times])
    torque = max(float(np.median([np.median(np.abs(run.drum_torque)) / run.gear_ratio for run in runs])), 1.0)
    count = max(float(np.median([sum(g.count for g in run.groups) or 1 for run in runs])), 1.0)
    term = tabulated(_table(row, knots, 0.05 * torque / float(size) / (1.0 if row.scope is Scope.SHAFT else count)))
    return Candidate(
        row.cause, "", term.parameters, partial(term_columns, term), term=term, needs=row.needs,
        hydraulic=row.scope is Scope.MOTOR, presumes=row.presumes, law_name=term.name, free=True, own_size=True,
        plausible=FAR, finer=(lambda _: _free(row, runs, True)) if curve and not fine else None,
    )  # fmt: skip


def _table(row: Free, knots: Sequence[FloatArray], typical: float) -> Table:
    drawn = "curve" if len(knots) == 1 else "surface"
    return Table(
        name_of(row), tuple((s, tuple(float(k) for k in at)) for s, at in zip(row.signals, knots, strict=True)),
        _unit(row.times), row.times, row.scope, row.opposing, row.shape, row.anchor, typical,
        place="motor" if row.scope is Scope.MOTOR else "gear and drum", side=row.side,
        source=f"a monotone {drawn} over {' and '.join(row.signals)} through the data",
    )  # fmt: skip


def _shares(row: Free, fine: bool = False) -> tuple[float, ...]:
    own = row.knots if len(row.signals) == 1 else LIMITS.surface_knots
    between = (0.5 * (a + b) for a, b in itertools.pairwise(own))  # one more in the middle of every two
    return tuple(sorted([*own, *between])) if fine else own


def outlines() -> Iterator[Term]:
    """The curves and surfaces as they are compiled, wherever data bend them."""
    for row in (*CURVES, *SURFACES):
        knots = np.arange(float(len(_shares(row))))
        yield outlined(_table(row, [knots] * len(row.signals), 1.0))[0]


def name_of(row: Free) -> str:
    """Of its term and its law; every row's is its own, for by it a slot is found again."""
    parts = [f"free_{row.cause}", *row.times[:1]]
    parts += row.signals if len(row.signals) > 1 else ()
    parts += [row.side] if row.side != "both" else []
    worn, hung = (row.cause == cause for cause in ("wear_drift", "tare_load"))
    bent = {"falling": worn or not row.times, "convex_rising": worn, "rising": hung}
    return "_".join([*parts, row.shape.partition("_")[0]] if bent.get(row.shape) else parts)


def shapes_over(cause: str, signal: str) -> set[str]:
    """What a cause's curves may look like over a signal: rising, falling, convex_rising; empty where it has none."""
    return {
        shape
        for row in (*CURVES, *SURFACES)
        for name, shape in zip(row.signals, row.shape.split() * len(row.signals), strict=False)
        if (row.cause, name) == (cause, signal)
    }


def bending(table: Table) -> FloatArray | None:
    """Quadratic form of a curve's coefficients that grows with every change of its slope, shape (intervals,
    intervals); None for what is no curve of one signal. Fitted freely it would go anywhere where no run has been.
    """
    if len(table.knots) != 1 or table.shape == "windows":
        return None
    axis = table.axes[0]
    widths = np.diff(axis.knots) / (axis.knots[-1] - axis.knots[0])
    if axis.shape == "convex_rising":  # one hinge per knot: every one after the first is a change of slope
        change = np.diag(1.0 / np.cumsum(widths[::-1])[::-1])[1:]
    else:
        change = np.diff(np.diag(1.0 / widths), axis=0)
    change *= float(np.mean(widths))
    return np.asarray(change.T @ change)


def _knots(values: FloatArray, shares: Sequence[float]) -> FloatArray:
    """Quantiles of what was covered, to nine digits for a readable file; the outermost, and none too near another."""
    at = np.unique([float(f"{k:.9g}") for k in np.quantile(values, shares)]) if len(values) else values
    kept = list(at[:1])
    for knot in at[1:-1]:
        kept += [knot] if min(knot - kept[-1], at[-1] - knot) >= LIMITS.knots_apart * np.ptp(at) else []
    return np.array([*kept, *at[1:][-1:]])


def _resolved(signal: str, runs: Sequence[PreparedRun]) -> float:
    """What its sensor tells apart of a signal, in its unit: by less, runs differ in that sensor alone."""
    own = SWASH if signal == LEFT else signal  # what is left of a full stroke is as uncertain as the stroke
    return RESOLVED.get(signal, LIMITS.resolved * float(np.abs(_covered(own, runs)).max(initial=0.0)))


def _unit(times: tuple[str, ...]) -> str:
    of_stroke = times in ((SWASH,), (LEFT,))  # which makes a torque of a pressure
    return "Pa" if of_stroke else quotient_unit("N*m", *((FACTORS[name][1], 1.0) for name in times))


def _covered(signal: str, runs: Sequence[PreparedRun]) -> FloatArray:
    """What the moving samples of all runs have seen of a signal; empty where no run has it."""
    return np.concatenate([np.array([]), *(_values(signal, run)[run.used] for run in runs if run.used.any())])


def _values(signal: str, run: PreparedRun) -> FloatArray:
    if signal in (PRESSURE, SWASH, LEFT, FLOW, "pressure_sum"):
        own = [np.abs(_of_group(signal, g, run)) for g in run.groups]
        return np.mean(own, axis=0) if own else np.zeros(len(run.time))
    own = run.point[[each.name for each in WINCH_SIGNALS].index(signal)]
    return np.broadcast_to(np.asarray(own, float), run.time.shape)


def _of_group(signal: str, group: GroupSignals, run: PreparedRun) -> FloatArray:
    if signal == LEFT:
        return dict(run.constants).get("max_displacement", 0.0) - group.displacement
    if signal == FLOW:
        return group.count * group.displacement * run.speed
    return np.asarray(getattr(group, signal))
