"""Texts that cost time to make, kept on disk from one start to the next: a seal in the first line says whether the rest
is whole. A file that is not, or that is another user's, counts as none."""

import hashlib
import os
import tempfile
from pathlib import Path


def read_kept(path: Path) -> str | None:
    """The text of a whole file of our own; None for any other."""
    try:
        with path.open(encoding="utf-8") as stream:
            if os.fstat(stream.fileno()).st_uid != os.getuid():
                return None
            first, text = stream.readline(), stream.read()
    except (OSError, ValueError):
        return None
    return text if first == _seal(text) else None


def keep(path: Path, text: str) -> None:
    """Write a text in one step, as several processes may make the same; the seal, not a flush to disk, says whether it
    is whole. Raises `OSError` where it cannot be written."""
    handle, name = tempfile.mkstemp(dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as stream:
            stream.write(_seal(text) + text)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def _seal(text: str) -> str:
    return f"# {hashlib.sha256(text.encode()).hexdigest()}\n"
