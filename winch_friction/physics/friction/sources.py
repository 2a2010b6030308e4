"""Python sources of the functions that SymPy makes of declared equations, kept on disk: making them takes a second.

A source is found by everything that it was made of: the equations, SymPy, and the code that writes it. A file that is
not whole, or another user's, is made anew; where nothing can be written, nothing is kept.
"""

import hashlib
import inspect
import linecache
import math
import re
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np
import sympy as sp

from winch_friction.physics.compiling import cache_root
from winch_friction.physics.friction import symbols
from winch_friction.physics.kept import keep, read_kept

Function = Callable[..., Any]

NAME = "equation"
_SMALL_POWER = re.compile(r"(?<![\w.])([A-Za-z_]\w*)\*\*([23])(?!\*\*|[\w.])")  # of a name alone
MOST_FILES = 4000  # of 1 to 4 kB; a search of data leaves some thirty that never come again
_NAMESPACES: dict[str, dict[str, Any]] = {
    "math": {**vars(math), "__name__": __name__, "abs": abs},
    "numpy": {**vars(np), "__name__": __name__},
}


def function_of(key: str, dialect: str, make: Callable[[], Function]) -> Function:
    """The function whose equations are `key`, in `dialect` (`math`, `numpy`): read, or else made and kept."""
    path = _path(key)
    source = None if path is None else read_kept(path)
    if source is None:
        made = make()
        if not _plain(made, _NAMESPACES[dialect]):
            return made
        source = _multiplied(python_source(made, NAME))
        if path is not None:
            _write(path, source)
    return _executed(source, dialect)


def python_source(function: Function, name: str) -> str:
    """Source of a function that `sympy.lambdify` made, under another name, the same in every process."""
    source = inspect.getsource(function)
    for number, dummy in enumerate(dict.fromkeys(re.findall(r"_Dummy_\d+", source))):
        source = re.sub(rf"\b{dummy}\b", f"_argument_{number}", source)
    return re.sub(r"^def \w+\(", f"def {name}(", source, count=1) + "\n\n"


def _multiplied(source: str) -> str:
    """Squares and cubes as products: a power of floats costs Python two products and NumPy twenty."""
    return _SMALL_POWER.sub(lambda found: f"({'*'.join([found[1]] * int(found[2]))})", source)


def _plain(function: Function, namespace: dict[str, Any]) -> bool:
    """Whether its names mean the same here as where SymPy made it, so that its source is all of it."""
    code, own = function.__code__, function.__globals__  # type: ignore[attr-defined]
    nested = any(isinstance(each, CodeType) for each in code.co_consts)
    return not nested and all(namespace.get(name) is own[name] for name in code.co_names if name in own)


def _executed(source: str, dialect: str) -> Function:
    name = f"<equation {hashlib.sha256(source.encode()).hexdigest()[:16]}>"
    # where `inspect` and tracebacks look for it
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    own: dict[str, Any] = {}
    exec(compile(source, name, "exec"), _NAMESPACES[dialect], own)
    function: Function = own[NAME]
    return function


@lru_cache(maxsize=1)
def _folder() -> tuple[Path, str] | None:
    """Where they are kept, and what changes them besides the equations."""
    try:
        root = cache_root("equations")
        root.mkdir(parents=True, exist_ok=True)
        makers = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    except OSError:
        return None
    digest = hashlib.sha256(b"".join(makers) + symbols.__name__.encode()).hexdigest()
    return root, f"{sp.__version__} {np.__version__} {digest}"


def _path(key: str) -> Path | None:
    folder = _folder()
    if folder is None:
        return None
    root, makers = folder
    return root / f"{hashlib.sha256(f'{makers} {key}'.encode()).hexdigest()[:32]}.py"


def _write(path: Path, source: str) -> None:
    with suppress(OSError):  # it works without
        _make_room(path.parent)
        keep(path, source)


@lru_cache(maxsize=1)  # once per process
def _make_room(folder: Path) -> None:
    files = sorted(folder.iterdir(), key=lambda path: path.stat().st_mtime)
    for path in files[: len(files) // 2] if len(files) > MOST_FILES else []:
        path.unlink(missing_ok=True)
