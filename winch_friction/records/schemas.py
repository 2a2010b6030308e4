"""JSON Schemas of the files that the strict reader takes apart: crane, model, practice; and their use.

The readers decide; a schema serves an editor's completion, and tells all problems of a file where a reader, which
stops at the first, has refused it.
"""

from collections.abc import Mapping
from typing import Any

from winch_friction.physics.errors import InputError, unknown_key

Schema = dict[str, Any]

TEXT: Schema = {"type": "string"}
# YAML 1.1 reads 1e-3 as a string, so a number may be one
NUMBER: Schema = {"type": ["number", "string"], "pattern": r"^[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"}
MAPPING_OF: Schema = {"type": "object"}
MOST_TOLD = 12  # problems of one file
_DRAFT = "https://json-schema.org/draft/2020-12/schema"


def quantity(unit: str, bounds: Mapping[str, float] | None = None) -> Schema:
    """A number in SI, or a mapping with value and unit; bounds are those of the number in SI."""
    spelled = {
        "type": "object",
        "properties": {"value": NUMBER, "unit": TEXT},
        "required": ["value"],
        "additionalProperties": False,
    }
    words = f"a number{'' if unit == '1' else f' in {unit}'}, or {{value, unit}}"
    return {"description": words, "anyOf": [{**NUMBER, **(bounds or {})}, spelled]}


def _object(required: Mapping[str, Schema], optional: Mapping[str, Schema] | None = None, **more: Any) -> Schema:
    optional = optional or {}
    return {
        "type": "object",
        "properties": {**required, **optional},
        "required": list(required),
        "additionalProperties": False,
        **more,
    }


def _tag(name: str) -> Schema:
    return {"const": f"winch_friction.{name}/1"}


# kinds of value, as people say them
_KINDS = {"integer": "a whole number", "number": "a number", "string": "a text", "array": "a list [...]",
          "object": "a mapping of keys", "boolean": "true or false"}  # fmt: skip
_BOUNDS = {"exclusiveMinimum": "above", "minimum": "at least", "exclusiveMaximum": "below", "maximum": "at most"}
_DRIVES = ["hydraulic", "electric", "power", "current"]
_DRIVE = _object(
    {"kind": {"enum": _DRIVES}}, {"torque_constant": quantity("N*m/A"), "slowest_speed": quantity("rad/s")}
)
_VALUE = _object({"value": NUMBER, "unit": TEXT}, {"std": NUMBER, "lower": NUMBER, "upper": NUMBER})
_PAIR: Schema = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2}
_CORRECTION = _object(
    {"value": NUMBER, "unit": TEXT},
    {
        "std": NUMBER,
        "lower": NUMBER,
        "upper": NUMBER,
        "source": TEXT,
        "groups": {"type": "array", "items": TEXT},
        "layers": {"type": "array", "items": {"type": "integer", "minimum": 1}},
        "time_constant": quantity("s"),
        "beyond": quantity("Pa or m^3/rad"),
        "during": {"type": "array", "items": _PAIR},
        "course": {"type": "array", "items": _PAIR, "minItems": 2},
    },
)
_GROUP: Schema = {
    "type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_]*$",
    "description": "a name of a motor group: letters, digits and _, a letter first",
}  # fmt: skip
_NAMES: Schema = {"type": "array", "items": TEXT}
_CONSTANTS = {
    "max_displacement": quantity("m^3/rad"), "density": quantity("kg/m^3"), "viscosity": quantity("Pa*s"),
    "gear_ratio": quantity("1"),
}  # fmt: skip
DECLARED: dict[str, Schema] = {
    "crane": _object(
        {
            "schema": _tag("crane"),
            "name": TEXT,
            "drive": {"anyOf": [{"enum": _DRIVES[:3]}, _DRIVE]},
            "gear_ratio": quantity("1", {"exclusiveMinimum": 0}),
            "drum": _object({"layer_radii": {"type": "array", "minItems": 1, "items": quantity("m")}}),
            "groups": {
                **MAPPING_OF, "propertyNames": _GROUP, "additionalProperties": {"type": "integer", "minimum": 1},
            },
            "inertia": quantity("kg*m^2", {"exclusiveMinimum": 0}),
            "absolute_torque_limit": quantity("N*m", {"exclusiveMinimum": 0}),
        },
        {
            "max_displacement": quantity("m^3/rad", {"exclusiveMinimum": 0}),
            "wire_mass": quantity("kg/m"),
            "wire_stiffness": quantity("N", {"exclusiveMinimum": 0}),
            "rated_pressure": quantity("Pa", {"exclusiveMinimum": 0}),
            "rated_speed": quantity("rad/s", {"exclusiveMinimum": 0}),
            "rated_load": quantity("kg", {"exclusiveMinimum": 0}),
            "description": TEXT,
        },
    ),
    "model": _object(
        {
            "schema": _tag("model"),
            "name": TEXT,
            "terms": {"type": "array", "items": TEXT, "uniqueItems": True},
            "parameters": {**MAPPING_OF, "additionalProperties": _VALUE},
        },
        {
            "crane": TEXT,
            "constants": {**MAPPING_OF, "properties": _CONSTANTS},
            "corrections": {
                **MAPPING_OF,
                "additionalProperties": {"anyOf": [_CORRECTION, {"type": "array", "items": _CORRECTION}]},
            },
            "correlation": {"type": "array", "items": {"type": "array"}},
            "tables": {},
            "provenance": {"type": ["object", "null"]},
            "description": TEXT,
        },
    ),
    "practice": _object(
        {"schema": _tag("practice"), "name": TEXT, "crane": TEXT, "supplier_table": TEXT,
         "tests": {**_NAMES, "minItems": 1}},
        {"held_out_tests": _NAMES, "ahc_tests": _NAMES, "motor_model": TEXT, "note": TEXT},
    ),
}  # fmt: skip


