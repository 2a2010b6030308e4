"""The load of a run in which nobody measured it, from the balance of torques."""

from collections.abc import Sequence

import numpy as np

from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.discrepancy.preparation.wire_mode import Mode
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane

LOAD_ROUNDS = 6  # friction depends on the load that is sought: the fixed point is reached to 0.1 % by then
LOAD_CONVERGED = 1e-5  # relative; a tenth of what any load cell tells


def estimated_loads(runs: Sequence[Run], crane: Crane, model: FrictionModel) -> dict[str, float]:
    """Mass in kg per run without `hook_load`: what balances the torque once friction has its say.

    Hoisting and lowering weigh alike, so that friction cancels in the mean.
    """
    if not crane.drive.hydraulic:
        return {}
    return {run.name: _estimated_load(run, crane, model) for run in runs if not _weighed(run)}


def _weighed(run: Run) -> bool:
    """Whether a column says what hangs there."""
    return any(name in run for name in ("hook_load", "rope_force", "load_torque"))


def _estimated_load(run: Run, crane: Crane, model: FrictionModel) -> float:
    load, seen = 0.0, None
    for _ in range(LOAD_ROUNDS):
        # a swinging load weighs the same in the mean, so its wire is not looked into
        prepared = prepare(run, crane, model, load, mode=Mode(0.0, 0.0), spikes=np.zeros(1, bool), seen=seen)
        seen = prepared.seen
        gap = prepared.gap[prepared.used] / (prepared.radius[prepared.used] / crane.gear_ratio * GRAVITY)
        direction = prepared.direction[prepared.used]
        sides = [np.median(gap[direction == s]) for s in (-1.0, 1.0) if (direction == s).any()]
        change = float(np.mean(sides)) if sides else 0.0
        load = max(load + change, 0.0)
        if abs(change) < LOAD_CONVERGED * load:
            break
    return load
