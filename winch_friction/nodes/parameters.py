"""ROS parameters from option dataclasses: declared once, with description and range, and read back as one object."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from typing import Any, Generic, TypeVar

import yaml
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterUninitializedException,
)

from winch_friction.physics.errors import InputError, Limits, Problems, default_of, from_mapping, limits_of, meant

T = TypeVar("T")
_LARGEST = 2**62


class OptionParameters(Generic[T]):
    """The fields of an option dataclass as parameters of a node.

    A mapping field becomes one parameter per key, `gains.stribeck`; `keys` says by field which keys there are beyond
    those of the default, and is asked at each `declare`. An empty tuple is declared as `[""]`, for rclpy cannot tell
    the type of an empty list. `fixed` names the fields that cannot change while the node lives.
    """

    def __init__(
        self,
        kind: type[T],
        *,
        fixed: Iterable[str] = (),
        keys: Callable[[], Mapping[str, Mapping[str, float]]] = dict,
        skip: Iterable[str] = (),
    ) -> None:
        self.kind = kind
        self.fixed = frozenset(fixed)
        self._keys = keys
        self._fields = [each for each in fields(kind) if each.name not in frozenset(skip)]  # type: ignore[arg-type]
        self.names: dict[str, tuple[str, str | None]] = {}

    def declare(self, node: Any) -> None:
        """Declare every field that is not declared yet; bad overrides are an `InputError` that names the parameters."""
        keys, problems = self._keys(), Problems()
        for each in self._fields:
            for name, key, default in self._entries(each, keys.get(each.name, {})):
                with problems:
                    declare(node, name, default, limits_of(each), each.name in self.fixed)
                self.names[name] = (each.name, key)
        problems.say()

    def _entries(self, each: Any, more: Mapping[str, float]) -> list[tuple[str, str | None, Any]]:
        default = default_of(each)
        if not isinstance(default, dict):
            return [(each.name, None, (list(default) or [""]) if isinstance(default, tuple) else default)]
        merged = {**default, **more}
        return [(f"{each.name}.{key}", key, float(value)) for key, value in merged.items()]

    def read(self, node: Any, changes: Mapping[str, Any] | None = None) -> T:
        """The options as the parameters stand, with `changes` by parameter name; `InputError` when they do not fit."""
        content: dict[str, Any] = {}
        for name, (option, key) in self.names.items():
            value = changes[name] if changes and name in changes else node.get_parameter(name).value
            if key is None:
                content[option] = tuple(v for v in value if v) if isinstance(value, (list, tuple)) else value
            else:
                content.setdefault(option, {})[key] = value
        return from_mapping(self.kind, content, f"{node.get_name()}: parameters")


def declare_all(node: Any, settings: Iterable[OptionParameters[Any]]) -> None:
    """Declare several dataclasses' fields; all bad overrides are said at once."""
    problems = Problems()
    for each in settings:
        with problems:
            each.declare(node)
    problems.say()


def unknown_parameters(node: Any, settings: Iterable[OptionParameters[Any]]) -> list[str]:
    """What is said of overrides that are no parameter: rclpy takes a misspelt one without a word."""
    known = [name for each in settings for name in each.names]
    return [
        f"parameter '{name}' is not known and has no effect;{meant(name, known)}".rstrip(";")
        for name in sorted(_overrides(node))
        if not node.has_parameter(name) and not name.startswith("qos_overrides.")
    ]


# -- the command line beside a parameter file
def overruled(node: Any, arguments: Sequence[str]) -> list[str]:
    """What is said of each `-p name:=value` of the command line that does not hold: rclpy takes it for a part of the
    section `/**` of a parameter file, which the section that names the node overrules, without a word."""
    held, told = _overrides(node), node.get_name()
    return [
        f"-p {rule} has no effect: a parameter file says {_shown(held[name].value)} in the section of this node; "
        f"write -p {told}:{rule}"
        for name, rule in _rules(arguments).items()
        if name in held and not _means(rule.partition(":=")[2], held[name].value)
    ]


def _rules(arguments: Sequence[str]) -> dict[str, str]:
    """The last `name:=value` of each parameter; those of a named node, `node:name:=value`, have names of their own."""
    rules, ros = dict[str, str](), False
    for each, after in zip(arguments, arguments[1:], strict=False):
        ros = (ros or each == "--ros-args") and each != "--"
        name, _, value = after.partition(":=")
        if ros and each in ("-p", "--param") and value:
            rules[name] = after
    return rules


