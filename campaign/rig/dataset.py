"""A data set: eight constant-speed cycles and four heave compensation runs of one crane."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple
from zlib import crc32

import numpy as np

from campaign.rig import instruments, profiles
from campaign.rig.effects import NEEDS_CHANNEL, strengths
from campaign.rig.flavour import FLAVOURS, Flavour
from campaign.rig.hidden import Hidden
from campaign.rig.oil import relative_viscosity
from campaign.rig.plant import STEP, new_output, simulate
from campaign.rig.truth import (
    BAR,
    CM3_PER_REV,
    GEAR,
    GRAVITY,
    INERTIA,
    MAX_DISPLACEMENT,
    PUMP_FLOW,
    RADII,
    RPM,
    WIRE_STIFFNESS,
    Friction,
    draw_friction,
)

Columns = dict[str, np.ndarray]
EPOCH = 1_700_000_000.0  # Unix time of the first run


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
    wire_stiffness: float  # N/m, 0: rigid
    wire_damping: float  # N s/m
    date: float  # 0 at the first run, 1 at the last


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
    need = NEEDS_CHANNEL.get(effect)
    tests = {
        None: lambda f: True,
        "several_layers": lambda f: len(f.layers) > 1,
        "gas_is_calculated": lambda f: f.gas_is_calculated,
        "weeks": lambda f: f.days > 14,
    }
    test = tests.get(need, lambda f: need in f.channels)
    full = {name: flavour for name, flavour in FLAVOURS.items() if flavour.channels}
    return [name for name, flavour in full.items() if test(flavour)]


def make_dataset(
    seed: int,
    flavour: str,
    effects: Sequence[tuple[str, float]] = (),
    truth: Friction | None = None,
    length: float = 1.0,
) -> list[Columns]:
    """Twelve runs as SI columns under the names of docs/interfaces.md.

    `effects` are (identifier, size) with size 1 the catalogue's typical size; `truth` fixes the base parameters, else
    they are drawn within 1.5 sigma of the shipped prior; `length` multiplies the runs' duration of 170-240 s.
    Raises KeyError for an unknown flavour or effect.
    """
    style = FLAVOURS[flavour]
    rng = np.random.default_rng([seed, crc32(flavour.encode())])
    truth = truth or draw_friction(rng, style.uniform_truth)
    # a stream of its own, so that the same seed without the effect is the same crane in the same sea
    hidden = Hidden(**strengths(list(effects), np.random.default_rng([seed, 7, 7]), truth))
    return [_run(plan, style, truth, hidden, length, rng) for plan in _plans(style, rng)]


def _plans(style: Flavour, rng: np.random.Generator) -> list[Plan]:
    loads = [*style.loads, *style.ahc_loads]
    displacements = [*style.displacements, *style.ahc_displacements]
    days = np.concatenate([[0.0], np.sort(rng.uniform(0, 1, 10)), [1.0]])
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
    plan: Plan, style: Flavour, truth: Friction, hidden: Hidden, length: float, rng: np.random.Generator
) -> Columns:
    duration = length * rng.uniform(170, 240)
    plant = _plant(plan, style, hidden, rng)
    if plan.ahc:
        heave = profiles.sea(style.irregular_sea, duration, rng.uniform(0.45, 0.95), rng)
        heave = profiles.calm_end(heave)
        reference = -heave * GEAR / RADII[plan.layer - 1]
    else:
        top = min(style.top_speed * RPM, 0.95 * PUMP_FLOW / (plant.drive_motors * plant.drive_displacement))
        reference = profiles.cycle(style, top, duration, rng)
        heave = np.zeros_like(reference)
    tip = heave if plan.ahc and style.crane_moves else np.zeros_like(heave)
    steps = len(reference)
    celsius = plan.celsius + rng.uniform(0, 4) * np.linspace(0, 1, steps)
    lead = int(style.pump_lag / STEP)  # the controller looks ahead by the pump's lag
    ahead = np.append(reference[lead:], np.zeros(lead))
    out = new_output(steps)
    acceleration = np.gradient(tip, STEP)
    simulate(truth, hidden, plant, ahead, tip, acceleration, celsius, relative_viscosity(celsius), out)
    return _log(plan, style, plant, hidden, out, (reference, tip, celsius), rng)


def _plant(plan: Plan, style: Flavour, hidden: Hidden, rng: np.random.Generator) -> RunPlant:
    radius = RADII[plan.layer - 1]
    gas = style.gas_pressure * BAR * rng.uniform(0.97, 1.03)
    motors, passive_motors = (3.0, 8.0) if plan.ahc else (11.0, 0.0)
    passive = plan.load * GRAVITY * radius / GEAR / (8 * (gas - plan.boost)) if plan.ahc else 0.0
    wire_out = rng.uniform(50, 400) + 250 * (6 - plan.layer)
    return RunPlant(
        motors, plan.displacement, passive_motors, min(passive, MAX_DISPLACEMENT), plan.load,
        radius * (1 + hidden.radius_step * (max(style.layers) - plan.layer)), float(plan.layer),
        wire_out, INERTIA, plan.boost, gas,
        motors * 5e-12 * rng.uniform(0.5, 2.0), 1.0e9 * rng.uniform(0.9, 1.1), style.pump_lag,
        0.5 if plan.ahc else 0.0, WIRE_STIFFNESS / wire_out if style.wire_damping else 0.0,
        _wire_damping(style, plan, wire_out), plan.date,
    )  # fmt: skip


def _wire_damping(style: Flavour, plan: Plan, wire_out: float) -> float:
    """N s/m: given as such, or, below 1, as the damping ratio of the load on its wire."""
    if style.wire_damping >= 1.0:
        return style.wire_damping
    return 2.0 * style.wire_damping * float(np.sqrt(WIRE_STIFFNESS / wire_out * plan.load))


def _log(
    plan: Plan,
    style: Flavour,
    plant: RunPlant,
    hidden: Hidden,
    out: np.ndarray,
    wanted: tuple[np.ndarray, np.ndarray, np.ndarray],
    rng: np.random.Generator,
) -> Columns:
    """The run as its PLC wrote it down."""
    _, angle, p_a, p_b, gas, gas_law = out
    reference, tip, celsius = wanted
    index, stamp = instruments.sampling(out.shape[1], style.jitter, rng)
    late, early = (hidden.delay, 0.0) if style.pressure_is_late else (0.0, hidden.delay)
    at = np.clip(np.round(index - late / STEP).astype(int), 0, None)
    group = "active" if plan.ahc else "main"
    columns: Columns = {
        "time": plan.start + stamp,
        "motor_speed": instruments.encoder_speed(angle, index, early, style, rng),
        f"{group}.pressure_a": instruments.pressure(p_a, at, style, rng, hidden.pressure_offset, hidden.pressure_scale),
        f"{group}.pressure_b": instruments.pressure(p_b, at, style, rng),
        f"{group}.displacement": _swash(plant.drive_displacement + hidden.swivel, len(index), rng),
    }
    if plan.ahc:
        columns["passive.pressure_a"] = instruments.pressure(
            gas_law if style.gas_is_calculated else gas, at, style, rng
        )
        columns["passive.pressure_b"] = instruments.pressure(np.full_like(gas, plant.boost), at, style, rng)
        columns["passive.displacement"] = _swash(plant.passive_displacement + hidden.swivel, len(index), rng)
        if style.crane_moves:
            columns["heave_velocity"] = tip[index] + rng.normal(0, 0.003, len(index))
    return columns | _optional(style, plan, plant, angle, (reference, celsius), index, rng)


def _swash(true: float, size: int, rng: np.random.Generator) -> np.ndarray:
    return true + rng.normal(0, 0.15, size) * CM3_PER_REV


def _optional(
    style: Flavour, plan: Plan, plant: RunPlant, angle: Any, wanted: Any, index: Any, rng: np.random.Generator
) -> Columns:
    reference, celsius = wanted
    turned = angle[index]
    available = {
        "speed_reference": reference[index],
        "hook_load": plan.load + instruments.noise(len(index), 150.0, 0.5, rng),
        "oil_temperature": np.round(celsius[index] + rng.normal(0, 0.1, len(index)), 1),
        "wire_layer": np.full(len(index), float(plan.layer)),
        "wire_out": np.round(plant.wire_out - turned * RADII[plan.layer - 1] / GEAR, 2),
        "shaft_angle": turned + rng.normal(0, 0.003, len(index)),
    }
    return {name: available[name] for name in style.channels}
