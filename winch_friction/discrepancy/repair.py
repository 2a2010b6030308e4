"""The repaired model as a file: effects that are terms become terms, what a signal, the geometry, the load or the
inertia has wrong becomes a correction, and all of it is fitted once more as the file will be read.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    CUT,
    Candidate,
    Estimates,
    ParameterEstimate,
    Sides,
    driving_alone,
)
from winch_friction.discrepancy.detectors.ripple import TERM, Ripple
from winch_friction.discrepancy.detectors.ripple_waves import in_phase
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.estimates import InFile, agreed, estimates_of, in_file, of_part, together
from winch_friction.discrepancy.expansion import Given, meet, meet_again, misfit, with_room
from winch_friction.discrepancy.regressors import base_of, build_problem, correction_std, key_of, layout_of
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel, Term, term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.term import unique_parameters
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane

UNTOLD = 0.99  # of the deviation that a parameter was freed to: with so much of it left the fit has told nothing
REPAIRED, REFITTED = "_repaired", "_refitted"  # behind the name of the given model


@dataclass(frozen=True)
class Repair:
    """The repaired model, the parameters of each effect, what was cut at a bound, which corrections say an effect's."""

    model: FrictionModel
    parameters: dict[str, dict[str, ParameterEstimate]]
    cut: tuple[str, ...] = ()
    said: dict[str, dict[str, InFile | None]] = field(default_factory=dict)


@dataclass
class _Draft:
    """A model in the making: parameters by name with their standard deviations, terms and corrections."""

    terms: list[Term]
    at: dict[str, float]
    std: dict[str, float]
    corrections: list[Correction]
    room: dict[str, tuple[float, float]]  # bounds beyond the usual: of a bare model's lack, and of another machine

    def add_term(self, candidate: Candidate | None, term: Term, own: Estimates) -> None:
        """A new term, or a change of one that the model has; a curve of another shape is melted in."""
        values = {name: each.value for name, each in own.items()}
        if term.name not in [each.name for each in self.terms]:
            self.terms.append(term)
            self.at.update(values)
            self.std.update({name: each.std for name, each in own.items()})
            return
        names = [p.name for p in term.parameters if candidate is None or candidate.merge or not p.shape]
        merge = candidate.merge if candidate else None
        self.at.update(merge(self.at, values) if merge else {name: self.at[name] + values[name] for name in names})
        for name in names:
            self.std[name] = float(np.hypot(self.std[name], own[name].std))

    def add_correction(self, new: Correction) -> None:
        """A new correction, or a change of one that the model has."""
        for k, old in enumerate(self.corrections):
            if key_of(old) == key_of(new):
                self.corrections[k] = _changed(old, old.value + new.value, new.std)
                return
        self.corrections.append(new)


def _changed(correction: Correction, value: float, std: float | None) -> Correction:
    lower, upper = correction.bounds
    inside = min(max(value, lower), upper)
    source = correction.source.partition(f", {CUT}")[0]
    if inside != value:
        source += f", {CUT} {value:g} {correction.declared.parameter.unit}"
    return replace(correction, value=inside, std=std, source=source)


def draft(search: Search, explanation: Explanation, provenance: Mapping[str, Any]) -> Repair:
    """The values of an explanation, and of what was found beside the moving samples, as a model."""
    seed, cross = search.given.model, search.cross
    columns = cross.problem.columns(explanation.slots)
    scale = cross.problem.layout.scales[list(columns)]
    value = explanation.beta * scale
    covariance = cross.covariance(explanation) * np.outer(scale, scale)
    std = np.sqrt(np.diag(covariance))
    base = cross.problem.base
    count = base.parameters
    names = search.expansion.model.parameter_names
    place = np.array(search.expansion.model.values) + value[:count]
    own = _Draft(
        list(seed.terms), dict(zip(names, place, strict=True)), dict(zip(names, std[:count], strict=True)), [], {}
    )
    for k, each in enumerate(seed.corrections, start=len(base.names) - len(seed.corrections)):
        own.corrections.append(_changed(each, each.value + value[k], float(std[k])))
    parameters: dict[str, dict[str, ParameterEstimate]] = {}
    said: dict[str, dict[str, InFile | None]] = {}
    sides, had = _sides(search.given), {key_of(each): each for each in seed.corrections}
    for slot in explanation.slots:
        where = [columns.index(c) for c in slot.columns]
        found = estimates_of(slot, value[where], std[where], cross)
        parameters[slot.name] = together(parameters.get(slot.name, {}), of_part(slot, explanation.slots, found))
        places = of_part(slot, explanation.slots, in_file(slot, found, sides, had))
        said[slot.name] = agreed(said.get(slot.name, {}), places)
        _add(own, slot, found, sides, seed, scale[where])
    if search.reversal is not None:
        finding = search.reversal
        at = [finding.cross.problem.columns(finding.fitted.slots).index(c) for c in finding.slot.columns]
        size = finding.cross.problem.layout.scales[list(finding.slot.columns)]
        deviation = np.sqrt(np.diag(finding.cross.covariance(finding.fitted)))[at] * size
        found = estimates_of(finding.slot, finding.fitted.beta[at] * size, deviation, finding.cross)
        parameters[finding.slot.name] = found
        _add(own, finding.slot, found, sides, seed, size)
    if search.ripple and TERM not in seed.term_names and (wave := _common_wave(search, search.ripple)) is not None:
        own.add_term(None, term_named(TERM), wave)
    for lost in search.flow:
        for each in lost.corrections:
            own.add_correction(each)
    return replace(_model_of(own, seed, search.given.crane, parameters, provenance), said=said)


