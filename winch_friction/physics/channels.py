"""The channels of a winch in one table, every column of a run and every signal of a sample, said once; and units.

Units, display units, limits, ages, topics, the columns of `Run`, the fields of `Sample` and what of them enters the
operating point derive from here (docs/interfaces.md). A group's channel is written `<group>.<channel>` in a run.
A number beyond a channel's limits, which are several times what any winch does, is a broken sensor, not a measurement:
a bus fault, an overflow, a wrong unit.

SI inside. The few units that crane files, model files and people use have their factors here, and equations are checked
by their dimensions: headers with arbitrary units are parsed with pint in `records`, this is what is needed without it.
"""

import math
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache

from winch_friction.physics.errors import InputError

UNBOUNDED = (-1.0e300, 1.0e300)


class Topic(Enum):
    """How a channel travels in ROS."""

    MOTION = "in the JointState of the motor or drum"
    REFERENCE = "in the JointState of the commanded speed"
    PRESSURE = "FluidPressure"
    SWASH = "in the JointState of the swash plate"
    TEMPERATURE = "Temperature"
    PLAIN = "Float64, without a stamp"
    OF_DRIVE = "Float64, where the crane's drive is known by it"
    NONE = "not at all"


@dataclass(frozen=True)
class Channel:
    """One channel.

    `unit` is SI (temperatures degC); `display` is what people read; `limits`: beyond them a number is a broken sensor,
    not a measurement, SI, several times what any winch does. `max_age` s: how long a value holds (None: the general
    limit). `of_group`: one per motor group; `live`: part of a `Sample`, else of runs alone.
    """

    name: str
    unit: str
    display: str
    doc: str
    limits: tuple[float, float] = UNBOUNDED
    max_age: float | None = None
    topic: Topic = Topic.NONE
    of_group: bool = False
    live: bool = True


_SPEEDS = (-3.0e3, 3.0e3)  # rad/s, 29 000 rpm
_TORQUES = (-1.0e6, 1.0e6)
_PRESSURES = (-1.0e7, 2.0e8)  # 2000 bar; gauges drift below zero
_FORCES = (-1.0e6, 1.0e8)  # an empty rope's load cell may read a little below zero

CHANNELS = (
    Channel("time", "s", "s", "from any origin; Unix time dates the run", live=False),
    Channel("motor_speed", "rad/s", "rpm", "motor shaft, positive when hoisting", _SPEEDS, topic=Topic.MOTION),
    Channel("drum_speed", "rad/s", "rpm", "drum; the gear makes it a motor speed", _SPEEDS, live=False),
    Channel("speed_reference", "rad/s", "rpm", "commanded motor speed", _SPEEDS, topic=Topic.REFERENCE),
    Channel("motor_torque", "N*m", "N*m", "measured torque per motor", _TORQUES, topic=Topic.MOTION),
    Channel(
        "hook_load", "kg", "t", "whole hanging mass; an empty cell may read below zero", (-1.0e5, 1.0e7), 2.0,
        Topic.PLAIN,
    ),
    Channel(
        "heave_velocity", "m/s", "m/s", "crane tip, up positive; absent: it stands still", (-50.0, 50.0),
        topic=Topic.PLAIN,
    ),
    Channel("oil_temperature", "degC", "degC", "oil", (-60.0, 250.0), 30.0, Topic.TEMPERATURE),
    Channel("wire_layer", "1", "1", "layer in use, from 1, innermost first", (0.0, 100.0), 30.0, Topic.PLAIN),
    Channel("wire_out", "m", "m", "wire paid out", (-1.0e3, 3.0e4), 2.0, Topic.PLAIN),
    Channel("shaft_angle", "rad", "rad", "motor shaft", topic=Topic.MOTION),
    Channel("load_torque", "N*m", "N*m", "load at the motor shaft, without inertia", (-1.0e8, 1.0e8),
            topic=Topic.OF_DRIVE),
    Channel("rope_force", "N", "kN", "tension of the rope at the drum", _FORCES, topic=Topic.PLAIN),
    Channel("mechanical_power", "W", "kW", "of all motors at their shafts, positive when hoisting a load",
            (-1.0e9, 1.0e9), topic=Topic.OF_DRIVE),
    Channel("motor_current", "A", "A", "torque-making current per motor, signed", (-1.0e5, 1.0e5),
            topic=Topic.OF_DRIVE),
    Channel("motor_torque_simulated", "N*m", "N*m", "motor_torque of a user's own simulation", _TORQUES, live=False),
    Channel("rope_force_simulated", "N", "kN", "rope_force of a user's own simulation", _FORCES, live=False),
    Channel("pressure_a", "Pa", "bar", "port A, gauge", _PRESSURES, topic=Topic.PRESSURE, of_group=True),
    Channel("pressure_b", "Pa", "bar", "port B, gauge", _PRESSURES, topic=Topic.PRESSURE, of_group=True),
    Channel(
        "displacement", "m^3/rad", "cm^3/rev", "per motor", (-0.06, 0.06), topic=Topic.SWASH, of_group=True
    ),  # 380 l/rev, the largest radial piston motor; a crane file says 300 at most, and a feedback a little more
    Channel(
        "pressure_drop_simulated", "Pa", "bar", "p_A - p_B of a user's own simulation", _PRESSURES, of_group=True,
        live=False,
    ),
)  # fmt: skip

