"""The cases of the hard gap campaign and the runs of each."""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from campaign.rig import CATALOGUE, FLAVOURS, make_dataset, suitable_flavours

FIRST_SEED = 300_000
POOR, RATES, FAR, PROOFS = 300, 54, 36, 27 * 2  # standard counts
OTHER_RATES = (10.0, 200.0)  # Hz
RIG_RATE = 50.0  # Hz


@dataclass(frozen=True)
class HardCase:
    """One data set: `runs` of the twelve, cut to `seconds`, logged at `rate` Hz; far: seeds 1.5 to 1.8 sigma away."""

    kind: str  # poor, rate, far, proof
    effect: str  # '' for a null
    flavour: str
    seed: int
    runs: int = 12
    seconds: float = 240.0
    rate: float = RIG_RATE
    idle: bool = False
    sigma: tuple[float, float] = (0.0, 1.5)

    @property
    def key(self) -> str:
        """Its name in the results file."""
        still = "/idle" if self.idle else ""
        hidden = self.effect or "nothing"
        return (
            f"{self.kind}/{hidden}/{self.flavour}/{self.seed}/{self.runs}x{self.seconds:.3g}s@{self.rate:.3g}Hz{still}"
        )


def all_cases(quick: bool, first_seed: int = FIRST_SEED) -> list[HardCase]:
    """Every case, the kinds in turn, so that a part of them speaks for all."""
    seeds = itertools.count(first_seed)
    share = 3 if quick else 1
    kinds = [
        [_poor(next(seeds)) for _ in range(POOR // share)],
        [_rate(k, next(seeds)) for k in range(RATES // share)],
        [_far(k, next(seeds)) for k in range(FAR // share)],
        [_proof(k, next(seeds)) for k in range(max(PROOFS // share, 27))],
    ]
    longest = max(map(len, kinds))
    # the longer a kind, the more often its turn comes
    places = [((j + 0.5) * longest / len(kind), k, j) for k, kind in enumerate(kinds) for j in range(len(kind))]
    return [kinds[k][j] for _, k, j in sorted(places)]


def _poor(seed: int) -> HardCase:
    rng = np.random.default_rng([seed, 1])
    effect = "" if rng.random() < 0.4 else str(rng.choice(list(CATALOGUE)))
    flavour = str(rng.choice(suitable_flavours(effect) if effect else list(FLAVOURS)))
    seconds = float(np.exp(rng.uniform(np.log(2.0), np.log(240.0))))
    rate = float(rng.choice([1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 50.0, 100.0, 200.0, 1000.0]))
    return HardCase("poor", effect, flavour, seed, int(rng.integers(1, 13)), seconds, rate, bool(rng.random() < 0.1))


def _rate(k: int, seed: int) -> HardCase:
    effects = ["", *CATALOGUE]
    effect = effects[(k // 2) % len(effects)]
    flavours = suitable_flavours(effect) if effect else list(FLAVOURS)
    return HardCase("rate", effect, flavours[k % len(flavours)], seed, rate=OTHER_RATES[k % 2])


def _far(k: int, seed: int) -> HardCase:
    return HardCase("far", "", list(FLAVOURS)[k % len(FLAVOURS)], seed, sigma=(1.5, 1.8))


def _proof(k: int, seed: int) -> HardCase:
    effect = list(CATALOGUE)[k % len(CATALOGUE)]
    flavours = suitable_flavours(effect)
    return HardCase("proof", effect, flavours[(k + k // len(CATALOGUE)) % len(flavours)], seed)


def runs_of(case: HardCase, fresh: bool = False) -> list[Any]:
    """The case's runs; `fresh`: the same plant and plan with other noise, sea and durations."""
    from winch_friction.physics.signals import Run

    effects = [(case.effect, 1.0)] if case.effect else []
    length = 0.8 if fresh else 1.0
    data = make_dataset(case.seed, case.flavour, effects, length=length, sigma=case.sigma)
    rng = np.random.default_rng([case.seed, 2])
    chosen = sorted(rng.choice(12, case.runs, replace=False))
    return [Run(f"run_{k + 1:02d}", _logged(data[k], case, rng)) for k in chosen]


def _logged(columns: dict[str, np.ndarray], case: HardCase, rng: np.random.Generator) -> dict[str, np.ndarray]:
    time = columns["time"] - columns["time"][0]
    begin = rng.uniform(0.0, max(time[-1] - case.seconds, 0.0))
    own = {name: values[(time >= begin) & (time <= begin + case.seconds)] for name, values in columns.items()}
    if case.idle:
        own["motor_speed"] = rng.normal(0.0, 0.02, len(own["time"]))
    if case.rate == RIG_RATE:
        return own
    at = np.arange(own["time"][0], own["time"][-1], 1.0 / case.rate)
    if case.rate < RIG_RATE:  # a slower logger takes instants; it does not average
        index = np.searchsorted(own["time"], at).clip(max=len(own["time"]) - 1)
        return {name: values[index] for name, values in own.items()} | {"time": at}
    # a faster one sees the same signals with more of the same noise
    noisy = {"motor_speed": 0.05, "pressure_a": 2e4, "pressure_b": 2e4}
    return {
        name: at if name == "time" else np.interp(at, own["time"], values)
        + rng.normal(0.0, noisy.get(name.rpartition(".")[2], 0.0), len(at))
        for name, values in own.items()
    }  # fmt: skip
