"""Plant files: what a simulation needs beyond the crane file (hydraulics, accumulator, pump), checked by pydantic."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from winch_friction.physics.errors import InputError
from winch_friction.records.paths import shipped
from winch_friction.records.strict_yaml import as_quantity, read_yaml


def quantity(unit: str) -> Any:
    """Field type: a number in SI or a mapping {value, unit}."""
    return Annotated[float, BeforeValidator(lambda content: as_quantity(content, unit, f"in {unit}"))]


class Strict(BaseModel):
    """Unknown keys are refused, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Pump(Strict):
    """The active side's pump: first-order lag, or second order where `bandwidth` is given."""

    flow: quantity("m^3/s") = Field(gt=0.0)
    lag: quantity("s") = Field(0.1, gt=0.0)
    bandwidth: quantity("rad/s") = Field(0.0, ge=0.0)
    damping: float = Field(1.0, gt=0.0)


class ActiveLoop(Strict):
    """The closed loop: volume per side, bulk modulus, boost and relief."""

    volume: quantity("m^3") = Field(gt=0.0)
    bulk_modulus: quantity("Pa") = Field(gt=0.0)
    air: float = Field(0.0, ge=0.0, le=0.2)
    boost_pressure: quantity("Pa") = Field(gt=0.0)
    relief_pressure: quantity("Pa") = Field(gt=0.0)
    valve_gain: float = Field(gt=0.0)


class Accumulator(Strict):
    """The passive side's gas."""

    pressure: quantity("Pa") = Field(gt=0.0)
    low_pressure: quantity("Pa") = Field(gt=0.0)
    gas_volume: quantity("m^3") = Field(gt=0.0)
    exponent: float = Field(1.2, gt=1.0, le=1.8)
    thermal_time: quantity("s") = Field(0.0, ge=0.0)


class PlantFile(Strict):
    """A plant around a crane."""

    schema_: str = Field(alias="schema", pattern=r"^winch_friction\.plant/1$")
    name: str
    description: str = ""
    pump: Pump
    active_loop: ActiveLoop
    accumulator: Accumulator
    leakage: float = Field(ge=0.0)
    case_leakage: float = Field(0.0, ge=0.0)
    torque_lag: quantity("s") = Field(0.05, gt=0.0)
    wire_damping: float = Field(ge=0.0)
    presliding: quantity("rad") = Field(gt=0.0)


def load_plant(name: str | Path) -> PlantFile:
    """A plant by path or shipped name; raises `InputError` in one line."""
    path = shipped("plants", name)
    return validated(PlantFile, read_yaml(path), str(path))


def validated(kind: type[Any], content: Any, where: str) -> Any:
    """A checked object, or `InputError` with the first complaint in one line."""
    try:
        return kind.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{where}: {_first_complaint(error)}") from None


def _first_complaint(error: ValidationError) -> str:
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"]) or "content"
    found = first.get("input")
    shown = f", found {found!r}" if isinstance(found, (int, float, str)) else ""
    if first["type"] == "extra_forbidden":
        return f"unknown key '{place}'; remove it or correct its name"
    return f"{place}: {first['msg'].removeprefix('Value error, ')}{shown}"
