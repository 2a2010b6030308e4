"""Mistakes that a log or a crane file may hold, each as what would undo it in a run's view.

One entry, one mistake: what it is called, which channel it concerns, how it is put right, and what it costs before any
data are seen (twice the negative log of its prior odds, up to a constant): the common ones come cheap, those with a
free number dear.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from winch_friction.commissioning.kinematics import tells_speed
from winch_friction.commissioning.other_cranes import claim
from winch_friction.commissioning.repairs import (
    Repair,
    displacement_times,
    drop_times,
    in_falls,
    load_times,
    motor_torque_times,
    port_times,
    speed_times,
    speeds_times,
)
from winch_friction.commissioning.view import RunView
from winch_friction.physics.channels import CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

UNIT, SIGN, PORTS, SWAP, CRANE, LAYER, DELAY, TARE, SCALE = 0.0, 1.0, 2.0, 3.0, 2.0, 5.0, 12.0, 6.0, 12.0  # prior costs
FALLS, MOST_FALLS = 4.0, 4  # dearer than a unit, cheaper than a layer: load and drum stand in two documents

RARELY, RARE = ("deg/s", "1/s", "lb", "l/rev", "mm^3", "kPa", "kN under [kg]", "t under [kN]"), 4.0
# channel -> factor to the true value, what is written in the log and under which unit it stands
_TURN = 2.0 * np.pi
LOAD_UNITS = (
    (1e-3, "kg under [t]"), (1e3, "t under [kg]"), (1.0 / GRAVITY, "kN under [t]"), (1e3 / GRAVITY, "kN under [kg]"),
    (GRAVITY, "t under [kN]"), (0.45359237, "lb under [kg]"), (0.45359237e-3, "lb under [t]"),
)  # fmt: skip
PRESSURE_UNITS = (
    (1e-5, "Pa under [bar]"), (1e5, "bar under [Pa]"), (10.0, "MPa under [bar]"), (0.1, "bar under [MPa]"),
    (0.0689476, "psi under [bar]"), (14.5038, "bar under [psi]"), (1e-2, "kPa under [bar]"), (1e2, "bar under [kPa]"),
    (1e-6, "Pa under [MPa]"), (1e6, "MPa under [Pa]"), (1e3, "kPa under [Pa]"), (1e-3, "Pa under [kPa]"),
)  # fmt: skip
THOUSANDS = ((1e3, "thousands under the plain unit"), (1e-3, "the plain unit under thousands"))
SPEED_UNITS = (
    (1.0 / RPM, "rad/s under [rpm]"), (RPM, "rpm under [rad/s]"), (60.0, "1/s under [rpm]"),
    (1.0 / 60.0, "rpm under [1/s]"),
    (_TURN / 360.0, "deg/s under [rad/s]"), (1.0 / 6.0, "deg/s under [rpm]"),
)  # fmt: skip
SHAFT = ("speed_reference", "shaft_angle", "drum_speed")  # what one logger turns with the motor's speed
DISPLACEMENT_UNITS = (
    (_TURN, "cm^3/rad under [cm^3/rev]"), (1.0 / _TURN, "cm^3/rev under [cm^3/rad]"), (1e3, "l/rev under [cm^3/rev]"),
    (1e-6, "cm^3/rad under [m^3/rad]"), (CM3_PER_REV, "cm^3/rev under [m^3/rad]"), (1e-3, "mm^3/rev under [cm^3/rev]"),
)  # fmt: skip


LARGEST_TARE = 0.05  # of the mass that all motors hold at 300 bar: hook, block and wire weigh no more


@dataclass(frozen=True)
class Mistake:
    """A mistake: `cause` and `channel` as in `Finding`, `words` that complete 'most likely ...', `undo` puts it right.

    `factor` is the number by which the channel was put right, NaN where there is none; `parts` the two that are one
    mistake each, where it takes both.
    """

    cause: str
    channel: str
    words: str
    cost: float
    undo: Repair
    factor: float = float("nan")
    parts: tuple["Mistake", ...] = ()


def fixed_mistakes(views: Sequence[RunView], crane: Crane, others: Mapping[str, Crane]) -> Iterator[Mistake]:
    """All mistakes without a free number that these runs can hold."""
    groups = tuple(dict.fromkeys(name for view in views for name in view.groups))
    told = any(tells_speed(view, crane) for view in views)
    yield from (each for each in _units(views, crane, groups) if told or each.channel != "motor_speed")
    yield from _signs(views, groups, crane)
    yield from _swaps(views, groups)
    yield from _cranes(views, crane, others)
    yield from _layers(views, crane)
    for n in range(2, MOST_FALLS + 1) if any(np.isfinite(view.load).any() for view in views) else ():
        words = f"the hook hangs in {n} falls and the crane file counts one: divide layer_radii by {n}, as init crane"
        yield Mistake("falls", "drum", f"{words} --falls {n} does", FALLS, in_falls(n), n)


def _units(views: Sequence[RunView], crane: Crane, groups: tuple[str, ...]) -> Iterator[Mistake]:
    def each(channel: str, table: Sequence[tuple[float, str]], undo: Callable[[float], Repair]) -> Iterator[Mistake]:
        for factor, words in table:
            cost = UNIT + (RARE if words.startswith(RARELY) else 0.0)
            yield Mistake("unit", channel, f"{channel} holds {words}", cost, undo(factor), factor)

    if any(np.isfinite(view.load).any() for view in views):
        yield from each("hook_load", LOAD_UNITS, load_times)
    yield from each("motor_speed", SPEED_UNITS, speed_times)
    if any("speed_reference" in view.rates for view in views):
        for factor, words in SPEED_UNITS[:2]:
            said = f"motor_speed and speed_reference hold {words}"
            yield Mistake("unit", "motor_speed", said, UNIT + 1.0, speeds_times(factor, "speed_reference"), factor)
    ratio = crane.gear_ratio
    if ratio > 1.5:
        yield Mistake(
            "unit", "motor_speed", "motor_speed holds the drum's speed", UNIT + 1.0, speed_times(ratio), ratio
        )
        words = "drum_speed (or its gear ratio) holds the motor's speed"
        yield Mistake("unit", "motor_speed", words, UNIT + 1.0, speed_times(1.0 / ratio), 1.0 / ratio)
    if crane.drive.channels:
        yield from each(crane.drive.channels[0], THOUSANDS, motor_torque_times)
    if not groups:
        return
    yield from each("pressure", PRESSURE_UNITS, drop_times)
    for port in "ab":  # a port of its own transducer, scaled in another unit than its neighbour on the same panel
        for factor, words in PRESSURE_UNITS:
            if not 1e-2 <= factor <= 1e2:
                continue
            cost = UNIT + 2.0 + (RARE if words.startswith(RARELY) else 0.0)
            said = f"pressure_{port} holds {words}, the other port does not"
            yield Mistake("unit", f"pressure_{port}", said, cost, port_times(factor, port), factor)
    yield from each("displacement", _displacement_table(crane), displacement_times)
    for name in groups if len(groups) > 1 else ():
        for channel, table, undo in (
            ("pressure", PRESSURE_UNITS, drop_times), ("displacement", _displacement_table(crane), displacement_times),
        ):  # fmt: skip
            for factor, words in table:
                said = f"{name}.{channel} holds {words}"
                yield Mistake("unit", f"{name}.{channel}", said, UNIT + 2.0, undo(factor, name), factor)


def _displacement_table(crane: Crane) -> tuple[tuple[float, str], ...]:
    largest = crane.max_displacement
    fractions = (
        (largest, "a fraction of the largest displacement, read as m^3/rad"),
        (largest / CM3_PER_REV, "a fraction under [cm^3/rev]"),
        (largest / 100.0 / CM3_PER_REV, "per cent under [cm^3/rev]"),
        (largest / 100.0, "per cent, read as m^3/rad"),
    )
    return (*DISPLACEMENT_UNITS, *fractions) if largest > 0.0 else DISPLACEMENT_UNITS


def _signs(views: Sequence[RunView], groups: tuple[str, ...], crane: Crane) -> Iterator[Mistake]:
    said = "the sign of motor_speed is flipped: positive must mean hoisting"
    yield Mistake("sign", "motor_speed", said, SIGN, speed_times(-1.0), -1.0)
    if also := [name for name in SHAFT if any(name in view.rates for view in views)]:
        names = " and ".join(", ".join(("motor_speed", *also)).rsplit(", ", 1))
        said = f"the sign of {names} is flipped: positive must mean hoisting"
        yield Mistake("sign", "motor_speed", said, SIGN + 1.0, speeds_times(-1.0, *also), -1.0)
    if any(_told_direction(view) is not None for view in views):
        said = "motor_speed has no sign: lowering must be negative"
        yield Mistake("sign", "motor_speed", said, SIGN, _signed)
    if any(view.heave is not None for view in views):
        said = "the sign of heave_velocity is flipped: positive must mean the crane tip rises"
        yield Mistake("sign", "heave_velocity", said, SIGN, _heave_turned, -1.0)
    for channel in crane.drive.channels:
        said = f"the sign of {channel} is flipped: positive must hold the load"
        yield Mistake("sign", channel, said, SIGN, motor_torque_times(-1.0), -1.0)
    negative = [name for name in groups if any(_negative(view, name) for view in views)]
    if negative:  # which looks like swapped ports, and can be seen not to be
        columns = ", ".join(f"{name}.displacement" for name in negative)
        said = f"the sign of {columns} is flipped: negative throughout, and a displacement is a size"
        yield Mistake("sign", columns, said, SIGN, _upright, -1.0)
    if groups and not all(_negative(view, name) for view in views for name in view.groups):
        said = "the ports are swapped: pressure_a must be the port that holds the load"
        yield Mistake("ports", "pressure", said, PORTS, drop_times(-1.0), -1.0)
    for name in groups if len(groups) > 1 else ():
        if name in negative:
            continue
        said = f"{name}.pressure_a and {name}.pressure_b are swapped"
        yield Mistake("ports", f"{name}.pressure", said, PORTS, drop_times(-1.0, name), -1.0)


def _negative(view: RunView, name: str) -> bool:
    """Whether a group's displacement is below zero throughout; of motors that swivel over centre it is so at times."""
    known = view.groups[name].displacement if name in view.groups else np.zeros(0)
    known = known[np.isfinite(known)]
    return bool(known.size and known.max() < 0.0)


