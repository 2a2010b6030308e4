"""Candidates in the geometry, the load and the inertia: what hangs, on which radius, and what has to be accelerated.

And in the calculated pressure of an accumulator: a gas that warms, cools, or follows another exponent.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    Candidate,
    Estimates,
    Shape,
    Sides,
    Values,
    correction,
    single_shape,
)
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.preparation.balance import SPARSEST
from winch_friction.discrepancy.preparation.grid import lagged
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.seen import GroupSignals
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter

GAS = "accumulator_thermal"
ONE_DEPTH, THICKER = -999.0, -998.0  # labels among the layer numbers
ONE_METRE, TENTH = 1.0, 0.1  # then e_R is the depth in m, or what a layer rises more than stated, in tenths of a metre
FEWEST_APART = 2  # layers

m_h = Parameter("m_h", "kg", 2000.0, lower=-2e4, upper=2e4, doc="mass that the load signal does not contain")
mu_w = Parameter("mu_w", "kg/m", 12.0, lower=0.0, upper=200.0, doc="wire weight that the load signal does not contain")
e_R = Parameter("e_R", "1", 0.06, lower=-0.5, upper=0.5, doc="relative error of the rope radius")
dJ = Parameter("dJ", "kg*m^2", 0.2, lower=-5.0, upper=10.0, doc="missing inertia at the motor shaft")


def hanging(run: PreparedRun, mass: FloatArray | float) -> FloatArray:
    """Torque at the motor shaft of a hanging mass with its inertia and the friction it causes, N m."""
    share = np.divide(mass, run.load, out=np.zeros(len(run.time)), where=run.load > 0.0)
    return mass * run.radius / run.gear_ratio * (GRAVITY + run.load_acceleration) + share * run.load_friction


def tare_columns(run: PreparedRun, values: Values) -> FloatArray:
    """A constant mass, the wire paid out, or both."""
    hook = hanging(run, 1.0) * values["hook"]
    length = run.channels["wire_out"] if "wire_out" in run.channels else np.zeros(len(run.time))
    return np.column_stack([hook, hanging(run, length) * values["wire"]])


def _tare_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    shapes = [Shape("hook", {"hook": 1.0, "wire": 0.0})]
    if any("wire_out" in run.channels for run in runs):
        shapes += [Shape("wire", {"hook": 0.0, "wire": 1.0}), Shape("hook and wire", {"hook": 1.0, "wire": 1.0})]
    return shapes


def radius_columns(run: PreparedRun, values: Values) -> FloatArray:
    """The load's torque on the layers concerned."""
    torque, layer = _on_radius(run), run.channels.get("wire_layer")
    if values["layer"] == 0.0 or layer is None:
        return torque[:, None]
    if values["layer"] in (ONE_DEPTH, THICKER):
        rises = ONE_METRE if values["layer"] == ONE_DEPTH else TENTH * (np.rint(layer) - 1.0)
        return (torque * rises / run.radius)[:, None]
    if values["layer"] < 0.0:
        return (torque * (-values["layer"] - layer))[:, None]
    return (torque * (np.rint(layer) == values["layer"]))[:, None]


def _on_radius(run: PreparedRun) -> FloatArray:
    """Torque at the motor shaft per relative change of the rope's radius, N m."""
    # the radius acts twice on the load's inertia: on its lever and on its acceleration
    inertia = 0.0 if run.tension_measured else run.load * (run.radius / run.gear_ratio) ** 2
    return hanging(run, run.load) + inertia * run.acceleration


def _layers(runs: Sequence[PreparedRun]) -> list[float]:
    logged = [np.rint(run.channels["wire_layer"]) for run in runs if "wire_layer" in run.channels]
    return sorted({float(layer) for own in logged for layer in np.unique(own)})


def _radius_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    layers = _layers(runs)
    shapes = [Shape("all layers", {"layer": 0.0})]
    if len(layers) > 1:
        shapes += [Shape(f"layer {layer:g}", {"layer": layer}) for layer in layers]
        shapes.append(Shape("the same depth on all layers", {"layer": ONE_DEPTH}))
        shapes.append(Shape("the rope's thickness", {"layer": THICKER}))
        shapes.append(Shape("growing with depth", {"layer": -layers[-1]}))
    return shapes


