"""What a node's own command line may say, besides ROS's arguments: nothing but `--help`."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from winch_friction.physics.errors import InputError, default_of, limits_of

HELP = ("--help", "-h")


def own_arguments(arguments: Sequence[str]) -> list[str]:
    """What stands before `--ros-args`, between the `--` that ends those and the next ones, and behind."""
    own, ros = list[str](), False
    for each in arguments:
        ros, mark = each == "--ros-args" or (ros and each != "--"), each in ("--ros-args", "--")
        own += [] if ros or mark else [each]
    return own


def refuse_own_arguments(arguments: Sequence[str]) -> None:
    """Raise `InputError` for what neither the node nor ROS would read: a parameter file named before `--ros-args` was
    passed over, and the node ran for the shipped crane."""
    if own := own_arguments(arguments):
        raise InputError(
            f"{' '.join(own)}: not understood; parameters, files and names stand behind --ros-args, as in "
            "--ros-args --params-file my_crane.yaml; --help says which there are"
        )


def usage(name: str, does: str, kinds: Sequence[type]) -> str:
    """The help of a node: how it is called, and every parameter of its option dataclasses with default and meaning."""
    lines = [
        f"usage: {name} [--ros-args [--params-file FILE] [-p NAME:=VALUE] [-r __ns:=/NAMESPACE] [-r TOPIC:=TOPIC] ...]",
        "",
        does,
        "",
        "Parameters; config/nodes/crane.yaml explains them, ros2 param describe says the same of a running node:",
    ]
    for each in (field for kind in kinds for field in fields(kind)):
        limits = limits_of(each)
        unit = f" {limits.unit}" if limits.unit not in ("", "1") else ""
        lines.append(f"  {each.name} ({_shown(default_of(each))}{unit}): {limits.doc}")
    return "\n".join(lines)


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, dict):
        return f"one number for each {{name}}: {', '.join(f'{k} {v}' for k, v in value.items()) or 'none given'}"
    return str(list(value)) if isinstance(value, tuple) else (str(value) or "empty")
