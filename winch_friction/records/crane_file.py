"""Crane files: the winch as the friction functions see it, from YAML; and what a number in one can be at all."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.winch.crane import SLOWEST_FOR_POWER, Crane, Drive, Drum
from winch_friction.records.schemas import with_all_problems
from winch_friction.records.strict_yaml import Section, as_quantity, expect_kind, read_yaml, shipped

SCHEMA = "winch_friction.crane/1"
RATINGS = {"rated_pressure": "Pa", "rated_speed": "rad/s", "rated_load": "kg"}  # optional


def load_crane(name: str | Path) -> Crane:
    """A crane by path or shipped name; raises `InputError` for anything that is not a complete crane file."""
    path = shipped("cranes", name)
    content = read_yaml(path)
    expect_kind(content, "crane", str(path))
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
    readers: dict[str, Callable[[], Any]] = {
        "name": lambda: top.text("name"),
        "gear_ratio": lambda: _positive(top, "gear_ratio", "1"),
        "drum": lambda: _drum(top),
        "groups": lambda: _groups(top, drive),
        "inertia": lambda: _positive(top, "inertia", "kg*m^2"),
        "max_displacement": lambda: _positive(top, "max_displacement", "m^3/rad") if drive.hydraulic else 0.0,
        "wire_mass": lambda: top.quantity("wire_mass", "kg/m") if "wire_mass" in top else 0.0,
        "wire_stiffness": lambda: _positive(top, "wire_stiffness", "N") if "wire_stiffness" in top else float("inf"),
        "absolute_torque_limit": lambda: _positive(top, "absolute_torque_limit", "N*m"),
    }
    readers |= {key: partial(_positive, top, key, unit) for key, unit in RATINGS.items() if key in top}
    problems, read = Problems(), {}
    for key, reader in readers.items():
        with problems:
            read[key] = reader()
    top.get("description")
    with problems:
        top.close()
    problems.say()
    return check_ranges(Crane(drive=drive, **read), where)


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


_GROUP_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*", re.ASCII)  # the front of a column, and a part of a topic


def _groups(top: Section, drive: Drive) -> dict[str, int]:
    section, problems = top.section("groups"), Problems()
    if drive.hydraulic and not section.content:
        raise InputError(f"{section.where}: none is there; a hydraulic crane needs one at least, e.g. main: 11")
    groups = {}
    for name in section.content:
        with problems:
            groups[str(name)] = _motors(section, name)
    problems.say()
    return groups


def _motors(section: Section, name: Any) -> int:
    count = section.get(name)
    if not _GROUP_NAME.fullmatch(str(name)):
        raise InputError(
            f"{section.where}: '{name}' is no name of a motor group: write letters, digits and _, a letter first"
        )
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise InputError(f"{section.where}: {name} must be a whole number of motors, found {count!r}")
    return count


# -- what a number can be at all: ranges that hold bench rigs and the largest offshore cranes alike
MOST_MOTORS = 200  # on one shaft


@dataclass(frozen=True)
class Plausible:
    """Smallest and largest value in SI, a usual one, and the units, as factors to SI, that are taken for SI."""

    unit: str
    lower: float
    upper: float
    usual: float
    slips: Mapping[str, float]
    of: str = "winches"

    def check(self, value: float, where: str) -> None:
        """Raise `InputError` where no winch has this value; what is not said (0 or infinite) is nobody's slip."""
        if value in (0.0, math.inf) or self.lower <= value <= self.upper:
            return
        unit = "" if self.unit == "1" else f" {self.unit}"
        usual = f"of {self.of} {self.lower:.4g} ... {self.upper:.4g}{unit}"
        raise InputError(f"{where} is {value:.4g}{unit}, {usual}:{self._meant(value)}")

    def _meant(self, value: float) -> str:
        """The slip that makes it the most usual value; a ratio upside down is one too."""
        made = {name: value * factor for name, factor in self.slips.items()}
        if self.unit == "1" and value > 0.0:
            made["its inverse"] = 1.0 / value
        near = {name: v for name, v in made.items() if self.lower <= v <= self.upper}
        if not near:
            return " correct the number or its unit"
        name = min(near, key=lambda each: abs(math.log(near[each] / self.usual)))
        return f" did you mean {name} ({near[name]:.4g}{'' if self.unit == '1' else ' ' + self.unit})?"


