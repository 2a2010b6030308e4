"""The repaired model: the base refitted within its prior, with the effects found as terms and the signals' errors
noted."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import least_squares

from winch_friction.discrepancy.blocks import Slot
from winch_friction.discrepancy.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.linearise import Expansion
from winch_friction.discrepancy.problem import PRIOR_WEIGHT
from winch_friction.discrepancy.turning import TurningFinding
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import unique_parameters
from winch_friction.physics.signals import FloatArray

SHAPE_STD = 0.1  # relative; a shape was chosen from a few values


@dataclass(frozen=True)
class Estimate:
    """A parameter of an effect with its standard deviation, SI."""

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class Repair:
    """The repaired model, and per effect its parameters."""

    model: FrictionModel
    parameters: dict[str, dict[str, Estimate]]


def covariance_of(cross: CrossFit, explanation: Explanation) -> FloatArray:
    """Covariance of the coefficients: data, thinned for correlated noise, and prior; bounds are not taken into
    account."""
    columns = np.asarray(cross.problem.columns(explanation.slots))
    base = len(cross.problem.base.names)
    h = cross.total_g[np.ix_(columns, columns)] / PRIOR_WEIGHT
    h[np.arange(base), np.arange(base)] += 1.0
    h[np.arange(len(columns)), np.arange(len(columns))] += 1e-9 * (1.0 + np.diag(h))
    return np.asarray(np.linalg.inv(h))


def repair(
    seed: FrictionModel, expansion: Expansion, cross: CrossFit, explanation: Explanation, provenance: Mapping[str, Any]
) -> Repair:
    """Values and covariance of an explanation as a model file's content."""
    problem = cross.problem
    columns = problem.columns(explanation.slots)
    scale = problem.scales[list(columns)]
    value = explanation.beta * scale
    covariance = covariance_of(cross, explanation) * np.outer(scale, scale)
    count = problem.base.parameters
    at = dict(zip(expansion.model.parameter_names, np.array(expansion.model.values) + value[:count], strict=True))
    std = dict(zip(expansion.model.parameter_names, np.sqrt(np.diag(covariance)[:count]), strict=True))
    keep = list(range(count))
    names = list(seed.parameter_names)
    terms, corrections, parameters = list(seed.terms), {}, {}
    for slot in explanation.slots:
        where = [columns.index(c) for c in slot.columns]
        own = _estimates(slot, value[where], np.sqrt(np.diag(covariance)[where]))
        unused = [
            p.name for p, c in zip(slot.candidate.linear, slot.columns, strict=True) if cross.total_g[c, c] <= 0.0
        ]
        own = {name: each for name, each in own.items() if slot.candidate.term is not None or name not in unused}
        parameters[slot.candidate.name] = own
        term = slot.candidate.term
        if term is None:
            corrections[slot.candidate.name] = {n: e.value for n, e in own.items()} | {"which": slot.variant.label}
        elif term.name in seed.term_names:
            _merge(at, std, own, [p.name for p in term.parameters])
        else:
            terms.append(term)
            at.update({name: each.value for name, each in own.items()})
            std.update({name: each.std for name, each in own.items()})
            for name, k in zip((p.name for p in slot.candidate.linear), where, strict=True):
                names.append(name)
                keep.append(k)
    model = _assembled(seed, tuple(terms), at, std, names, covariance[np.ix_(keep, keep)])
    notes = {**seed.provenance, **provenance}
    if corrections:
        notes["measurement_corrections"] = corrections
    return Repair(FrictionModel(**{**_fields(model), "provenance": notes}), parameters)


