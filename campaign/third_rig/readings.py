"""Wrong figures of the owner and wrong readings of the sensors, each under laws of its own."""

from collections.abc import Callable

import numpy as np

from campaign.third_rig.crane import BAR, CM3_PER_REV
from campaign.third_rig.hidden import Channels, Effect, State
from campaign.third_rig.motion import Series
from campaign.third_rig.plan import AHC, MAIN

Sensed = Callable[[Channels, State, float], None]
Change = Callable[[Series, State, float], Series]  # a channel with its effect, given the size
HIGH_PRESSURE = 250 * BAR
MEAN_HALF_WAVE = 0.6366
BOW = 1.6


def _of_lead(channel: str, change: Change) -> Sensed:
    """Changes a channel of the leading group."""

    def sensed(channels: Channels, s: State, size: float) -> None:
        name = f"{s.run.balancing}.{channel}"
        channels[name] = change(channels[name], s, size)

    return sensed


def _zero_some(pressure: Series, s: State, bar: float) -> Series:
    return pressure + bar * BAR * s.run.marked


def _zero_warm(pressure: Series, s: State, bar: float) -> Series:
    return pressure + bar * BAR * np.tanh((s.run.celsius - 35) / 8)


def _compressed(pressure: Series, s: State, size: float) -> Series:
    return pressure * (1 - size * (np.clip(pressure, 0, None) / HIGH_PRESSURE) ** 1.5)


def _bowed(displacement: Series, s: State, cm3: float) -> Series:
    stroke = displacement / s.crane.max_displacement
    return displacement + cm3 * CM3_PER_REV * 4 * stroke * (1 - stroke) * BOW


def _offset_some(displacement: Series, s: State, cm3: float) -> Series:
    return displacement + cm3 * CM3_PER_REV * s.run.marked


def _late(channels: Channels, s: State, seconds: float) -> None:
    delay = seconds * (0.65 + 0.8 * s.run.share)
    channels["motor_speed"] = np.interp(s.run.time - delay, s.run.time, channels["motor_speed"])


def _gas_warm(channels: Channels, s: State, size: float) -> None:
    """The pressure that is reckoned is too low while the gas is warm."""
    warm = 0.6 * np.exp(-s.run.time / 12) + 0.4 * np.exp(-s.run.time / 70)
    pressure = channels["passive.pressure_a"]
    channels["passive.pressure_a"] = pressure - size * warm * (0.5 + s.run.share) * pressure


def _triangle(s: State) -> Series:
    """Once per turn of the motor."""
    turns = s.run.angle / 2 / np.pi
    return s.load_torque * (4 * np.abs(turns - np.floor(turns + 0.5)) - 1)


def _drum(s: State) -> Series:
    return s.load_torque * (np.abs(np.sin(s.run.angle / s.crane.gear)) - MEAN_HALF_WAVE)


READINGS = {
    "layer_one": Effect(
        ("layer_radius",), "second of all layers crushed: radius smaller there only", largest_size=0.06,
        radius=lambda run, crane: -crane.radius(run.layer) * (run.layer == 2),
        options={"layers": (1, 2, 3), "runs": (10, 12)},
    ),
    "layer_sink": Effect(
        ("layer_radius",), "rope beds in with load on upper layers: -a R (T/T0)^1.4 (layer-1)", largest_size=0.06,
        radius=lambda run, crane: -crane.radius(run.layer) * (run.mass / crane.rated) ** 1.4 * (run.layer - 1),
        options={"layers": "all"},
    ),
    "accu_two": Effect(
        ("accumulator_thermal",),
        "gas warm at start, decays with two time constants 12 s and 70 s; passive pressure is calculated",
        sensed=_gas_warm, options={"modes": (AHC,), "calculated": True},
    ),
    "inertia_const": Effect(
        ("inertia_error",), "inertia larger by a constant", inertia=lambda run, crane: crane.inertia,
        first_size=0.1, largest_size=0.4, options={"rate": 50, "pulses": 0},
    ),
    "inertia_wire": Effect(
        ("inertia_error",), "inertia larger with the wire on the drum: 1+(300-L)/300",
        inertia=lambda run, crane: crane.inertia * (1 + (300 - run.wire_out) / 300),
        first_size=0.1, largest_size=0.4, options={"rate": 100, "pulses": 0, "modes": (MAIN, AHC)},
    ),
    "poff_some": Effect(
        ("pressure_offset",), "zero off in some runs only (port A, balancing group)",
        sensed=_of_lead("pressure_a", _zero_some), first_size=2.0, largest_size=6.0,
    ),
    "poff_warm": Effect(
        ("pressure_offset",), "zero shifts as tanh((T-35)/8) with oil temperature",
        sensed=_of_lead("pressure_a", _zero_warm), first_size=2.0, largest_size=6.0, options={"celsius": (18, 54)},
    ),
    "pscale_sat": Effect(
        ("pressure_scale",), "gain of port A compresses at high pressure: p^2.5",
        sensed=_of_lead("pressure_a", _compressed), first_size=0.01, largest_size=0.03,
        options={"displacements": (0.4, 0.6, 0.8, 1.0)},
    ),
    "delay_run": Effect(
        ("signal_delay",), "speed late, by another amount in each run (0.65 to 1.45 times the size)", sensed=_late,
        first_size=0.06, largest_size=0.15, slowest=10, options={"rate": 50, "pulses": 0, "modes": (AHC, MAIN)},
    ),
    "swivel_play": Effect(
        ("swivel_offset",), "feedback off by a bow over the stroke, 6.4 a(1-a)",
        sensed=_of_lead("displacement", _bowed), first_size=0.5, largest_size=4.0,
        options={"displacement_changes": 0.6},
    ),
    "swivel_some": Effect(
        ("swivel_offset",), "offset in some runs only", sensed=_of_lead("displacement", _offset_some),
        first_size=0.5, largest_size=4.0, options={"displacement_changes": 0.4},
    ),
    "ripple_tri": Effect(
        ("torque_ripple",), "triangle wave once per motor turn, in proportion to the load", one_way=_triangle,
        largest_size=0.05, options={"rate": 100, "pulses": 0},
    ),
    "ripple_drum": Effect(
        ("torque_ripple",), "drum out of round: |sin| of the drum angle", one_way=_drum, largest_size=0.05,
        options={"seconds": (90, 140), "rate": 50, "modes": (MAIN,)},
    ),
    "tare_hook": Effect(
        ("tare_load", "wire_weight"), "hook missing in the load signal in all runs", first_size=0.02,
        largest_size=0.06, mass=lambda run, crane: crane.rated, options={"displacement_changes": 0.5},
    ),
    "tare_wire": Effect(
        ("tare_load", "wire_weight"), "wire weight missing, L^1.5 (current drag)", first_size=0.02, largest_size=0.06,
        mass=lambda run, crane: crane.rated * (run.wire_out / 200) ** 1.5, options={"wire_out": (30, 500)},
    ),
}  # fmt: skip