WINCH = {each.name: each for each in CHANNELS if not each.of_group}
OF_GROUP = {each.name: each for each in CHANNELS if each.of_group}
# what a sample has of every motor group, in the order of `GroupSample`
GROUP_CHANNELS = tuple(each.name for each in CHANNELS if each.of_group and each.live)
SAMPLE_SCALARS = tuple(each.name for each in CHANNELS if not each.of_group and each.live)
SLOW_INPUTS = {each.name: each.max_age for each in CHANNELS if each.max_age is not None}
PLAIN_SCALARS = tuple(each.name for each in CHANNELS if each.topic is Topic.PLAIN)
DRIVE_SCALARS = tuple(each.name for each in CHANNELS if each.topic is Topic.OF_DRIVE)


def channel_of(column: str) -> Channel | None:
    """The channel of a run's column, or None when the name is not one of the contract's."""
    group, _, name = column.rpartition(".")
    return OF_GROUP.get(name) if group else WINCH.get(name)


def column_unit(column: str) -> str | None:
    """SI unit of a run's column, or None when the name is not one of the contract's."""
    channel = channel_of(column)
    return channel.unit if channel else None


def display_unit(column: str) -> str | None:
    """The unit in which people read a run's column, or None when the name is not one of the contract's."""
    channel = channel_of(column)
    return channel.display if channel else None


# -- what a sensor can say at all
LIMITS = {each.name: each.limits for each in CHANNELS}  # channel, without its group -> smallest and largest value, SI


def plausible(channel: str, value: float) -> bool:
    """Whether a value of this channel (a run's column or its short name) is a number that a sensor can mean."""
    lower, upper = limits_of(channel)
    return lower <= value <= upper  # false for NaN too


@lru_cache(maxsize=1024)
def limits_of(channel: str) -> tuple[float, float]:
    """Smallest and largest value of a channel (a run's column or its short name), SI."""
    return LIMITS.get(channel.rpartition(".")[2], UNBOUNDED)


# -- units
GRAVITY = 9.81  # m/s^2
RPM = 2.0 * math.pi / 60.0  # rad/s per rev/min
FASTEST_ROPE = 12.0  # m/s: three times the fastest hoist at sea
BAR = 1.0e5  # Pa per bar
CM3_PER_REV = 1.0e-6 / (2.0 * math.pi)  # m^3/rad per cm^3/rev

# unit -> (SI unit, factor); a unit that stands for itself has factor 1
_CONVERSIONS = {
    "rpm": ("rad/s", RPM),
    "bar": ("Pa", BAR),
    "cm^3/rev": ("m^3/rad", CM3_PER_REV),
    "t": ("kg", 1.0e3),
    "kN*m": ("N*m", 1.0e3),
    "kN": ("N", 1.0e3),
    "kW": ("W", 1.0e3),
    "mm": ("m", 1.0e-3),
    "ms": ("s", 1.0e-3),
    "h": ("s", 3600.0),
    "deg": ("rad", math.pi / 180.0),
    "-": ("1", 1.0),
    "N*m*s": ("N*m*s/rad", 1.0),
}


def factor_to_si(unit: str, expected: str, where: str = "") -> float:
    """Factor that takes a value in `unit` to the SI unit `expected`; raises `InputError` for another dimension."""
    if unit == expected:
        return 1.0
    si_unit, factor = _CONVERSIONS.get(unit, (unit, 1.0))
    if si_unit == expected:
        return factor
    raise InputError(
        f"{where or 'value'}: unit '{unit}' cannot be used, expected {' or '.join(accepted_units(expected))}"
    )


def in_unit(column: str, value: float) -> str:
    """A value of a run's column with its SI unit, if it has one."""
    unit = column_unit(column)
    return f"{value:.4g}" if unit in (None, "1") else f"{value:.4g} {unit}"