def with_turning(model: FrictionModel, finding: TurningFinding) -> tuple[FrictionModel, dict[str, Estimate]]:
    """The model with an effect that shows only after reversals; its amplitudes are independent of the other
    parameters."""
    term = finding.slot.candidate.term
    problem = finding.cross.problem
    columns = problem.columns(finding.fitted.slots)
    where = [columns.index(c) for c in finding.slot.columns]
    scale = problem.scales[list(finding.slot.columns)]
    std = np.sqrt(np.diag(covariance_of(finding.cross, finding.fitted)))[where] * scale
    own = _estimates(finding.slot, finding.fitted.beta[where] * scale, std)
    if term is None or term.name in model.term_names:
        return model, own
    old = model.covariance if model.covariance is not None else np.diag(np.full(len(model.values), 1e-12))
    added = [own[p.name] for p in term.parameters]
    covariance = block_diag(old, np.diag([max(each.std, 1e-12) ** 2 for each in added]))
    values = (*model.values, *(float(np.clip(own[p.name].value, p.lower, p.upper)) for p in term.parameters))
    fields = _fields(model) | {"terms": (*model.terms, term), "values": values, "covariance": covariance}
    return FrictionModel(**fields), own


def _fields(model: FrictionModel) -> dict[str, Any]:
    return {name: getattr(model, name) for name in FrictionModel.__dataclass_fields__}


def _estimates(slot: Slot, value: FloatArray, std: FloatArray) -> dict[str, Estimate]:
    found = {
        p.name: Estimate(float(v), float(s), p.unit) for p, v, s in zip(slot.candidate.linear, value, std, strict=True)
    }
    if slot.candidate.term is not None:
        units = {p.name: p.unit for p in slot.candidate.term.parameters}
        for name, shape in slot.variant.shape.items():
            found[name] = Estimate(float(shape), SHAPE_STD * abs(float(shape)), units[name])
    return found


def _merge(at: dict[str, float], std: dict[str, float], own: Mapping[str, Estimate], names: list[str]) -> None:
    """An effect whose term the model has already changes that term; a Stribeck curve of another width is melted in."""
    if "C4" in own:
        at.update(_one_stribeck(at, own))
    else:
        for name in names:
            at[name] += own[name].value
    for name in names:
        std[name] = float(np.hypot(std[name], own[name].std))


def _one_stribeck(at: Mapping[str, float], own: Mapping[str, Estimate]) -> dict[str, float]:
    """The one exponential nearest to the sum of two over speed (rad/s), for the two load coefficients."""
    speed = np.linspace(0.5, 4.0 * max(at["C4"], own["C4"].value), 60)
    first, second = np.exp(-speed / at["C4"]), np.exp(-speed / own["C4"].value)
    load = [at["C1"] * first + own["C1"].value * second, at["C3"] * first + own["C3"].value * second]
    typical = 4e5  # N m of drum torque, to weigh the two coefficients

    def misfit(q: FloatArray) -> FloatArray:
        shape = np.exp(-speed / q[2])
        return np.concatenate([(q[0] * shape - load[0]) * typical, q[1] * shape - load[1]])

    start = [at["C1"] + own["C1"].value, at["C3"] + own["C3"].value, 0.5 * (at["C4"] + own["C4"].value)]
    best = least_squares(misfit, start, x_scale=[1e-5, 1.0, 10.0]).x
    return {"C1": float(max(best[0], 0.0)), "C3": float(max(best[1], 0.0)), "C4": float(best[2])}


def _assembled(seed, terms, at, std, names, known) -> FrictionModel:  # type: ignore[no-untyped-def]
    declared = unique_parameters(terms)
    bounds, values, deviations = {}, [], []
    for p in declared:
        lower, upper = seed.bounds_of(p.name) if p.name in seed.parameter_names else (p.lower, p.upper)
        value = float(np.clip(at[p.name], lower, upper))
        values.append(value)
        deviations.append(max(std[p.name], 1e-12 * abs(p.typical)))
        if p.name in seed.bounds:
            bounds[p.name] = seed.bounds[p.name]
    scale = np.sqrt(np.maximum(np.diag(known), 1e-300))
    correlation = np.eye(len(declared))
    index = [[p.name for p in declared].index(name) for name in names]
    correlation[np.ix_(index, index)] = known / np.outer(scale, scale)
    np.fill_diagonal(correlation, 1.0)
    covariance = correlation * np.outer(deviations, deviations)
    return FrictionModel(f"{seed.name}_repaired", terms, tuple(values), covariance, bounds, seed.constants, {})
