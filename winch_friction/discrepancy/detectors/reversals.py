"""What shows only just after a reversal: bristles that turn over with travel, and contacts that have grown while at
rest.

The moving regime names everything else first; here its explanation is the base, on samples whose travel since the
reversal is certain but short. Samples at rest take no part: static friction is undetermined there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from winch_friction.discrepancy.candidates.candidate import MOVING, REVERSALS, Candidate, Shape
from winch_friction.discrepancy.candidates.friction import blurred_travel
from winch_friction.discrepancy.candidates.geometry import GAS
from winch_friction.discrepancy.candidates.signals import DELAY
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import chance_of_no_gain
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, candidate_trials, flip_p_values
from winch_friction.discrepancy.expansion import Expansion, Given, expand_around
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import build_problem
from winch_friction.discrepancy.thresholds import LIMITS

SIGNIFICANCE_AFTER_REVERSALS = 0.005
FEWEST_BLOCKS = 200


@dataclass(frozen=True)
class ReversalFinding:
    """One effect of the turning regime: its slot in the regime's own problem, evidence and fit."""

    slot: Slot
    p_value: float
    gain: float
    cross: CrossFit
    fitted: Explanation
    base: Explanation  # the same without it
    expansion: Expansion

    def holds_on(self, names: Sequence[str], rng: np.random.Generator) -> bool:
        """Whether it also shrinks the gap just after reversals of runs that it was not fitted to, each run by its own
        noise: one whose reversals are blurred would otherwise speak for all."""
        chosen = [run for run in self.expansion.runs if run.name in names and run.used.any()]
        if not chosen:
            return False
        blocks = build_problem(chosen, self.expansion.layout, by_sample=True).blocks
        columns = self.cross.problem.columns
        without, with_it = (
            (blocks.y - blocks.x[:, list(columns(each.slots))] @ each.beta) * blocks.weight
            for each in (self.base, self.fitted)
        )
        return chance_of_no_gain(without, with_it, blocks.segment, blocks.run, rng) <= LIMITS.proof_p


def too_short(candidate: Candidate, shape: Shape, runs: Sequence[PreparedRun]) -> bool:
    """Whether a travel is over before the instant of a reversal is known."""
    if candidate.shortest is None:
        return False
    name, least = candidate.shortest
    return shape.values[name] <= max(least, blurred_travel(runs))


def detect(
    given: Given, expansion: Expansion, explanation: Explanation, candidates: Sequence[Candidate],
    train: Sequence[str], rng: np.random.Generator, cleaned: Callable[[Expansion], Expansion],
) -> ReversalFinding | None:  # fmt: skip
    """The best effect just after reversals, if it is one that only shows there, surely and usefully.

    `cleaned` takes out of the runs what has been found beside the torque balance.
    """
    named = {slot.name for slot in explanation.slots}
    balanced = [each for each in candidates if each.regime in (MOVING, REVERSALS)]
    tried = [each for each in balanced if each.reversal_rival or each.name in named]
    if DELAY in named:  # with speed and pressure apart, the instant of a reversal is not known well enough
        return None
    turning = cleaned(expand_around(given, expansion, explanation, tried, turning=True))
    if GAS in named:  # what its law has wrong is largest where the passive side's motion turns
        turning = replace(turning, runs=tuple(run for run in turning.runs if len(run.groups) < 2))
    chosen = [run for run in turning.runs if run.name in train and run.used.any()]
    if sum(int(run.used.sum()) for run in chosen) < FEWEST_BLOCKS:
        return None
    cross = CrossFit(build_problem(chosen, turning.layout, by_sample=True))
    kept = [turning.layout.slot_like(slot) for slot in explanation.slots]
    base = cross.explain(kept)
    trials = candidate_trials(cross, base, named)
    if not trials:
        return None
    p = flip_p_values(np.array([base.losses - each.losses for each in trials]), rng)
    best = min(range(len(trials)), key=lambda k: trials[k].loss)
    gain = cross.gain(base, trials[best])
    candidate, shape = trials[best].slots[-1].origin
    if too_short(candidate, shape, chosen) or cross.at_bound(trials[best], trials[best].slots[-1]):
        return None
    # what a named effect's law leaves of itself is its own second order, here as elsewhere
    own = max(cross.explain(()).loss - base.loss, 0.0) if kept else 0.0
    if base.loss - trials[best].loss < LIMITS.small_left_over * own:
        return None
    # what swings, rings or is squeezed after a reversal is imitated in part; what is there is most of it
    if base.loss - trials[best].loss < LIMITS.reversal_share * (base.loss - cross.floor):
        return None
    least = 1.0 if candidate.reversal_gain is None else candidate.reversal_gain
    if p[best] > SIGNIFICANCE_AFTER_REVERSALS or gain < least:
        return None
    return ReversalFinding(trials[best].slots[-1], float(p[best]), float(gain), cross, trials[best], base, turning)
