"""What a user of the workflow may choose, what it found, as one object, and its verdict; `gap.json` is its content.

The verdict follows from the selection and what it leaves; a fifth, `insufficient`, is given before any search.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.discrepancy.adequacy import Check
from winch_friction.discrepancy.candidates.candidate import Candidate, ParameterEstimate, Untestable
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks
from winch_friction.discrepancy.engine.chance import Dependence, Size, rms
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.regions import Region, find_regions
from winch_friction.discrepancy.engine.selection import Considered, Selection
from winch_friction.discrepancy.preparation.prepare import READ_AS, PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel

# -- what may be chosen
STEPS = 4  # that `told` hears of


def _silent(_: str) -> None:
    """For who does not watch; by its name, so that options go to other processes."""


@dataclass(frozen=True)
class GapOptions:
    """`holdout` is the share of runs locked for the proof; `seed` drives every random choice."""

    holdout: float = 0.25
    seed: int = 0
    effects_file: Path | None = None
    proposals: bool = True  # laws are looked for where no name fits
    plan: bool = True  # look for the experiment that separates rivals
    candidates: tuple[Candidate, ...] = ()  # instead of the catalogue, when given
    told: Callable[[str], None] = _silent  # hears what begins: for a progress bar


# -- what is found
SCHEMA = "winch_friction.gap/2"


@dataclass(frozen=True)
class Combination:
    """A combination of parameters that the runs determine where its members are tied, with its deviation."""

    expression: str
    value: float
    std: float
    unit: str
    because: str

    def content(self) -> dict[str, Any]:
        """The entry of gap.json."""
        return {**vars(self), "interval": [self.value - 1.96 * self.std, self.value + 1.96 * self.std]}


@dataclass(frozen=True)
class Effect:
    """One missing effect as it is reported; `gain` is the relative reduction of the held-out error where it shows."""

    name: str
    rivals: tuple[str, ...]
    variant: str
    law: str
    parameters: Mapping[str, ParameterEstimate]
    p_value: float
    gain: float
    selection_frequency: float
    where: str = "moving"
    law_name: str = ""  # which member of the cause's family; empty: the catalogue's own law
    free: bool = False
    combination: Combination | None = None  # what of it, and of what is tied to it, is really known

    def content(self) -> dict[str, Any]:
        """The entry of `effects` in gap.json."""
        return {
            "name": self.name,
            "indistinguishable_from": list(self.rivals),
            "parameters": {k: {"value": e.value, "std": e.std, "unit": e.unit} for k, e in self.parameters.items()},
            "variant": self.variant,
            "law": self.law_name or self.name,
            "law_kind": "free" if self.free else "literature",
            "latex": self.law,
            "identifiable_combination": self.combination.content() if self.combination else None,
            "evidence": {
                "p_value": self.p_value, "cv_gain": self.gain, "selection_frequency": self.selection_frequency,
                "where": self.where,
            },
        }  # fmt: skip


@dataclass(frozen=True)
class Side:
    """Block residuals of the training or of the locked runs before and after the repair, with their blocks."""

    runs: tuple[PreparedRun, ...]
    blocks: Blocks
    before: FloatArray  # of the model as given
    after: FloatArray
    size_before: Size
    size_after: Size
    noise_floor: float  # independent noise of the blocks
    least_noise: float  # what no balance closes better than
    relative: tuple[float, float]  # residual against drive torque, before and after
    slowest: float = 0.0  # RMS that the slowest blocks keep after the repair; 0 where too few are known

    @property
    def floor(self) -> float:
        """What is left at best: the noise, and what no balance closes better than."""
        return float(np.hypot(self.noise_floor, self.least_noise))

    @property
    def excused(self) -> float:
        """The floor with zeros that are off by no more than a step of the transducers."""
        return float(np.hypot(self.noise_floor, LIMITS.step * self.least_noise))

    @property
    def left_by_run(self) -> "list[tuple[PreparedRun, FloatArray]]":
        """Each run with what its blocks keep, in floors."""
        return [(run, self.after[self.blocks.run == k] / max(self.floor, 1e-12)) for k, run in enumerate(self.runs)]

    @property
    def most_left_first(self) -> dict[str, float]:
        """RMS of what each run's blocks keep, in floors, by its name, from the run on that keeps most."""
        left = {run.name: rms(own) for run, own in self.left_by_run}
        return dict(sorted(left.items(), key=lambda pair: -pair[1]))


