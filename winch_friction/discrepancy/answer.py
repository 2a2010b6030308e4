"""What the workflow found, as one object; `gap.json` is its content."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from winch_friction.discrepancy.adequacy import Check
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate, Untestable
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks
from winch_friction.discrepancy.engine.interval import Size
from winch_friction.discrepancy.engine.omnibus import Dependence
from winch_friction.discrepancy.engine.regions import Region
from winch_friction.discrepancy.engine.selection import Considered
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction import FrictionModel

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

    @property
    def floor(self) -> float:
        """What is left at best: the noise, and what no balance closes better than."""
        return float(np.hypot(self.noise_floor, self.least_noise))

    @property
    def left_by_run(self) -> "list[tuple[PreparedRun, FloatArray]]":
        """Each run with what its blocks keep, in floors."""
        floor = max(self.floor, 1e-12)
        return [(run, self.after[self.blocks.run == k] / floor) for k, run in enumerate(self.runs)]


@dataclass(frozen=True)
class GapResult:
    """Everything that is written and drawn."""

    verdict: str
    refused: str
    effects: tuple[Effect, ...]
    regions: tuple[Region, ...]
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
    seed_refuted: Sequence[Any] = field(default_factory=tuple)  # the seed's uncertainty, where the data refute it
    proposals: Sequence[Any] = field(default_factory=tuple)  # laws for what has no name, the simplest first
    adequacy: tuple[Check, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def content(self) -> dict[str, Any]:
        """The JSON document of docs/interfaces.md; further keys only add."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "effects": [effect.content() for effect in self.effects],
            "regions": [
                {"where": r.where, "share_of_gap": r.share_of_gap, "mean_residual": r.mean_residual} for r in
                self.regions
            ],
            "gap": {
                "unit": self.unit,
                "train": {**_before_after(self.train)},
                "holdout": {
                    **_before_after(self.holdout),
                    "noise_floor": self.holdout.noise_floor if self.holdout.blocks.y.size else None,
                    "before_ci": list(self.holdout.size_before.interval) if self.holdout.blocks.y.size else None,
                    "after_ci": list(self.holdout.size_after.interval) if self.holdout.blocks.y.size else None,
                    "runs": [run.name for run in self.holdout.runs],
                },
            },
            "unexplained": {
                "depends_on": [each.signal for each in self.depends],
                "share_of_gap": self.unexplained_share,
                "reason": self.refused,
            },
            "next_experiment": dict(self.next_experiment) if self.next_experiment else None,
            "untestable": [{"name": u.name, "needs": u.needs, "because": u.because} for u in self.untestable],
            "considered": [
                {"name": c.name, "variant": c.variant, "stage": c.stage, "cv_gain": c.gain, "p_value": c.p_value,
                 "outcome": c.verdict} for c in self.considered
            ],
            "notes": list(self.notes),
            "seed_refuted": [each.content() for each in self.seed_refuted],
            "adequacy": [vars(each) for each in self.adequacy],
            "proposals": [each.content(f"proposal_{k}") for k, each in enumerate(self.proposals, start=1)],
            "provenance": dict(self.provenance),
        }  # fmt: skip


def _before_after(side: Side) -> dict[str, Any]:
    if not side.blocks.y.size:  # nothing that could be looked at
        return dict.fromkeys(("before", "after", "relative_before", "relative_after"))
    return {
        "before": side.size_before.value,
        "after": side.size_after.value,
        "relative_before": side.relative[0],
        "relative_after": side.relative[1],
    }


def relative_error(residual: FloatArray, blocks_torque: FloatArray) -> float:
    """Norm of the residual over the norm of the measured torque."""
    return float(np.sqrt((residual**2).sum() / max(float((blocks_torque**2).sum()), 1e-300)))