def _upright(view: RunView) -> RunView:
    turned = {
        name: replace(group, displacement=-group.displacement) if _negative(view, name) else group
        for name, group in view.groups.items()
    }
    return replace(view, groups=turned)


def _told_direction(view: RunView) -> FloatArray | None:
    """The direction that another channel tells of a run whose speed is never negative."""
    if not np.nanmin(view.speed, initial=0.0) >= 0.0:
        return None
    told = [np.sign(rate) for name, rate in view.rates.items() if name != "heave_velocity"]
    return next((sign for sign in told if (sign < 0.0).any() and (sign > 0.0).any()), None)


def _signed(view: RunView) -> RunView:
    sign = _told_direction(view)
    if sign is None:
        return view
    speed = np.abs(view.speed) * sign
    return replace(view, speed=speed, acceleration=np.gradient(speed, view.time))


def _heave_turned(view: RunView) -> RunView:
    if view.heave is None:
        return view
    rates = {name: (-v if name == "heave_velocity" else v) for name, v in view.rates.items()}
    return replace(view, heave=-view.heave, heave_acceleration=-view.heave_acceleration, rates=rates)


def _swaps(views: Sequence[RunView], groups: tuple[str, ...]) -> Iterator[Mistake]:
    for k, first in enumerate(groups):
        for second in groups[k + 1 :]:
            if any({first, second} <= set(view.groups) for view in views):
                said = f"the columns of motor groups {first} and {second} are exchanged"
                yield Mistake("groups", f"{first}, {second}", said, SWAP, _exchanged(first, second))


