"""The proof: the repaired model's file, read back, against runs that nothing before has looked at.

Before and after are evaluated alike: the file's corrections taken out, the balance closed with its terms, nothing
fitted. What is claimed is what a user of the file gets.
"""

from collections.abc import Sequence

import numpy as np

from winch_friction.discrepancy.answer import Side, relative_error
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks, joined, run_blocks, segment_length
from winch_friction.discrepancy.engine.interval import rms_with_interval
from winch_friction.discrepancy.engine.noise import noise_of_run
from winch_friction.discrepancy.expansion import Given, meet
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch import Crane
from winch_friction.records.model_file import model_from_text, model_to_text


def read_back(model: FrictionModel) -> FrictionModel:
    """The model as whoever loads its file gets it."""
    return model_from_text(model_to_text(model), f"repaired model of '{model.name}'")


def both_sides(
    given: Given, runs: Sequence[Run], crane: Crane, repaired: FrictionModel, train: Sequence[str],
    holdout: Sequence[str], rng: np.random.Generator,
) -> tuple[Side, Side]:  # fmt: skip
    """Training and locked runs before and after the repair; `runs` as they were measured, `repaired` as read back."""
    after = meet(runs, crane, repaired)
    train_side = compare(given, after, train, rng)
    return train_side, compare(given, after, holdout, rng)


def compare(before: Given, after: Given, names: Sequence[str], rng: np.random.Generator) -> Side:
    """The gap of these runs with either model, over the blocks that both can use."""
    pairs = [(a, b) for a, b in zip(before.prepared, after.prepared, strict=True) if a.name in names]
    length = segment_length(sum(old.time[-1] for old, _ in pairs))
    tables = [_blocks(old, new, length) for old, new in pairs]
    blocks = joined(tables, dict.fromkeys(range(len(pairs)), 1.0))
    y_before, y_after = blocks.y, blocks.x[:, 0]
    noise = np.array([_noise(y_after, blocks, k) for k in range(len(pairs))])
    floor = np.sqrt(np.mean(noise[blocks.run] ** 2)) if len(blocks.run) else 0.0
    runs = tuple(old for old, _ in pairs)
    torque = np.array([_drive(run) for run in runs])[blocks.run]
    return Side(
        runs=runs, blocks=blocks, before=y_before, after=y_after,
        size_before=rms_with_interval(y_before, blocks.segment, rng),
        size_after=rms_with_interval(y_after, blocks.segment, rng), noise_floor=float(floor),
        relative=(relative_error(y_before, torque), relative_error(y_after, torque)),
    )  # fmt: skip


def _blocks(old: PreparedRun, new: PreparedRun, length: float):  # type: ignore[no-untyped-def]
    at = old.time + old.start
    own = new.time + new.start
    inside = (at >= own[0] - 1e-9) & (at <= own[-1] + 1e-9)
    used = old.used & inside & (np.interp(at, own, new.used.astype(float)) > 0.99)
    gap = np.interp(at, own, new.gap) / new.unit_torque
    return run_blocks(
        old.time,
        old.gap / old.unit_torque,
        gap[:, None],
        used,
        old.direction,
        old.channels,
        LIMITS.block_samples,
        length,
    )


def _noise(values: FloatArray, blocks: Blocks, k: int) -> float:
    """Independent noise of one run, in the gap's unit."""
    own = blocks.run == k
    return noise_of_run(values[own], blocks.position[own]) if own.any() else 0.0


def _drive(run: PreparedRun) -> float:
    """RMS of a run's measured drive while moving, in the gap's unit."""
    if not run.used.any():
        return 0.0
    return float(np.sqrt(np.mean(((run.gap + run.predicted)[run.used] / run.unit_torque) ** 2)))
