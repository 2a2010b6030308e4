"""Locate, name, add, prove: the whole workflow on runs in memory."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.discrepancy.blocks import Blocks, Slot
from winch_friction.discrepancy.candidates.candidate import Candidate, Untestable
from winch_friction.discrepancy.candidates.catalogue import all_candidates, testable
from winch_friction.discrepancy.candidates.refine import refined
from winch_friction.discrepancy.crossfit import FEWEST_RUNS, CrossFit, Explanation
from winch_friction.discrepancy.holdout import Split, lock_holdout, rms_with_interval
from winch_friction.discrepancy.linearise import Expansion, expand_around, expand_at_seed
from winch_friction.discrepancy.loads import estimated_loads
from winch_friction.discrepancy.next_experiment import NextExperiment, plan_experiment
from winch_friction.discrepancy.noise import noise_of_run
from winch_friction.discrepancy.omnibus import SIGNIFICANCE, Dependence, dependences, remainder
from winch_friction.discrepancy.problem import Problem, base_of, build_problem, layout_of
from winch_friction.discrepancy.regions import find_regions
from winch_friction.discrepancy.repair import Estimate, repair, with_turning
from winch_friction.discrepancy.result import Effect, GapResult, Side, relative_error
from winch_friction.discrepancy.ripple import Ripple
from winch_friction.discrepancy.selection import Found, Selection, select
from winch_friction.discrepancy.side_findings import (
    find_ripple,
    leakage_effect,
    ripple_effect,
    ripple_waves,
    without_ripple,
)
from winch_friction.discrepancy.turning import TurningFinding, search_turning
from winch_friction.discrepancy.verdict import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, Verdict, decide
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane

MOST_SIGNALS = 3
MOST_EXPANSIONS = 2
MOST_KEPT_NOISE, MOST_KEPT = 3.0, 0.05  # times the noise, and share of the excess, that locked runs may keep
LEAST_NAMED_SHARE = 0.02  # of the remainder, that a signal must predict to be named before those that predict more


@dataclass(frozen=True)
class GapOptions:
    """`holdout` is the share of runs locked for the proof; `seed` drives every random choice."""

    holdout: float = 0.25
    seed: int = 0
    effects_file: Path | None = None
    plan: bool = True  # look for the experiment that separates rivals
    candidates: tuple[Candidate, ...] = ()  # instead of the catalogue, when given


def find_gap(runs: Sequence[Run], crane: Crane, model: FrictionModel, options: GapOptions | None = None) -> GapResult:
    """Where runs and model disagree, which effect is missing, and the proof on locked runs.

    Raises `InputError` for runs that lack what the torque balance needs, for two runs of one name and for no run at
    all.
    """
    options = options or GapOptions()
    _check(runs, options)
    split = lock_holdout(runs, options.holdout, np.random.default_rng(options.seed))
    rng = np.random.default_rng(options.seed + 1)
    search = _search(split, crane, model, options, rng)
    result = _assemble(split, crane, model, options, search, rng)
    if len(split.train) < FEWEST_RUNS and result.effects and not _proved(result):
        return _assemble(split, crane, model, options, _withdrawn(search), rng)
    if result.effects and _refuted(result):
        return _assemble(split, crane, model, options, _unexplained(search, rng), rng)
    return result


def _proved(result: GapResult) -> bool:
    """Whether the locked runs' gap came down below the interval that it had before."""
    return result.holdout.size_after.value < result.holdout.size_before.interval[0]


def _refuted(result: GapResult) -> bool:
    """Whether the locked runs keep far more than their noise, and not only because there was so much before."""
    before, after, noise = result.holdout.size_before.value, result.holdout.size_after.value, result.holdout.noise_floor
    kept = (after**2 - noise**2) / max(before**2 - noise**2, 1e-9)
    return after > MOST_KEPT_NOISE * noise and kept > MOST_KEPT


def _unexplained(search: "_Search", rng: np.random.Generator) -> "_Search":
    """The search with what it found refused."""
    names = ", ".join(found.slot.candidate.name for found in search.selection.found)
    left = dependences(search.cross, remainder(search.cross, search.selection.base), rng)
    verdict = Verdict(UNEXPLAINED, f"{names} does not hold on the locked runs")
    return replace(search, verdict=verdict, left=tuple(left), turning=None)


