"""Candidates that are declared friction terms: their regressors are the term's own derivatives by its parameters."""

import itertools
from collections.abc import Sequence
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Shape, Variant
from winch_friction.discrepancy.candidates.linear_state import state_history
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.compiled import broadcast_columns, compiled
from winch_friction.physics.friction.term import Parameter, Term
from winch_friction.physics.signals import FloatArray

# shape parameters are profiled over these values; what is not named takes the typical value times 0.5, 1, 2
SHAPES: dict[str, tuple[float, ...]] = {
    "n_t": (1.5, 2.0, 2.5),
    "n_ch": (1.9,),
    "b_g": (0.0,),
    "d_z": (0.009, 0.02, 0.04, 0.09),
    "g_dw": (0.4,),
    "d_dw": (0.5, 1.0, 2.0, 5.0),
}
STRIBECK_SHARES = (0.05, 0.075, 0.11, 0.17)  # of the largest speed
SHIPPED = (
    "viscosity_temperature", "stribeck", "dwell_stiction", "gear_asymmetry", "gear_load_loss", "sheave_bending",
    "wear_drift",
    "low_displacement_loss", "port_turbulence", "notch_loss", "churning", "high_pressure_mixed", "line_pressure_drop",
    "case_pressure", "brake_drag", "coulomb", "viscous", "torque_offset", "direction_asymmetry",
)  # fmt: skip
TURNING = ("presliding",)
NEEDS = {"viscosity_temperature": ("oil_temperature",)}
COULOMB = ("coulomb", "motor_coulomb")
PRESUMES = {"brake_drag": COULOMB, "sheave_bending": ("gear_load_loss",), "wear_drift": COULOMB}
# marginality: the slope of what depends on direction is never taken without its intercept
BRINGS = {"direction_asymmetry": ("torque_offset",)}


def shipped_friction() -> list[Candidate]:
    """The catalogue's friction effects and the base terms."""
    return [friction_candidate(term_named(name)) for name in (*SHIPPED, *TURNING)]


def friction_candidate(term: Term) -> Candidate:
    """A candidate from a declared term, a user's own included."""
    linear = tuple(p for p in term.parameters if not p.shape)
    return Candidate(
        name=term.name,
        law=term.latex,
        linear=linear,
        columns=partial(term_columns, term),
        shapes=partial(_shapes, term),
        needs=NEEDS.get(term.name, ()),
        presumes=PRESUMES.get(term.name, ()),
        term=term,
        regime="turning" if term.name in TURNING else "moving",
        brings=BRINGS.get(term.name, ()),
        continuous=_continuous(term),
        hydraulic=any(name in term.reads for name in ("pressure", "pressure_sum", "displacement")),
    )


def _continuous(term: Term) -> tuple[str, ...]:
    """Positive shape parameters of which several values are tried."""
    if term.name == "wear_drift":
        return ()
    positive = (p for p in term.parameters if p.shape and p.lower > 0.0)
    return tuple(p.name for p in positive if len(SHAPES.get(p.name, STRIBECK_SHARES)) > 1)


def _shapes(term: Term, runs: Sequence[PreparedRun]) -> list[Variant]:
    if term.name == "wear_drift":
        return _observed_time(runs)
    shape = [p for p in term.parameters if p.shape]
    values = [_shape_values(p, runs) for p in shape]
    return [
        Variant(", ".join(f"{p.name} = {v:g}" for p, v in zip(shape, point, strict=True)),
                dict(zip((p.name for p in shape), point, strict=True)))
        for point in itertools.product(*values)
    ]  # fmt: skip


def _shape_values(parameter: Parameter, runs: Sequence[PreparedRun]) -> tuple[float, ...]:
    """The values over which a shape parameter is profiled."""
    if parameter.name == "C4":
        top = max(float(np.percentile(np.abs(run.speed), 99)) for run in runs)
        return tuple(top * share for share in STRIBECK_SHARES)
    usual = (parameter.typical * factor for factor in (0.5, 1.0, 2.0))
    return SHAPES.get(parameter.name, tuple(v for v in usual if parameter.lower <= v <= parameter.upper))


def _observed_time(runs: Sequence[PreparedRun]) -> list[Variant]:
    begin, end = min(run.start for run in runs), max(run.start + run.time[-1] for run in runs)
    span = max(end - begin, 1.0)
    return [
        Variant("since the first run", {"t_w": begin, "tau_w": span}),
        Variant("around the middle of the dates", {"t_w": begin + 0.5 * span, "tau_w": span}),
        Variant("since well before the first run", {"t_w": begin - 0.5 * span, "tau_w": span}),
        Variant("since long before the first run", {"t_w": begin - span, "tau_w": span}),
    ]


def term_columns(term: Term, run: PreparedRun, shape: Shape) -> FloatArray:
    """Torque at the shaft per unit of each linear parameter, N m, shape (samples, parameters)."""
    functions = compiled((term,), len(run.groups), run.constants)
    theta = tuple(shape.get(p.name, 1.0) for p in functions.parameters)
    z = state_history(functions, run.point, theta, run.dt)
    with np.errstate(all="ignore"):
        parts = functions.vector_gradient(run.point, theta, z)
    keep = [k for k, p in enumerate(functions.parameters) if not p.shape]
    return np.nan_to_num(broadcast_columns([parts[k] for k in keep], len(run.time)))
