"""One run as it is prescribed: what the shaft, the tip, the load, the oil and the gas do."""

from dataclasses import dataclass

import numpy as np

from campaign.third_rig.crane import BAR, GRAVITY, rng_of
from campaign.third_rig.motion import Series, clocks, compensating, hoisting, smooth, turned_over
from campaign.third_rig.plan import AHC, MAIN, Plan

SLIP = 0.003  # rad of the shaft within which friction turns over
HIGHEST_PRESSURE = 300.0  # bar that the load alone may ask for
HIGHEST_GAS = 330.0  # bar
RETURN_OF_GAS = 25.0  # bar, low side of the motors on the gas
POLYTROPIC = 1.25
LEAST_WIRE = 8.0  # m
GENTLE = 0.5  # m/s^2 of the wire
FIRST_GENTLE_DRAW = 2  # draws 0 and 1 were seen with harder ramps


@dataclass(frozen=True)
class Group:
    """Motors that share two pressures."""

    motors: int
    displacement: Series  # m^3/rad, of one motor
    low: Series  # Pa, of its low side
    drop: Series | None = None  # Pa over a motor; without, it carries what the other group leaves


@dataclass(frozen=True)
class Run:
    """Every series has one value per step of the plant, SI, oil in degC."""

    number: int
    mode: str
    layer: int
    started: float  # Unix s
    marked: bool  # effects of some runs are in this one
    share: float  # 0 to 1, for what differs from run to run
    time: Series  # from 0
    speed: Series
    acceleration: Series
    angle: Series
    heave: Series  # m/s, of the crane's tip
    heave_acceleration: Series
    celsius: Series
    wire_out: Series
    mass: Series  # what the load signal says, kg
    groups: dict[str, Group]
    turned_over: Series  # sign of the friction, -1 to 1
    since_reversal: Series  # s
    dwell: Series  # s of the last rest
    travel: Series  # rad since the last start or reversal

    @property
    def balancing(self) -> str:
        """The group that carries what the gas does not."""
        return next(name for name, group in self.groups.items() if group.drop is None)


def draw_runs(plan: Plan, fresh: bool = False) -> list[Run]:
    """The runs to search, or the fresh ones."""
    name = "fresh" if fresh else "run"
    return [
        _draw_run(plan, rng_of(name, plan.draw, plan.key, number), number, fresh)
        for number in range(len(plan.dates[fresh]))
    ]


def _draw_run(plan: Plan, rng: np.random.Generator, number: int, fresh: bool) -> Run:
    crane, options = plan.crane, plan.options
    mode = options.modes[number % len(options.modes)]
    kind = options.kinds[mode][int(rng.integers(len(options.kinds[mode])))]
    seconds = rng.uniform(*options.seconds or (0, 0))
    layer = int(rng.choice(plan.layers))
    radius = crane.radius(layer)
    mass, share = _load(plan, rng, radius)
    speed, heave = _motion(plan, rng, mode, kind, seconds, crane.gear / radius, share)
    time = np.arange(len(speed)) * plan.step
    angle = np.cumsum(speed) * plan.step
    hoisted = radius / crane.gear * angle
    first_wire = _first_wire(plan, rng, float(hoisted.max()))
    warmed = 1 - np.exp(-time / seconds * 1.5)
    celsius = rng.uniform(*options.celsius) + rng.uniform(0, options.warming) * warmed
    wire = -crane.wire_mass * hoisted
    hanging = mass + wire * (mass > 3 * np.abs(wire).max())
    boost = _boost(plan, rng, time)
    group = _sea_groups if mode == AHC else _main_group
    groups = group(plan, rng, seconds, angle, share, boost, mass * GRAVITY * radius / crane.gear)
    offset, differs = rng.uniform(0, 5e3), float(rng.uniform())
    since_reversal, dwell, travel = clocks(speed, plan.step)
    return Run(
        number, mode, layer, float(plan.dates[fresh][number]), bool(plan.marked[fresh][number]), differs, time, speed,
        np.gradient(speed, plan.step), angle + offset, heave, np.gradient(heave, plan.step), celsius,
        first_wire - hoisted, hanging, groups, turned_over(speed, plan.step, SLIP), since_reversal, dwell, travel,
    )  # fmt: skip


