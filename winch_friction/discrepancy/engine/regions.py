"""Where a gap lies, in words: regions of the operating space with a share each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks
from winch_friction.discrepancy.engine.chance import varies
from winch_friction.discrepancy.thresholds import LIMITS

AT_ONCE = 8192  # blocks, of which all conditions are looked at together
# a condition whose blocks are so far of one direction says the direction first: at reversals pressures run ahead
ONE_WAY = 0.9
# and one that holds nearly all blocks of that direction says nothing but the direction
SAME_AS_DIRECTION = 0.9
BORDERS = (0.15, 0.33, 0.5, 0.67, 0.85)  # quantiles of a signal: of a half, thirds and what is rare but not single

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
        if not varies(values[good], 1e-6):  # of its size: so little is no condition that anybody can read
            continue
        factor, unit = read_as.get(name.rpartition(".")[2], (1.0, ""))
        for threshold in np.unique(np.quantile(values[good], BORDERS)):
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


def _best(conditions: Sequence[Condition], left: FloatArray) -> Condition | None:
    """The condition, or the pair of two signals, whose mean explains most of what is left."""
    size = len(left)
    if not conditions:
        return None
    both_counts, both_sums = _of_pairs(conditions, left)
    counts, sums = np.diag(both_counts), np.diag(both_sums)
    single = sums**2 / np.maximum(counts, 1.0)
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


def _of_pairs(conditions, left):  # type: ignore[no-untyped-def]
    """How many blocks two conditions share, and the sum of what is left there: (conditions, conditions), of a condition
    with itself its own. All conditions over all blocks of hours are several times what the fits need."""
    counts, sums = np.zeros((len(conditions), len(conditions))), np.zeros((len(conditions), len(conditions)))
    for at in range(0, len(left), AT_ONCE):
        own = np.array([mask[at : at + AT_ONCE] for _, mask, _ in conditions], float)
        counts += own @ own.T
        sums += (own * left[at : at + AT_ONCE]) @ own.T
    return counts, sums