def _common_wave(search: Search, ripple: Ripple) -> dict[str, ParameterEstimate] | None:
    pairs = list(zip(search.given.runs, search.expansion.runs, strict=True))
    # what has been found so far is not in the expansion's prediction; it is slow against a ripple
    training = [(run, p) for run, p in pairs if p.name in search.train]
    return in_phase([run for run, _ in training], [p for _, p in training], search.given.crane, ripple)


def _add(own: _Draft, slot: Slot, found: Estimates, sides: Sides, seed: FrictionModel, typical: FloatArray) -> None:
    candidate, shape = slot.origin
    if (term := candidate.term) is not None:
        own.add_term(candidate, term, found)
        if (most := candidate.most_in(seed)) >= LIMITS.unbounded:
            reach = {p.name: LIMITS.bare_room * abs(own.at[p.name]) for p in term.parameters}
        else:  # as much as the search believes: 100 N m at 2000 rpm, a usual bound, is 9 at a slow motor's top speed
            sizes = zip(candidate.linear, most * np.abs(typical), strict=True)
            reach = {p.name: float(size) for p, size in sizes if p.name not in seed.parameter_names and size > p.upper}
        own.room |= {p.name: (p.lower, max(p.upper, reach[p.name])) for p in term.parameters if p.name in reach}
    elif candidate.corrects is not None:
        for each in candidate.corrects(found, shape, sides):
            own.add_correction(each)


def _sides(given: Given) -> Sides:
    """Which motor groups close the balance somewhere, and which never do."""
    named = {(group.name, group.balances) for run in given.prepared for group in run.groups}
    balancing, passive = (tuple(sorted(name for name, b in named if b == balances)) for balances in (True, False))
    return Sides(given.crane, balancing, passive, driving_alone(given.prepared))


def _model_of(
    own: _Draft, seed: FrictionModel, crane: Crane, parameters: dict[str, dict[str, ParameterEstimate]],
    provenance: Mapping[str, Any],
) -> Repair:  # fmt: skip
    declared = unique_parameters(tuple(own.terms))
    values, deviations, cut = [], [], []
    for p in declared:
        usual = own.room.get(p.name, (p.lower, p.upper))
        lower, upper = seed.bounds_of(p.name) if p.name in seed.parameter_names else usual
        value = float(np.clip(own.at[p.name], lower, upper))
        if abs(value - own.at[p.name]) > 1e-9 * abs(p.typical):
            cut.append(f"{p.name}: {CUT} {own.at[p.name]:.4g} {p.unit}")
        values.append(value)
        deviations.append(max(own.std[p.name], 1e-12 * abs(p.typical)))
    bounds = {name: each for name, each in {**own.room, **seed.bounds}.items() if name in own.at}
    model = FrictionModel(
        seed.name.removesuffix(REFITTED).removesuffix(REPAIRED) + REPAIRED, tuple(own.terms), tuple(values),
        np.diag(deviations) ** 2 if values else None,
        bounds, seed.constants, {**seed.provenance, **provenance}, tuple(own.corrections), seed.crane or crane.name,
    )  # fmt: skip
    cut += [f"{key_of(each)}: {each.source.partition(', ')[2]}" for each in own.corrections if CUT in each.source]
    return Repair(model, parameters, tuple(cut))


def polished(
    drafted: Repair, seed: FrictionModel, runs: Sequence[Run], train: Sequence[str], crane: Crane,
    known: Given | None = None,
) -> Repair:  # fmt: skip
    """The model fitted once more to the runs of these names along the path by which its file will be read.

    All runs are prepared at first, for all of them decide whether their wire gives, and by fewer it may be otherwise.
    The draft comes from a linear problem around the seed: melted curves, pressures that depend on what was found and
    shapes from a grid leave a second order, which Gauss-Newton steps on the model take away, while they shrink the gap.
    The covariance is the last fit's, wider where more than noise is left.
    """
    best = drafted
    now = meet(runs, crane, best.model, train, known).only(train)
    prior, loose = _prior(drafted, seed)
    for _ in range(LIMITS.polishing):
        step, covariance, deviations = _step(now, prior, loose)
        for share in (1.0, 0.5, 0.25):
            tried = _stepped(best.model, share * step, covariance, deviations)
            new = meet_again(now, runs, crane, tried)
            if LIMITS.worth_polishing * misfit(new, now) <= misfit(now, new):
                break  # else it went too far, as the width of a curve from a grid may
        if misfit(new, now) > LIMITS.worth_polishing * misfit(now, new):
            # no better, but the uncertainty is this fit's all the same
            best = replace(best, model=_stepped(best.model, np.zeros_like(step), covariance, deviations))
            break
        now, best = new, replace(best, model=tried)
        prior = with_room(prior, tried, loose, seed)
    best = replace(best, model=_as_found(best.model, drafted.model, seed))
    return replace(best, parameters=_reported(best, seed))


