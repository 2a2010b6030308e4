"""ROS parameters from option dataclasses: declared once, with description and range, and read back as one object."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from typing import Any, Generic, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException

from winch_friction.physics.errors import InputError
from winch_friction.physics.options import Limits, default_of, from_mapping, limits_of

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
        """Declare every field that is not declared yet; a bad override is an `InputError` that names the parameter."""
        keys = self._keys()
        for each in self._fields:
            for name, key, default in self._entries(each, keys.get(each.name, {})):
                declare(node, name, default, limits_of(each), each.name in self.fixed)
                self.names[name] = (each.name, key)

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


def declare(node: Any, name: str, default: Any, limits: Limits, read_only: bool = False) -> None:
    """Declare one parameter with its descriptor."""
    try:
        if not node.has_parameter(name):
            node.declare_parameter(name, default, descriptor(default, limits, read_only))
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        allowed = f" ({limits.lower:g} ... {limits.upper:g})" if isinstance(default, (int, float)) else ""
        raise InputError(f"{node.get_name()}: parameter '{name}': {_one_line(error)}{allowed}") from error


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
