"""How the simulation's functions are compiled, and called by the names of their parameters."""

import inspect
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numba
from numba.np.unsafe.ndarray import to_fixed_tuple

import winch_friction.physics.channels as channels
import winch_friction.physics.corrections as corrections
import winch_friction.physics.friction.symbols as symbols
from winch_friction.physics.friction.sources import cache_root, compiled_in, source_digest

tuple_of: Any = to_fixed_tuple  # the first so many values of an array as a tuple, in compiled code


def compiled(function: Callable[..., Any]) -> Any:
    """`numba.njit`, cached between processes where a cache can be written."""
    try:
        return compiled_in(_directory(), function)
    except RuntimeError:  # no place to write: compile anew in every process
        return numba.njit(error_model="numpy")(function)


def inlined(function: Callable[..., Any]) -> Any:
    """`numba.njit` of a function that becomes part of its callers' code; these are what is kept in the cache."""
    return numba.njit(error_model="numpy", forceinline=True)(function)


def in_order(function: Any, *given: str, **named: Any) -> tuple[Any, ...]:
    """Arguments of a compiled function by their names, in the order of its parameters, for calls that cost no names.

    `given` are the first parameters, which each call brings itself; `TypeError` for names that do not fit.
    """
    wanted = list(inspect.signature(getattr(function, "py_func", function)).parameters)
    if wanted[: len(given)] != list(given) or set(wanted[len(given) :]) != set(named):
        odd = set(wanted[len(given) :]) ^ set(named)
        raise TypeError(f"{function}: {sorted(odd) or given} do not fit its parameters {wanted}")
    return tuple(named[name] for name in wanted[len(given) :])


@lru_cache(maxsize=1)
def _directory() -> str:
    own = sorted(Path(__file__).parent.rglob("*.py"))
    used = [Path(str(each.__file__)) for each in (symbols, channels, corrections)]
    return str(cache_root() / source_digest([*own, *used]))
