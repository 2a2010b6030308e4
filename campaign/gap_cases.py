"""The cases of the gap campaign: what is hidden, in which flavour of data, from which seed."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from campaign.rig import CATALOGUE, DRAWN, DRAWN_LAW, FLAVOURS, LAWS, OUTSIDE, suitable_flavours

NEAR, FAR = (0.0, 1.5), (2.0, 3.0)  # sigma
# structurally the same trace (docs/physics.md §3), so not a pair of two
_TIED = ({"gear_load_loss", "sheave_bending"}, {"pressure_offset", "tare_load"}, {"brake_drag", "wear_drift"})


@dataclass(frozen=True)
class Case:
    """One data set to be diagnosed."""

    # null, single, pair, outside; over drawn cranes: drawn_null, law, held_out, drawn_law, far_seed, drawn_outside
    kind: str
    effects: tuple[tuple[str, float], ...]
    flavour: str
    seed: int
    sigma: tuple[float, float] = NEAR  # how far the base parameters lie from the seed model, least and most

    @property
    def key(self) -> str:
        """Its name in the results file."""
        hidden = "+".join(f"{name}*{size:g}" for name, size in self.effects) or "nothing"
        return f"{self.kind}/{hidden}/{self.flavour}/{self.seed}"


@dataclass(frozen=True)
class Counts:
    """How many data sets of each kind."""

    nulls: int = 200
    seeds: int = 10
    small_seeds: int = 10  # at 0.3
    tiny_seeds: int = 10  # at 0.1
    pairs: int = 20
    pair_seeds: int = 5
    outside_seeds: int = 10
    # over drawn cranes, seed models, test plans and rates
    drawn_nulls: int = 300
    far_seeds: int = 40  # nulls whose seed model is 2 to 3 sigma off in every parameter
    law_seeds: int = 2  # of every law that the package has
    held_seeds: int = 3  # of every law that it has not
    drawn_seeds: int = 5  # of a law per cause whose exponents are drawn as well
    drawn_outside: int = 5


QUICK = Counts(
    nulls=2, seeds=1, small_seeds=0, tiny_seeds=0, pairs=1, pair_seeds=1, outside_seeds=0,
    drawn_nulls=1, far_seeds=1, law_seeds=0, held_seeds=0, drawn_seeds=0, drawn_outside=0,
)  # fmt: skip


def all_cases(counts: Counts, first_seed: int) -> list[Case]:
    """Every case, the most telling first: nulls, full size, 0.3, outside, pairs, 0.1. No seed is used twice."""
    seeds = itertools.count(first_seed)
    blocks = (
        _nulls(counts.nulls, seeds),
        _singles(1.0, counts.seeds, seeds),
        _singles(0.3, counts.small_seeds, seeds),
        _outside(counts.outside_seeds, seeds),
        _pairs(counts.pairs, counts.pair_seeds, seeds),
        _singles(0.1, counts.tiny_seeds, seeds),
        _drawn(counts, seeds),
    )
    return [case for block in blocks for case in block]


def _drawn(counts: Counts, seeds: Iterator[int]) -> list[Case]:
    """What nobody has tuned to: cranes, seed models, plans and rates drawn, laws that the package has and has not."""
    cases = [Case("drawn_null", (), DRAWN, next(seeds)) for _ in range(counts.drawn_nulls)]
    cases += [Case("far_seed", (), DRAWN, next(seeds), FAR) for _ in range(counts.far_seeds)]
    for cause, laws in LAWS.items():
        for law in laws:
            effects = ((f"{cause}:{law.name}", 1.0),)
            kind, count = ("held_out", counts.held_seeds) if law.held_out else ("law", counts.law_seeds)
            kind, count = ("drawn_law", counts.drawn_seeds) if law.name == DRAWN_LAW else (kind, count)
            cases += [Case(kind, effects, DRAWN, next(seeds)) for _ in range(count)]
    for effect in OUTSIDE:
        cases += [Case("drawn_outside", ((effect, 1.0),), DRAWN, next(seeds)) for _ in range(counts.drawn_outside)]
    return cases


def _nulls(count: int, seeds: Iterator[int]) -> list[Case]:
    names = list(FLAVOURS)
    return [Case("null", (), names[k % len(names)], next(seeds)) for k in range(count)]


def _singles(size: float, count: int, seeds: Iterator[int]) -> list[Case]:
    return [
        Case("single", ((effect, size),), _flavour([effect], k + offset), next(seeds))
        for k in range(count)
        for offset, effect in enumerate(CATALOGUE)
    ]


def _outside(count: int, seeds: Iterator[int]) -> list[Case]:
    return [
        Case("outside", ((effect, 1.0),), _flavour([effect], k + offset), next(seeds))
        for k in range(count)
        for offset, effect in enumerate(OUTSIDE, start=1)
    ]


def _pairs(pairs: int, count: int, seeds: Iterator[int]) -> list[Case]:
    chosen = list(itertools.islice(_pair_names(), pairs))
    return [
        Case("pair", tuple((name, 1.0) for name in pair), _flavour(list(pair), k + offset), next(seeds))
        for k in range(count)
        for offset, pair in enumerate(chosen)
    ]


def _pair_names() -> Iterator[tuple[str, str]]:
    """Pairs in a fixed random order, so that the first twenty visit most effects."""
    rng = np.random.default_rng(20)
    while True:
        order = list(rng.permutation(list(CATALOGUE)))
        for first, second in zip(order[::2], order[1::2], strict=False):
            if not any({first, second} <= tied for tied in _TIED) and _shared_flavours([first, second]):
                yield str(first), str(second)


def _shared_flavours(effects: list[str]) -> list[str]:
    return [name for name in FLAVOURS if all(name in suitable_flavours(effect) for effect in effects)]


def _flavour(effects: list[str], k: int) -> str:
    flavours = _shared_flavours(effects)
    return flavours[k % len(flavours)]
