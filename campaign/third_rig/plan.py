"""What is drawn of a set before its runs: the winch, the habits of its owner, the dates and the transducers' zeros."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from campaign.third_rig.crane import BAR, Crane, Figures, draw_crane, draw_figures, rng_of

MAIN, AHC = "main", "ahc"  # all motors driven; heave compensation with some on the gas
STEPS, JOYSTICK, RAMP, REGULAR, IRREGULAR = "steps", "joystick", "ramp", "regular", "irregular"
FIRST_DAY = 1.79e9  # Unix s
DAY = 86400.0  # s
BETWEEN = 400.0  # s from one run to the next, at least
LATEST_PRESSURE = 0.3  # of a sample


@dataclass(frozen=True)
class Options:
    """How a winch is run and logged; ranges are least and most."""

    modes: tuple[str, ...] = (MAIN,)  # in turn
    kinds: Mapping[str, tuple[str, ...]] = field(
        default_factory=lambda: {MAIN: (STEPS, JOYSTICK, RAMP), AHC: (REGULAR, IRREGULAR)}
    )
    runs: tuple[int, int] = (8, 12)
    seconds: tuple[float, float] | None = None  # of a run; by the rate if not said
    days: float = 30.0  # over which the runs lie
    loads: tuple[float, ...] = (0.12, 0.3, 0.5, 0.75, 0.95)  # of the rated one
    displacements: tuple[float, ...] = (0.4, 0.55, 0.7, 0.85, 1.0)  # of the largest one
    displacement_changes: float = 0.3  # share of the runs in which it does
    layers: tuple[int, ...] | Literal["all"] | None = None  # three drawn ones if not said
    wire_out: tuple[float, float] = (40.0, 250.0)  # m
    celsius: tuple[float, float] = (22.0, 52.0)  # of the oil at the start
    warming: float = 6.0  # K, at most
    boost: tuple[float, float] = (20.0, 30.0)  # bar
    boost_steps: float = 0.0  # bar
    elastic: bool = False  # wire; its stiffness is in the crane file then
    damping: float = 0.03  # of the load on its wire, 1 is critical
    rate: int = 50  # Hz
    pulses: int = 0  # of the encoder per turn; 0 is a noisy analogue speed
    speed_noise: float = 0.1  # rad/s
    pressure_noise: float = 0.3  # bar
    pressure_lag: float = 0.002  # s
    rpm: bool = True  # speed in rpm rather than rad/s
    reference: bool = False  # log the speed reference
    calculated: bool = False  # the passive pressure is reckoned from the gas, not measured
    stribeck: bool = True  # has the seed the term
    zero_tolerance: float = 0.0  # bar, of a transducer, stated in the model file


@dataclass(frozen=True)
class Plan:
    """A drawn set; the second of `dates` and `marked` is of the fresh runs."""

    key: str
    draw: int
    crane: Crane
    figures: Figures
    options: Options
    layers: tuple[int, ...]
    dates: tuple[NDArray[np.float64], NDArray[np.float64]]  # Unix s
    marked: tuple[NDArray[np.bool_], NDArray[np.bool_]]  # runs in which an effect of some runs is there
    stiffness: float  # N, what the wire really has
    zeros: dict[str, float]  # Pa, by channel

    @property
    def step(self) -> float:
        """Of the plant, s."""
        return min(0.002, 1 / self.options.rate / 2)


def draw_plan(key: str, draw: int, options: Mapping[str, Any]) -> Plan:
    """Draw a set; `options` stand above what is drawn of `Options`."""
    rng = rng_of("third", draw, key)
    habits = _habits(rng, options)
    crane = draw_crane(rng, AHC in habits.modes)
    figures = draw_figures(rng, crane)
    layers = _layers(habits, len(crane.radii), rng.integers(1, len(crane.radii) + 1, 3))
    count = int(rng.integers(habits.runs[0], habits.runs[1] + 1))
    later = int(rng.integers(4, 7))
    dates = np.sort(rng.uniform(0, habits.days * DAY, count)) + np.arange(count) * BETWEEN
    later_dates = np.sort(rng.uniform(0, habits.days * DAY, later)) + np.arange(later) * BETWEEN + BETWEEN / 2
    marked = np.ones(count, bool)
    marked[rng.permutation(count)[: int(count * 0.45)]] = False
    later_marked = rng.random(later) < 0.5
    later_marked[0] = True
    stiffness = float(rng.uniform(0.95, 1.05)) * crane.wire_stiffness
    dated = (np.round(FIRST_DAY + dates), np.round(FIRST_DAY + later_dates))
    zeros = _zeros(rng, habits)
    return Plan(key, draw, crane, figures, habits, layers, dated, (marked, later_marked), stiffness, zeros)


def _habits(rng: np.random.Generator, said: Mapping[str, Any]) -> Options:
    rate = int(rng.choice([10, 20, 25, 50, 50, 100, 100, 200]))
    drawn = Options(
        rate=rate,
        pressure_noise=float(np.round(rng.uniform(0.15, 0.45), 2)),
        speed_noise=float(np.round(rng.uniform(0.03, 0.15), 3)),
        modes=((MAIN,), (MAIN, MAIN, AHC), (MAIN, AHC), (AHC,))[int(rng.choice(4, p=[0.35, 0.25, 0.25, 0.15]))],
        rpm=bool(rng.random() < 0.6),
        elastic=bool(rng.random() < 0.6),
        damping=float(rng.uniform(0.02, 0.05)),
        reference=bool(rng.random() < 0.25),
        days=float(rng.choice([0.5, 10, 60])),
        pulses=(4096 if rate == 100 else 2048) if rate in (50, 100) and rng.random() < 0.4 else 0,
        pressure_lag=float(rng.uniform(0, 0.15) / rate),
    )
    habits = replace(drawn, **said)
    lag = min(habits.pressure_lag, LATEST_PRESSURE / habits.rate)
    return replace(habits, pressure_lag=lag, seconds=habits.seconds or _seconds(habits.rate))


def _seconds(rate: float) -> tuple[float, float]:
    """Of a run, least and most; faster logs are shorter."""
    return (90, 160) if rate <= 25 else (50, 95) if rate <= 60 else (35, 60)


def _layers(habits: Options, count: int, drawn: NDArray[np.int64]) -> tuple[int, ...]:
    if habits.layers == "all":
        return tuple(range(1, count + 1))
    return habits.layers or tuple(sorted({int(each) for each in drawn}))


def _zeros(rng: np.random.Generator, habits: Options) -> dict[str, float]:
    if not habits.zero_tolerance:
        return {}
    driven = (MAIN,) if MAIN in habits.modes else ()
    groups = (*driven, "active", "passive") if AHC in habits.modes else driven
    scale = habits.zero_tolerance * BAR
    return {f"{group}.pressure_a": float(np.clip(rng.normal(), -1.5, 1.5) * scale) for group in groups}
