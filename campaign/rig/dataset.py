"""A data set: eight constant-speed cycles and four heave compensation runs of one crane."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple
from zlib import crc32

import numpy as np

from campaign.rig import instruments, profiles
from campaign.rig.draws import draw_flavour
from campaign.rig.effects import NEEDS_CHANNEL
from campaign.rig.flavour import FLAVOURS, Flavour
from campaign.rig.hidden import Hidden
from campaign.rig.laws import cause_of
from campaign.rig.oil import relative_viscosity
from campaign.rig.plant import STEP, new_output, simulate
from campaign.rig.sizes import strengths
from campaign.rig.truth import BAR, CM3_PER_REV, GRAVITY, RPM, Friction, draw_friction
from campaign.rig.world import SHIPPED, World, draw_world

Columns = dict[str, np.ndarray]
EPOCH = 1_700_000_000.0  # Unix time of the first run
APART = 300.0  # s between the starts of two runs at least: the longest takes 240
SETTLES = 6.0  # how many times over all dates what creeps comes nearer by a factor of e
DRAINS_IN = 40.0  # s, by when all but a part in e of what waits between PLC and logger is worked off
WANDERS_IN = 70.0  # s, from one quiet time of the network to the next
DRAWN = "drawn"  # the flavour of a crane, seed model, test plan and instruments that are drawn from the data set's seed


class RunPlant(NamedTuple):
    """The plant's constants of one run, SI."""

    drive_motors: float
    drive_displacement: float
    passive_motors: float
    passive_displacement: float
    load: float
    radius: float
    layer: float
    wire_out: float
    inertia: float
    boost: float
    gas_pressure: float
    leakage: float
    modulus: float
    pump_lag: float
    position_gain: float
    wire_stiffness: float  # N/m at the run's beginning, 0: rigid; it follows the wire paid out
    wire_damping: float  # N s/m
    date: float  # 0 at the first run, 1 at the last
    gear: float
    max_displacement: float
    wire_mass: float
    largest_static: float
    line_volume: float
    gas_volume: float  # m^3 at 300 bar
    boost_valve: float  # m^3/s/Pa
    brake_hangs: float  # 1: the run has whatever the brake does


@dataclass(frozen=True)
class Plan:
    """What one run is to do."""

    ahc: bool
    load: float  # kg
    displacement: float  # m^3/rad of the driving motors
    layer: int
    boost: float  # Pa
    celsius: float  # at the start
    start: float  # Unix time, s
    date: float


def suitable_flavours(effect: str) -> list[str]:
    """Flavours whose channels and test plan can show an effect at all."""
    need = NEEDS_CHANNEL.get(cause_of(effect))
    tests = {
        None: lambda f: True,
        "several_layers": lambda f: len(f.layers) > 1,
        "gas_is_calculated": lambda f: f.gas_is_calculated,
        "weeks": lambda f: f.days > 14,
    }
    test = tests.get(need, lambda f: need in f.channels)
    full = {name: flavour for name, flavour in FLAVOURS.items() if flavour.channels}
    return [name for name, flavour in full.items() if test(flavour)]


def world_of(seed: int, flavour: str) -> World:
    """The crane of a data set, as its owner knows it."""
    return draw_world(np.random.default_rng([seed, 11])) if flavour == DRAWN else SHIPPED


def make_dataset(
    seed: int,
    flavour: str,
    effects: Sequence[tuple[str, float]] = (),
    truth: Friction | None = None,
    length: float = 1.0,
    sigma: tuple[float, float] = (0.0, 1.5),
) -> list[Columns]:
    """Twelve runs as SI columns under the names of docs/interfaces.md.

    `effects` are (identifier, size) with size 1 the catalogue's typical size; `identifier` is a cause, `cause:law` or
    an outside effect. Flavour "drawn": crane, seed model, test plan and instruments come from the seed (`world_of`).
    `truth` fixes the base parameters, else they are drawn so many `sigma` (least, most) from the seed model; `length`
    multiplies the runs' duration of 170-240 s.
    Raises KeyError for an unknown flavour or effect.
    """
    names = tuple(name for name, _ in effects)
    world = world_of(seed, flavour)
    style = draw_flavour(np.random.default_rng([seed, 12]), world, names) if flavour == DRAWN else FLAVOURS[flavour]
    rng = np.random.default_rng([seed, crc32(flavour.encode())])
    truth = truth or draw_friction(rng, style.uniform_truth, sigma[1], world.seed, sigma[0])
    # a stream of its own, so that the same seed without the effect is the same crane in the same sea
    own = np.random.default_rng([seed, 7, 7])
    hidden = Hidden(**strengths(list(effects), own, truth, world))
    hangs = own.permutation(12) < round(12 * min(hidden.brake_every, hidden.delay_every))
    hangs = hangs * (own.uniform(0.0, 2.0, 12) if hidden.brake_spread > 0.0 else 1.0)
    return [
        _run(plan, style, world, truth, hidden, length, float(hangs[k]), rng)
        for k, plan in enumerate(_plans(style, rng))
    ]


