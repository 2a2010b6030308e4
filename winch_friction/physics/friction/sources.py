"""What takes long to make is kept on disk from one start to the next: compiled code, and sources of equations.

A text's first line is a seal that says whether the rest is whole. A file that is not, or that is another user's, counts
as none; where nothing can be written, nothing is kept.

Numba itself notices changes of the file that a function stands in, not of the functions that it calls: its cache lies
where a change of any source that a function is made of makes it a new one. It is imported on use: a node runs without
it. Making the Python functions of declared equations takes SymPy a second; a source is found by everything that it was
made of: the equations, SymPy, and the code that writes it.
"""

import gc
import hashlib
import inspect
import linecache
import math
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np
import sympy as sp

from winch_friction.physics.friction import symbols


# -- texts with a seal
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


# -- numba's cache
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


# -- sources of equations
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
