"""The gap and its regressors as block means, and their Gram matrices per segment: after this, every fit is small.

Everything is in bar of the balancing motor group (N m for an electric drive) and weighted by each run's own noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Variant
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.signals import FloatArray

BLOCK_SAMPLES = 10  # 0.2 s at 50 Hz: the fast noise averages out, friction does not
SEGMENTS_WANTED = 100
LONGEST_SEGMENT, SHORTEST_SEGMENT = 20.0, 1.0  # s


@dataclass(frozen=True)
class Slot:
    """Where one variant of one candidate has its columns."""

    candidate: Candidate
    variant: Variant
    columns: tuple[int, ...]


@dataclass(frozen=True)
class Blocks:
    """Block means of one regime over all runs; `x` is (blocks, columns), `weight` 1/bar per block."""

    y: FloatArray
    x: FloatArray
    run: np.ndarray
    segment: np.ndarray  # numbered over all runs
    weight: FloatArray
    features: dict[str, FloatArray]
    direction: FloatArray
    position: np.ndarray  # of the block on its run's grid


def segment_length(runs: Sequence[PreparedRun]) -> float:
    """Seconds per segment: tens of seconds for a campaign, shorter for a short record."""
    total = sum(run.time[-1] for run in runs)
    return float(min(max(total / SEGMENTS_WANTED, SHORTEST_SEGMENT), LONGEST_SEGMENT))


def block_means(values: FloatArray, starts: np.ndarray, counts: FloatArray, mask: np.ndarray) -> FloatArray:
    """Means over the masked samples of each block; blocks without any give 0."""
    masked = values * (mask[:, None] if values.ndim > 1 else mask)
    sums = np.add.reduceat(masked, starts, axis=0)
    return sums / (np.maximum(counts, 1.0)[:, None] if values.ndim > 1 else np.maximum(counts, 1.0))


@dataclass(frozen=True)
class RunBlocks:
    """The blocks of one run."""

    y: FloatArray
    x: FloatArray
    segment: np.ndarray
    contiguous: np.ndarray  # index of the block in the run's own grid
    features: dict[str, FloatArray]
    direction: FloatArray


def run_blocks(run: PreparedRun, columns: FloatArray, mask: np.ndarray, size: int, length: float) -> RunBlocks:
    """Block means of one run's gap, regressors (N m, scaled) and features, over the masked samples."""
    starts = np.arange(0, len(run.time), size)
    counts = np.add.reduceat(mask.astype(float), starts)
    keep = counts >= 0.6 * size
    y = block_means(run.gap / run.unit_torque, starts, counts, mask)[keep]
    x = block_means(columns / run.unit_torque, starts, counts, mask)[keep]
    features = {name: block_means(values, starts, counts, mask)[keep] for name, values in run.channels.items()}
    direction = np.sign(block_means(run.direction, starts, counts, mask)[keep])
    segment = (run.time[starts[keep]] / length).astype(int)
    return RunBlocks(y, x, segment, np.flatnonzero(keep), features, direction)


@dataclass(frozen=True)
class Grams:
    """Per segment: G (s, c, c), b (s, c), y2 (s,), count (s,), in units of the noise; and the run of each segment."""

    g: FloatArray
    b: FloatArray
    y2: FloatArray
    count: FloatArray
    run: np.ndarray

    def losses(self, columns: Sequence[int], beta: FloatArray) -> FloatArray:
        """Sum of squares of each segment's residual for one coefficient vector, in units of the noise."""
        index = np.asarray(columns)
        g = self.g[:, index[:, None], index]
        return self.y2 - 2.0 * self.b[:, index] @ beta + np.einsum("i,sij,j->s", beta, g, beta)

    def of_runs(self, runs: Sequence[int]) -> "Grams":
        """The segments of these runs."""
        keep = np.isin(self.run, runs)
        return Grams(self.g[keep], self.b[keep], self.y2[keep], self.count[keep], self.run[keep])


def grams(blocks: Blocks) -> Grams:
    """Gram matrices of every segment."""
    z = np.column_stack([blocks.x, blocks.y]) * blocks.weight[:, None]
    order = np.argsort(blocks.segment, kind="stable")
    z, segment = z[order], blocks.segment[order]
    numbers, starts = np.unique(segment, return_index=True)
    ends = np.append(starts[1:], len(segment))
    full = np.stack([z[a:b].T @ z[a:b] for a, b in zip(starts, ends, strict=True)])
    run = blocks.run[order][starts]
    return Grams(full[:, :-1, :-1], full[:, :-1, -1], full[:, -1, -1], (ends - starts).astype(float), run)
