"""Checkpoints of the estimator: JSON, written atomically, versioned, with a digest; refused when they are not whole."""

import hashlib
import itertools
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from winch_friction.physics.errors import InputError
from winch_friction.records.atomic import remove_stale, write_text

SCHEMA = "winch_friction.checkpoint/1"
OTHERS = re.compile(rb"schema\W+(winch_friction\.(?!checkpoint)\w+/\d+)")
LARGEST = 16_000_000  # bytes; a filter of 60 states has 100 thousand: a recording is not read into memory to be refused
HEAD = 4096  # bytes of a file, within which it says its schema


def write_checkpoint(path: Path | str, snapshot: Mapping[str, Any]) -> Path:
    """Write an estimator's snapshot (plain types, keyed by crane and seed): a crash leaves the old or the new."""
    content = {"schema": SCHEMA, "sha256": _digest(snapshot), "snapshot": dict(snapshot)}
    return write_text(Path(path), json.dumps(content, indent=1, allow_nan=False))


def file_there(path: Path | str) -> tuple[int, int] | None:
    """Which file stands there: another one in its place has another number and time; None where there is none."""
    try:
        found = Path(path).stat()
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns


def read_checkpoint(path: Path | str) -> dict[str, Any] | None:
    """The snapshot, or None when there is no file yet; raises `InputError` for what is not a whole checkpoint."""
    path = Path(path)
    remove_stale(path)
    if not path.exists():
        return None
    if not path.is_file():  # a pipe would be waited for, and no signal heard
        raise InputError(f"{path}: not a checkpoint, nor a file at all")
    if path.stat().st_size > LARGEST:
        raise InputError(f"{path}: not a checkpoint: {path.stat().st_size / 1e6:.0f} MB; name another file")
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a checkpoint ({error})") from error
    snapshot = content.get("snapshot") if isinstance(content, dict) else None
    if not isinstance(snapshot, dict) or content.get("schema") != SCHEMA:
        raise InputError(f"{path}: not a checkpoint of schema '{SCHEMA}'")
    if content.get("sha256") != _digest(snapshot):
        raise InputError(f"{path}: not a checkpoint as it was written (its digest differs)")
    return snapshot


def set_aside(path: Path | str) -> Path:
    """Give a file that was refused another name, so that the next checkpoint does not replace it; the name. Where none
    can be given, its own: it stands where nothing can be written.

    Raises `InputError` for what is no file, and could not be written either, and for another file of this package,
    which somebody needs where it is.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: not a file: no checkpoint can be written there")
    with path.open("rb") as stream:
        other = OTHERS.search(stream.read(HEAD))
    if other is not None:
        raise InputError(f"{path}: a file of schema '{other[1].decode()}', not a checkpoint: name another")
    names = (path.with_name(f"{path.name}.refused{number}") for number in itertools.chain(("",), itertools.count(2)))
    try:
        kept = next(each for each in names if not each.exists())
        path.rename(kept)
    except OSError:  # a disk that is read-only, or a name as long as it may be: nothing is written over there either
        return path
    return kept


def _digest(snapshot: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(dict(snapshot), sort_keys=True).encode()).hexdigest()
