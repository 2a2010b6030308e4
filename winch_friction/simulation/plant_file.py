"""Plant files: what a simulation needs beyond the crane file (hydraulics, accumulator, pump), checked by pydantic."""

from pathlib import Path

from pydantic import Field

from winch_friction.records.paths import shipped
from winch_friction.records.strict_yaml import read_yaml
from winch_friction.simulation.quantities import (
    CubicMetres,
    CubicMetresPerSecond,
    Pascals,
    Radians,
    RadiansPerSecond,
    Seconds,
    Strict,
    validated,
)


class Pump(Strict):
    """The active side's pump: first-order lag, or second order where `bandwidth` is given."""

    flow: CubicMetresPerSecond = Field(gt=0.0)
    lag: Seconds = Field(default=0.1, gt=0.0)
    bandwidth: RadiansPerSecond = Field(default=0.0, ge=0.0)
    damping: float = Field(default=1.0, gt=0.0)


class ActiveLoop(Strict):
    """The closed loop: volume per side, bulk modulus, boost and relief."""

    volume: CubicMetres = Field(gt=0.0)
    bulk_modulus: Pascals = Field(gt=0.0)
    air: float = Field(default=0.0, ge=0.0, le=0.2)
    boost_pressure: Pascals = Field(gt=0.0)
    relief_pressure: Pascals = Field(gt=0.0)
    valve_gain: float = Field(gt=0.0)


class Accumulator(Strict):
    """The passive side's gas."""

    pressure: Pascals = Field(gt=0.0)
    low_pressure: Pascals = Field(gt=0.0)
    gas_volume: CubicMetres = Field(gt=0.0)
    exponent: float = Field(default=1.2, gt=1.0, le=1.8)
    thermal_time: Seconds = Field(default=0.0, ge=0.0)


class PlantFile(Strict):
    """A plant around a crane."""

    schema_: str = Field(alias="schema", pattern=r"^winch_friction\.plant/1$")
    name: str
    description: str = ""
    pump: Pump
    active_loop: ActiveLoop
    accumulator: Accumulator
    leakage: float = Field(ge=0.0)
    case_leakage: float = Field(default=0.0, ge=0.0)
    torque_lag: Seconds = Field(default=0.05, gt=0.0)
    wire_damping: float = Field(ge=0.0)
    presliding: Radians = Field(gt=0.0)


def load_plant(name: str | Path) -> PlantFile:
    """A plant by path or shipped name; raises `InputError` in one line."""
    path = shipped("plants", name)
    return validated(PlantFile, read_yaml(path), str(path))
