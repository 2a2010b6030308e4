"""Field types of scenario and plant files: a number in SI, or a mapping {value, unit}, within limits."""

import operator
from collections.abc import Callable, Generator, Mapping
from numbers import Integral
from typing import Any, get_origin

from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import as_quantity, finite
from winch_friction.simulation.pydantic_v1 import BaseModel, Field, ModelField, ValidationError, validator

Validators = Generator[Callable[..., Any], None, None]
LIMITS: dict[str, tuple[Callable[[Any, Any], bool], str]] = {
    "gt": (operator.gt, "greater than"),
    "ge": (operator.ge, "at least"),
    "le": (operator.le, "at most"),
}


def limited(default: Any = ..., *, gt: float | None = None, ge: float | None = None, le: float | None = None) -> Any:
    """A field of one of the types below with its limits; without a default it must be given.

    pydantic's own `Field(gt=...)` would put a bare float in the place of our type, and its unit would be lost.
    """
    return Field(default, limits={"gt": gt, "ge": ge, "le": le})


def _within(value: float, field: ModelField) -> float:
    for name, limit in field.field_info.extra.get("limits", {}).items():
        holds, words = LIMITS[name]
        if limit is not None and not holds(value, limit):
            raise ValueError(f"must be {words} {limit:g}, found {value!r}")
    return value


class Number(float):
    """A finite number."""

    @classmethod
    def __get_validators__(cls) -> Validators:
        yield cls.read
        yield _within

    @classmethod
    def read(cls, content: Any) -> float:
        """The number; raises `InputError`."""
        return finite(content, "value")


class Whole(int):
    """A whole number."""

    @classmethod
    def __get_validators__(cls) -> Validators:
        yield cls.read
        yield _within

    @classmethod
    def read(cls, content: Any) -> int:
        """The number; raises `InputError` or `ValueError`."""
        if isinstance(content, Integral) and not isinstance(content, bool):
            return int(content)
        value = finite(content, "value")
        if not value.is_integer():
            raise ValueError(f"must be a whole number, found {content!r}")
        return int(value)


class Quantity(Number):
    """A number in SI, or a mapping {value, unit}."""

    unit = ""

    @classmethod
    def read(cls, content: Any) -> float:
        """The value in SI; raises `InputError`."""
        return as_quantity(content, cls.unit, f"in {cls.unit}")


class Seconds(Quantity):
    unit = "s"


class Metres(Quantity):
    unit = "m"


class MetresPerSecond(Quantity):
    unit = "m/s"


class CubicMetres(Quantity):
    unit = "m^3"


class CubicMetresPerSecond(Quantity):
    unit = "m^3/s"


class Pascals(Quantity):
    unit = "Pa"


class Radians(Quantity):
    unit = "rad"


class RadiansPerSecond(Quantity):
    unit = "rad/s"


class Kilograms(Quantity):
    unit = "kg"


class Displacement(Quantity):
    unit = "m^3/rad"


class Strict(BaseModel):
    """Unknown keys are refused, values are frozen."""

    class Config:
        extra = "forbid"
        frozen = True

    @classmethod
    def __get_validators__(cls) -> Validators:
        yield cls._keyed
        yield cls.validate

    @classmethod
    def _keyed(cls, content: Any) -> Any:
        """Content with keys; pydantic alone would also take a list of pairs, and an empty list as all defaults."""
        return content if isinstance(content, cls) else _mapping(content)

    @validator("*", pre=True)
    def _named(cls, content: Any, field: ModelField) -> Any:
        return _mapping(content) if get_origin(field.outer_type_) is dict else content


def _mapping(content: Any) -> Any:
    if not isinstance(content, Mapping):
        raise ValueError("must be a mapping of keys")
    for key in content:
        if not isinstance(key, str):
            raise ValueError(f"keys must be strings, found {key!r}")
    return content


def validated(kind: type[Any], content: Any, where: str) -> Any:
    """A checked object, or `InputError` with all complaints."""
    try:
        return kind(**_mapping(content))
    except ValidationError as error:
        raise InputError(*(f"{where}: {each}" for each in _complaints(error, content))) from None
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None


def _complaints(error: ValidationError, content: Any) -> list[str]:
    return list(dict.fromkeys(_complaint(each, content) for each in error.errors()))


def _complaint(first: Any, content: Any) -> str:
    place, found = _found(content, first["loc"])
    if first["type"] == "value_error.extra":
        return f"unknown key '{place}'; remove it or correct its name"
    message = first["msg"]
    shown = f", found {found!r}" if isinstance(found, (int, float, str)) and "found" not in message else ""
    return f"{place}: {message}{shown}" if place else f"{message}"


def _found(content: Any, location: tuple[int | str, ...]) -> tuple[str, Any]:
    """The key path and what stands there. A member of a union is named by its class, which is no key."""
    path = []
    for part in location:
        if part == "__root__":
            return "", None
        inside = isinstance(content, Mapping) and part in content or isinstance(content, (list, tuple))
        path.append(str(part) if inside else str(part).lower())
        content = content[part] if inside else content
    return ".".join(path), content
