"""The hanging mass of runs whose load was not recorded: what balances the torque once friction has its say."""

from collections.abc import Sequence

import numpy as np

from winch_friction.discrepancy.preparation.prepare import prepare
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.units import GRAVITY
from winch_friction.physics.winch import Crane

ROUNDS = 6


def estimated_loads(runs: Sequence[Run], crane: Crane, model: FrictionModel) -> dict[str, float]:
    """Mass in kg per run without `hook_load`; hoisting and lowering weigh alike, so that friction cancels in the
    mean."""
    if crane.electric:
        return {}
    return {run.name: _estimated(run, crane, model) for run in runs if "hook_load" not in run}


def _estimated(run: Run, crane: Crane, model: FrictionModel) -> float:
    load = 0.0
    for _ in range(ROUNDS):
        prepared = prepare(run, crane, model, load)
        gap = prepared.gap[prepared.moving] / (prepared.radius[prepared.moving] / crane.gear_ratio * GRAVITY)
        direction = prepared.direction[prepared.moving]
        sides = [np.median(gap[direction == s]) for s in (-1.0, 1.0) if (direction == s).any()]
        load = max(load + float(np.mean(sides)), 0.0)
    return load