def _withdrawn(search: "_Search") -> "_Search":
    """The search without its findings: with a few runs the folds are stretches of one operating point, in which small
    mismatches repeat themselves, so that only the locked part can tell an effect from them.
    """
    selection = replace(search.selection, final=search.selection.base, found=())
    refused = "what seemed to be missing did not shrink the gap on the locked part; bring more runs"
    return replace(search, selection=selection, verdict=Verdict(NOTHING, refused), turning=None, side=())


@dataclass(frozen=True)
class _Search:
    """What the training runs gave."""

    at_seed: Expansion
    expansion: Expansion
    cross: CrossFit
    selection: Selection
    left: tuple[Dependence, ...]
    verdict: Verdict
    turning: TurningFinding | None
    side: tuple[Effect, ...]
    untestable: tuple[Untestable, ...]
    loads: Mapping[str, float]

    @property
    def explanation(self) -> Explanation:
        """The effects that the verdict stands by."""
        return self.selection.base if self.verdict.kind in (UNEXPLAINED, NOTHING) else self.selection.final


def _search(split: Split, crane: Crane, model: FrictionModel, options: GapOptions, rng: np.random.Generator) -> _Search:
    loads = estimated_loads(split.runs, crane, model)
    prepared = expand_at_seed(split.runs, crane, model, loads)
    training = [(r, p) for r, p in zip(split.runs, prepared, strict=True) if r.name in split.train]
    own_runs, own_prepared = [r for r, _ in training], [p for _, p in training]
    ripple = find_ripple(own_runs, own_prepared, crane)
    usable, blind = testable(options.candidates or all_candidates(options.effects_file), prepared, model)
    candidates = [each for each in usable if each.regime == "moving"]
    at_seed = Expansion(prepared, layout_of(base_of(model, model), candidates, prepared, model), model)
    cross = _cleaned(at_seed, ripple).cross(split.train)
    expansion, selection = at_seed, select(cross, rng, 1)
    for _ in range(MOST_EXPANSIONS):
        candidates, usable = (_refined(each, selection.final) for each in (candidates, usable))
        around = expand_around(split.runs, crane, model, loads, expansion, selection.final, candidates)
        expansion = _cleaned(around, ripple)
        cross = expansion.cross(split.train, selection.final.slots)
        selection = select(cross, rng)
        if not any(slot.candidate.continuous for slot in selection.final.slots):
            break
    left = dependences(cross, remainder(cross, selection.final), rng)
    verdict = decide(cross, selection, left, ripple is not None)
    if verdict.kind == UNEXPLAINED:
        left = dependences(cross, remainder(cross, selection.base), rng)
    kept = selection.base if verdict.kind in (UNEXPLAINED, NOTHING) else selection.final
    turning = None
    if verdict.kind != UNEXPLAINED:
        # just after reversals there is too little of a run to tell a ripple from what is looked for
        cleaned = partial(_cleaned, ripple=ripple, waves=ripple_waves(around.runs, ripple) if ripple else None)
        turning = search_turning(split.runs, crane, model, loads, expansion, kept, usable, split.train, rng, cleaned)
    leakage = leakage_effect(own_runs, own_prepared)
    side = ([ripple_effect(ripple)] if ripple else []) + ([leakage] if leakage else [])
    if verdict.kind == NOTHING and (turning or side):
        verdict = Verdict(MISSING)
    return _Search(
        at_seed, expansion, cross, selection, tuple(left), verdict, turning, tuple(side), tuple(blind), loads
    )


def _refined(candidates: Sequence[Candidate], explanation: Explanation) -> list[Candidate]:
    """The candidates, those that were found with a finer grid of shapes."""
    found = {slot.candidate.name: slot.variant for slot in explanation.slots}
    return [refined(each, found[each.name]) if each.name in found else each for each in candidates]


def _cleaned(expansion: Expansion, ripple: Ripple | None, waves: Mapping[str, FloatArray] | None = None) -> Expansion:
    """The runs without the ripple: that of `waves`, or else what each has of it."""
    if ripple is None:
        return expansion
    waves = ripple_waves(expansion.runs, ripple) if waves is None else waves
    return replace(expansion, runs=tuple(without_ripple(run, ripple, waves[run.name]) for run in expansion.runs))


