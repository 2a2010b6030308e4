"""Crane files: the winch as the friction functions see it, from YAML."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import SLOWEST_FOR_POWER, Crane, Drive, Drum
from winch_friction.records.atomic import shipped
from winch_friction.records.schemas import with_all_problems
from winch_friction.records.strict_yaml import Section, as_quantity, read_yaml

SCHEMA = "winch_friction.crane/1"
RATINGS = {"rated_pressure": "Pa", "rated_speed": "rad/s", "rated_load": "kg"}  # optional


def load_crane(name: str | Path) -> Crane:
    """A crane by path or shipped name; raises `InputError` for anything that is not a complete crane file."""
    path = shipped("cranes", name)
    content = read_yaml(path)
    try:
        return crane_from_content(content, str(path))
    except InputError as error:
        raise with_all_problems(error, content, "crane", str(path)) from None


def crane_from_content(content: Any, where: str) -> Crane:
    """A crane from parsed YAML."""
    top = Section(content, where)
    if top.text("schema") != SCHEMA:
        raise InputError(f"{where}: schema '{top.text('schema')}' is not '{SCHEMA}'")
    drive = _drive(top)
    crane = Crane(
        name=top.text("name"),
        drive=drive,
        gear_ratio=_positive(top, "gear_ratio", "1"),
        drum=_drum(top),
        groups=_groups(top),
        inertia=_positive(top, "inertia", "kg*m^2"),
        max_displacement=_positive(top, "max_displacement", "m^3/rad") if drive.hydraulic else 0.0,
        wire_mass=top.quantity("wire_mass", "kg/m") if "wire_mass" in top else 0.0,
        wire_stiffness=_positive(top, "wire_stiffness", "N") if "wire_stiffness" in top else float("inf"),
        absolute_torque_limit=_positive(top, "absolute_torque_limit", "N*m"),
        **{key: _positive(top, key, unit) for key, unit in RATINGS.items() if key in top},
    )
    top.get("description")
    top.close()
    return crane


def _drive(top: Section) -> Drive:
    """`drive: hydraulic`, or a mapping where the kind needs a number: `{kind: current, torque_constant: ...}`, or
    `{kind: power, slowest_speed: ...}`.
    """
    given = top.need("drive")
    if not isinstance(given, Mapping):
        given = {"kind": given}
    section = Section(given, f"{top.where}: drive")
    kind = section.text("kind")
    constant = section.quantity("torque_constant", "N*m/A") if "torque_constant" in section else 0.0
    slowest = section.quantity("slowest_speed", "rad/s") if "slowest_speed" in section else SLOWEST_FOR_POWER
    section.close()
    try:
        return Drive(kind, constant, slowest)
    except InputError as error:
        raise InputError(f"{top.where}: {error}") from None


def _positive(section: Section, key: str, unit: str) -> float:
    value = section.quantity(key, unit)
    if value <= 0.0:
        raise InputError(f"{section.where}: {key} must be above 0, found {value:g}")
    return value


def _drum(top: Section) -> Drum:
    section = top.section("drum")
    radii = section.need("layer_radii")
    if not isinstance(radii, list) or not radii:
        raise InputError(f"{section.where}: layer_radii must be a list of radii in m, innermost layer first")
    values = tuple(as_quantity(r, "m", f"{section.where}: layer_radii[{k + 1}]") for k, r in enumerate(radii))
    section.close()
    if min(values) <= 0.0 or list(values) != sorted(values):
        raise InputError(f"{section.where}: layer_radii must be positive and grow from layer to layer")
    return Drum(values)


def _groups(top: Section) -> dict[str, int]:
    section = top.section("groups")
    groups = {}
    for name in section.content:
        count = section.get(name)
        if isinstance(count, bool) or not isinstance(count, int) or count < 1:
            raise InputError(f"{section.where}: {name} must be a whole number of motors, found {count!r}")
        groups[str(name)] = count
    return groups
