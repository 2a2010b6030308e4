"""Field types of scenario and plant files: a number in SI, or a mapping {value, unit}."""

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError

from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import as_quantity


def _in(unit: str) -> Callable[[Any], float]:
    return lambda content: as_quantity(content, unit, f"in {unit}")


Seconds = Annotated[float, BeforeValidator(_in("s"))]
Metres = Annotated[float, BeforeValidator(_in("m"))]
MetresPerSecond = Annotated[float, BeforeValidator(_in("m/s"))]
CubicMetres = Annotated[float, BeforeValidator(_in("m^3"))]
CubicMetresPerSecond = Annotated[float, BeforeValidator(_in("m^3/s"))]
Pascals = Annotated[float, BeforeValidator(_in("Pa"))]
Radians = Annotated[float, BeforeValidator(_in("rad"))]
RadiansPerSecond = Annotated[float, BeforeValidator(_in("rad/s"))]
Kilograms = Annotated[float, BeforeValidator(_in("kg"))]
Displacement = Annotated[float, BeforeValidator(_in("m^3/rad"))]


class Strict(BaseModel):
    """Unknown keys are refused, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def validated(kind: type[Any], content: Any, where: str) -> Any:
    """A checked object, or `InputError` with the first complaint in one line."""
    try:
        return kind.model_validate(content)
    except ValidationError as error:
        raise InputError(f"{where}: {_first_complaint(error)}") from None


def _first_complaint(error: ValidationError) -> str:
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"]) or "content"
    if first["type"] == "extra_forbidden":
        return f"unknown key '{place}'; remove it or correct its name"
    message = first["msg"].removeprefix("Value error, ")
    found = first.get("input")
    shown = f", found {found!r}" if isinstance(found, (int, float, str)) and "found" not in message else ""
    return f"{place}: {message}{shown}"