def layers_apart(runs: Sequence[PreparedRun]) -> list[Candidate]:
    """Every layer with an error of its own, as a rope that was wound anew or is crushed unevenly has.

    Only over layers that a run has; of a single one that of all layers says as much.
    """
    layers = _layers(runs)
    if len(layers) < FEWEST_APART:
        return []
    own = {layer: replace(e_R, name=f"e_R{layer:g}", doc=f"{e_R.doc} on layer {layer:g}") for layer in layers}

    def columns(run: PreparedRun, _: Values) -> FloatArray:
        layer = np.rint(run.channels["wire_layer"])
        return _on_radius(run)[:, None] * (layer[:, None] == np.array(layers))

    def corrects(found: Estimates, _: Shape, sides: Sides) -> list[Correction]:
        radii = dict(enumerate(sides.crane.drum.layer_radii, start=1))
        # a layer that only locked runs are on is known to nothing
        known = {int(k): found[p.name] for k, p in own.items() if p.name in found}
        return [correction("layer_radius", each, radii[k], layers=(k,)) for k, each in known.items()]

    return [
        Candidate(
            "layer_radius", r"\sum_k e_{Rk}\,m\,(g+\ddot x)\,R_k/i", tuple(own.values()), columns, single_shape,
            kind="geometry", needs=("hook_load", "wire_layer"), varies_with=("drum_torque", "wire_layer"),
            corrects=corrects, law_name="each layer by itself", free=True,
        )
    ]  # fmt: skip


TOKEN_INERTIA = 0.02  # of the gap; below it a crane file's inertia stands for one that nobody knows


def inertia_columns(run: PreparedRun, _: Values) -> FloatArray:
    """The shaft's acceleration."""
    return run.acceleration[:, None]


def _too_slow(runs: Sequence[PreparedRun]) -> tuple[str, str] | None:
    if max(run.dt for run in runs) <= SPARSEST or all(_hardly_any_inertia(run) for run in runs):
        return None
    return "a faster log", "a speed that is logged so seldom does not give its acceleration; log at 20 Hz or more"


def _hardly_any_inertia(run: PreparedRun) -> bool:
    """Whether next to nothing is accounted for as inertia: nothing that a poor acceleration could smear."""
    if not run.used.any():
        return False
    known = run.inertia * run.acceleration + run.load * run.radius / run.gear_ratio * run.load_acceleration
    return float(np.std(known[run.used])) <= TOKEN_INERTIA * float(np.std(run.gap[run.used]))


def _to_mass(found: Estimates, shape: Shape, _: Sides) -> list[Correction]:
    masses = [correction("tare_load", found["m_h"])] if shape.values["hook"] else []
    return masses + ([correction("wire_weight", found["mu_w"])] if shape.values["wire"] else [])


def _to_radius(found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    """What the crane file's radius lacks, layer by layer."""
    radii = dict(enumerate(sides.crane.drum.layer_radii, start=1))
    kind = shape.values["layer"]
    if kind == ONE_DEPTH:
        return [correction("layer_radius", found["e_R"])]
    if kind == THICKER:  # or its lay on the drum: the innermost layer lies on the drum itself
        return [correction("layer_radius", found["e_R"], TENTH * (k - 1.0), layers=(k,)) for k in radii if k > 1]
    if kind > 0.0:
        radii = {int(kind): radii[int(kind)]}
    depth = {k: -kind - k if kind < 0.0 else 1.0 for k in radii}
    return [correction("layer_radius", found["e_R"], depth[k] * r, layers=(k,)) for k, r in radii.items() if depth[k]]


def _to_inertia(found: Estimates, _: Shape, __: Sides) -> list[Correction]:
    return [correction("inertia", found["dJ"])]


def geometry_candidates() -> list[Candidate]:
    """Tare, rope radius, inertia."""
    return [
        Candidate(
            "tare_load",
            r"(m_h+\mu_w L)\,(g+\ddot x)\,R/i",
            (m_h, mu_w),
            tare_columns,
            _tare_shapes,
            kind="load",
            needs=("hook_load",),
            varies_with=("wire_out",),
            corrects=_to_mass,
        ),
        Candidate(
            "layer_radius",
            r"e_R\,m\,(g+\ddot x)\,R/i",
            (e_R,),
            radius_columns,
            _radius_shapes,
            kind="geometry",
            needs=("hook_load",),
            varies_with=("drum_torque", "wire_layer"),
            plain=True,
            corrects=_to_radius,
        ),
        Candidate(
            "inertia_error",
            r"\Delta J\,\dot\omega",
            (dJ,),
            inertia_columns,
            single_shape,
            kind="inertia",
            plain=True,
            blind=_too_slow,
            corrects=_to_inertia,
        ),
    ]


# -- the gas of an accumulator
TIME_CONSTANTS = (30.0, 60.0, 120.0, 240.0)  # s, of an accumulator's gas
SLOWER = 5.0  # times the fast time constant: further apart than that the fast one is over before the slow one shows
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
