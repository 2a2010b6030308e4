"""The arrays of HDF5 files: MATLAB's of version 7.3, and other programs' with the units of their attributes."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.importing.optional import library
from winch_friction.physics.errors import InputError

_UNITS = ("unit", "units")  # attributes of a dataset, in any letter case
_PANDAS = (
    "{}: an HDFStore of pandas, whose blocks pandas alone can put together; save its table: "
    "pandas.read_hdf('{}').to_parquet('log.parquet')"
)


def matlab_arrays(path: Path, most: int, objects: str) -> list[tuple[str, Any]]:
    """Dotted names and arrays of numbers of at most `most` values; raises `InputError` (`objects` says what to do) for
    a file of objects that MATLAB alone can open.
    """
    h5py = library("h5py", "MATLAB files of version 7.3")
    found: list[tuple[str, Any]] = []
    opaque: list[str] = []

    def visit(name: str, item: Any) -> None:
        if "MATLAB_object_decode" in item.attrs:
            opaque.append(f"'{name}' is a {_text(item.attrs.get('MATLAB_class', b'object'))}")
        elif isinstance(item, h5py.Dataset) and not name.startswith("#") and _is_numbers(item, most):
            found.append((name.replace("/", "."), np.squeeze(item[()])))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    if opaque and not found:
        raise InputError(f"{path}: {objects.format(', '.join(opaque))}")
    return found


def plain_arrays(path: Path, most: int) -> list[tuple[str, Any, str]]:
    """Name, array and unit ('' for none) of every dataset of numbers or texts, of every field of one of records.

    A dataset's own name where it has it alone, else with its groups'. Raises `InputError` for what pandas has cut up.
    """
    h5py = library("h5py", "HDF5 logs")
    found: list[tuple[str, str, Any, str]] = []  # dotted groups, own name, array, unit

    def visit(name: str, item: Any) -> None:
        if "pandas_type" in item.attrs:
            raise InputError(_PANDAS.format(path, path.name))
        if not isinstance(item, h5py.Dataset) or not 1 < item.size <= most:
            return
        groups, _, own = name.rpartition("/")
        if item.dtype.names:
            found.extend((name, each, item[each], "") for each in item.dtype.names)
        elif h5py.check_string_dtype(item.dtype):
            found.append((groups, own, np.asarray(item.asstr()[()], dtype=str), ""))
        elif _is_numbers(item, most):
            found.append((groups, own, np.squeeze(item[()]), _unit(item)))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    often = Counter(own for _, own, _, _ in found)
    return [
        (own if often[own] == 1 or not groups else f"{groups.replace('/', '.')}.{own}", array, unit)
        for groups, own, array, unit in found
    ]


def _is_numbers(item: Any, most: int) -> bool:
    return item.dtype.kind in "biuf" and 1 < item.size <= most


def _unit(item: Any) -> str:
    said = next((item.attrs[key] for key in item.attrs if key.lower() in _UNITS), "")
    return _text(said).strip()


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size else ""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
