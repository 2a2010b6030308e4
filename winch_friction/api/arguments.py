"""What the public functions are called with: another kind of argument is an `InputError` that says what to give."""

from collections.abc import Callable
from functools import wraps
from inspect import signature
from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import taken

P = ParamSpec("P")
R = TypeVar("R")
FILE = (str, PathLike)

# argument by its name -> what it may be, in words, and what to write where it is the name of one
_KINDS: dict[str, tuple[tuple[type, ...], str, str]] = {
    "crane": ((Crane,), "a Crane", "wf.load_crane({})"),
    "model": ((FrictionModel,), "a FrictionModel", "wf.load_model({})"),
    "run": ((Run,), "a Run", "wf.read_run({}, crane)"),
    "recording": ((Run, *FILE), "a run, a run file or a bag", ""),
    "scenario": (FILE, "a file or a shipped name", ""),
    "name": (FILE, "a file or a shipped name", ""),
    "path": (FILE, "a file", ""),
}


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """The function, which looks at its crane, model, runs and files before its work; None is taken where it is the
    default. A string of characters was read as so many files, and a crane's name failed deep inside."""
    known = signature(function)

    @wraps(function)
    def called(*arguments: P.args, **named: P.kwargs) -> R:
        try:
            given = known.bind(*arguments, **named).arguments
        except TypeError:
            given = {}  # Python says it better
        for name, value in given.items():
            if value is not None or known.parameters[name].default is not None:
                _check(f"{function.__name__}: {name}", name, value)
        return function(*arguments, **named)

    return called


def vacant(path: "str | PathLike[str]", overwrite: bool) -> Path:
    """The path, where nothing is yet, or what is there may go: a log that was read, and is written with fewer columns
    under its own name, is never logged again."""
    place = Path(path)
    if taken(place, overwrite) and not overwrite and not place.is_dir():
        raise InputError(f"{place}: exists already; give another name, or overwrite=True to replace it")
    return place


def _check(where: str, name: str, value: Any) -> None:
    if name in ("runs", "held_out") or (name == "data" and not isinstance(value, FILE)):
        if isinstance(value, (Run, *FILE)) or not hasattr(value, "__iter__"):
            raise InputError(f"{where} must be a list of runs or files, found {_shown(value)}")
        for each in value if isinstance(value, (list, tuple)) else ():
            _check(f"{where}: each", "recording", each)
        return
    kinds, words, instead = _KINDS.get(name, ((object,), "", ""))
    if name == "seed" and (isinstance(value, bool) or not isinstance(value, Integral)):
        raise InputError(f"{where} {value!r}: give a whole number, 0 or more")
    if not isinstance(value, kinds):
        hint = f": {instead.format(repr(str(value)))}" if isinstance(value, FILE) else ""
        raise InputError(f"{where} must be {words}, found {_shown(value)}{hint}")


def _shown(value: Any) -> str:
    return f"the text {value!r}" if isinstance(value, str) else f"a {type(value).__name__}"
