"""Content as JSON has it, out of this package and into it."""

import json
from typing import Any


def finite(value: Any) -> Any:
    """Plain content with null for what JSON has no number for: not-a-number and infinity."""
    if isinstance(value, dict):
        return {str(key): finite(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(each) for each in value]
    if hasattr(value, "tolist"):
        return finite(value.tolist())
    return None if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))) else value


def own_metadata(text: Any, name: str) -> tuple[dict[str, Any], list[str]]:
    """What this package wrote about a run, from its JSON; nothing where it is none, and then a warning of the run."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError, RecursionError):
        found = None
    if isinstance(found, dict):
        return found, []
    return {}, [f"{name}: what it keeps of itself (crane, settings) is not the JSON that was written: left out"]
