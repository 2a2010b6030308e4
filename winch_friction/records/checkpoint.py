"""Checkpoints of the estimator: JSON, written atomically, versioned, refused when it is not one."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError
from winch_friction.records.atomic import write_text

SCHEMA = "winch_friction.checkpoint/1"


def write_checkpoint(path: Path | str, snapshot: Mapping[str, Any]) -> Path:
    """Write an estimator's snapshot (plain types, keyed by crane and seed): a crash leaves the old or the new."""
    content = {"schema": SCHEMA, "snapshot": dict(snapshot)}
    return write_text(Path(path), json.dumps(content, indent=1, allow_nan=False))


def read_checkpoint(path: Path | str) -> dict[str, Any] | None:
    """The snapshot, or None when there is no file yet; raises `InputError` for a file that is not a checkpoint."""
    path = Path(path)
    if not path.exists():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{path}: not a checkpoint ({error}); delete it to start over") from error
    if (
        not isinstance(content, dict)
        or content.get("schema") != SCHEMA
        or not isinstance(content.get("snapshot"), dict)
    ):
        raise InputError(f"{path}: not a checkpoint of schema '{SCHEMA}'; delete it to start over")
    return content["snapshot"]
