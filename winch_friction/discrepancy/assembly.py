"""From a search to the result: the repaired model, the proof on locked runs, regions and the next experiment.

An instant between two training runs at which something changed is placed among the locked runs that lie between.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.discrepancy.adequacy import Check
from winch_friction.discrepancy.answer import (
    AMBIGUOUS,
    INSUFFICIENT,
    MISSING,
    UNEXPLAINED,
    Effect,
    GapOptions,
    GapResult,
    Side,
    Verdict,
    named,
    unexplained_share,
)
from winch_friction.discrepancy.candidates.candidate import Candidate, ParameterEstimate
from winch_friction.discrepancy.engine.blocks import Slot, find_regions
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.selection import TAKEN, Considered, Finding, Selection
from winch_friction.discrepancy.expansion import Given, Split, meet
from winch_friction.discrepancy.next_experiment import NextExperiment, plan_experiment, supplying
from winch_friction.discrepancy.preparation.prepare import READ_AS
from winch_friction.discrepancy.proof import compare, drift_note, nothing_compared, read_back
from winch_friction.discrepancy.repair import REFITTED, REPAIRED, Repair, draft, polished
from winch_friction.discrepancy.search import ReversalFinding, Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.discrepancy.ties import Company, company, known_combination
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.table import in_windows
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.records.strict_yaml import shipped

CATALOGUES = "catalogue's"  # of two laws, the one without a name of its own
LEFT_AS_GIVEN = "the model is left as it was given: fitted to what nothing explains, it does worse on the locked runs"


@dataclass(frozen=True)
class Trial:
    """A repaired model as its file is read, and what it leaves of the gap."""

    search: Search
    repaired: Repair
    train: Side
    holdout: Side


def tried(split: Split, crane: Crane, options: GapOptions, search: Search, rng: np.random.Generator) -> Trial:
    """The file that a search would write, put to all runs."""
    search = placed(search, split)
    repaired = draft(search, search.explanation, _provenance(split.train, search.verdict, options))
    repaired = polished(repaired, search.given.model, split.runs, split.train, crane)
    after = meet(split.runs, crane, read_back(repaired.model), ())
    sides = (compare(search.given, after, names, rng) for names in (split.train, split.holdout))
    return Trial(search, repaired, *sides)


def as_given(split: Split, options: GapOptions, search: Search, rng: np.random.Generator) -> Trial:
    """The given model as it is, where a refit would only make it worse on the locked runs."""
    given = search.given
    model = replace(
        given.model, provenance={**given.model.provenance, **_provenance(split.train, search.verdict, options)}
    )
    sides = (compare(given, given, names, rng) for names in (split.train, split.holdout))
    return Trial(search, Repair(model, {}), *sides)


def assemble(split: Split, options: GapOptions, trial: Trial) -> GapResult:
    """The result that a trial stands by."""
    search, repaired = trial.search, trial.repaired
    cross, selection, verdict, given = search.cross, search.selection, search.verdict, search.given
    found = selection.found if search.explanation is selection.final else ()
    experiment = _experiment(given.crane, search, options) if options.plan else None
    first = {each.slot.name: each for each in reversed(found)}  # of a cause with two laws, the one found first
    tied = {name: company(search, each) for name, each in first.items()}
    kind = AMBIGUOUS if verdict.kind == MISSING and any(own.partners for own in tied.values()) else verdict.kind
    left = [LEFT_AS_GIVEN] if kind == UNEXPLAINED and repaired.model.values == given.model.values else []
    drift = drift_note((trial.train, trial.holdout), list(search.explanation.names), given.crane.drive.unit)
    return GapResult(
        verdict=kind, refused=verdict.refused, effects=_effects(search, found, repaired, tied),
        regions=tuple(find_regions(trial.train.blocks, trial.train.before, READ_AS)),
        unit=given.crane.drive.unit, train=trial.train, holdout=trial.holdout,
        depends=named(search.left) if verdict.kind == UNEXPLAINED else (),
        unexplained_share=unexplained_share(cross, selection, verdict), considered=_in_the_end(selection),
        untestable=search.untestable, model=_concluded(repaired.model, given.model, kind), seed_model=given.model,
        next_experiment=experiment.content() if experiment else None,
        next_scenario=experiment.text if experiment else "",
        notes=(
            *_notes(split.runs, given.loads), *_amounts(repaired.model, split.runs),
            *_times(repaired.model, given.model, split.runs), *repaired.cut,
            *(each.note for own in tied.values() for each in own.partners),
            *filter(None, (own.note(name) for name, own in tied.items())), *([drift] if drift else []), *left,
            *(_inexact(trial.holdout, given.crane.drive.unit) if found else []),
        ),
    )  # fmt: skip


def _in_the_end(selection: Selection) -> tuple[Considered, ...]:
    """What was considered; of what was taken at first and does not stand it says so."""
    stand = {finding.slot.name for finding in selection.found}
    fell = f"{TAKEN} at first, but it does not stand in the end"
    return tuple(
        replace(each, verdict=fell) if each.verdict == TAKEN and each.name not in stand else each
        for each in selection.considered
    )


def insufficient(
    checks: Sequence[Check], notes: Sequence[str], crane: Crane, model: FrictionModel,
    looked_at: tuple[Given, Split] | None = None,
) -> GapResult:  # fmt: skip
    """The result of runs that cannot answer: what they lack in numbers, and a scenario that supplies it."""
    sides = [nothing_compared(), nothing_compared()]
    if looked_at is not None:
        given, split = looked_at
        rng = np.random.default_rng(0)
        sides = [compare(given, given, names, rng) for names in (split.train, split.holdout)]
    name = supplying(checks) if crane.drive.hydraulic else ""
    lacking = "; ".join(check.sentence for check in checks if not check.met)
    plan = {
        "scenario": f"{name}.yaml", "separates": [], "expected_z": 0.0, "considered": {},
        "note": f"supplies what the runs lack ({lacking})",
    }  # fmt: skip
    return GapResult(
        verdict=INSUFFICIENT, refused=lacking, effects=(), regions=(), unit=crane.drive.unit, train=sides[0],
        holdout=sides[1], depends=(), unexplained_share=0.0, considered=(), untestable=(), model=model,
        seed_model=model, next_experiment=plan if name else None,
        next_scenario=shipped("scenarios", name).read_text(encoding="utf-8") if name else "", notes=tuple(notes),
        adequacy=tuple(checks),
    )  # fmt: skip


def _effects(
    search: Search, found: Sequence[Finding], repaired: Repair, tied: Mapping[str, Company]
) -> tuple[Effect, ...]:
    effects = [
        _effect(search, [each for each in found if each.slot.name == name], repaired, tied[name])
        for name in dict.fromkeys(each.slot.name for each in found)
    ]
    if search.reversal is not None:
        effects.append(_reversal_effect(search.reversal, repaired.parameters))
    side = [search.ripple.effect] if search.ripple else []
    return (*effects, *side, *(each.effect for each in search.flow))


def _experiment(crane: Crane, search: Search, options: GapOptions) -> NextExperiment | None:
    """For the first effect that has rivals; an electric drive has no scenario family."""
    if search.verdict.kind != AMBIGUOUS or not crane.drive.hydraulic:
        return None
    own = next(each for each in search.selection.found if each.rivals)
    fitted = search.selection.final
    return plan_experiment(crane, search.expansion, search.cross, fitted, own.slot, own.rivals, options.seed)


def _effect(search: Search, laws: Sequence[Finding], repaired: Repair, tied: Company) -> Effect:
    """One cause with its law, or with the two that its law is a mixture of."""
    found, candidates = laws[0], [each.slot.origin[0] for each in laws]
    name = candidates[0].name
    estimates = repaired.parameters.get(name, {})
    return Effect(
        name, tied.rivals, _and(each.slot.label for each in laws),
        " + ".join(dict.fromkeys(each.latex for each in candidates)), estimates,
        found.p_value, found.gain, found.selection_frequency,
        law_name=_law_name(candidates),
        free=any(each.free for each in candidates),
        combination=known_combination(search, found, estimates, tied.partners, repaired.model),
    )  # fmt: skip


def _law_name(candidates: Sequence[Candidate]) -> str:
    """Of one law or of several; the catalogue's own has no name unless there is another beside it."""
    names = dict.fromkeys(each.law_name for each in candidates)
    return _and(name or CATALOGUES for name in names) if len(names) > 1 else next(iter(names))