RADIUS = Plausible("m", 1e-3, 10.0, 0.5, {"mm": 1e-3, "cm": 1e-2})
NUMBERS: Mapping[str, Plausible] = {
    "gear_ratio": Plausible("1", 0.1, 5000.0, 200.0, {}),
    "max_displacement": Plausible(
        "m^3/rad", 0.5 * CM3_PER_REV, 3e5 * CM3_PER_REV, 200.0 * CM3_PER_REV,
        {"cm^3/rev": CM3_PER_REV, "cm^3/rad": 1e-6, "l/rev": 1e3 * CM3_PER_REV},
    ),
    "wire_mass": Plausible("kg/m", 1e-3, 1000.0, 10.0, {"kg/km": 1e-3}),
    "wire_stiffness": Plausible("N", 1e3, 1e11, 3e8, {"kN": 1e3, "MN": 1e6, "GN": 1e9}),
    "rated_pressure": Plausible("Pa", 5.0 * BAR, 1500.0 * BAR, 350.0 * BAR, {"bar": BAR, "MPa": 1e6}),
    "rated_speed": Plausible("rad/s", 0.01, 3000.0, 400.0, {"rpm": RPM}),
    "rated_load": Plausible("kg", 0.1, 1e7, 5e4, {"t": 1e3}),
}  # fmt: skip
HYDRAULIC_STIFFNESS = Plausible("N", 1e6, 1e11, 3e8, {"kN": 1e3, "MN": 1e6, "GN": 1e9})  # a rope of 6 mm at least
LARGEST_AT_DRUM = 1e7  # kg m^2, of all that turns, seen from the drum: a drum of 400 t with 5 m of radius


def _inertia(gear_ratio: float) -> Plausible:
    """What turns may be as heavy as the largest drum; at the motor it is less by the ratio squared."""
    upper = LARGEST_AT_DRUM / max(gear_ratio, 1.0) ** 2
    return Plausible("kg*m^2", 1e-9, upper, upper / 100.0, {"kg*cm^2": 1e-4, "g*m^2": 1e-3})


HELD = (1.0 / 200.0, 20.0)  # of what the motors hold at 300 bar: a rated load; init asks within 0.1 and 2
_HOLDING = 300.0 * BAR


def _rated(crane: Crane) -> Plausible | None:
    """A rated load beside what the motors of a hydraulic crane hold on the innermost layer; None where none is said."""
    torque = max(crane.groups.values(), default=0) * crane.max_displacement * _HOLDING * crane.gear_ratio
    holds = torque / (GRAVITY * crane.drum.layer_radii[0])
    return (
        Plausible("kg", HELD[0] * holds, HELD[1] * holds, 0.5 * holds, {"t": 1e3}, "motors and a gear like these")
        if holds
        else None
    )


def check_ranges(crane: Crane, where: str) -> Crane:
    """The crane again; raises `InputError`, a line for each number that no winch has."""
    problems = Problems()
    for key, plausible in NUMBERS.items():
        if key == "wire_stiffness" and crane.drive.hydraulic:
            plausible = HYDRAULIC_STIFFNESS
        with problems:
            plausible.check(getattr(crane, key), f"{where}: {key}")
    if NUMBERS["gear_ratio"].lower <= crane.gear_ratio <= NUMBERS["gear_ratio"].upper:
        with problems:
            _inertia(crane.gear_ratio).check(crane.inertia, f"{where}: inertia (at the motor shaft)")
    with problems:
        for k, radius in enumerate(crane.drum.layer_radii, 1):  # one line tells all layers
            RADIUS.check(radius, f"{where}: drum: layer_radii[{k}]")
    for name, count in crane.groups.items():
        if count > MOST_MOTORS:
            with problems:
                raise InputError(f"{where}: groups: {name} has {count} motors, of winches 1 ... {MOST_MOTORS}")
    problems.say()
    if (rated := _rated(crane)) is not None:
        rated.check(crane.rated_load, f"{where}: rated_load")
    return crane