def titled(name: str, schema: Schema) -> Schema:
    """The schema as a file of its own."""
    return {"$schema": _DRAFT, "$id": f"winch_friction.{name}/1", "title": f"winch_friction {name} file", **schema}


def problems(content: Any, schema: Schema) -> list[str]:
    """What of a file's content breaks its schema, each with its place; empty without the library jsonschema."""
    try:
        from jsonschema import Draft202012Validator
    except ModuleNotFoundError:  # the nodes need none; the reader's own first complaint stands
        return []
    found = sorted(Draft202012Validator(schema).iter_errors(content), key=lambda each: [str(p) for p in each.path])
    return list(dict.fromkeys(said for each in found for said in _said(each)))


def _said(error: Any) -> list[str]:
    place = ".".join(str(part) for part in error.absolute_path)
    front = f"{place}: " if place else ""
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        unknown = [key for key in error.instance if key not in known]
        return [f"{front}{unknown_key(str(key), known)}" for key in unknown]
    if error.validator == "required":
        missing = [key for key in error.validator_value if key not in error.instance]
        return [f"{front}key '{key}' is missing" for key in missing]
    words = error.message
    beyond = [each for each in error.context or () if each.validator in _BOUNDS]
    inner = [each for each in error.context or () if each.validator != "type" or each.relative_path]  # nearly of a kind
    if beyond:  # a number, but not one that can be
        words = f"must be {_BOUNDS[beyond[0].validator]} {beyond[0].validator_value:g}, found {error.instance!r}"
    elif inner and isinstance(error.instance, Mapping):
        return [said for each in inner for said in _said(each)]
    elif error.validator == "uniqueItems":
        words = "must name each once"
    elif error.validator in ("anyOf", "pattern", "type"):
        kind = _KINDS.get(str(error.schema.get("type")), "what belongs here")
        words = f"must be {error.schema.get('description', kind)}, found {error.instance!r}"
    return [f"{front}{words}"]


def with_all_problems(refused: InputError, content: Any, name: str, where: str) -> InputError:
    """A reader's complaints, followed by whatever else the schema finds wrong with a file."""
    if not isinstance(content, Mapping):
        return InputError(f"{refused}: is this a {name} file?")  # a log, say: its keys are no subject
    first = list(refused.problems)
    others = [each for each in problems(content, DECLARED[name]) if not any(_same(each, said) for said in first)]
    more = [f"{where}: ... and {len(others) - MOST_TOLD} more"] if len(others) > MOST_TOLD else []
    return InputError(*first, *(f"{where}: {each}" for each in others[:MOST_TOLD]), *more)


def _same(problem: str, first: str) -> bool:
    """Whether a problem's place and key are those of the reader's own complaint."""
    place, _, words = problem.rpartition(": ")
    quoted = words.split("'")[1::2][:1]
    last = place.rpartition(".")[2]
    return (bool(last) and last in first and not quoted) or any(f"'{each}'" in first for each in quoted)
