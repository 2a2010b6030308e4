"""From measured signals to the operating point that every friction function takes (the order of `symbols.layout`)."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from winch_friction.physics.friction.direction import smooth_sign, smooth_signs
from winch_friction.physics.friction.symbols import WINCH_SIGNALS
from winch_friction.physics.signals import FloatArray, Run, Sample
from winch_friction.physics.units import GRAVITY
from winch_friction.physics.winch.crane import Crane

_DEFAULTS = {signal.name: signal.default for signal in WINCH_SIGNALS if signal.default is not None}


def operating_point(
    *,
    direction: Any,
    speed: Any,
    drum_torque: Any,
    groups: Sequence[tuple[Any, Any, Any, Any]] = (),
    motor_total: Any,
    acceleration: Any = _DEFAULTS["acceleration"],
    oil_temperature: Any = _DEFAULTS["oil_temperature"],
    time: Any = _DEFAULTS["time"],
    shaft_angle: Any = _DEFAULTS["shaft_angle"],
    wire_layer: Any = _DEFAULTS["wire_layer"],
    wire_out: Any = _DEFAULTS["wire_out"],
) -> tuple[Any, ...]:
    """The operating point as a flat tuple of floats or of arrays; SI.

    `groups` holds per motor group: number of motors, |p_A - p_B|, p_A + p_B, displacement per motor.
    """
    winch = (
        direction, abs(speed), speed, drum_torque, acceleration, oil_temperature, time, shaft_angle, wire_layer,
        wire_out, motor_total,
    )  # fmt: skip
    return winch + tuple(value for group in groups for value in group)


def sample_operating_point(
    sample: Sample, crane: Crane, *, drum_torque: float, speed: float, width: float = 0.0, acceleration: float = 0.0
) -> tuple[float, ...]:
    """The operating point of one sample at a given speed; `width` smooths the direction, rad/s."""
    groups = [
        (crane.motor_count(name), abs(g.pressure_a - g.pressure_b), g.pressure_a + g.pressure_b, g.displacement)
        for name, g in sample.groups.items()
    ]
    return operating_point(
        direction=smooth_sign(speed, width),
        speed=speed,
        drum_torque=drum_torque,
        groups=groups,
        motor_total=crane.motor_total(tuple(sample.groups)),
        acceleration=acceleration,
        **_present(sample),
    )


def _present(sample: Sample) -> dict[str, float]:
    optional = {
        "oil_temperature": sample.oil_temperature,
        "time": sample.time,
        "shaft_angle": sample.shaft_angle,
        "wire_layer": sample.wire_layer,
        "wire_out": sample.wire_out,
    }
    return {name: value for name, value in optional.items() if value == value}


def run_operating_points(
    run: Run, crane: Crane, *, drum_torque: FloatArray, width: float = 0.0, acceleration: Any = 0.0
) -> tuple[Any, ...]:
    """The operating points of a whole run as arrays of one length."""
    speed = run["motor_speed"]
    optional = {
        name: run[name] for name in ("oil_temperature", "time", "shaft_angle", "wire_layer", "wire_out") if name in run
    }
    return operating_point(
        direction=smooth_signs(speed, width),
        speed=speed,
        drum_torque=drum_torque,
        groups=[run_group(run, crane, group) for group in run.groups],
        motor_total=np.full(len(run), crane.motor_total(run.groups)),
        acceleration=acceleration,
        **optional,
    )


def run_group(run: Run, crane: Crane, group: str) -> tuple[Any, ...]:
    """Motors, |p_A - p_B|, p_A + p_B and displacement of one group along a run."""
    a, b = run[f"{group}.pressure_a"], run[f"{group}.pressure_b"]
    return np.full(len(run), crane.motor_count(group)), np.abs(a - b), a + b, run[f"{group}.displacement"]


def run_drum_torque(run: Run, crane: Crane, load: float = float("nan")) -> FloatArray:
    """T_d in N m along a run from `hook_load`, or from a given load in kg where the run has none."""
    loads = run.column("hook_load", load)
    layers = run.column("wire_layer")
    radii = {layer: crane.drum.radius(layer) for layer in np.unique(layers[~np.isnan(layers)])}
    radius = np.array([radii.get(layer, crane.drum.radius(float("nan"))) for layer in layers])
    return loads * GRAVITY * radius