@dataclass(frozen=True)
class GapResult:
    """Everything that is written and drawn."""

    verdict: str
    refused: str
    effects: tuple[Effect, ...]
    unit: str
    train: Side
    holdout: Side
    depends: tuple[Dependence, ...]
    unexplained_share: float
    considered: tuple[Considered, ...]
    untestable: tuple[Untestable, ...]
    model: FrictionModel
    seed_model: FrictionModel
    next_experiment: Mapping[str, Any] | None = None
    next_scenario: str = ""  # its file's text
    notes: Sequence[str] = field(default_factory=tuple)
    levels: str = ""  # the one of them on load cells whose levels are not believed
    seed_refuted: Sequence[Any] = field(default_factory=tuple)  # the seed's uncertainty, where the data refute it
    proposals: Sequence[Any] = field(default_factory=tuple)  # laws for what has no name, the simplest first
    adequacy: tuple[Check, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def regions(self) -> tuple[Region, ...]:
        """Where the training runs and the model as it was given disagree; no verdict hangs on it."""
        return tuple(find_regions(self.train.blocks, self.train.before, READ_AS))

    @property
    def depends_on(self) -> tuple[str, ...]:
        """Signals that what is left depends on: those that predict it, else those that the simplest law reads."""
        of_law = tuple(self.proposals[0].declared.reads) if self.proposals else ()
        return tuple(each.signal for each in self.depends) or of_law

    def content(self) -> dict[str, Any]:
        """The JSON document of docs/interfaces.md; further keys only add."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "effects": [effect.content() for effect in self.effects],
            "regions": [{"where": r.where, "share_of_gap": r.share_of_gap, "mean_residual": r.mean_residual}
                        for r in self.regions],
            "gap": {
                "unit": self.unit,
                "train": _before_after(self.train),
                "holdout": {
                    **_before_after(self.holdout),
                    "noise_floor": self.holdout.noise_floor if self.holdout.blocks.y.size else None,
                    "before_ci": list(self.holdout.size_before.interval) if self.holdout.blocks.y.size else None,
                    "after_ci": list(self.holdout.size_after.interval) if self.holdout.blocks.y.size else None,
                    "runs": [run.name for run in self.holdout.runs],
                },
            },
            "unexplained": {
                "depends_on": list(self.depends_on),
                "share_of_gap": self.unexplained_share,
                "reason": self.refused,
            },
            "next_experiment": dict(self.next_experiment) if self.next_experiment else None,
            "untestable": [{"name": u.name, "needs": u.needs, "because": u.because} for u in self.untestable],
            "considered": [
                {"name": c.name, "variant": c.variant, "stage": c.stage, "cv_gain": c.gain, "p_value": c.p_value,
                 "outcome": c.verdict} for c in self.considered],
            "notes": list(self.notes),
            "seed_refuted": [each.content() for each in self.seed_refuted],
            "adequacy": [vars(each) for each in self.adequacy],
            "proposals": [each.content(f"proposal_{k}") for k, each in enumerate(self.proposals, start=1)],
            "provenance": dict(self.provenance),
        }  # fmt: skip


def _before_after(side: Side) -> dict[str, Any]:
    if not side.blocks.y.size:  # nothing that could be looked at
        return dict.fromkeys(("before", "after", "relative_before", "relative_after"))
    return {"before": side.size_before.value, "after": side.size_after.value,
            "relative_before": side.relative[0], "relative_after": side.relative[1]}  # fmt: skip


# -- the verdict
NOTHING, MISSING, AMBIGUOUS, UNEXPLAINED = "nothing_missing", "missing_effect", "ambiguous", "unexplained"
INSUFFICIENT = "insufficient"
POINTS = 0.5  # of the share that tells of something where no effect was found: beside one there is less to point at


@dataclass(frozen=True)
class Verdict:
    """The verdict, and in words why an explanation was refused."""

    kind: str
    refused: str = ""
    leaves: bool = False  # refused for nothing but what the names leave of the training runs
    untold: bool = False  # refused for nothing but the many others that do as well


def decide(cross: CrossFit, selection: Selection, left: Sequence[Dependence], rippled: bool = False) -> Verdict:
    """`left`: what signals predict of the final explanation's remainder; `rippled`: a ripple may be part of it."""
    before, after = max(steady_excess(cross, selection.base), 1e-9), steady_excess(cross, selection.final)
    depends = telling(cross, left)
    if not selection.found:
        strong = any(d.share >= LIMITS.least_unexplained for d in depends)
        strong |= before > LIMITS.never_noise and not rippled
        return Verdict(UNEXPLAINED, "no named effect explains it") if strong else Verdict(NOTHING)
    implausible = [f.slot for f in selection.found if cross.at_bound(selection.final, f.slot)]
    if implausible:
        times = "" if implausible[0].plain else f", {implausible[0].most:g} times what is typical or more"
        return Verdict(UNEXPLAINED, f"{implausible[0].name} would need an implausible size{times}")
    # plain terms that a bare model lacked from the start: several of them may be missing without being an imitation
    if len({f.slot.name for f in selection.found if not f.slot.plain}) > LIMITS.most_named:
        many = selection.final.names
        return Verdict(UNEXPLAINED, f"it would take {len(many)} effects at once to imitate it ({', '.join(many)})")
    whole, whole_before = cross.excess(selection.final), max(cross.excess(selection.base), 1e-9)
    elsewhere = whole > LIMITS.least_excess and whole / whole_before > LIMITS.left_over
    elsewhere &= any(d.share >= LIMITS.least_unexplained for d in depends)
    if keeps_something(after, before, depends) or elsewhere:
        after, before = max((after, before), (whole, whole_before), key=lambda pair: pair[0] / pair[1])
        names = ", ".join(selection.final.names)
        why = f"{names} leaves {100 * after / before:.0f} % of the gap above the noise floor"
        return Verdict(UNEXPLAINED, why, leaves=True)
    if selection.untold:
        return Verdict(UNEXPLAINED, selection.untold, untold=True)
    return Verdict(AMBIGUOUS if any(f.rivals for f in selection.found) else MISSING)


def telling(cross: CrossFit, left: Sequence[Dependence]) -> list[Dependence]:
    """Of what signals predict of a remainder that which is sure and large enough to matter to anybody."""
    return [d for d in left if d.p_value <= LIMITS.remainder_p and d.size >= cross.problem.matters]


def keeps_something(excess: float, before: float, depends: Sequence[Dependence]) -> bool:
    """Whether what an explanation leaves above the noise is more than it may: a share of the excess `before` that is
    large in itself or hangs on a signal."""
    remains = excess > LIMITS.least_excess and excess / before > LIMITS.left_over
    remains |= excess > LIMITS.large_excess and excess / before > LIMITS.small_left_over
    tells = any(d.share >= POINTS * LIMITS.least_unexplained for d in depends)
    return remains and (excess > LIMITS.obvious_excess or tells)


def steady_excess(cross: CrossFit, explanation: Explanation) -> float:
    """Excess of the remainder over the noise variance where the shaft hardly accelerates.

    There the balance holds whatever swings on the wire or rings in the oil, which no friction model is to answer for.
    """
    acceleration = np.abs(cross.problem.blocks.features["acceleration"])
    steady = acceleration <= LIMITS.steady * np.percentile(acceleration, 99)
    chosen = steady if steady.sum() >= LIMITS.fewest_steady else np.ones_like(steady)
    return cross.inside_excess(explanation, chosen)


def named(left: Sequence[Dependence]) -> tuple[Dependence, ...]:
    """The signals that 'unexplained' names, those that are sure first."""
    sure = [d for d in left if d.p_value <= LIMITS.remainder_p and d.share > LIMITS.least_named_share]
    return tuple((sure or [d for d in left if d.share > 0.0])[: LIMITS.most_signals])


def unexplained_share(cross: CrossFit, selection: Selection, verdict: Verdict) -> float:
    """Share of the gap above the noise floor that no named effect explains."""
    before = max(selection.base.loss - cross.floor, 1e-9)
    after = max(selection.final.loss - cross.floor, 0.0)
    if verdict.kind == NOTHING:
        return 0.0
    return float(min(after / before, 1.0)) if selection.found else 1.0
