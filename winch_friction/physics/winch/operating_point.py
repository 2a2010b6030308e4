"""From measured signals to the operating point that every friction function takes (the order of `symbols.layout`)."""

from collections.abc import Sequence
from operator import attrgetter
from typing import Any

import numpy as np

from winch_friction.physics.channels import WINCH
from winch_friction.physics.friction.direction import smooth_sign, smooth_signs
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.signals import FloatArray, Run, Sample
from winch_friction.physics.units import GRAVITY
from winch_friction.physics.winch.crane import Crane

_ORDER = tuple(signal.name for signal in WINCH_SIGNALS)
_DEFAULTS: dict[str, Any] = {signal.name: signal.default for signal in WINCH_SIGNALS if signal.default is not None}
# of a motor group's last signals, for whoever does not give them
_GROUP_DEFAULTS = tuple(signal.default for signal in GROUP_SIGNALS)
# what of them is a channel of its own: taken from a sample or run as it is, where it is there
CHANNEL_SIGNALS = tuple(name for name in _DEFAULTS if name in WINCH)
# places for the one point of a sample, which a node needs at every step
_TEMPLATE: list[Any] = [_DEFAULTS.get(name) for name in _ORDER]
_PLACES = tuple(_ORDER.index(name) for name in CHANNEL_SIGNALS)
_channels_of = attrgetter(*CHANNEL_SIGNALS)
_DIRECTION, _MAGNITUDE, _SPEED, _DRUM_TORQUE, _ACCELERATION, _MOTOR_TOTAL = (
    _ORDER.index(name)
    for name in ("direction", "speed_magnitude", "speed", "drum_torque", "acceleration", "motor_total")
)


def operating_point(
    *,
    direction: Any,
    speed: Any,
    drum_torque: Any,
    groups: Sequence[tuple[Any, ...]] = (),
    motor_total: Any,
    **optional: Any,
) -> tuple[Any, ...]:
    """The operating point as a flat tuple of floats or of arrays; SI.

    `groups` holds per motor group: number of motors, |p_A - p_B|, p_A + p_B, displacement per motor and which port's
    pressure is the higher (left out: port A's), in short a `group_point`. `optional` are signals of the table that have
    a default: acceleration, oil_temperature, time, ... (`symbols.WINCH_SIGNALS`).
    """
    values = _DEFAULTS | optional
    if len(values) > len(_DEFAULTS):
        raise TypeError(f"no such signals: {sorted(set(optional) - set(_DEFAULTS))}")
    values |= {
        "direction": direction, "speed_magnitude": abs(speed), "speed": speed, "drum_torque": drum_torque,
        "motor_total": motor_total,
    }  # fmt: skip
    return tuple(values[name] for name in _ORDER) + tuple(value for group in groups for value in _whole(group))


def _whole(group: tuple[Any, ...]) -> tuple[Any, ...]:
    """A group's signals with the defaults of those at the end that are not given."""
    missing = _GROUP_DEFAULTS[len(group) :]
    if len(group) > len(_GROUP_DEFAULTS) or None in missing:
        raise TypeError(f"a group has {[signal.name for signal in GROUP_SIGNALS]}, not {len(group)} values")
    return (*group, *missing)


def group_point(count: Any, drop: Any, displacement: Any, pressure_sum: Any = None) -> tuple[Any, ...]:
    """A motor group's part of an operating point: `drop` is p_A - p_B in Pa, a float or an array; without p_A + p_B the
    lower port's pressure is taken for zero.

    The higher port is +1 for port A and -1 for port B, so that p_B = (p_A + p_B - higher_port |p_A - p_B|) / 2; it
    steps where the pressures are equal and |p_A - p_B| is zero.
    """
    size = np.abs(drop)
    higher_port = np.where(np.asarray(drop) < 0.0, -1.0, 1.0)
    return count, size, size if pressure_sum is None else pressure_sum, displacement, higher_port


def sample_operating_point(
    sample: Sample, crane: Crane, *, drum_torque: float, speed: float, width: float = 0.0, acceleration: float = 0.0
) -> tuple[float, ...]:
    """The operating point of one sample at a given speed; `width` smooths the direction, rad/s."""
    x: list[Any] = _TEMPLATE.copy()
    for index, value in zip(_PLACES, _channels_of(sample), strict=True):
        if value == value:
            x[index] = value
    x[_DIRECTION], x[_MAGNITUDE], x[_SPEED] = smooth_sign(speed, width), abs(speed), speed
    x[_DRUM_TORQUE], x[_ACCELERATION] = drum_torque, acceleration
    total = 0
    for name, g in sample.groups.items():
        a, b, count = g.pressure_a, g.pressure_b, crane.motor_count(name)
        total += count
        x += count, abs(a - b), a + b, g.displacement, -1.0 if a < b else 1.0
    x[_MOTOR_TOTAL] = total if sample.groups else crane.motor_total(())
    return tuple(x)


def run_operating_points(
    run: Run, crane: Crane, *, drum_torque: FloatArray, width: float = 0.0, acceleration: Any = 0.0
) -> tuple[Any, ...]:
    """The operating points of a whole run as arrays of one length."""
    speed = run["motor_speed"]
    optional = {name: run[name] for name in CHANNEL_SIGNALS if name in run}
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
    """`group_point` of one group along a run."""
    a, b = run[f"{group}.pressure_a"], run[f"{group}.pressure_b"]
    return group_point(np.full(len(run), crane.motor_count(group)), a - b, run[f"{group}.displacement"], a + b)


def run_drum_torque(run: Run, crane: Crane, load: float = float("nan")) -> FloatArray:
    """T_d in N m along a run from `hook_load`, or from a given load in kg where the run has none."""
    loads = run.column("hook_load", load)
    layers = run.column("wire_layer")
    radii = {layer: crane.drum.radius(layer) for layer in np.unique(layers[~np.isnan(layers)])}
    radius = np.array([radii.get(layer, crane.drum.radius(float("nan"))) for layer in layers])
    return loads * GRAVITY * radius