def _load(plan: Plan, rng: np.random.Generator, radius: float) -> tuple[float, float]:
    """Mass, kg, and share of the largest displacement at which its pressure stays in bounds."""
    crane, options = plan.crane, plan.options
    mass = float(np.round(crane.rated * rng.choice(options.loads) * rng.uniform(0.9, 1.1), -1))
    share = 1.0
    for _ in range(50):
        share = min(float(np.round(rng.choice(options.displacements) * rng.uniform(0.95, 1.03), 3)), 1.0)
        oil = crane.motors * share * crane.max_displacement  # m^3/rad
        if mass * GRAVITY * radius / crane.gear / oil / BAR < HIGHEST_PRESSURE:
            break
        mass *= 0.93
    return mass, share


def _motion(
    plan: Plan, rng: np.random.Generator, mode: str, kind: str, seconds: float, turns: float, share: float
) -> tuple[Series, Series]:
    top = plan.crane.top_speed
    if mode == AHC:
        return compensating(rng, kind, seconds, plan.step, top, turns)
    top = top * rng.uniform(0.7, 1) * (min(1.0, 0.8 / share) if share > 0.8 else 1)
    steepest = GENTLE * turns if plan.draw >= FIRST_GENTLE_DRAW else np.inf
    speed = hoisting(rng, kind, seconds, plan.step, top, steepest)
    return speed, np.zeros_like(speed)


def _first_wire(plan: Plan, rng: np.random.Generator, hoisted: float) -> float:
    """Wire out at the start, m, so that enough is left."""
    wire = float(rng.uniform(*plan.options.wire_out))
    return wire if wire - hoisted >= LEAST_WIRE else hoisted + LEAST_WIRE + rng.uniform(0, 20)


def _boost(plan: Plan, rng: np.random.Generator, time: Series) -> Series:
    """Pressure of the low side, Pa."""
    boost = rng.uniform(*plan.options.boost) * BAR + 0.6 * BAR * np.sin(2 * np.pi * time / rng.uniform(15, 40))
    if not plan.options.boost_steps:
        return boost
    high = np.sin(2 * np.pi * time / rng.uniform(12, 25) + rng.uniform(0, 6)) > 0
    return boost + BAR * plan.options.boost_steps * smooth(high * 1.0, 0.5 / plan.step)


def _main_group(
    plan: Plan, rng: np.random.Generator, seconds: float, angle: Series, share: float, boost: Series, torque: float
) -> dict[str, Group]:
    largest = plan.crane.max_displacement
    displacement = share * largest * np.ones(len(angle))
    if rng.random() < plan.options.displacement_changes:
        other = np.clip(share * rng.uniform(0.8, 1.2), 0.3, 1)
        time = np.arange(len(angle)) * plan.step
        changed = smooth((time > seconds * rng.uniform(0.35, 0.65)) * 1.0, 1.5 / plan.step)
        displacement = largest * (share + (other - share) * changed)
    return {MAIN: Group(plan.crane.motors, displacement, boost)}


def _sea_groups(
    plan: Plan, rng: np.random.Generator, seconds: float, angle: Series, share: float, boost: Series, torque: float
) -> dict[str, Group]:
    """The gas loses pressure while the winch hoists; `torque` is the load's at the shaft, N m."""
    crane, ones = plan.crane, np.ones(len(angle))
    driven = float(min(1, share * rng.uniform(0.9, 1.25)))
    displacement = share * crane.max_displacement * ones
    carried = rng.uniform(0.85, 1.0)
    charged = min(torque * carried / (crane.passive * displacement[0]), HIGHEST_GAS * BAR)
    room = crane.passive * crane.max_displacement * crane.top_speed * rng.uniform(18, 30)
    volume = room + crane.passive * displacement * (angle - angle.mean())
    drop = (charged + RETURN_OF_GAS * BAR) * (room / volume) ** POLYTROPIC - RETURN_OF_GAS * BAR
    return {
        "active": Group(crane.active, driven * crane.max_displacement * ones, boost),
        "passive": Group(crane.passive, displacement, RETURN_OF_GAS * BAR * ones, drop),
    }