def _and(parts: Iterable[str]) -> str:
    return " and ".join(part for part in parts if part)


def _reversal_effect(finding: ReversalFinding, parameters: Mapping[str, Mapping[str, ParameterEstimate]]) -> Effect:
    candidate = finding.slot.origin[0]
    return Effect(
        candidate.name, (), finding.slot.label, candidate.latex, parameters[candidate.name], finding.p_value,
        finding.gain, 1.0, "just after reversals", candidate.law_name, candidate.free,
    )  # fmt: skip


def _provenance(train: Sequence[str], verdict: Verdict, options: GapOptions) -> Mapping[str, Any]:
    return {
        "repaired_by": "winch-friction gap", "verdict": verdict.kind, "trained_on": list(train), "seed": options.seed,
    }  # fmt: skip


def _concluded(model: FrictionModel, given: FrictionModel, verdict: str) -> FrictionModel:
    """The model under the verdict that stands; where nothing was put right it is called refitted."""
    changed = model.term_names != given.term_names or model.corrections != given.corrections
    same = not changed and model.values == given.values
    other = given.name if same else model.name.removesuffix(REPAIRED) + REFITTED
    name = model.name if changed else other
    return replace(model, name=name, provenance={**model.provenance, "verdict": verdict})


def _notes(runs: Sequence[Run], loads: Mapping[str, float]) -> tuple[str, ...]:
    notes = [f"{name}: no hook_load; {load / 1e3:.1f} t estimated from the balance" for name, load in loads.items()]
    bare = [run.name for run in runs if "wire_layer" not in run and run.groups]
    if bare:
        notes.append(f"no wire_layer in {len(bare)} runs: the outer layer is assumed")
    return tuple(notes)


