"""The one error that bad input raises, how several of them are said at once, and settings that refuse bad input.

Settings are frozen dataclasses whose fields carry their own limits; built from YAML or from ROS parameters alike.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, Field, dataclass, field, fields
from difflib import get_close_matches
from types import TracebackType
from typing import Any, TypeVar


class InputError(ValueError):
    """Bad input, said in one line a problem: what, where (file, row, column, parameter) and what to do.

    `problems` are those lines; as text they stand in one line.

    >>> import winch_friction as wf
    >>> try:
    ...     wf.load_crane("no_such_crane")
    ... except wf.InputError as error:
    ...     print("no_such_crane" in str(error), len(error.problems))
    True 1
    """

    def __init__(self, *problems: str) -> None:
        self.problems = tuple(" ".join(each.split()) for each in problems)
        super().__init__(" | ".join(self.problems))


@contextmanager
def said_of(path: Any, name: str) -> Iterator[None]:
    """What is refused of a `name` is said of its `path`: a run is its file's name, and there are more folders."""
    try:
        yield
    except InputError as refused:
        own = f"{name}:"
        said = (f"{path}:{each.removeprefix(own)}" if each.startswith(own) else each for each in refused.problems)
        raise InputError(*said) from None


class Problems:
    """Gathers the `InputError`s of several `with` blocks, so that all of them are said at once.

    >>> problems = Problems()
    >>> with problems:
    ...     raise InputError("no crane")
    >>> problems.found
    ['no crane']
    """

    def __init__(self) -> None:
        self.found: list[str] = []

    def __enter__(self) -> "Problems":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> bool:
        if not isinstance(error, InputError):
            return False
        self.found += [each for each in error.problems if each not in self.found]
        return True

    def say(self, *before: str) -> None:
        """Raise `InputError` with what was gathered `before` and here; nothing, where nothing was."""
        if before or self.found:
            raise InputError(*before, *self.found)


def meant(name: str, known: Iterable[str]) -> str:
    """' did you mean ...?' where a name is nearly a known one, otherwise nothing."""
    written: dict[str, list[str]] = {}
    for each in sorted(set(known)):
        written.setdefault(each.casefold(), []).append(each)  # capitals make no other name
    close = get_close_matches(name.casefold(), written, n=3, cutoff=0.75)
    near = [each for key in close for each in written[key]]
    return f" did you mean {' or '.join(near)}?" if near else ""


def counted(count: int, one: str, more: str) -> str:
    """A number with what is counted, in the singular for one: `1 cell is no number`, `2 cells are no numbers`."""
    return f"{count} {one if count == 1 else more}"


def no_cells(error: Exception) -> str:
    """What is said of rows that `csv` cannot cut: of a cell without an end that a quotation mark is not closed."""
    if "field larger" not in str(error):
        return str(error)
    return "a cell that begins here has no end: is a quotation mark not closed? Close or remove it"


def unknown_key(key: str, known: Iterable[str]) -> str:
    """What is said of a key that a file cannot have: what may be meant, or else which keys there are."""
    known = list(known)
    return f"unknown key '{key}';" + (
        meant(key, known) or (f" known keys are {', '.join(known)}" if known else " none may stand here")
    )


# -- settings with limits
T = TypeVar("T")


@dataclass(frozen=True)
class Limits:
    """What a value may be: a closed range for numbers, or one of some words."""

    lower: float = -math.inf
    upper: float = math.inf
    choices: tuple[str, ...] = ()
    unit: str = "1"
    doc: str = ""
    may_be_nan: bool = False


def option(default: Any, **limits: Any) -> Any:
    """A dataclass field with a default and `Limits`; a mapping as default is copied for every instance."""
    metadata = {"limits": Limits(**limits)}
    if isinstance(default, Mapping):
        return field(default_factory=lambda: dict(default), metadata=metadata)
    return field(default=default, metadata=metadata)


def limits_of(each: "Field[Any]") -> Limits:
    """The limits that a field was declared with."""
    return each.metadata.get("limits", Limits())


def default_of(each: "Field[Any]") -> Any:
    """The default of a field."""
    return each.default if each.default is not MISSING else each.default_factory()  # type: ignore[misc, operator]


def from_mapping(kind: type[T], content: Mapping[str, Any], where: str) -> T:
    """A configuration of this dataclass from a plain mapping.

    Absent keys keep their default. Raises `InputError` for unknown keys, wrong types and values out of range, in one
    line that begins with `where`.
    """
    if not isinstance(content, Mapping):
        raise InputError(f"{where}: expected a mapping of keys, found {content!r}")
    known = {each.name: each for each in fields(kind)}  # type: ignore[arg-type]
    problems, values = Problems(), {}
    for key, value in content.items():
        with problems:
            if key not in known:
                raise InputError(f"{where}: {unknown_key(str(key), known)}")
            values[key] = _converted(known[key], value, f"{where}: {key}")
    try:
        made = kind(**values)
    except InputError as error:
        raise InputError(*problems.found, *(f"{where}: {each}" for each in error.problems)) from error
    problems.say()
    return made


def check(configuration: Any) -> None:
    """Raise `InputError` when a field is outside its limits; to be called from `__post_init__`."""
    problems = Problems()
    for each in fields(configuration):
        with problems:
            _check_value(getattr(configuration, each.name), default_of(each), limits_of(each), each.name)
    problems.say()


def _converted(each: "Field[Any]", value: Any, where: str) -> Any:
    default = default_of(each)
    if isinstance(default, float) and isinstance(value, str):  # YAML 1.1 reads 1e-3 as a string
        try:
            return float(value)
        except ValueError:
            pass
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if isinstance(default, dict):
        if not isinstance(value, Mapping):
            raise InputError(f"{where} must be a mapping, found {value!r}")
        own = {str(key): _number(item, f"{where}.{key}") for key, item in value.items()}
        return {**default, **own}  # as a node's parameters: what is not said keeps its default
    return value


def _number(value: Any, where: str) -> float:
    try:
        if isinstance(value, bool):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"{where} must be a number, found {value!r}") from None


def _check_value(value: Any, default: Any, limits: Limits, where: str) -> None:
    if isinstance(default, dict):
        for key, item in value.items():
            _check_number(item, limits, f"{where}.{key}")
    elif isinstance(default, float):
        _check_number(value, limits, where)
    elif type(value) is not type(default):
        raise InputError(f"{where} must be of type {type(default).__name__}, found {value!r}")
    elif isinstance(value, int) and not isinstance(value, bool):
        _check_number(float(value), limits, where)
    if limits.choices and value not in limits.choices:
        raise InputError(f"{where} must be one of {', '.join(limits.choices)}, found {value!r}")


def _check_number(value: Any, limits: Limits, where: str) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InputError(f"{where} must be a number, found {value!r}")
    if math.isnan(value) and limits.may_be_nan:
        return
    if not limits.lower <= value <= limits.upper:  # false for NaN too
        unit = "" if limits.unit == "1" else f" {limits.unit}"
        raise InputError(f"{where} must be {limits.lower:g} ... {limits.upper:g}{unit}, found {value:g}")
