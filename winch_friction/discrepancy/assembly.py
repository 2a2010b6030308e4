"""From a search to the result: the repaired model, the proof on locked runs, regions and the next experiment."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from winch_friction.discrepancy.answer import Effect, GapResult, ParameterEstimate, Side, relative_error
from winch_friction.discrepancy.detectors.reversals import ReversalFinding
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks, Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.interval import rms_with_interval
from winch_friction.discrepancy.engine.noise import noise_of_run
from winch_friction.discrepancy.engine.omnibus import Dependence
from winch_friction.discrepancy.engine.problem import Problem
from winch_friction.discrepancy.engine.regions import find_regions
from winch_friction.discrepancy.engine.selection import Finding, Selection
from winch_friction.discrepancy.expansion import Expansion
from winch_friction.discrepancy.holdout import Split
from winch_friction.discrepancy.next_experiment import NextExperiment, plan_experiment
from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.preparation.prepare import READ_AS
from winch_friction.discrepancy.regressors import build_problem
from winch_friction.discrepancy.repair import repair, with_reversal_effect
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.verdict import AMBIGUOUS, NOTHING, UNEXPLAINED, Verdict
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane


def assemble(
    split: Split, crane: Crane, model: FrictionModel, options: GapOptions, search: Search, rng: np.random.Generator
) -> GapResult:
    """The result that a search stands by."""
    cross, selection, verdict = search.cross, search.selection, search.verdict
    explanation = search.explanation
    found = selection.found if explanation is selection.final else ()
    notes = _provenance(split.train, verdict, options)
    repaired = repair(model, search.expansion, cross, explanation, notes)
    effects = [_effect(each, repaired.parameters) for each in found]
    final_model = repaired.model
    if search.reversal is not None:
        final_model, parameters = with_reversal_effect(repaired.model, search.reversal)
        effects.append(_reversal_effect(search.reversal, parameters))
    experiment = _experiment(crane, search, options) if options.plan else None
    train = _side(search.at_seed, search.expansion, split.train, explanation, rng)
    holdout = _side(search.at_seed, search.expansion, split.holdout, explanation, rng)
    unexplained = verdict.kind == UNEXPLAINED
    return GapResult(
        verdict=verdict.kind, refused=verdict.refused, effects=(*effects, *search.side),
        regions=tuple(find_regions(cross.problem.blocks, _unweighted(cross, selection.base), READ_AS)),
        unit=crane.drive.unit, train=train, holdout=holdout,
        depends=_named(search.left) if unexplained else (),
        unexplained_share=_unexplained_share(cross, selection, verdict), considered=selection.considered,
        untestable=search.untestable, model=final_model, seed_model=model,
        next_experiment=experiment.content() if experiment else None,
        next_scenario=experiment.text if experiment else "",
        notes=_notes(split.runs, search.loads),
    )  # fmt: skip


def _experiment(crane: Crane, search: Search, options: GapOptions) -> NextExperiment | None:
    """For the first effect that has rivals; an electric drive has no scenario family."""
    if search.verdict.kind != AMBIGUOUS or not crane.drive.hydraulic:
        return None
    own = next(each for each in search.selection.found if each.rivals)
    fitted = search.selection.final
    return plan_experiment(crane, search.expansion, search.cross, fitted, own.slot, own.rivals, options.seed)


def _effect(found: Finding, parameters: Mapping[str, Mapping[str, ParameterEstimate]]) -> Effect:
    candidate = found.slot.origin[0]
    return Effect(
        candidate.name, tuple(rival.name for rival in found.rivals), found.slot.label, candidate.law,
        parameters.get(candidate.name, {}), found.p_value, found.gain, found.selection_frequency,
    )  # fmt: skip


def _reversal_effect(finding: ReversalFinding, parameters: Mapping[str, ParameterEstimate]) -> Effect:
    candidate = finding.slot.origin[0]
    return Effect(
        candidate.name, (), finding.slot.label, candidate.law, parameters, finding.p_value, finding.gain, 1.0,
        "just after reversals",
    )  # fmt: skip


def _provenance(train: Sequence[str], verdict: Verdict, options: GapOptions) -> Mapping[str, Any]:
    return {
        "repaired_by": "winch-friction gap", "verdict": verdict.kind, "trained_on": list(train), "seed": options.seed,
    }  # fmt: skip


def _unweighted(cross: CrossFit, explanation: Explanation) -> FloatArray:
    return np.asarray(cross.remainder(explanation) / cross.problem.blocks.weight)


def _side(
    at_seed: Expansion, expansion: Expansion, names: Sequence[str], explanation: Explanation, rng: np.random.Generator
) -> Side:
    given = _problem(at_seed, names, ())
    around = _problem(expansion, names, explanation.slots)
    after = around.blocks.y - around.blocks.x @ explanation.beta
    before = given.blocks.y
    torque = _measured(at_seed, given.blocks, names)
    floor = np.sqrt(np.mean(_noise_per_run(after, around.blocks)[around.blocks.run] ** 2))
    return Side(
        runs=tuple(run for run in expansion.runs if run.name in names), blocks=around.blocks,
        before=before, after=after,
        size_before=rms_with_interval(before, given.blocks.segment, rng),
        size_after=rms_with_interval(after, around.blocks.segment, rng), noise_floor=float(floor),
        relative=(relative_error(before, torque), relative_error(after, torque)),
    )  # fmt: skip


def _noise_per_run(residual: FloatArray, blocks: Blocks) -> FloatArray:
    """Independent noise of each run, in the residual's unit."""
    runs = range(int(blocks.run.max()) + 1)
    own = [blocks.run == k for k in runs]
    return np.array([noise_of_run(residual[k], blocks.position[k]) if k.any() else 0.0 for k in own])


def _problem(expansion: Expansion, names: Sequence[str], slots: Sequence[Slot]) -> Problem:
    layout, _ = expansion.layout.only(slots)
    return build_problem([run for run in expansion.runs if run.name in names], layout)


def _measured(expansion: Expansion, blocks: Blocks, names: Sequence[str]) -> FloatArray:
    """RMS-true stand-in for the measured torque of the blocks: each run's own RMS while moving, in the gap's unit."""
    chosen = [run for run in expansion.runs if run.name in names]
    own = [np.sqrt(np.mean(((r.gap + r.predicted)[r.used] / r.unit_torque) ** 2)) for r in chosen]
    return np.array(own)[blocks.run]


def _named(left: Sequence[Dependence]) -> tuple[Dependence, ...]:
    significant = [
        each for each in left if each.p_value <= LIMITS.remainder_p and each.share > LIMITS.least_named_share
    ]
    return tuple((significant or [d for d in left if d.share > 0.0])[: LIMITS.most_signals])


def _unexplained_share(cross: CrossFit, selection: Selection, verdict: Verdict) -> float:
    """Share of the gap above the noise floor that no named effect explains."""
    floor = float(cross.problem.grams.count.sum()) + cross.unresolved
    before = max(selection.base.loss - floor, 1e-9)
    after = max(selection.final.loss - floor, 0.0)
    if verdict.kind == NOTHING:
        return 0.0
    return float(min(after / before, 1.0)) if selection.found else 1.0


def _notes(runs: Sequence[Run], loads: Mapping[str, float]) -> tuple[str, ...]:
    notes = [f"{name}: no hook_load; {load / 1e3:.1f} t estimated from the balance" for name, load in loads.items()]
    bare = [run.name for run in runs if "wire_layer" not in run and run.groups]
    if bare:
        notes.append(f"no wire_layer in {len(bare)} runs: the outer layer is assumed")
    return tuple(notes)
