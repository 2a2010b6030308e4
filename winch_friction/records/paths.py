"""Where the shipped configuration lies, in a checkout, a ROS installation or a Python one."""

import sys
from pathlib import Path

from winch_friction.physics.errors import InputError, meant

_PACKAGE = "winch_friction"


def config_directory() -> Path:
    """The directory with cranes/, models/, nodes/, scenarios/; raises `InputError` when the installation lacks it."""
    for candidate in _candidates():
        if (candidate / "models").is_dir():
            return candidate
    raise InputError("the shipped configuration was not found: reinstall the package, or give paths instead of names")


def _candidates() -> list[Path]:
    package = Path(__file__).resolve().parents[1]
    prefixes = [Path(sys.prefix), *package.parents[:5]]
    return [package.parent / "config", *(prefix / "share" / _PACKAGE / "config" for prefix in prefixes)]


def shipped(kind: str, name: str | Path, suffix: str = ".yaml") -> Path:
    """A path as given, or the shipped file of that name, e.g. ('cranes', 'crane_150t')."""
    path = Path(name)
    if path.is_file():
        return path
    folder = config_directory() / kind
    candidate = folder / f"{name}{suffix}"
    if candidate.is_file():
        return candidate
    known = sorted(each.stem for each in folder.glob(f"*{suffix}"))
    raise InputError(
        f"'{name}' is neither a file nor a shipped name in {kind};{meant(str(name), known)} shipped: {', '.join(known)}"
    )
