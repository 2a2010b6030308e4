"""A gap and its regressors as block means, and their Gram matrices per fold: after this, every fit is small.

Values are in the gap's unit and weighted by each record's own noise.
"""

import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.noise import Made
from winch_friction.discrepancy.thresholds import LIMITS

AT_ONCE = 8  # columns, 12 MB over an hour at 50 Hz


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
class Means:
    """Columns whose means over the blocks of a record are known already, (blocks, columns)."""

    values: FloatArray


@dataclass(frozen=True)
class RunBlocks:
    """The blocks of one record; `position` is the block's number on the record's own grid, `made` says how."""

    y: FloatArray
    x: FloatArray
    segment: np.ndarray
    position: np.ndarray
    features: dict[str, FloatArray]
    direction: FloatArray
    made: Made | None = None


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
    """Gram matrices of every part, the segments of one record that one fold leaves out: b (p, c), y2 (p,), and each
    part's record; and of every segment its fold, and the number of its blocks.

    Of the symmetric matrices, the largest thing there is, the upper half is kept, row by row (p, c (c + 1)/2). The
    blocks of a segment stand together in `order`, from its place in `starts` on.
    """

    upper: FloatArray
    b: FloatArray
    y2: FloatArray
    run: np.ndarray
    part_fold: np.ndarray
    fold: np.ndarray
    count: FloatArray
    order: np.ndarray
    starts: np.ndarray

    def total(self, fold: int | None = None) -> tuple[FloatArray, FloatArray]:
        """The sums over all parts or those of a fold: (c, c) and (c,)."""
        own = slice(None) if fold is None else self.part_fold == fold
        whole = self.upper[own].sum(axis=0).take(_both_halves(self.b.shape[1]))
        return whole, np.asarray(self.b[own].sum(axis=0))

    def by_segment(self, values: FloatArray) -> FloatArray:
        """Sums over the blocks of every segment: (s,)."""
        return np.add.reduceat(values[self.order], self.starts) if len(self.starts) else np.zeros(0)

    def of_segments(self, values: np.ndarray) -> np.ndarray:
        """What every segment has, for each of its blocks: (blocks, ...)."""
        found = np.empty((len(self.order), *values.shape[1:]), values.dtype)
        found[self.order] = np.repeat(values, self.count.astype(int), axis=0)
        return found


@lru_cache(maxsize=1)
def _both_halves(size: int) -> np.ndarray:
    """Where the upper half, row by row, has the entries of a symmetric matrix: (size, size)."""
    rows, columns = np.triu_indices(size)
    places = np.empty((size, size), np.intp)
    places[rows, columns] = places[columns, rows] = np.arange(len(rows))
    return places


def on_disk(blocks: Blocks) -> Blocks:
    """The same blocks with their columns in a file without a name, of which memory holds what is read; as they are
    where no disk has room."""
    try:
        with tempfile.TemporaryFile() as file:
            blocks.x.T.tofile(file)
            file.flush()
            kept = np.memmap(file, blocks.x.dtype, "r", shape=blocks.x.T.shape)
    except OSError:
        return blocks
    return replace(blocks, x=np.asarray(kept).T)


def segment_length(total: float) -> float:
    """Seconds per segment for so many seconds of records: tens for a campaign, shorter for a short record."""
    return float(min(max(total / LIMITS.segments_wanted, LIMITS.shortest_segment), LIMITS.longest_segment))


def run_blocks(
    time: FloatArray, gap: FloatArray, columns: Iterable[FloatArray | Means], mask: np.ndarray, direction: FloatArray,
    features: Mapping[str, FloatArray], size: int, length: float, into: FloatArray | None = None,
    made: Made | None = None,
) -> RunBlocks:  # fmt: skip
    """Means over blocks of `size` samples, of the masked ones; segments are `length` seconds long.

    `columns` come in parts (samples, some columns), over all samples or over those of `usable_samples`, each of which
    is let go once its means are taken: all of them over all samples of an hour are a gigabyte; or as the `Means` that
    they have, where these were asked for before. The means go `into` a place of the right size (columns, blocks) where
    one is given: those of many records are half a gigabyte, for which there is no room twice.
    """
    starts, _, keep, _ = _usable(mask, size)
    means_of = block_means(mask, size)
    return RunBlocks(
        y=means_of(gap),
        x=_beside_each_other((p.values if isinstance(p, Means) else means_of(p) for p in columns), into),
        segment=(time[starts[keep]] / length).astype(int),
        position=np.flatnonzero(keep),
        features={name: means_of(values) for name, values in features.items()},
        direction=np.sign(means_of(direction)),
        made=made,
    )


def block_means(mask: np.ndarray, size: int) -> Callable[[FloatArray], FloatArray]:
    """What takes means over blocks of `size` samples, of the masked ones, of values over all or `usable_samples`."""
    _, counts, keep, own = _usable(mask, size)
    weights, places = mask[own].astype(float), size * np.arange(keep.sum())

    def means_of(values: FloatArray) -> FloatArray:
        return _means(values if len(values) == len(weights) else values[own], places, counts[keep], weights)

    return means_of


def usable_blocks(mask: np.ndarray, size: int) -> int:
    """How many blocks of `size` samples have enough masked ones."""
    return int(_usable(mask, size)[2].sum())


def usable_samples(mask: np.ndarray, size: int) -> np.ndarray | slice:
    """The samples of the blocks that have enough masked ones, which alone any mean is taken of."""
    return _usable(mask, size)[3]


def samples_of(columns: FloatArray, own: np.ndarray | slice) -> FloatArray:
    """These samples of columns (samples, columns), column by column in memory."""
    return columns if isinstance(own, slice) else np.array([each[own] for each in columns.T]).T