def outside(column: str, value: float, lower: float, upper: float) -> str:
    """What is said of a value, SI, outside a range; asks for the unit in which people read the column if it is inside
    in that.

    >>> outside("motor_speed", 1480.0, -300.0, 300.0)
    '1480 rad/s is outside -300 ... 300 rad/s: sent in rpm? Inputs are in rad/s'
    """
    unit, display = column_unit(column), display_unit(column)
    said = f"{in_unit(column, value)} is outside {lower:.4g} ... {in_unit(column, upper)}"
    factor = _CONVERSIONS.get(display or "", ("", 1.0))[1]
    return f"{said}: sent in {display}? Inputs are in {unit}" if lower <= value * factor <= upper else said


def accepted_units(si_unit: str) -> list[str]:
    """The SI unit and every unit of the table that converts to it."""
    return [si_unit, *(unit for unit, (target, _) in _CONVERSIONS.items() if target == si_unit)]


# -- dimensions
Dimension = Mapping[str, float]  # exponents of kg, m, s, K, A; absent: 0
_UNITS: dict[str, dict[str, float]] = {
    "1": {}, "rad": {}, "kg": {"kg": 1}, "m": {"m": 1}, "s": {"s": 1}, "K": {"K": 1}, "degC": {"K": 1},
    "N": {"kg": 1, "m": 1, "s": -2}, "Pa": {"kg": 1, "m": -1, "s": -2}, "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3}, "Hz": {"s": -1}, "A": {"A": 1},
}  # fmt: skip
_TOKEN = re.compile(r"([*/]?)([A-Za-z]+|1)(?:\^(-?\d+(?:\.\d+)?))?")


def dimension_of(unit: str) -> dict[str, float]:
    """Exponents of kg, m, s, K and A; `InputError` for what is no SI unit."""
    return dict(_dimension_of(unit))


@lru_cache(maxsize=512)  # a search declares hundreds of curves with the same few units
def _dimension_of(unit: str) -> dict[str, float]:
    total: Counter[str] = Counter()
    at = 0
    for token in _TOKEN.finditer(unit):
        if token.start() != at or token[2] not in _UNITS or (token[1] == "") != (at == 0):
            break
        power = float(token[3] or 1.0) * (-1.0 if token[1] == "/" else 1.0)
        for base, exponent in _UNITS[token[2]].items():
            total[base] += exponent * power  # type: ignore[assignment]
        at = token.end()
    if at != len(unit) or not unit:
        raise InputError(f"unit '{unit}' is not a product of SI units such as N*m*s/rad")
    return _without_zeros(total)


def product(*factors: tuple[str, float]) -> dict[str, float]:
    """Dimension of a product of powers of units."""
    total: Counter[str] = Counter()
    for unit, power in factors:
        for base, exponent in dimension_of(unit).items():
            total[base] += exponent * power  # type: ignore[assignment]
    return _without_zeros(total)


def quotient_unit(over: str, *factors: tuple[str, float]) -> str:
    """A readable unit that times the factors gives `over`, such as N*m*s/rad for N*m over rad/s."""
    powers: dict[str, float] = {}
    for unit, power in factors:
        for token in _TOKEN.finditer(unit):
            if token[2] != "1":
                own = float(token[3] or 1.0) * (-1.0 if token[1] == "/" else 1.0)
                powers[token[2]] = powers.get(token[2], 0.0) - own * power
    if over == "N*m" and powers.get("N", 0.0) == powers.get("m", 0.0) == -1.0:  # a torque over a torque
        over, powers = "1", {name: power for name, power in powers.items() if name not in ("N", "m")}
    above = "".join(f"*{_power(n, p)}" for n, p in powers.items() if p > 1e-12)
    below = "".join(f"/{_power(n, -p)}" for n, p in powers.items() if p < -1e-12)
    return f"{over}{above}{below}".removeprefix("1*")


NOTHING_BESIDE = 0.005  # of its standard deviation: half of the second digit, the last that is shown of that one


def beside(value: float, std: float) -> float:
    """A value as it is shown to people beside its standard deviation: 0 where it is nothing beside it.

    What a search leaves of a parameter at its bound, -6.9e-20 beside 5e-11, says nothing but the rounding of a solver.

    >>> beside(-6.91e-20, 5e-11), beside(-2e-12, 5e-11)
    (0.0, -2e-12)
    """
    return 0.0 if abs(value) < NOTHING_BESIDE * std else value


def _power(name: str, power: float) -> str:
    return name if power == 1.0 else f"{name}^{power:g}"


def _without_zeros(total: Mapping[str, float]) -> dict[str, float]:
    return {base: float(exponent) for base, exponent in sorted(total.items()) if abs(exponent) > 1e-12}
