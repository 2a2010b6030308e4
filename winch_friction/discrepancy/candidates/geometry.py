"""Candidates in the geometry, the load and the inertia: what hangs, on which radius, and what has to be accelerated."""

from collections.abc import Sequence

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
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter
from winch_friction.physics.units import GRAVITY

ONE_DEPTH = -999.0  # a label among the layer numbers
ONE_METRE = 1.0  # then e_R is the depth in m

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
    # the radius acts twice on the load's inertia: on its lever and on its acceleration
    inertia = 0.0 if run.tension_measured else run.load * (run.radius / run.gear_ratio) ** 2
    turning = inertia * run.acceleration
    torque = hanging(run, run.load) + turning
    layer = run.channels.get("wire_layer")
    if values["layer"] == 0.0 or layer is None:
        return torque[:, None]
    if values["layer"] == ONE_DEPTH:
        return (torque * ONE_METRE / run.radius)[:, None]
    if values["layer"] < 0.0:
        return (torque * (-values["layer"] - layer))[:, None]
    return (torque * (np.rint(layer) == values["layer"]))[:, None]


def _radius_shapes(runs: Sequence[PreparedRun]) -> list[Shape]:
    layers = sorted(
        {
            float(v)
            for run in runs
            if "wire_layer" in run.channels
            for v in np.unique(np.rint(run.channels["wire_layer"]))
        }
    )
    shapes = [Shape("all layers", {"layer": 0.0})]
    if len(layers) > 1:
        shapes += [Shape(f"layer {layer:g}", {"layer": layer}) for layer in layers]
        shapes.append(Shape("the same depth on all layers", {"layer": ONE_DEPTH}))
        shapes.append(Shape("growing with depth", {"layer": -layers[-1]}))
    return shapes


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
