"""Numba's cache, kept where a change of any source of the simulation makes it a new one.

Numba itself notices changes of the file that a function stands in, not of the functions that it calls.
"""

import hashlib
import inspect
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

import numba

import winch_friction.physics.friction.symbols as symbols
import winch_friction.physics.units as units

_numba_config: Any = numba.config


def compiled(function: Callable[..., Any]) -> Any:
    """`numba.njit`, cached between processes where a cache can be written."""
    with _cache_directory(_directory()):
        try:
            return numba.njit(cache=True, error_model="numpy")(function)
        except RuntimeError:  # no place to write: compile anew in every process
            return numba.njit(error_model="numpy")(function)


def in_order(function: Any, *given: str, **named: Any) -> tuple[Any, ...]:
    """Arguments of a compiled function by their names, in the order of its parameters, for calls that cost no names.

    `given` are the first parameters, which each call brings itself; `TypeError` for names that do not fit.
    """
    wanted = list(inspect.signature(getattr(function, "py_func", function)).parameters)
    if wanted[: len(given)] != list(given) or set(wanted[len(given) :]) != set(named):
        odd = set(wanted[len(given) :]) ^ set(named)
        raise TypeError(f"{function}: {sorted(odd) or given} do not fit its parameters {wanted}")
    return tuple(named[name] for name in wanted[len(given) :])


@contextmanager
def _cache_directory(path: str) -> Iterator[None]:
    before = _numba_config.CACHE_DIR
    _numba_config.CACHE_DIR = path
    try:
        yield
    finally:
        _numba_config.CACHE_DIR = before


@lru_cache(maxsize=1)
def _directory() -> str:
    own = sorted(Path(__file__).parent.rglob("*.py"))
    return str(cache_root() / source_digest([*own, Path(str(symbols.__file__)), Path(str(units.__file__))]))


def cache_root() -> Path:
    """Where compiled code is kept: the user's cache, or the temporary directory where that cannot be written."""
    root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "winch_friction" / "numba"
    return root if _writable(root) else Path(tempfile.gettempdir()) / f"winch_friction_numba_{os.getuid()}"


def source_digest(sources: Iterable[Path]) -> str:
    """A key that changes with any of these files and with numba itself."""
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
