"""JSON Schemas of the configuration files, and all problems of a file at once.

Scenario and plant schemas are generated from the classes that read these files; those of crane, model and
practice, which a strict reader takes apart key by key, are in `records.schemas`, that of a map in
`importing.map_schema`, and held to the readers by tests.
"""

from collections.abc import Mapping
from typing import Any, get_args, get_origin

from winch_friction.records.schemas import DECLARED, MAPPING_OF, NUMBER, TEXT, quantity, titled
from winch_friction.simulation.plant_file import PlantFile
from winch_friction.simulation.pydantic_v1 import BaseModel
from winch_friction.simulation.quantities import Quantity, Whole
from winch_friction.simulation.scenario import Scenario

Schema = dict[str, Any]
_LIMITS = {"gt": "exclusiveMinimum", "ge": "minimum", "le": "maximum"}


def all_schemas() -> dict[str, Schema]:
    """Every schema by the kind of file, but that of a map."""
    own = {"scenario": schema_of(Scenario, "scenario"), "plant": schema_of(PlantFile, "plant")}
    return {name: titled(name, each) for name, each in sorted({**DECLARED, **own}.items())}


def schema_of(kind: type[BaseModel], name: str = "") -> Schema:
    """The schema of a class that reads a mapping."""
    fields = kind.__fields__.values()
    properties = {each.alias: _field(each) for each in fields}
    if name:
        properties["schema"] = {"const": f"winch_friction.{name}/1"}
    schema: Schema = {"type": "object", "properties": properties, "additionalProperties": False}
    required = [each.alias for each in fields if each.required]
    if required:
        schema["required"] = required
    words = (kind.__doc__ or "").strip().partition("\n\n")[0]
    return {"description": " ".join(words.split()), **schema} if words else schema


def _field(each: Any) -> Schema:
    limits = {k: v for k, v in each.field_info.extra.get("limits", {}).items() if v is not None}
    if each.pre_validators or any("_steps" in str(v) or "_speeds" in str(v) for v in each.class_validators):
        schema: Schema = {"type": "array"} if get_origin(each.outer_type_) is tuple else _type(each.outer_type_, limits)
    else:
        schema = _type(each.outer_type_, limits)
    if each.allow_none and not each.required:
        schema = {"anyOf": [schema, {"type": "null"}]}
    default = each.default
    if isinstance(default, (str, int, float, bool)) and default != "":
        schema = {**schema, "default": default}
    return schema


def _type(kind: Any, limits: Mapping[str, float]) -> Schema:
    origin = get_origin(kind)
    if str(origin) in ("typing.Literal", "<class 'typing.Literal'>"):
        return {"enum": list(get_args(kind))}
    if origin is dict:
        return {**MAPPING_OF, "additionalProperties": _type(get_args(kind)[1], limits)}
    if origin is tuple:
        return {"type": "array"}
    if origin is not None:  # a union of classes
        return {"anyOf": [_type(each, limits) for each in get_args(kind) if each is not type(None)]}
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return schema_of(kind)
    bounds = {_LIMITS[name]: value for name, value in limits.items()}
    if isinstance(kind, type) and issubclass(kind, Quantity):
        return quantity(kind.unit, bounds)
    if kind is bool:
        return {"type": "boolean"}
    if isinstance(kind, type) and issubclass(kind, Whole):
        return {"type": "integer", **bounds}
    if isinstance(kind, type) and issubclass(kind, float):
        return {**NUMBER, **bounds}
    return dict(TEXT)
