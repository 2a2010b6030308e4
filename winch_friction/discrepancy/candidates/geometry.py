"""Candidates in the geometry, the load and the inertia: what hangs, on which radius, and what has to be accelerated."""

from collections.abc import Sequence
from dataclasses import replace

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
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import Parameter

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


def inertia_columns(run: PreparedRun, _: Values) -> FloatArray:
    """The shaft's acceleration."""
    return run.acceleration[:, None]


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
            corrects=_to_inertia,
        ),
    ]
