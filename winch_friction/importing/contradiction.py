"""Data in SI against the crane: what contradicts it, and which single mistake would explain that, likeliest first."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from winch_friction.importing.balance import closure, drive_torque, groups_of, opposes_motion, power_ratio, told
from winch_friction.importing.expectations import usual_size
from winch_friction.importing.kinematics import rope_over_motor
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.units import CM3_PER_REV, RPM
from winch_friction.physics.winch.crane import Crane

_RATIO = 0.25  # relative; the wire's layers differ by a twelfth, a wrong gear or unit by more than a third
_LOSSES = 2.0  # power over load times speed: no winch loses half of it
_MARGIN = 1.15  # times the crane's displacement: feedback error and a setting beyond its stop
_KNOWN_FACTORS = (
    ("is in rad/s, not rpm", 1.0 / RPM),
    ("is in rpm, not rad/s", RPM),
    ("is in rev/s, not rpm", 60.0),
    ("is the drum's, not the motor's", None),
)

_KINDS = {"pressures": ("pressure_a", "pressure_b")}

Columns = Mapping[str, FloatArray]


@dataclass(frozen=True)
class Mistake:
    """One explanation: what is wrong in words, the columns as they would be without it."""

    what: str
    columns: dict[str, FloatArray]


def contradictions(columns: Columns, crane: Crane) -> list[str]:
    """What in a log cannot be this crane, each with its likely cause; empty when nothing contradicts."""
    said = [*_too_large(columns, crane), *_wrong_ratio(columns, crane)]
    balance = closure(columns, crane)
    if balance is not None and not balance.closes:
        said.append(_unbalanced(columns, crane, balance.motors, balance.load))
    elif (gain := power_ratio(columns, crane)) is not None:
        said.extend(_wrong_power(gain))
    elif not said:
        said.extend(_pushing_load(columns, crane) or _driving_friction(columns, crane))
    return said


def _too_large(columns: Columns, crane: Crane) -> list[str]:
    said = []
    for group in groups_of(columns) if crane.drive.hydraulic else ():
        values = columns[f"{group}.displacement"]
        largest = float(np.nanpercentile(np.abs(values), 95.0)) if np.isfinite(values).any() else 0.0
        if largest > _MARGIN * crane.max_displacement:
            said.append(
                f"{group}.displacement reaches {largest / CM3_PER_REV:.4g} cm^3/rev, those of crane '{crane.name}' "
                f"have {crane.max_displacement / CM3_PER_REV:.4g}: its unit, or the log of another crane"
            )
    layers = columns.get("wire_layer")
    if layers is not None and np.isfinite(layers).any() and np.nanmax(layers) > len(crane.drum.layer_radii):
        count = len(crane.drum.layer_radii)
        said.append(
            f"wire_layer reaches {np.nanmax(layers):g}, the drum of crane '{crane.name}' has {count}: "
            "the log of another crane"
        )
    return said


def _wrong_ratio(columns: Columns, crane: Crane) -> list[str]:
    ratio = rope_over_motor(columns, crane)
    if ratio is None or abs(ratio.value - 1.0) < _RATIO:
        return []
    size = abs(ratio.value)
    head = f"{ratio.by} moves {ratio.value:.3g} times as fast as motor_speed, gear and drum of crane '{crane.name}' say"
    if abs(size - 1.0) < _RATIO:
        return [f"{head}: the sign of motor_speed (positive is hoisting), or of {ratio.by}"]
    for what, factor in _KNOWN_FACTORS:
        if abs(size * (1.0 / (factor or crane.gear_ratio)) - 1.0) < _RATIO:
            return [f"{head}: motor_speed {what}"]
    return [f"{head}: another gear or drum, the log of another crane, or the unit of {ratio.by}"]


def _unbalanced(columns: Columns, crane: Crane, motors: float, load: float) -> str:
    head = f"the torque balance does not close: the motors give {motors:.4g} N m on average, the load needs {load:.4g}"
    closing = []
    for mistake in mistakes(columns, crane):
        found = closure(mistake.columns, crane)
        if found is not None and found.closes:
            closing.append(mistake.what)
    if not closing:
        none = "no single mistake of unit, port or group would close it"
        return f"{head}, and {none}: the log of another crane than '{crane.name}'?"
    return f"{head}; it would if {' or '.join(closing[:3])}"


def mistakes(columns: Columns, crane: Crane) -> Iterator[Mistake]:
    """The mistakes people make, the commonest first."""
    groups = [g for g in groups_of(columns) if g in crane.groups]
    for each in groups:
        yield Mistake(f"ports A and B of group '{each}' were swapped", _ports_swapped(columns, [each]))
    if len(groups) > 1:
        yield Mistake("ports A and B of all groups were swapped", _ports_swapped(columns, groups))
    for one, other in pairwise(groups):
        yield Mistake(f"groups '{one}' and '{other}' were swapped", _groups_swapped(columns, one, other))
    for kind, what, factor in _unit_mistakes(columns, groups):
        touched = [name for name in columns if name.rpartition(".")[2] in _KINDS.get(kind, (kind,))]
        scaled = {name: columns[name] * factor if name in touched else columns[name] for name in columns}
        if all(_usual(name, scaled[name], crane) for name in touched):
            yield Mistake(what, scaled)


def _unit_mistakes(columns: Columns, groups: list[str]) -> Iterator[tuple[str, str, float]]:
    if "hook_load" in columns:
        yield "hook_load", "hook_load were in t where kg stands", 1e3
        yield "hook_load", "hook_load were in kg where t stands", 1e-3
        yield "hook_load", "hook_load were a force in kN where t stands", 1.0 / 9.81
        yield "hook_load", "hook_load were the mass in t where kN stands", 9.81
        yield "hook_load", "hook_load were in lb where kg stands", 0.4536
    if groups:
        for unit, factor in (("Pa", 1e-5), ("MPa", 10.0), ("psi", 0.0689476), ("kPa", 0.01)):
            yield "pressures", f"the pressures were in {unit} where bar stands", factor
        yield "pressures", "the pressures were in bar where Pa stands", 1e5
        yield "pressures", "the pressures were in bar where psi stands", 14.5038
        yield "pressures", "the pressures were in bar where MPa stands", 0.1
        yield "displacement", "displacement were per radian where per revolution stands", 2.0 * np.pi
        yield "displacement", "displacement were per revolution where per radian stands", 0.5 / np.pi
        yield "displacement", "displacement were in % of the largest where cm^3/rev stands", 2.15
    if "motor_torque" in columns:
        yield "motor_torque", "motor_torque had the other sign", -1.0
        yield "motor_torque", "motor_torque were in kN m where N m stands", 1e3


def _ports_swapped(columns: Columns, groups: list[str]) -> dict[str, FloatArray]:
    swapped = dict(columns)
    for group in groups:
        a, b = f"{group}.pressure_a", f"{group}.pressure_b"
        swapped[a], swapped[b] = columns[b], columns[a]
    return swapped


def _groups_swapped(columns: Columns, one: str, other: str) -> dict[str, FloatArray]:
    swapped = dict(columns)
    for channel in ("pressure_a", "pressure_b", "displacement"):
        a, b = f"{one}.{channel}", f"{other}.{channel}"
        swapped[a], swapped[b] = columns[b], columns[a]
    return swapped


def _usual(name: str, values: FloatArray, crane: Crane) -> bool:
    finite = np.abs(values[np.isfinite(values)])
    return bool(finite.size) and float(np.percentile(finite, 95.0)) <= usual_size(name.rpartition(".")[2], crane)[1]


def _wrong_power(gain: float) -> list[str]:
    if 1.0 / _LOSSES < gain < _LOSSES:
        return []
    what = (
        "the sign of mechanical_power or motor_speed" if -_LOSSES < gain < -1.0 / _LOSSES else "a unit of one of them"
    )
    return [f"mechanical_power is {gain:.3g} times load times speed: {what}"]


def _pushing_load(columns: Columns, crane: Crane) -> list[str]:
    """A hanging load always pulls out: motors that hold it give a torque above zero."""
    drive = drive_torque(columns, crane)
    groups = [g for g in groups_of(columns) if g in crane.groups]
    if drive is None or not groups or not np.isfinite(drive).any():
        return []
    mean, spread = float(np.nanmean(drive)), float(np.nanstd(drive))
    if mean > -0.5 * spread or len(groups) > 1:
        return []
    ports = f"ports A and B of group '{groups[0]}' were swapped"
    return [f"the motors give {mean:.4g} N m on average, but a load pulls out: {ports}"]


def _driving_friction(columns: Columns, crane: Crane) -> list[str]:
    t_value = opposes_motion(columns, crane)
    if t_value > 0.0 or not told(t_value):
        return []
    known = rope_over_motor(columns, crane)
    groups = [g for g in groups_of(columns) if g in crane.groups]
    sign = "the sign of motor_speed is the other (positive is hoisting)"
    ports = f"ports A and B of group '{groups[0]}' were swapped" if len(groups) > 1 else ""
    causes = [ports] if known is not None and ports else [sign, *([ports] if ports else [])]
    return [f"friction would drive the motion instead of opposing it: {' or '.join(causes)}"]
