"""Functions that are generated from declared terms, compiled once and kept: their source is a module in the cache.

Numba keeps compiled code beside the file that a function stands in. What SymPy makes stands in none, so that its source
is written to one, named by its own content; another equation is another file.
"""

import hashlib
import importlib.util
import sys
from types import ModuleType
from typing import Any

import numba

from winch_friction.physics.friction.sources import cache_root, uncollected
from winch_friction.records.atomic import write_text

_HEADER = """from math import *

from numba import cfunc, njit, types

_P = types.CPointer(types.float64)


@njit(error_model="numpy")
"""


def c_function(name: str, source: str, pointers: int) -> Any:
    """The function `name` of a source as a C function of so many pointers to doubles that gives a double."""
    pointed = ", ".join(["_P"] * pointers)
    at = source.rindex(f"def {name}(")
    decorator = f'@cfunc(types.float64({pointed}), error_model="numpy", cache=True)\n'
    text = _HEADER + source[:at] + decorator + source[at:]
    return getattr(_module(text), name)


def _module(text: str) -> ModuleType:
    digest = hashlib.sha256((numba.__version__ + text).encode()).hexdigest()[:16]
    path = cache_root() / f"equations_{digest}.py"
    try:
        if not path.is_file():
            write_text(path, text)
        return _imported(path.stem, str(path))
    except (OSError, RuntimeError):  # nowhere to keep it: compile it anew in every process
        module = ModuleType(path.stem)
        exec(text.replace(", cache=True", ""), module.__dict__)
        return module


def _imported(name: str, path: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # numba looks its functions' module up when it loads them
    with uncollected():
        spec.loader.exec_module(module)
    return module
