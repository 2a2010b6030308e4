"""Plant files: what a simulation needs beyond the crane file (hydraulics, accumulator, pump), checked by pydantic."""

from pathlib import Path
from typing import Literal

from winch_friction.records.paths import shipped
from winch_friction.records.strict_yaml import read_yaml
from winch_friction.simulation.pydantic_v1 import Field, StrictStr
from winch_friction.simulation.quantities import (
    CubicMetres,
    CubicMetresPerSecond,
    Number,
    Pascals,
    Radians,
    RadiansPerSecond,
    Seconds,
    Strict,
    limited,
    validated,
)


class Pump(Strict):
    """The active side's pump: first-order lag, or second order where `bandwidth` is given."""

    flow: CubicMetresPerSecond = limited(gt=0.0)
    lag: Seconds = limited(0.1, gt=0.0)
    bandwidth: RadiansPerSecond = limited(0.0, ge=0.0)
    damping: Number = limited(1.0, gt=0.0)


class ActiveLoop(Strict):
    """The closed loop: volume per side, bulk modulus, boost and relief."""

    volume: CubicMetres = limited(gt=0.0)
    bulk_modulus: Pascals = limited(gt=0.0)
    air: Number = limited(0.0, ge=0.0, le=0.2)
    boost_pressure: Pascals = limited(gt=0.0)
    relief_pressure: Pascals = limited(gt=0.0)
    valve_gain: Number = limited(gt=0.0)


class Accumulator(Strict):
    """The passive side's gas."""

    pressure: Pascals = limited(gt=0.0)
    low_pressure: Pascals = limited(gt=0.0)
    gas_volume: CubicMetres = limited(gt=0.0)
    exponent: Number = limited(1.2, gt=1.0, le=1.8)
    thermal_time: Seconds = limited(0.0, ge=0.0)


class PlantFile(Strict):
    """A plant around a crane."""

    schema_: Literal["winch_friction.plant/1"] = Field(alias="schema")
    name: StrictStr
    description: StrictStr = ""
    pump: Pump
    active_loop: ActiveLoop
    accumulator: Accumulator
    leakage: Number = limited(ge=0.0)
    case_leakage: Number = limited(0.0, ge=0.0)
    torque_lag: Seconds = limited(0.05, gt=0.0)
    wire_damping: Number = limited(ge=0.0)
    presliding: Radians = limited(gt=0.0)


def load_plant(name: str | Path) -> PlantFile:
    """A plant by path or shipped name; raises `InputError` in one line."""
    path = shipped("plants", name)
    return validated(PlantFile, read_yaml(path), str(path))