def _assemble(
    split: Split, crane: Crane, model: FrictionModel, options: GapOptions, search: _Search, rng: np.random.Generator
) -> GapResult:
    cross, selection, verdict = search.cross, search.selection, search.verdict
    explanation = search.explanation
    found = selection.found if explanation is selection.final else ()
    notes = _provenance(split.train, verdict, options)
    repaired = repair(model, search.expansion, cross, explanation, notes)
    effects = [_effect(each, repaired.parameters) for each in found]
    final_model = repaired.model
    if search.turning is not None:
        final_model, parameters = with_turning(repaired.model, search.turning)
        effects.append(_turning_effect(search.turning, parameters))
    experiment = _experiment(crane, search, options) if options.plan else None
    train = _side(search.at_seed, search.expansion, split.train, explanation, rng)
    holdout = _side(search.at_seed, search.expansion, split.holdout, explanation, rng)
    unexplained = verdict.kind == UNEXPLAINED
    return GapResult(
        verdict=verdict.kind, refused=verdict.refused, effects=(*effects, *search.side),
        regions=tuple(find_regions(cross.problem.blocks, _unweighted(cross, selection.base))),
        unit="N*m" if crane.electric else "bar", train=train, holdout=holdout,
        depends=_named(search.left) if unexplained else (),
        unexplained_share=_unexplained_share(cross, selection, verdict), considered=selection.considered,
        untestable=search.untestable, model=final_model, seed_model=model,
        next_experiment=experiment.content() if experiment else None,
        next_scenario=experiment.text if experiment else "",
        notes=_notes(split.runs, search.loads),
    )  # fmt: skip


def _experiment(crane: Crane, search: _Search, options: GapOptions) -> NextExperiment | None:
    """For the first effect that has rivals; an electric drive has no scenario family."""
    if search.verdict.kind != AMBIGUOUS or crane.electric:
        return None
    own = next(each for each in search.selection.found if each.rivals)
    fitted = search.selection.final
    return plan_experiment(crane, search.expansion, search.cross, fitted, own.slot, own.rivals, options.seed)


def _effect(found: Found, parameters: Mapping[str, Mapping[str, Estimate]]) -> Effect:
    candidate = found.slot.candidate
    return Effect(
        candidate.name, tuple(rival.candidate.name for rival in found.rivals), found.slot.variant.label, candidate.law,
        parameters.get(candidate.name, {}), found.p_value, found.gain, found.selection_frequency,
    )  # fmt: skip


def _turning_effect(turning: TurningFinding, parameters: Mapping[str, Estimate]) -> Effect:
    candidate = turning.slot.candidate
    return Effect(
        candidate.name, (), turning.slot.variant.label, candidate.law, parameters, turning.p_value, turning.gain, 1.0,
        "just after reversals",
    )  # fmt: skip


def _check(runs: Sequence[Run], options: GapOptions) -> None:
    if not runs:
        raise InputError("no run given; name at least one run file")
    names = [run.name for run in runs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(f"two runs are called '{twice[0]}'; a run's identity is its file name")
    if not 0.05 <= options.holdout <= 0.6:
        raise InputError(f"--holdout {options.holdout:g} is outside 0.05 ... 0.6")


def _provenance(train: Sequence[str], verdict: Verdict, options: GapOptions) -> Mapping[str, Any]:
    return {
        "repaired_by": "winch-friction gap", "verdict": verdict.kind, "trained_on": list(train), "seed": options.seed,
    }  # fmt: skip


def _unweighted(cross: CrossFit, explanation: Explanation) -> FloatArray:
    return np.asarray(remainder(cross, explanation) / cross.problem.blocks.weight)


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
    own = [np.sqrt(np.mean(((r.gap + r.predicted)[r.moving] / r.unit_torque) ** 2)) for r in chosen]
    return np.array(own)[blocks.run]


def _named(left: Sequence[Dependence]) -> tuple[Dependence, ...]:
    significant = [each for each in left if each.p_value <= SIGNIFICANCE and each.share > LEAST_NAMED_SHARE]
    return tuple((significant or [d for d in left if d.share > 0.0])[:MOST_SIGNALS])


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
