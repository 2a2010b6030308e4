"""A gap and its regressors as block means, and their Gram matrices per fold: after this, every fit is small.

Values are in the gap's unit and weighted by each record's own noise. Where the gap lies is said in words, as regions
of the operating space with a share each.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def on_their_own(slots: Sequence[Slot]) -> list[Slot]:
    """Those of a name of their own: not what a bare model lacks, nor what another of them always brings along."""
    return [own for own in slots if not own.plain and not any(own.name in each.brings for each in slots)]


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
        size = self.b.shape[1]
        rows, columns = np.triu_indices(size)
        whole = np.empty((size, size))
        whole[rows, columns] = whole[columns, rows] = self.upper[own].sum(axis=0)
        return whole, np.asarray(self.b[own].sum(axis=0))

    def by_segment(self, values: FloatArray) -> FloatArray:
        """Sums over the blocks of every segment: (s,)."""
        return np.add.reduceat(values[self.order], self.starts) if len(self.starts) else np.zeros(0)

    def of_segments(self, values: np.ndarray) -> np.ndarray:
        """What every segment has, for each of its blocks: (blocks, ...)."""
        found = np.empty((len(self.order), *values.shape[1:]), values.dtype)
        found[self.order] = np.repeat(values, self.count.astype(int), axis=0)
        return found


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
    """Gram matrices of every part, and which blocks are a segment's."""
    order = np.argsort(blocks.segment, kind="stable")
    _, starts, count = np.unique(blocks.segment[order], return_index=True, return_counts=True)
    run, size = blocks.run[order][starts], blocks.x.shape[1]
    fold = np.unique(_folds(run), return_inverse=True)[1]  # numbered from 0
    pairs, part = np.unique(np.column_stack([run, fold]), axis=0, return_inverse=True)
    part_of_block = np.repeat(part.ravel(), count)
    rows, columns = np.triu_indices(size)
    half = rows * (size + 1) + columns
    upper, b, y2 = np.empty((len(pairs), len(half))), np.empty((len(pairs), size)), np.empty(len(pairs))
    for k in range(len(pairs)):
        own = order[part_of_block == k]
        z = np.column_stack([blocks.x[own], blocks.y[own]]) * blocks.weight[own, None]
        full = z.T @ z
        np.take(full.ravel(), half, out=upper[k], mode="clip")  # `mode` saves NumPy a copy; no place is outside
        b[k], y2[k] = full[:-1, -1], full[-1, -1]
    return Grams(upper, b, y2, pairs[:, 0], pairs[:, 1], fold, count.astype(float), order, starts)


def _folds(run: np.ndarray) -> np.ndarray:
    """The fold that leaves each segment out: its record, or of few records a stretch of time."""
    if len(np.unique(run)) >= LIMITS.fewest_runs:
        return run
    return np.arange(len(run)) * min(LIMITS.folds, len(run)) // len(run)


def _stacked(parts: Sequence[FloatArray]) -> FloatArray:
    """Parts behind each other, column by column in memory: a fit asks for a few columns of all blocks."""
    return np.concatenate([part.T for part in parts], axis=1).T


# -- regions of the operating space

# a condition whose blocks are so far of one direction says the direction first: at reversals pressures run ahead
ONE_WAY = 0.9
# and one that holds nearly all blocks of that direction says nothing but the direction
SAME_AS_DIRECTION = 0.9

Mask = NDArray[np.bool_]
Condition = tuple[str, Mask, tuple[str, ...]]  # its words, its blocks, the signals in it
ReadAs = Mapping[str, tuple[float, str]]  # how people read a signal: factor and unit, by the last part of its name


@dataclass(frozen=True)
class Region:
    """A part of the operating space: its words, its share of the summed squared gap, its mean in the gap's unit."""

    where: str
    share_of_gap: float
    mean_residual: float
    signals: tuple[str, ...]


def find_regions(blocks: Blocks, residual: FloatArray, read_as: ReadAs) -> list[Region]:
    """Up to three regions in which the residual is large and of one sign, the largest share first."""
    conditions = _conditions(blocks, read_as)
    total = float((residual**2).sum()) or 1.0
    left = residual.copy()
    regions: list[Region] = []
    for _ in range(LIMITS.most_regions):
        best = _best(conditions, left)
        if best is None:
            break
        words, mask, signals = best
        share = float((residual[mask] ** 2).sum()) / total
        regions.append(Region(words, share, float(residual[mask].mean()), signals))
        left = np.where(mask, 0.0, left)
    return sorted(regions, key=lambda each: -each.share_of_gap)


def _conditions(blocks: Blocks, read_as: ReadAs) -> list[Condition]:
    found: list[Condition] = [
        ("hoisting", blocks.direction > 0, ("direction",)),
        ("lowering", blocks.direction < 0, ("direction",)),
    ]
    for name, values in blocks.features.items():
        good = np.isfinite(values)
        if good.sum() < 20 or np.ptp(values[good]) <= 1e-6 * (np.abs(values[good]).max() + 1e-12):
            continue
        factor, unit = read_as.get(name.rpartition(".")[2], (1.0, ""))
        for threshold in np.unique(np.quantile(values[good], (0.15, 0.33, 0.5, 0.67, 0.85))):
            text = f"{threshold * factor:.3g} {unit}".strip()
            found += _directed(blocks.direction, f"{name} < {text}", good & (values < threshold), name)
            found += _directed(blocks.direction, f"{name} > {text}", good & (values > threshold), name)
    least = LIMITS.smallest_region * len(blocks.y)
    return [(words, mask, signals) for words, mask, signals in found if mask.sum() >= least]


def _directed(direction: FloatArray, words: str, mask: Mask, name: str) -> list[Condition]:
    """The condition with the direction said where its blocks have one; none where it is nothing but the direction."""
    for way, sign in (("hoisting", 1), ("lowering", -1)):
        own = direction == sign
        if own.all() or not mask.any() or own[mask].mean() < ONE_WAY:
            continue
        same = mask[own].mean() >= SAME_AS_DIRECTION
        return [] if same else [(f"{words} and {way}", mask & own, (name, "direction"))]
    return [(words, mask, (name,))]


def _best(conditions, left):  # type: ignore[no-untyped-def]
    """The condition, or the pair of two signals, whose mean explains most of what is left."""
    size = len(left)
    masks = np.array([mask for _, mask, _ in conditions], float)
    if not len(masks):
        return None
    counts, sums = masks.sum(axis=1), masks @ left
    single = sums**2 / np.maximum(counts, 1.0)
    both_counts, both_sums = masks @ masks.T, (masks * left) @ masks.T
    pairs = np.where(both_counts >= LIMITS.smallest_region * size, both_sums**2 / np.maximum(both_counts, 1.0), 0.0)
    names = [name for _, _, name in conditions]
    for first, second in combinations(range(len(names)), 2):
        if set(names[first]) & set(names[second]):
            pairs[first, second] = pairs[second, first] = 0.0
    k = int(np.argmax(single))
    i, j = (int(each) for each in np.unravel_index(int(np.argmax(pairs)), pairs.shape))
    if max(single[k], pairs[i, j]) <= 0.0:
        return None
    if single[k] >= LIMITS.single_condition * pairs[i, j]:
        return conditions[k]
    first, second = sorted((i, j), key=lambda c: "direction" in names[c])
    words = f"{conditions[first][0]} and {conditions[second][0]}"
    return words, conditions[first][1] & conditions[second][1], (*names[first], *names[second])
