"""The JSON Schema of map files, for editors that check while one writes; the reader itself is `mapping`."""

from typing import Any

from winch_friction.importing.mapping import BAD_CELLS, PLACES, SCHEMA
from winch_friction.importing.own_clocks import CLOCKS
from winch_friction.importing.time_base import FORMS, ORDERS
from winch_friction.importing.units import CHANNEL_UNITS

_TEXT = {"type": "string"}
_TEXTS = {"oneOf": [_TEXT, {"type": "array", "items": _TEXT}]}
_SURE = {"type": "number", "minimum": 0, "maximum": 1}
_ROW = {"type": "integer", "minimum": 0}


def map_schema() -> dict[str, Any]:
    """The schema as plain types, without its title."""
    channels = "|".join(CHANNEL_UNITS)
    return {
        "type": "object",
        "required": ["schema", "columns"],
        "additionalProperties": False,
        "properties": {
            "schema": {"const": SCHEMA},
            "crane": _TEXT,
            "questions": _TEXTS,
            "log": _object({
                **dict.fromkeys(("kind", "encoding", "thousands", "sheet", "namespace"), _TEXT),
                "clocks": {"enum": list(CLOCKS)},
                **dict.fromkeys(("delimiter", "decimal"), {**_TEXT, "minLength": 1, "maxLength": 1}),
                **dict.fromkeys(("names_row", "unit_row", "first_row"), _ROW),
            }),
            "time": _object({
                "from": _TEXTS, "form": {"enum": list(FORMS)}, "unit": _TEXT, "order": {"enum": ["", *ORDERS]},
                "zone": _TEXT, "spread": {"type": "boolean"}, "fraction": _TEXT, "confidence": _SURE, "because": _TEXT,
            }),
            "columns": {
                "type": "object",
                "minProperties": 1,
                "additionalProperties": False,
                "patternProperties": {rf"^([^.]+\.)?({channels})$": _entry()},
            },
            "bad_cells": {"enum": list(BAD_CELLS)},
            "unused": _TEXTS,
        },
    }  # fmt: skip


def _entry() -> dict[str, Any]:
    return _object(
        {
            "from": _TEXT, "unit": _TEXT, "sign": {"enum": [1, -1]}, "factor": {"type": "number", "not": {"const": 0}},
            "add": {"type": "number"}, "of": _TEXT, "at": {"enum": list(PLACES)},
            "differentiate": {"type": "number", "minimum": 0}, "constant": _TEXT, "confidence": _SURE, "because": _TEXT,
        },
    ) | {"anyOf": [{"required": ["from"]}, {"required": ["constant"]}]}  # fmt: skip


def _object(properties: dict[str, Any], required: tuple[str, ...] = ()) -> dict[str, Any]:
    needed = {"required": list(required)} if required else {}
    return {"type": "object", "additionalProperties": False, "properties": properties, **needed}