def _as_found(model: FrictionModel, drafted: FrictionModel, seed: FrictionModel) -> FrictionModel:
    """The model with the draft's deviation of what was freed and of which the fit tells nothing: a step's place."""
    new = [name not in seed.parameter_names for name in model.parameter_names]
    freed = LIMITS.loosened * np.array(drafted.std) * new
    share = np.where((freed > 0.0) & (np.array(model.std) >= UNTOLD * freed), 1.0 / LIMITS.loosened, 1.0)
    return replace(model, covariance=model.covariance * np.outer(share, share)) if len(share) else model


def _prior(drafted: Repair, seed: FrictionModel) -> tuple[FrictionModel, dict[str, float]]:
    """What is known before the fit: what no effect changed, as the seed has it; what was found only by its size."""
    model, known = drafted.model, seed.as_dict()
    loose: dict[str, float] = {}
    own = {name for found in drafted.parameters.values() for name in found}
    values = {name: known.get(name, value) for name, value in model.as_dict().items()}
    for name, std in zip(model.parameter_names, model.std, strict=True):
        if name in own or name not in known:
            loose[name] = LIMITS.loosened * std
            values[name] = model.as_dict()[name]
        else:
            loose[name] = float(seed.std[seed.parameter_names.index(name)])
    at = {key_of(each): each.value for each in model.corrections}
    loose |= {key_of(each): LIMITS.loosened * (each.std or 0.0) for each in model.corrections}
    loose |= {key_of(each): each.std or 0.0 for each in seed.corrections}
    most = 1.1 * LIMITS.prior_bound  # a tenth beyond its room: only an effect has moved it further
    kept = [c for c in seed.corrections if abs(at.get(key_of(c), np.inf) - c.value) <= most * correction_std(c)]
    return replace(model.with_values(values), corrections=tuple(kept)), loose


def _step(now: Given, prior: FrictionModel, loose: Mapping[str, float]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Change of parameters and corrections, the parameters' covariance and the corrections' deviations."""
    # a delay that is in the model is all that the signals are out of step by: the tolerance beside it would keep a part
    # of it, and the file does not carry tolerances
    delayed = any(each.declared.late and not each.during for each in now.model.corrections)
    base = base_of(prior, now.model, loose, held=("timing",) if delayed else ())
    cross = CrossFit(build_problem(now.prepared, layout_of(base, (), now.prepared, prior)))
    fitted = cross.explain(())
    count, corrections = base.parameters, len(now.model.corrections)
    keep = [*range(count), *range(len(base.names) - corrections, len(base.names))]
    scale = base.scale[keep]
    excess = max(fitted.train_loss / max(float(cross.problem.grams.count.sum()), 1.0), 1.0)
    covariance = cross.covariance(fitted)[np.ix_(keep, keep)] * excess
    shrink = np.minimum(1.0, 1.0 / np.sqrt(np.diag(covariance)))  # none is less certain after the fit than before it
    covariance = covariance * np.outer(shrink, shrink) * np.outer(scale, scale)
    return fitted.beta[keep] * scale, covariance[:count, :count], np.sqrt(np.diag(covariance)[count:])


def _stepped(model: FrictionModel, step: FloatArray, covariance: FloatArray, deviations: FloatArray) -> FrictionModel:
    count = len(model.values)
    bounds = np.array([model.bounds_of(name) for name in model.parameter_names]).reshape(-1, 2)
    values = np.clip(np.array(model.values) + step[:count], bounds[:, 0], bounds[:, 1])
    corrections = tuple(
        _changed(each, each.value + change, float(std))
        for each, change, std in zip(model.corrections, step[count:], deviations, strict=True)
    )
    least = np.diag(np.maximum(np.diag(covariance), [(1e-9 * abs(p.typical)) ** 2 for p in model.parameters]))
    covariance = covariance - np.diag(np.diag(covariance)) + least
    return replace(model.with_values(list(values)), covariance=covariance if count else None, corrections=corrections)


def _reported(best: Repair, seed: FrictionModel) -> dict[str, dict[str, ParameterEstimate]]:
    """The estimates as the polished model has them: those of new terms, and those that one correction says."""
    model, corrections = best.model, {key_of(each): each for each in best.model.corrections}
    new = {
        name: (value, float(std))
        for name, value, std in zip(model.parameter_names, model.values, model.std, strict=True)
        if name not in seed.parameter_names
    }

    def now(effect: str, name: str, e: ParameterEstimate) -> ParameterEstimate:
        said = best.said.get(effect, {}).get(name)
        if said is not None and said.key in corrections:
            return said.read(corrections[said.key], e.unit)
        return ParameterEstimate(*new[name], e.unit) if name in new else e

    return {
        effect: {name: now(effect, name, e) for name, e in found.items()} for effect, found in best.parameters.items()
    }
