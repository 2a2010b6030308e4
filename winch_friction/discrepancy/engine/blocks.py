"""A gap and its regressors as block means, and their Gram matrices per segment: after this, every fit is small.

Values are in the gap's unit and weighted by each record's own noise.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS


@dataclass(frozen=True)
class Slot:
    """Where one shape of one candidate has its columns.

    `law` tells the members of one candidate's family apart, `free` marks the flexible one, `plain` what a bare
    model simply lacks.
    `part` tells which of several like things the columns speak of, each of which may follow a law of its own.
    `brings` names candidates that belong to it, `most` is the largest amplitude (in units of its columns) that is
    believed; `origin` is whatever the caller made the columns of.
    """

    name: str
    label: str
    columns: tuple[int, ...]
    brings: tuple[str, ...] = ()
    most: float = float("inf")
    origin: Any = None
    law: str = ""
    free: bool = False
    plain: bool = False
    part: str = ""


@dataclass(frozen=True)
class RunBlocks:
    """The blocks of one record; `position` is the block's number on the record's own grid."""

    y: FloatArray
    x: FloatArray
    segment: np.ndarray
    position: np.ndarray
    features: dict[str, FloatArray]
    direction: FloatArray


@dataclass(frozen=True)
class Blocks:
    """Block means over all records; `x` is (blocks, columns), `weight` one over the noise per block."""

    y: FloatArray
    x: FloatArray
    run: np.ndarray
    segment: np.ndarray  # numbered over all records
    weight: FloatArray
    features: dict[str, FloatArray]
    direction: FloatArray
    position: np.ndarray


@dataclass(frozen=True)
class Grams:
    """Per segment: Gram matrix, b (s, c), y2 (s,), count (s,) in units of the noise; and each segment's record.

    Of the symmetric matrices, the largest thing there is, the upper half is kept, row by row (s, c (c + 1)/2).
    """

    upper: FloatArray
    b: FloatArray
    y2: FloatArray
    count: FloatArray
    run: np.ndarray

    @cached_property
    def _place(self) -> np.ndarray:
        """Where each entry of a matrix stands in its upper half, (c, c)."""
        size = self.b.shape[1]
        rows, columns = np.triu_indices(size)
        place = np.empty((size, size), np.int32)
        place[rows, columns] = place[columns, rows] = np.arange(len(rows))
        return place

    def total(self, own: np.ndarray | None = None) -> FloatArray:
        """The sum over all segments or these, (c, c)."""
        upper = self.upper if own is None else self.upper[own]
        return np.asarray(upper.sum(axis=0)[self._place])

    def part(self, own: np.ndarray, index: np.ndarray) -> FloatArray:
        """The matrices of these segments and columns, (own, index, index)."""
        return np.asarray(self.upper[own[:, None, None], self._place[np.ix_(index, index)]])


def segment_length(total: float) -> float:
    """Seconds per segment for so many seconds of records: tens for a campaign, shorter for a short record."""
    return float(min(max(total / LIMITS.segments_wanted, LIMITS.shortest_segment), LIMITS.longest_segment))


def run_blocks(
    time: FloatArray, gap: FloatArray, columns: Iterable[FloatArray], mask: np.ndarray, direction: FloatArray,
    features: Mapping[str, FloatArray], size: int, length: float,
) -> RunBlocks:  # fmt: skip
    """Means over blocks of `size` samples, of the masked ones; segments are `length` seconds long.

    `columns` come in parts (samples, some columns), each of which is let go once its means are taken: all of them over
    all samples of an hour are a gigabyte.
    """
    starts = np.arange(0, len(time), size)
    counts = np.add.reduceat(mask.astype(float), starts)
    keep = counts >= LIMITS.fullest_block * size
    means = {name: _means(values, starts, counts, mask)[keep] for name, values in features.items()}
    return RunBlocks(
        y=_means(gap, starts, counts, mask)[keep],
        x=np.column_stack([_means(part, starts, counts, mask)[keep] for part in columns]),
        segment=(time[starts[keep]] / length).astype(int),
        position=np.flatnonzero(keep),
        features=means,
        direction=np.sign(_means(direction, starts, counts, mask)[keep]),
    )


def _means(values: FloatArray, starts: np.ndarray, counts: FloatArray, mask: np.ndarray) -> FloatArray:
    """Means over the masked samples of each block; blocks without any give 0."""
    masked = values * (mask[:, None] if values.ndim > 1 else mask)
    sums = np.add.reduceat(masked, starts, axis=0)
    return np.asarray(sums / (np.maximum(counts, 1.0)[:, None] if values.ndim > 1 else np.maximum(counts, 1.0)))


def joined(tables: Sequence[RunBlocks], noise: Mapping[int, float]) -> Blocks:
    """The blocks of several records, weighted by each one's noise."""
    offsets = np.cumsum([0] + [int(t.segment.max(initial=0)) + 1 for t in tables])
    names = list(dict.fromkeys(name for t in tables for name in t.features))
    features = {
        name: np.concatenate([t.features.get(name, np.full(len(t.y), np.nan)) for t in tables]) for name in names
    }
    return Blocks(
        y=np.concatenate([t.y for t in tables]),
        x=_stacked([t.x for t in tables]),
        run=np.concatenate([np.full(len(t.y), k) for k, t in enumerate(tables)]),
        segment=np.concatenate([t.segment + o for t, o in zip(tables, offsets[:-1], strict=True)]),
        weight=np.concatenate([np.full(len(t.y), 1.0 / noise[k]) for k, t in enumerate(tables)]),
        features=features,
        direction=np.concatenate([t.direction for t in tables]),
        position=np.concatenate([t.position for t in tables]),
    )


def grams(blocks: Blocks) -> Grams:
    """Gram matrices of every segment."""
    order = np.argsort(blocks.segment, kind="stable")
    segment, size = blocks.segment[order], blocks.x.shape[1]
    _, starts = np.unique(segment, return_index=True)
    ends = np.append(starts[1:], len(segment))[: len(starts)]
    rows, columns = np.triu_indices(size)
    half = rows * (size + 1) + columns
    upper, b, y2 = np.empty((len(starts), len(half))), np.empty((len(starts), size)), np.empty(len(starts))
    for k, (first, last) in enumerate(zip(starts, ends, strict=True)):
        own = order[first:last]
        z = np.column_stack([blocks.x[own], blocks.y[own]]) * blocks.weight[own, None]
        full = z.T @ z
        np.take(full.ravel(), half, out=upper[k], mode="clip")  # `mode` saves NumPy a copy; no place is outside
        b[k], y2[k] = full[:-1, -1], full[-1, -1]
    return Grams(upper, b, y2, (ends - starts).astype(float), blocks.run[order][starts])


def _stacked(parts: Sequence[FloatArray]) -> FloatArray:
    """Parts behind each other; one alone as it is."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
