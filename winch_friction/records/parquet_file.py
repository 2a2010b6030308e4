"""Run files as Parquet: the same headers as CSV; the run's metadata travels in the schema."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.signals import FloatArray, Run, column_unit
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import atomic_path
from winch_friction.records.csv_file import Header, header_text, read_headers, said_of_nameless
from winch_friction.records.parquet_units import said_units
from winch_friction.records.plain import own_metadata
from winch_friction.records.run_checks import Place, checked_run

_METADATA = b"winch_friction"
_DATES = ("timestamp", "duration")  # types of a column of dates, as pandas writes an index of times


def read_parquet_run(path: Path, crane: Crane | None = None, complete: bool = True) -> Run:
    """A run from a Parquet file; raises `InputError` with row (from 1) and column."""
    run = _run_of(path, _table(path), crane, complete)
    _pyarrow()[0].default_memory_pool().release_unused()  # of the table, which is gone now: it is as large as the run
    return run


def _run_of(path: Path, table: Any, crane: Crane | None, complete: bool) -> Run:
    problems = Problems()
    headers = read_headers(path, _with_units(table), problems)
    place: Place = lambda row: f"row {row + 1}"
    columns, aside = {}, {}
    bare = [header.name for header in headers if header.known and not header.unit]
    for header, chunked in zip(headers, table.columns, strict=True):
        if header.name == "time" and str(chunked.type).startswith(_DATES):
            columns[header.name] = _seconds(chunked)
            bare = [name for name in bare if name != "time"]
        elif header.known:
            with problems:
                columns[header.name] = _numbers(path, header, chunked)
                columns[header.name] = header.to_si(columns[header.name], str(path))
        else:
            aside[header.text] = chunked.to_numpy()
    metadata, spoilt = own_metadata((table.schema.metadata or {}).get(_METADATA, b"{}"), path.name)
    with problems:
        run = checked_run(
            path.name, columns, place=place, crane=crane, complete=complete, aside=aside, metadata=metadata, bare=bare,
            warnings=[*said_of_nameless(headers, path.name), *spoilt],
        )  # fmt: skip
    problems.say()
    return run


def _with_units(table: Any) -> list[str]:
    """The names of a table's columns, a channel's without a bracket with the unit that the file says beside it."""
    units = {name: unit for name, unit in said_units(table.schema).items() if column_unit(name) is not None}
    return [f"{name} [{units[name]}]" if name in units else name for name in table.column_names]


def write_parquet_run(run: Run, path: Path) -> Path:
    """Write a run atomically, SI units in the headers, metadata in the schema."""
    pyarrow, parquet = _pyarrow()
    content = {header_text(name): values for name, values in run.columns.items()} | dict(run.aside)
    metadata = {_METADATA: json.dumps(dict(run.metadata), default=str).encode()}
    table = pyarrow.table(content).replace_schema_metadata(metadata)
    with atomic_path(path) as temporary:
        parquet.write_table(table, temporary)
    return path


def _pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:  # absent, or built for another numpy
        raise InputError(f"Parquet files need pyarrow ({error}); install one that fits numpy, or use CSV") from error
    return pyarrow, parquet


def _table(path: Path) -> Any:
    pyarrow, parquet = _pyarrow()
    try:
        return parquet.ParquetFile(path).read()  # read_table would refuse nothing less, but merges folders
    except (pyarrow.ArrowException, OSError) as error:
        raise InputError(f"{path}: not a readable Parquet file ({str(error).splitlines()[0][:100]})") from error


def _numbers(path: Path, header: Header, chunked: Any) -> FloatArray:
    if str(chunked.type) == "double" and not chunked.null_count:
        return _doubles(chunked)
    try:
        if str(chunked.type).startswith(_DATES):
            raise TypeError("dates")  # NumPy would count their ticks
        return np.asarray(chunked.to_numpy(), dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: column '{header.text}': {chunked.type} values are not numbers") from error


def _seconds(chunked: Any) -> FloatArray:
    """Dates as s since 1970, durations as s; NaN where there is none."""
    values = np.asarray(chunked.to_numpy())
    since = values - np.datetime64(0, "s") if values.dtype.kind == "M" else values
    return np.asarray(since / np.timedelta64(1, "s"), dtype=np.float64)


def _doubles(chunked: Any) -> FloatArray:
    """A column without nulls from its buffers; pyarrow's own way imports pandas, at a quarter of a second and 30 MB."""
    parts = [np.empty(0)]
    for chunk in chunked.chunks:
        if len(chunk):
            parts.append(np.frombuffer(chunk.buffers()[1])[chunk.offset : chunk.offset + len(chunk)])
    return np.concatenate(parts)