def _means(text: str, value: Any) -> bool:
    """Whether a parameter of the command line says this value."""
    said: Any = text
    try:
        said = float(text)
    except ValueError:
        with suppress(yaml.YAMLError):
            said = yaml.safe_load(text)
    if isinstance(said, list):
        return said == list(value) if isinstance(value, Sequence) else False
    return bool(said == value) or text == str(value) or (said != said and value != value)


def _shown(value: Any) -> str:
    return str(list(value) if isinstance(value, (tuple, list)) else value)


_QUALITIES = {
    "reliability": ("reliable", "best_effort", "system_default", "best_available"),
    "durability": ("volatile", "transient_local", "system_default", "best_available"),
    "history": ("keep_last", "keep_all", "system_default"),
}
_DEEPEST = 100_000  # messages; rclpy takes any number, and the middleware then fails without naming it


def check_qualities(node: Any) -> None:
    """Raise `InputError` for overrides of quality of service that rclpy would raise for, at whatever topic's turn."""
    problems = Problems()
    for name, given in sorted(_overrides(node).items()):
        policy = name.rpartition(".")[2]
        if not name.startswith("qos_overrides.") or policy not in (*_QUALITIES, "depth"):
            continue
        with problems:
            if policy == "depth" and not (type(given.value) is int and 0 <= given.value <= _DEEPEST):
                raise InputError(f"parameter '{name}' must be a whole number 0 ... {_DEEPEST}, found {given.value!r}")
            if policy != "depth" and str(given.value).lower() not in _QUALITIES[policy]:
                raise InputError(
                    f"parameter '{name}' must be one of {', '.join(_QUALITIES[policy])}, found {given.value!r}"
                )
    problems.say()


def _overrides(node: Any) -> Mapping[str, Any]:
    given: Mapping[str, Any] = getattr(node, "_parameter_overrides", {})
    return given


def declare(node: Any, name: str, default: Any, limits: Limits, read_only: bool = False) -> None:
    """Declare one parameter with its descriptor."""
    try:
        if not node.has_parameter(name):
            node.declare_parameter(name, default, descriptor(default, limits, read_only))
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        given = _overrides(node).get(name)
        said = _must_be(given.value, default, limits) if given is not None else f": {_one_line(error)}"
        raise InputError(f"{node.get_name()}: parameter '{name}'{said}") from error
    try:
        value = node.get_parameter(name).value
    except ParameterUninitializedException:  # [], whose type rclpy cannot tell
        none = ', found none, or [] (of which ROS tells no type): [""] stands for none'
        words = none if isinstance(default, list) else ", found none"
        kind = _KINDS.get(type(default), type(default).__name__)
        raise InputError(f"{node.get_name()}: parameter '{name}' must be {kind}{words}") from None
    if limits.choices and value != default and value not in limits.choices:
        words = f"must be one of {', '.join(limits.choices)}, found {value!r}"
        raise InputError(f"{node.get_name()}: parameter '{name}' {words}")


_KINDS = {float: "a number", int: "a whole number", bool: "true or false", str: "a text", list: "a list of texts"}


def _must_be(value: Any, default: Any, limits: Limits) -> str:
    """What is said of an override of another type, or out of its range."""
    same = type(value) is type(default)
    unit = f" {limits.unit}" if limits.unit not in ("", "1") else ""
    bounds = f"{limits.lower:g} ... {limits.upper:g}{unit}" if _KINDS.get(type(default), "").endswith("number") else ""
    kind = "" if same and bounds else _KINDS.get(type(default), type(default).__name__)
    whole = isinstance(default, float) and type(value) is int and limits.lower <= value <= limits.upper
    hint = f": write {value}.0" if whole else ""
    return f" must be {' '.join(filter(None, (kind, bounds)))}, found {value!r}{hint}"


def descriptor(default: Any, limits: Limits, read_only: bool) -> ParameterDescriptor:
    """Description and range of a parameter."""
    unit = f" [{limits.unit}]" if limits.unit not in ("", "1") else ""
    choices = f" One of: {', '.join(limits.choices)}." if limits.choices else ""
    made = ParameterDescriptor(description=f"{limits.doc}{unit}{choices}", read_only=read_only)
    bounded = (math.isfinite(limits.lower) or math.isfinite(limits.upper)) and not limits.may_be_nan
    if isinstance(default, float) and bounded:
        made.floating_point_range = [FloatingPointRange(from_value=limits.lower, to_value=limits.upper)]
    elif isinstance(default, int) and not isinstance(default, bool) and bounded:
        made.integer_range = [IntegerRange(from_value=int(limits.lower), to_value=_whole(limits.upper))]
    return made


def _whole(value: float) -> int:
    return int(value) if math.isfinite(value) else _LARGEST


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
