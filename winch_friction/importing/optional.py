"""Libraries that one kind of log needs: imported when that log is read, their absence said in one line."""

import importlib
from typing import Any

from winch_friction.physics.errors import InputError


def library(name: str, what: str) -> Any:
    """A module of the extra `import`; raises `InputError` with the pip command when it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.split(".")[0]
        raise InputError(
            f"{what} need the library '{package}' ({error}): pip install 'winch_friction[import]', "
            f"or pip install {package}"
        ) from error
