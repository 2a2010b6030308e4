"""The repaired model: the base refitted within its prior, with the effects found as terms and the signals' errors
noted."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from winch_friction.discrepancy.answer import ParameterEstimate
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.detectors.reversals import ReversalFinding
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.expansion import Expansion
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import unique_parameters


@dataclass(frozen=True)
class Repair:
    """The repaired model, and per effect its parameters."""

    model: FrictionModel
    parameters: dict[str, dict[str, ParameterEstimate]]


def repair(
    seed: FrictionModel, expansion: Expansion, cross: CrossFit, explanation: Explanation, provenance: Mapping[str, Any]
) -> Repair:
    """Values and covariance of an explanation as a model file's content."""
    problem = cross.problem
    columns = problem.columns(explanation.slots)
    scale = problem.layout.scales[list(columns)]
    value = explanation.beta * scale
    covariance = cross.covariance(explanation) * np.outer(scale, scale)
    count = problem.base.parameters
    at = dict(zip(expansion.model.parameter_names, np.array(expansion.model.values) + value[:count], strict=True))
    std = dict(zip(expansion.model.parameter_names, np.sqrt(np.diag(covariance)[:count]), strict=True))
    keep = list(range(count))
    names = list(seed.parameter_names)
    terms, corrections, parameters = list(seed.terms), {}, {}
    for slot in explanation.slots:
        candidate, shape = slot.origin
        where = [columns.index(c) for c in slot.columns]
        own = _estimates(slot, value[where], np.sqrt(np.diag(covariance)[where]))
        unused = [p.name for p, c in zip(candidate.linear, slot.columns, strict=True) if cross.total_g[c, c] <= 0.0]
        own = {name: each for name, each in own.items() if candidate.term is not None or name not in unused}
        parameters[slot.name] = own
        term = candidate.term
        if term is None:
            corrections[slot.name] = {n: e.value for n, e in own.items()} | {"which": slot.label}
        elif term.name in seed.term_names:
            _merge(candidate, at, std, own)
        else:
            terms.append(term)
            at.update({name: each.value for name, each in own.items()})
            std.update({name: each.std for name, each in own.items()})
            for name, k in zip((p.name for p in candidate.linear), where, strict=True):
                names.append(name)
                keep.append(k)
    model = _assembled(seed, tuple(terms), at, std, names, covariance[np.ix_(keep, keep)])
    notes = {**seed.provenance, **provenance}
    if corrections:
        notes["measurement_corrections"] = corrections
    return Repair(FrictionModel(**{**_fields(model), "provenance": notes}), parameters)


def with_reversal_effect(
    model: FrictionModel, finding: ReversalFinding
) -> tuple[FrictionModel, dict[str, ParameterEstimate]]:
    """The model with an effect that shows only after reversals; its amplitudes are independent of the other
    parameters."""
    term = finding.slot.origin[0].term
    problem = finding.cross.problem
    columns = problem.columns(finding.fitted.slots)
    where = [columns.index(c) for c in finding.slot.columns]
    scale = problem.layout.scales[list(finding.slot.columns)]
    std = np.sqrt(np.diag(finding.cross.covariance(finding.fitted)))[where] * scale
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


def _estimates(slot: Slot, value: FloatArray, std: FloatArray) -> dict[str, ParameterEstimate]:
    candidate, shape = slot.origin
    found = {
        p.name: ParameterEstimate(float(v), float(s), p.unit)
        for p, v, s in zip(candidate.linear, value, std, strict=True)
    }
    if candidate.term is not None:
        units = {p.name: p.unit for p in candidate.term.parameters}
        for name, at in shape.values.items():
            found[name] = ParameterEstimate(float(at), LIMITS.shape_std * abs(float(at)), units[name])
    return found


def _merge(
    candidate: Candidate, at: dict[str, float], std: dict[str, float], own: Mapping[str, ParameterEstimate]
) -> None:
    """An effect whose term the model has already changes that term; a curve of another shape is melted in."""
    values = {name: each.value for name, each in own.items()}
    assert candidate.term is not None
    names = [p.name for p in candidate.term.parameters]
    at.update(candidate.merge(at, values) if candidate.merge else {name: at[name] + values[name] for name in names})
    for name in names:
        std[name] = float(np.hypot(std[name], own[name].std))


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
