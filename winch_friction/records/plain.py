"""Content as JSON has it."""

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