def _plans(style: Flavour, rng: np.random.Generator) -> list[Plan]:
    loads = [*style.loads, *style.ahc_loads]
    displacements = [*style.displacements, *style.ahc_displacements]
    days = np.concatenate([[0.0], np.sort(rng.uniform(0, 1, 10)), [1.0]])
    for k in range(1, 12):  # one winch makes one run at a time
        days[k] = max(days[k], days[k - 1] + APART / 86400 / style.days)
    days = days[rng.permutation(12)]
    celsius = rng.permutation(np.linspace(*style.temperatures, 12))
    layers = rng.permutation(np.resize(style.layers, 12))
    return [
        Plan(
            k >= 8, loads[k] * 1e3 * rng.uniform(0.98, 1.02), displacements[k] * CM3_PER_REV, int(layers[k]),
            style.boost[k % len(style.boost)] * BAR, celsius[k], EPOCH + 86400 * style.days * days[k], days[k],
        )
        for k in range(12)
    ]  # fmt: skip


def _run(
    plan: Plan, style: Flavour, world: World, truth: Friction, hidden: Hidden, length: float, hangs: float,
    rng: np.random.Generator,
) -> Columns:  # fmt: skip
    duration = length * rng.uniform(170, 240)
    plant = _plant(plan, style, world, hidden, hangs, rng)
    if plan.ahc:
        heave = profiles.sea(style.irregular_sea, duration, rng.uniform(0.45, 0.95), rng)
        heave = profiles.calm_end(heave)
        reference = -heave * world.gear / world.radii[plan.layer - 1]
    else:
        top = min(style.top_speed * RPM, 0.95 * world.pump_flow / (plant.drive_motors * plant.drive_displacement))
        reference = profiles.cycle(style, top, duration, rng)
        heave = np.zeros_like(reference)
    tip = heave if plan.ahc and style.crane_moves else np.zeros_like(heave)
    steps = len(reference)
    celsius = plan.celsius + rng.uniform(0, 4) * np.linspace(0, 1, steps)
    lead = int(style.pump_lag / STEP)  # the controller looks ahead by the pump's lag
    ahead = np.append(reference[lead:], np.zeros(lead))
    out = new_output(steps)
    acceleration = np.gradient(tip, STEP)
    viscosity = relative_viscosity(celsius, hidden.oil_law, hidden.oil_reference)
    simulate(truth, hidden, plant, ahead, tip, acceleration, celsius, viscosity, out)
    return _log(plan, style, world, plant, hidden, out, (reference, tip, celsius), rng)


def _plant(
    plan: Plan, style: Flavour, world: World, hidden: Hidden, hangs: float, rng: np.random.Generator
) -> RunPlant:
    radius = world.radii[plan.layer - 1]
    gas = style.gas_pressure * BAR * rng.uniform(0.97, 1.03)
    passive_motors = float(world.passive) if plan.ahc else 0.0
    motors = world.motors - passive_motors
    static = plan.load * GRAVITY * radius / world.gear
    passive = static / (world.passive * (gas - plan.boost)) if plan.ahc else 0.0
    wire_out = rng.uniform(50, 400) + 250 * (len(world.radii) - plan.layer)
    sunk = hidden.radius_load * static / world.largest_static
    active_size = world.active * world.motor_size / 3.0  # oil volumes and valves grow with the flow
    return RunPlant(
        motors, plan.displacement, passive_motors, min(passive, world.max_displacement), plan.load,
        radius * (1 + hidden.radius_step * (max(style.layers) - plan.layer) - sunk), float(plan.layer),
        wire_out, world.inertia, plan.boost, gas,
        motors * world.motor_size * 5e-12 * rng.uniform(0.5, 2.0), 1.0e9 * rng.uniform(0.9, 1.1), style.pump_lag,
        0.5 if plan.ahc else 0.0, world.wire_stiffness / wire_out if style.wire_damping else 0.0,
        _wire_damping(style, world, plan, wire_out), plan.date, world.gear, world.max_displacement, world.wire_mass,
        world.largest_static, world.line_volume, 1.6 * world.passive * world.motor_size / 8.0, 1e-8 * active_size,
        hangs,
    )  # fmt: skip


def _wire_damping(style: Flavour, world: World, plan: Plan, wire_out: float) -> float:
    """N s/m: given as such, or, below 1, as the damping ratio of the load on its wire."""
    if style.wire_damping >= 1.0:
        return style.wire_damping
    return 2.0 * style.wire_damping * float(np.sqrt(world.wire_stiffness / wire_out * plan.load))


