"""Strengths of the effects inside one crane: amounts stated for eleven motors of 215 cm^3/rev, made to its measure."""

from collections.abc import Sequence

import numpy as np

from campaign.rig.effects import Strengths
from campaign.rig.laws import law_of
from campaign.rig.truth import INERTIA, Friction
from campaign.rig.world import World

PER_MOTOR = (
    "low_displacement", "notch", "churning", "mixed", "case", "case_b", "case_rest", "brake", "motor_amount", "swivel",
    "swivel_play", "swivel_warm", "swivel_mid", "swivel_s", "swivel_stop",
)  # fmt: skip
PER_WINCH = (
    "winch_amount", "leakage", "line_flow", "ripple_still", "wire_drag", "seal_grip", "sector", "run_drift",
    "pressure_memory", "root_speed", "speed_bump", "jerkiness", "layer_scrub", "power_loss", "cold_load", "groove",
    "fast_step", "swash_step", "speed_memory",
)  # fmt: skip
INERTIAS = ("inertia", "inertia_wire", "inertia_oil")


def strengths(
    effects: Sequence[tuple[str, float]], rng: np.random.Generator, truth: Friction, world: World
) -> Strengths:
    """All strengths of a data set's effects in this world; an unknown name raises KeyError."""
    found: Strengths = {}
    for name, size in effects:
        found |= law_of(name)(size, rng, truth)
    if "line_drop" in found:
        found.setdefault("line_flow", 1.29 / 60)
    return {name: value * _measure(name, world) for name, value in found.items()}


def _measure(name: str, world: World) -> float:
    if name in PER_MOTOR:
        return world.motor_size
    if name in PER_WINCH:
        return world.winch_size
    if name in INERTIAS:
        return world.inertia / INERTIA
    if name == "line_drop":
        return world.winch_size**-2
    return world.capacity if name == "tare" else 1.0
