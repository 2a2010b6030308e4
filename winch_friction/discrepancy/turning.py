"""What shows only just after a reversal: bristles that turn over with travel, and contacts that have grown while at
rest.

The moving regime names everything else first; here its explanation is the base, on samples whose travel since the
reversal is certain but short. Samples at rest take no part: static friction is undetermined there.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.blocks import Slot
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.candidates.friction import SHAPES
from winch_friction.discrepancy.crossfit import CrossFit, Explanation, flip_p_values
from winch_friction.discrepancy.linearise import Expansion, expand_around
from winch_friction.discrepancy.problem import build_problem
from winch_friction.discrepancy.selection import candidate_trials
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane

SIGNIFICANCE = 0.005
# of the held-out RMSE just after reversals, where every imperfection of timing looks like a little presliding
LEAST_GAIN = {"presliding": 0.3, "dwell_stiction": 0.1}
RIVALS = ("presliding", "dwell_stiction", "signal_delay", "stribeck", "coulomb", "viscous")
FEWEST_BLOCKS = 200


@dataclass(frozen=True)
class TurningFinding:
    """One effect of the turning regime: its slot in the regime's own problem, evidence and fit."""

    slot: Slot
    p_value: float
    gain: float
    cross: CrossFit
    fitted: Explanation
    expansion: Expansion


def search_turning(
    runs: Sequence[Run], crane: Crane, seed: FrictionModel, loads: dict[str, float], expansion: Expansion,
    explanation: Explanation, candidates: Sequence[Candidate], train: Sequence[str], rng: np.random.Generator,
    cleaned: Callable[[Expansion], Expansion],
) -> TurningFinding | None:  # fmt: skip
    """The best effect just after reversals, if it is one that only shows there, surely and usefully.

    `cleaned` takes out of the runs what has been found beside the torque balance.
    """
    named = {slot.candidate.name for slot in explanation.slots}
    tried = [each for each in candidates if each.name in (*RIVALS, *named)]
    if "signal_delay" in named:  # with speed and pressure apart, the instant of a reversal is not known well enough
        return None
    turning = cleaned(expand_around(runs, crane, seed, loads, expansion, explanation, tried, turning=True))
    chosen = [run for run in turning.runs if run.name in train and run.moving.any()]
    if sum(int(run.moving.sum()) for run in chosen) < FEWEST_BLOCKS:
        return None
    cross = CrossFit(build_problem(chosen, turning.layout, "turning"))
    kept = [turning.layout.slot_like(slot) for slot in explanation.slots]
    base = cross.explain(kept)
    trials = candidate_trials(cross, base, named)
    if not trials:
        return None
    p = flip_p_values(np.array([base.losses - each.losses for each in trials]), rng)
    best = min(range(len(trials)), key=lambda k: trials[k].loss)
    gain = cross.gain(base, trials[best])
    shape = trials[best].slots[-1].variant.shape
    if shape.get("d_z", 1.0) <= min(SHAPES["d_z"]):  # so short a travel is within the timing's own blur
        return None
    if p[best] > SIGNIFICANCE or gain < LEAST_GAIN.get(trials[best].slots[-1].candidate.name, 1.0):
        return None
    return TurningFinding(trials[best].slots[-1], float(p[best]), float(gain), cross, trials[best], turning)