def _log(
    plan: Plan,
    style: Flavour,
    world: World,
    plant: RunPlant,
    hidden: Hidden,
    out: np.ndarray,
    wanted: tuple[np.ndarray, np.ndarray, np.ndarray],
    rng: np.random.Generator,
) -> Columns:
    """The run as its PLC wrote it down."""
    _, angle, p_a, p_b, gas, gas_law = out
    reference, tip, celsius = wanted
    index, stamp = instruments.sampling(out.shape[1], 1.0 / style.rate, style.jitter, rng)
    delay = hidden.delay if hidden.delay_every == 1.0 else hidden.delay * plant.brake_hangs
    delay = delay + hidden.delay_swing * np.mod(stamp / hidden.delay_fills_in, 1.0)
    worked_off = np.exp(-stamp / DRAINS_IN)
    delay = delay + hidden.delay_drains * worked_off + hidden.delay_settles * (1.0 - worked_off)
    delay = delay + hidden.delay_wanders * np.sin(np.pi * stamp / WANDERS_IN) ** 2
    late, early = (delay, 0.0 * delay) if style.pressure_is_late else (0.0 * delay, delay)
    at = np.clip(np.round(index - late / STEP).astype(int), 0, None)
    group = "active" if plan.ahc else "main"
    there = plant.date > hidden.pressure_after
    warm = (celsius[index] - 40.0) / 15.0
    offset = hidden.pressure_offset * there + hidden.pressure_drift * plant.date + hidden.pressure_warm * warm
    offset += hidden.pressure_settles * (1.0 - np.exp(-SETTLES * plant.date))
    gain = hidden.pressure_scale + hidden.pressure_curve * p_a[at] / (200 * BAR)
    gain += hidden.pressure_bend * np.maximum(1.0 - 150 * BAR / np.maximum(p_a[at], BAR), 0.0)
    gain += hidden.pressure_s * np.sin(2.0 * np.pi * p_a[at] / (320 * BAR))
    shown = instruments.filtered(angle, hidden.speed_filter) if hidden.speed_filter > 0.0 else angle
    play = hidden.swivel_play * (1.0 if (plan.start // 60) % 2 else -1.0) + hidden.swivel_warm * warm
    columns: Columns = {
        "time": plan.start + stamp,
        "motor_speed": instruments.encoder_speed(shown, index, early, style, rng),
        f"{group}.pressure_a": instruments.pressure(p_a, at, style, rng, offset, gain),
        f"{group}.pressure_b": instruments.pressure(p_b, at, style, rng, hidden.pressure_offset_b),
        f"{group}.displacement": _swash(plant.drive_displacement, hidden, play, world, len(index), rng),
    }
    if plan.ahc:
        columns["passive.pressure_a"] = instruments.pressure(
            gas_law if style.gas_is_calculated else gas, at, style, rng,
            hidden.pressure_offset_passive, hidden.pressure_scale_passive,
        )  # fmt: skip
        columns["passive.pressure_b"] = instruments.pressure(np.full_like(gas, plant.boost), at, style, rng)
        columns["passive.displacement"] = _swash(plant.passive_displacement, hidden, play, world, len(index), rng)
        if style.crane_moves:
            columns["heave_velocity"] = tip[index] + rng.normal(0, 0.003, len(index))
    return columns | _optional(style, world, plan, plant, angle, (reference, celsius), index, rng)


def _swash(
    true: float, hidden: Hidden, play: np.ndarray, world: World, size: int, rng: np.random.Generator
) -> np.ndarray:
    noise = rng.normal(0, 0.15, size) * CM3_PER_REV * world.motor_size
    x = true / world.max_displacement
    bow = 4.0 * hidden.swivel_mid * x * (1.0 - x)
    bow += hidden.swivel_s * np.sin(2.0 * np.pi * x) - hidden.swivel_stop * (np.maximum(x - 0.6, 0.0) / 0.4) ** 2
    return true * (1.0 + hidden.swivel_gain) + hidden.swivel + bow + play + noise


def _optional(
    style: Flavour, world: World, plan: Plan, plant: RunPlant, angle: Any, wanted: Any, index: Any,
    rng: np.random.Generator,
) -> Columns:  # fmt: skip
    reference, celsius = wanted
    turned = angle[index]
    available = {
        "speed_reference": reference[index],
        "hook_load": plan.load + instruments.noise(len(index), 150.0 * world.capacity, 0.5 ** (50.0 / style.rate), rng),
        "oil_temperature": np.round(celsius[index] + rng.normal(0, 0.1, len(index)), 1),
        "wire_layer": np.full(len(index), float(plan.layer)),
        "wire_out": np.round(plant.wire_out - turned * world.radii[plan.layer - 1] / world.gear, 2),
        "shaft_angle": turned + rng.normal(0, 0.003, len(index)),
    }
    return {name: available[name] for name in style.channels}