def _amounts(model: FrictionModel, runs: Sequence[Run]) -> list[str]:
    """Which runs have what a table of windows over time says, and how much of it."""
    found = []
    for term in model.terms:
        if term.table is None or not term.table.in_times:
            continue
        level = model.value(term.parameters[0].name)
        own = [(run.name, in_windows(term.table, level, float(run.time[len(run) // 2]))) for run in runs]
        said = ", ".join(f"{name} {amount:.3g}" for name, amount in own if amount)
        found.append(f"{term.name}, N·m at each motor: {said}; to any other run the file gives none")
    return found


def _times(model: FrictionModel, seed: FrictionModel, runs: Sequence[Run]) -> list[str]:
    """Which runs have an error that is not always there, of those that the given model did not know."""
    found = []
    for each in model.corrections:
        if each.during and not each.declared.grows and each.during not in [old.during for old in seed.corrections]:
            there = [run.name for run in runs if each.holds(float(run.time[len(run) // 2]))]
            found.append(f"{each.name} is there in {', '.join(there)}; in no other of these runs")
    return list(dict.fromkeys(found))


def _inexact(side: Side, unit: str) -> list[str]:
    """That more than noise is left beside what is named."""
    left = side.size_after.value
    if left <= LIMITS.far_off_the_floor * side.floor:
        return []
    return [
        f"the locked runs keep {left:.3g} {unit} where their noise is {side.noise_floor:.3g}: the cause is named, its "
        "law is not exact, or a smaller effect is beside it"
    ]


# -- when something changed
def placed(search: Search, split: Split) -> Search:
    """The search with each effect that has an instant at the one that the locked runs tell by their first halves.

    The training runs say between which two of them a machine changed, and of the instants between these they cannot
    say more: on them the columns are the same. A locked run between was before the change or after it, as it is in a
    state (`run_states`): the first half of its samples says which, and all of it is what the names are proven on.
    """
    for k, slot in enumerate(search.selection.final.slots):
        if others := _same_on_training(search.cross, slot):
            search = _told(search, k, [slot, *others], split)
    return search


def _same_on_training(cross: CrossFit, slot: Slot) -> list[Slot]:
    """Other shapes of the same law whose columns are the same over the training runs."""
    x = cross.problem.blocks.x
    alike = [each for each in cross.problem.slots if (each.name, each.law) == (slot.name, slot.law)]
    own = x[:, slot.columns]
    return [each for each in alike if each.columns != slot.columns and np.array_equal(x[:, each.columns], own)]


def _told(search: Search, k: int, shapes: list[Slot], split: Split) -> Search:
    """The search with that of the shapes for its effect number `k` that leaves least of the locked runs' first
    halves."""
    selection, final = search.selection, search.selection.final
    sets = [(*final.slots[:k], each, *final.slots[k + 1 :]) for each in shapes]
    locked = search.expansion.cross(split.holdout, final.slots)
    best = min(sets, key=lambda slots: _left_of_first_halves(locked, replace(final, slots=slots)))
    found = [replace(each, slot=best[k]) if each.slot is final.slots[k] else each for each in selection.found]
    return replace(search, selection=replace(selection, final=search.cross.explain(best), found=tuple(found)))


def _left_of_first_halves(locked: CrossFit, explanation: Explanation) -> float:
    """Sum of squares, in units of the noise, that an explanation of the training runs leaves of the first half of every
    locked run."""
    blocks, left = locked.problem.blocks, locked.remainder(explanation)
    runs = range(int(blocks.run.max(initial=-1)) + 1)
    half = np.array([np.median(blocks.position[blocks.run == k]) if (blocks.run == k).any() else 0 for k in runs])
    return float((left[blocks.position <= half[blocks.run]] ** 2).sum()) if len(left) else 0.0
