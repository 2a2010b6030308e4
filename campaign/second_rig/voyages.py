"""The runs of a set as a crew would sail them: six staircases, then seas, a hand at the lever and creeping."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Any

import numpy as np

from campaign.second_rig.crane import BAR, GRAVITY, Crane

DAY = 86400.0  # s
STAIRS, REGULAR, IRREGULAR, LEVER, CREEP = "stairs", "regular", "irregular", "joy", "creep"
LATER_RUNS = (REGULAR, IRREGULAR, REGULAR, LEVER, CREEP, IRREGULAR)
LOADS = (0.08, 0.3, 0.55, 0.8, 1.0)  # of the rated one
DISPLACEMENTS = (1.0, 0.7, 1.0, 0.55, 0.85, 1.0)  # of the largest one


@dataclass(frozen=True)
class Logging:
    """How a set is measured and written."""

    rate: float = 50.0  # Hz
    pressure_noise: float = 0.25  # bar
    pressure_range: float = 600.0  # bar, in 4096 steps
    pulses: int = 1024  # of the encoder, per turn
    displacement_noise: float = 7e-4  # relative
    displacement_steps: int = 16384  # of the largest one
    load_noise: float = 4e-4  # relative
    load_steps: int = 8192  # of the rated load
    time_noise: float = 4e-4  # s
    wire: bool = True  # the wire that is paid out is logged
    angle: bool = False  # the shaft's angle is logged
    reference: bool = False  # the wanted speed is logged
    units: int = 0  # which of files.UNITS
    separator: str = ","
    gaps: int = 0  # stretches of 0.3 to 2 s without samples
    blanks: int = 0  # stretches of empty cells in a column


@dataclass(frozen=True)
class Voyage:
    """One run as planned."""

    number: int  # from 0
    kind: str
    mass: float  # kg
    layer: int  # from 1
    seconds: float
    displacement: float  # of the largest one, of the driven motors
    celsius: tuple[float, float]  # of the oil at start and end
    date: float  # s, Unix time of the start
    wire_out: float  # m, at the start
    zeros: dict[tuple[str, str], float]  # Pa, of each group's two transducers
    steps: tuple[float, ...]  # of the top speed, in a staircase
    wave: tuple[float, float]  # m and s: amplitude and period
    angle: float  # rad, of the shaft at the start
    logging: Logging
    boost: float = 25.0  # bar
    stiff: bool = True  # the rope does not stretch
    damping: float = 0.08  # of the load on its rope, 1 is critical
    above: float = 30.0  # m of rope that the log does not count
    wire_weighs: bool = False  # what hangs out of the rope pulls and is weighed

    @property
    def at_sea(self) -> bool:
        """Heave compensation."""
        return self.kind in (REGULAR, IRREGULAR)


@dataclass(frozen=True)
class Options:
    """What a set has of its own."""

    grouping: str = "main"
    runs: int = 12
    celsius: tuple[float, float] = (38.0, 44.0)  # between which a run's oil starts
    logging: Logging = field(default_factory=Logging)
    of_every_run: dict[str, Any] = field(default_factory=dict)  # fields of `Voyage`
    boost_of: Callable[[int], float] | None = None  # bar, by the run's number


def draw_voyages(rng: np.random.Generator, crane: Crane, options: Options) -> list[Voyage]:
    """The set's runs: loads, layers, displacements, oil, dates and seas."""
    rng.choice([10, 20, 50, 100, 200])  # a rate that every set overrides; kept, so that a seed stays the same set
    first = datetime(2024, 3, 1, tzinfo=UTC).timestamp() + rng.uniform(0, 300) * DAY
    zeros = {(group, side): rng.normal(0, 0.004) * BAR for group in ("main", "active", "passive") for side in "ab"}
    layers = sorted({max(1, crane.layers - 2), crane.layers - 1, crane.layers})
    voyages, date = [], first
    for number, kind in enumerate([STAIRS] * 6 + list(LATER_RUNS[: options.runs - 6])):
        voyage = _draw(rng, crane, options, number, kind, layers[number % len(layers)], date, zeros)
        if options.boost_of:
            voyage = replace(voyage, boost=options.boost_of(number))
        voyages.append(voyage)
        date += rng.uniform(0.5, 2) * 3600 if number % 4 != 3 else rng.uniform(5, 20) * DAY
    return voyages


def _draw(
    rng: np.random.Generator, crane: Crane, options: Options, number: int, kind: str, layer: int, date: float,
    zeros: dict[tuple[str, str], float],
) -> Voyage:  # fmt: skip
    share = LOADS[(number * 2) % 5] if kind == STAIRS else float(rng.choice([0.3, 0.55, 0.8]))
    if kind in (CREEP, LEVER):
        share = float(rng.choice([0.3, 0.55, 0.8]))
    seconds = float(rng.choice([120, 160, 200] if kind != STAIRS else [180, 210, 240]))
    least, most = options.celsius
    start = rng.uniform(least, most)
    end = start + rng.uniform(0, min(6, 0.3 * (most - least)))
    mass = share * crane.rated * rng.uniform(0.95, 1.03)
    wire_out = float(rng.uniform(120, 240))
    steps = (0.06, 0.15, 0.35, 0.65, 1.0) if rng.random() < 0.6 else (0.1, 0.25, 0.5, 0.85)
    amplitude, period = rng.uniform(0.5, 1.5), rng.uniform(7, 13)
    angle = float(rng.uniform(0, 100))
    fastest = 0.85 * crane.top_speed * crane.radii[layer - 1] / crane.gear  # m/s
    room = fastest * period / 2 / np.pi if kind == REGULAR else 0.8 * fastest * period / 2 / np.pi
    displacement = _displacement(crane, share, layer, DISPLACEMENTS[number % 6])
    drawn = Voyage(
        number, kind, mass, layer, seconds, displacement, (start, end), date, wire_out, zeros, steps,
        (min(amplitude, room), period), angle, options.logging,
    )  # fmt: skip
    return replace(drawn, **options.of_every_run)


def _displacement(crane: Crane, share: float, layer: int, wanted: float) -> float:
    """Share of the largest one at which the load's pressure stays under 80 % of the rated one."""
    torque = share * crane.rated * GRAVITY * crane.radii[layer - 1] / crane.gear * 1.25
    needed = torque / (crane.motors * crane.max_displacement) / (0.82 * crane.rated_pressure)
    return float(np.clip(max(wanted, needed), 0.3, 1.0))
