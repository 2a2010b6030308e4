"""Mistakes that a log may hold, put into runs: what is checked to be found, each with the cause that is to be named."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from winch_friction.physics.channels import CM3_PER_REV, RPM

Columns = dict[str, np.ndarray]
PRESSURES = ("pressure_a", "pressure_b")


@dataclass(frozen=True)
class Spoil:
    """A mistake: what it does to a run's columns, and the cause (and channels) that may be named for it."""

    name: str
    apply: Callable[[Columns], Columns]
    cause: str
    channels: tuple[str, ...]
    needs: str = ""  # a column without which it cannot be made


def times(factor: float, *endings: str, group: str = "") -> Callable[[Columns], Columns]:
    return lambda columns: {
        name: values * factor if name.endswith(endings) and name.startswith(group) else values
        for name, values in columns.items()
    }


def ports(group: str = "") -> Callable[[Columns], Columns]:
    def apply(columns: Columns) -> Columns:
        spoilt = dict(columns)
        for name in columns:
            if name.endswith("pressure_a") and name.startswith(group):
                other = name[:-1] + "b"
                spoilt[name], spoilt[other] = columns[other], columns[name]
        return spoilt

    return apply


def exchanged(columns: Columns) -> Columns:
    other = {"active": "passive", "passive": "active"}
    return {
        ".".join([other.get(name.partition(".")[0], name.partition(".")[0]), *name.split(".")[1:]]): values
        for name, values in columns.items()
    }


def late(seconds: float) -> Callable[[Columns], Columns]:
    def apply(columns: Columns) -> Columns:
        time = columns["time"]
        return {**columns, "motor_speed": np.interp(time - seconds, time, columns["motor_speed"])}

    return apply


def cell(ending: str) -> Callable[[Columns], Columns]:
    def apply(columns: Columns) -> Columns:
        name = next(each for each in columns if each.endswith(ending))
        values = columns[name].copy()
        values[len(values) // 3] = 1e30
        return {**columns, name: values}

    return apply


def spoils(max_displacement: float, gear_ratio: float) -> list[Spoil]:
    """Every mistake, for a crane with these figures."""
    fraction = CM3_PER_REV / max_displacement
    return [
        Spoil("kg under [t]", times(1e3, "hook_load"), "unit", ("hook_load",), "hook_load"),
        Spoil("t under [kg]", times(1e-3, "hook_load"), "unit", ("hook_load",), "hook_load"),
        Spoil("kN under [t]", times(9.81, "hook_load"), "unit", ("hook_load",), "hook_load"),
        Spoil("Pa under [bar]", times(1e5, *PRESSURES), "unit", ("pressure",)),
        Spoil("bar under [Pa]", times(1e-5, *PRESSURES), "unit", ("pressure",)),
        Spoil("MPa under [bar]", times(0.1, *PRESSURES), "unit", ("pressure",), "hook_load"),
        Spoil("psi under [bar]", times(14.5038, *PRESSURES), "unit", ("pressure",)),
        Spoil("rad/s under [rpm]", times(RPM, "motor_speed"), "unit", ("motor_speed",)),
        Spoil("rpm under [rad/s]", times(1.0 / RPM, "motor_speed"), "unit", ("motor_speed",)),
        Spoil("drum's speed", times(1.0 / gear_ratio, "motor_speed"), "unit", ("motor_speed",)),
        Spoil("all speeds in rad/s", times(RPM, "motor_speed", "speed_reference"), "unit", ("motor_speed",)),
        Spoil("speed sign", times(-1.0, "motor_speed"), "sign", ("motor_speed",)),
        Spoil("every speed's sign", times(-1.0, "motor_speed", "speed_reference", "shaft_angle"), "sign",
              ("motor_speed",)),
        Spoil("ports", ports(), "ports", ("pressure",)),
        Spoil("ports of the passive group", ports("passive"), "ports", ("passive.pressure",), "passive.pressure_a"),
        Spoil("ports of the active group", ports("active"), "ports", ("active.pressure",), "passive.pressure_a"),
        Spoil("groups exchanged", exchanged, "groups", ("active, passive", "passive, active"), "passive.pressure_a"),
        Spoil("cm^3/rev read per radian", times(2.0 * np.pi, "displacement"), "unit", ("displacement",), "hook_load"),
        Spoil("fraction under [cm^3/rev]", times(fraction, "displacement"), "unit", ("displacement",)),
        Spoil("displacement of all motors", times(1.7, "displacement"), "scale",
              ("displacement", "hook_load", "gear_ratio"), "hook_load"),
        Spoil("speed late by 1 s", late(1.0), "delay", ("motor_speed",), "passive.pressure_a"),
        Spoil("one pressure of 1e30", cell("pressure_a"), "cell", ("main.pressure_a", "active.pressure_a",
              "passive.pressure_a")),
        Spoil("one load of 1e30", cell("hook_load"), "cell", ("hook_load",), "hook_load"),
    ]  # fmt: skip