def _exchanged(first: str, second: str) -> Repair:
    def undo(view: RunView) -> RunView:
        if not {first, second} <= set(view.groups):
            return view
        a, b = view.groups[first], view.groups[second]
        swapped = {first: replace(b, count=a.count), second: replace(a, count=b.count)}
        return replace(view, groups={**view.groups, **swapped})

    return undo


def _cranes(views: Sequence[RunView], crane: Crane, others: Mapping[str, Crane]) -> Iterator[Mistake]:
    for name, other in others.items():
        if said := claim(views, crane, name, other):
            yield Mistake("crane", "", said, CRANE, _on(other))


def _on(crane: Crane) -> Repair:
    return lambda view: view.on(crane)


def _layers(views: Sequence[RunView], crane: Crane) -> Iterator[Mistake]:
    radii = crane.drum.layer_radii
    if len(radii) < 2:
        return
    for k, radius in enumerate(radii, 1):
        if all(np.all(view.layer == k) for view in views):
            continue

        def undo(view: RunView, radius: float = radius) -> RunView:
            return replace(view, radius=np.full(len(view.time), radius))

        yield Mistake("layer", "wire_layer", f"the wire lies on layer {k}, not where wire_layer says", LAYER, undo, k)


def free_mistakes(views: Sequence[RunView], scale_of: Mapping[str, float], tare: float) -> Iterator[Mistake]:
    """Mistakes with a number that the data give: `scale_of` by what is scaled (`load`, `pressure`, a group's name),
    `tare` kg missing in the load."""
    load = scale_of.get("load", float("nan"))
    if np.isfinite(load) and load > 0.0:
        ratio = views[0].gear_ratio / load
        words = (
            f"the gear ratio of the crane file is wrong ({ratio:.4g} would close), or these are another crane's runs"
        )
        yield Mistake("gear", "gear_ratio", words, SCALE - 2.0, _geared(1.0 / load), 1.0 / load)
        words = f"displacement is wrong by a factor (or per group, not per motor): times {1.0 / load:.3g} would close"
        yield Mistake("scale", "displacement", words, SCALE - 2.0, displacement_times(1.0 / load), 1.0 / load)
        words = f"hook_load is wrong by a factor: times {load:.3g} would close"
        yield Mistake("scale", "hook_load", words, SCALE, load_times(load), load)
    for name, factor in scale_of.items():
        if name != "load" and np.isfinite(factor) and factor > 0.0:
            words = f"{name}.displacement (or its pressures) is wrong by a factor: times {factor:.3g} would close"
            yield Mistake("scale", f"{name}.displacement", words, SCALE + 1.0, displacement_times(factor, name), factor)
    holds = min(view.rated_torque / (GRAVITY * float(np.median(view.lever))) for view in views) if views else 0.0
    if 0.0 < tare < LARGEST_TARE * holds:
        words = f"hook_load lacks a tare (hook, block or wire) of {tare / 1e3:.3g} t"
        yield Mistake("tare", "hook_load", words, TARE + 2.0, lambda v: replace(v, load=v.load + tare), tare)


def _geared(factor: float) -> Repair:
    return lambda view: replace(view, gear_ratio=view.gear_ratio * factor)


def delayed(seconds: float, hydraulic: bool = True) -> Mistake:
    """The speed and its companions are logged late (positive) against what tells the torque, by this many seconds."""
    told, are = ("the pressures", "are") if hydraulic else ("the drive's torque", "is")
    which = f"motor_speed is late against {told}" if seconds > 0.0 else f"{told} {are} late against motor_speed"
    words = f"{which} by about {abs(seconds):.2g} s"
    return Mistake(
        "delay", "motor_speed", words, DELAY * (1.0 + 0.5 * abs(seconds)), lambda view: _shifted(view, seconds), seconds
    )


def _shifted(view: RunView, seconds: float) -> RunView:
    def at(values: FloatArray) -> FloatArray:
        return np.interp(view.time + seconds, view.time, values)

    return replace(view, speed=at(view.speed), acceleration=at(view.acceleration))
