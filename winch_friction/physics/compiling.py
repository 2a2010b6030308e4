"""Numba's cache, kept where a change of any source that a function is made of makes it a new one.

Numba itself notices changes of the file that a function stands in, not of the functions that it calls. It is
imported on use: a node runs without it.
"""

import gc
import hashlib
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def compiled_in(directory: str, function: Callable[..., Any], signature: str | None = None) -> Any:
    """`numba.njit` of a function, with its code kept in `directory`.

    With a `signature` it is compiled (or read) here and now. Raises `RuntimeError` where nothing can be written.
    """
    with uncollected():
        import numba

        with _cache_directory(directory):
            return numba.njit(signature, cache=True, error_model="numpy")(function)


@contextmanager
def uncollected() -> Iterator[None]:
    """No look for garbage while modules and compiled code are loaded: numba's are hundreds, none of it is garbage, and
    every look goes through all that SymPy holds."""
    before = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if before:
            gc.enable()


@contextmanager
def _cache_directory(path: str) -> Iterator[None]:
    import numba

    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, path
    try:
        yield
    finally:
        config.CACHE_DIR = before


def cache_root(kind: str = "numba") -> Path:
    """Where compiled code is kept: the user's cache, or the temporary directory where that cannot be written."""
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "winch_friction" / kind
    return root if _writable(root) else Path(tempfile.gettempdir()) / f"winch_friction_{kind}_{os.getuid()}"


def source_digest(sources: Iterable[Path]) -> str:
    """A key that changes with any of these files and with numba itself."""
    import numba

    digest = hashlib.sha256(numba.__version__.encode())
    for path in sources:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)
