"""The units that a Parquet file says beside its names: of each column, of the whole file, or as pandas keeps them.

Arrow keeps notes of a column as bytes by bytes (`unit`: `bar`); whole files hold a table of them as JSON under `units`,
and pandas writes `frame.attrs` as JSON under `PANDAS_ATTRS`.
"""

import json
from collections.abc import Mapping
from typing import Any

KEYS = ("unit", "units")  # in any letter case


def said_units(schema: Any) -> dict[str, str]:
    """Column -> unit of an Arrow schema, for the columns that have one; a column's own note goes before the file's."""
    whole = schema.metadata or {}
    tables = [_table(whole, "PANDAS_ATTRS").get("units"), _table(whole, *KEYS)]
    found = {name: unit for table in tables if isinstance(table, Mapping) for name, unit in table.items()}
    found |= {field.name: unit for field in schema if (unit := _text(field.metadata or {}, *KEYS))}
    return {name: unit.strip() for name, unit in found.items() if isinstance(unit, str) and unit.strip()}


def _text(notes: Mapping[bytes, bytes], *keys: str) -> str:
    for key, value in notes.items():
        if key.decode("utf-8", "replace").lower() in [each.lower() for each in keys]:
            return value.decode("utf-8", "replace")
    return ""


def _table(notes: Mapping[bytes, bytes], *keys: str) -> Mapping[str, Any]:
    try:
        content = json.loads(_text(notes, *keys) or "{}")
    except ValueError:
        return {}
    return content if isinstance(content, dict) else {}