def _usable(mask: np.ndarray, size: int) -> tuple[np.ndarray, FloatArray, np.ndarray, np.ndarray | slice]:
    """Where blocks begin, how many masked samples each has, whether these are enough, and the samples of those."""
    starts = np.arange(0, len(mask), size)
    counts = np.add.reduceat(mask.astype(float), starts)
    keep = counts >= LIMITS.fullest_block * size
    return starts, counts, keep, slice(None) if keep.all() else np.repeat(keep, size)[: len(mask)]


def _means(values: FloatArray, starts: np.ndarray, counts: FloatArray, weights: FloatArray) -> FloatArray:
    """Means over the samples of each block that have the weight 1 and not 0."""
    if not len(starts):
        return np.zeros((0, *values.shape[1:]))
    sums = np.add.reduceat(values * (weights[:, None] if values.ndim > 1 else weights), starts, axis=0)
    return np.asarray(sums / (counts[:, None] if values.ndim > 1 else counts))


def scaled(columns: FloatArray, scales: FloatArray, unit: float) -> Iterator[FloatArray]:
    """Columns in units of their scales, as shares of a `unit`, a few at a time: a surface has as many as all laws."""
    for at in range(0, columns.shape[1], AT_ONCE):
        some = columns[:, at : at + AT_ONCE] * scales[at : at + AT_ONCE]
        some /= unit
        yield some


def without_column(table: RunBlocks, column: int) -> RunBlocks:
    """A table without what one of its columns could explain, which is taken out of the others where they stand."""
    own = table.x[:, column]
    square = float(own @ own)
    if square <= 0.0:
        return table
    y = table.y - own * (own @ table.y / square)
    table.x[...] -= np.outer(own, own @ table.x / square)
    return replace(table, y=y)


def _beside_each_other(parts: Iterable[FloatArray], into: FloatArray | None) -> FloatArray:
    if into is None:
        return np.column_stack(list(parts))
    at = 0
    for part in parts:
        into[at : at + part.shape[1]] = part.T
        at += part.shape[1]
    return into.T


def joined(tables: Sequence[RunBlocks], noise: Mapping[int, float], x: FloatArray | None = None) -> Blocks:
    """The blocks of several records, weighted by each one's noise; `x`: their columns, where these stand together."""
    offsets = np.cumsum([0] + [int(t.segment.max(initial=0)) + 1 for t in tables])
    names = list(dict.fromkeys(name for t in tables for name in t.features))
    features = {
        name: np.concatenate([t.features.get(name, np.full(len(t.y), np.nan)) for t in tables]) for name in names
    }
    return Blocks(
        y=np.concatenate([t.y for t in tables]),
        x=_stacked([t.x for t in tables]) if x is None else x,
        run=np.concatenate([np.full(len(t.y), k) for k, t in enumerate(tables)]),
        segment=np.concatenate([t.segment + o for t, o in zip(tables, offsets[:-1], strict=True)]),
        weight=np.concatenate([np.full(len(t.y), 1.0 / noise[k]) for k, t in enumerate(tables)]),
        features=features,
        direction=np.concatenate([t.direction for t in tables]),
        position=np.concatenate([t.position for t in tables]),
    )


def first_halves(blocks: Blocks) -> np.ndarray:
    """Whether each block is one of the first half of its record's, (blocks,)."""
    half = np.zeros(int(blocks.run.max(initial=-1)) + 1)
    for k in np.unique(blocks.run):
        half[k] = np.median(blocks.position[blocks.run == k])
    return np.asarray(blocks.position <= half[blocks.run])


def grams(blocks: Blocks) -> Grams:
    """Gram matrices of every part, and which blocks are a segment's."""
    order = np.argsort(blocks.segment, kind="stable")
    _, starts, count = np.unique(blocks.segment[order], return_index=True, return_counts=True)
    run, size = blocks.run[order][starts], blocks.x.shape[1]
    fold = np.unique(_folds(run), return_inverse=True)[1]  # numbered from 0
    pairs, part = np.unique(np.column_stack([run, fold]), axis=0, return_inverse=True)
    part_of_block = np.repeat(part.ravel(), count)
    half = np.ravel_multi_index(np.triu_indices(size), (size + 1, size + 1))
    upper, b, y2 = np.empty((len(pairs), len(half))), np.empty((len(pairs), size)), np.empty(len(pairs))
    for k in range(len(pairs)):
        own = stretch(order[part_of_block == k])
        weight = blocks.weight[own]
        z = np.empty((size + 1, len(weight))).T
        np.multiply(blocks.x[own], weight[:, None], out=z[:, :size])
        np.multiply(blocks.y[own], weight, out=z[:, size])
        full = z.T @ z
        np.take(full.ravel(), half, out=upper[k], mode="clip")  # `mode` saves NumPy a copy; no place is outside
        b[k], y2[k] = full[:-1, -1], full[-1, -1]
    return Grams(upper, b, y2, pairs[:, 0], pairs[:, 1], fold, count.astype(float), order, starts)


def _folds(run: np.ndarray) -> np.ndarray:
    """The fold that leaves each segment out: its record, or of few records a stretch of time."""
    if len(np.unique(run)) >= LIMITS.fewest_runs:
        return run
    return np.arange(len(run)) * min(LIMITS.folds, len(run)) // len(run)


def stretch(places: np.ndarray) -> np.ndarray | slice:
    """Places that follow each other as the stretch that they are, which is read where it stands."""
    return slice(places[0], places[-1] + 1) if len(places) and (np.diff(places) == 1).all() else places


def _stacked(parts: Sequence[FloatArray]) -> FloatArray:
    """Parts behind each other, column by column in memory: a fit asks for a few columns of all blocks."""
    return np.concatenate([part.T for part in parts], axis=1).T
