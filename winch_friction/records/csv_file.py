"""Run files as CSV: one header line with units, one row per sample; comma, semicolon or tab."""

from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import atomic_path
from winch_friction.records.headers import Header, header_text, parse_header
from winch_friction.records.run_checks import Place, checked_run

_FIRST_ROW_LINE = 2  # the header is line 1
_MISSING = ("", "nan", "na", "n/a", "null", "none", "-nan")


def read_csv_run(path: Path, crane: Crane | None = None, complete: bool = True) -> Run:
    """A run from a CSV file; raises `InputError` with line and column for whatever cannot be read."""
    text = _text(path)
    separator = _separator(text)
    lines = text.splitlines()
    headers = unique_headers([parse_header(cell, str(path)) for cell in _cells(lines[0], separator)], path)
    _check_width(path, lines, separator, len(headers))
    table = _table(path, text, separator, headers)
    place: Place = lambda row: f"line {row + _FIRST_ROW_LINE}"
    columns, aside = {}, {}
    for header, values in zip(headers, table.columns, strict=True):
        if header.known:
            columns[header.name] = header.to_si(_numbers(path, header, values), str(path))
        else:
            aside[header.text] = _as_numbers_if_possible(values)
    return checked_run(path.name, columns, place=place, crane=crane, complete=complete, aside=aside)


def write_csv_run(run: Run, path: Path) -> Path:
    """Write a run atomically, SI units in the headers, every digit kept; metadata has no place in a CSV file."""
    import pandas

    frame = pandas.DataFrame({header_text(name): values for name, values in run.columns.items()} | dict(run.aside))
    with atomic_path(path) as temporary:
        frame.to_csv(temporary, index=False)
    return path


def unique_headers(headers: list[Header], path: Path) -> list[Header]:
    """The headers, when no two name the same column; else `InputError`."""
    seen: dict[str, Header] = {}
    for header in headers:
        name = header.name if header.known else header.text
        if name in seen:
            raise InputError(f"{path}: column '{name}' stands twice, as '{seen[name].text}' and '{header.text}'")
        seen[name] = header
    return headers


def _text(path: Path) -> str:
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file (byte {error.start} is not UTF-8); expected CSV") from error
    if "\0" in text:
        raise InputError(f"{path}: not a text file (it holds zero bytes); expected CSV")
    if not text.strip():
        raise InputError(f"{path}: the file is empty; expected a header line with column names")
    return text.rstrip("\r\n") + "\n"  # blank lines at the end are nobody's data


def _separator(text: str) -> str:
    header = text.partition("\n")[0]
    return max(",;\t", key=header.count)


def _cells(line: str, separator: str) -> list[str]:
    return [cell.strip().strip('"') for cell in line.split(separator)]


def _check_width(path: Path, lines: list[str], separator: str, width: int) -> None:
    if not lines[0].strip():
        raise InputError(f"{path}: line 1 is blank; expected the header line there")
    for k, line in enumerate(lines[1:]):
        found = line.count(separator) + 1
        if '"' in line:
            continue  # quoted text may hold separators; the parser counts these rows
        if found != width:
            at = f"{path}: line {k + _FIRST_ROW_LINE}"
            raise InputError(f"{at}: blank line" if not line else f"{at}: {found} values for {width} columns")


def _table(path: Path, text: str, separator: str, headers: list[Header]) -> Any:
    import pyarrow
    from pyarrow import csv

    try:
        return csv.read_csv(
            pyarrow.BufferReader(text.encode()),
            read_options=csv.ReadOptions(column_names=[header.text for header in headers], skip_rows=1),
            parse_options=csv.ParseOptions(delimiter=separator, newlines_in_values=True),
            convert_options=csv.ConvertOptions(null_values=[""], strings_can_be_null=True),
        )
    except pyarrow.ArrowException as error:
        raise InputError(f"{path}: {str(error).splitlines()[0]}") from error


def _numbers(path: Path, header: Header, values: Any) -> Any:
    if str(values.type) in ("int64", "double", "null"):
        return np.asarray(values.to_pandas(), dtype=float)
    texts = values.cast("string").to_pylist() if str(values.type) != "string" else values.to_pylist()
    return np.array([_number(path, header, row, text) for row, text in enumerate(texts)])


def _number(path: Path, header: Header, row: int, text: str | None) -> float:
    if text is None or text.strip().lower() in _MISSING:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        at = f"{path}: line {row + _FIRST_ROW_LINE}, column '{header.text}'"
        raise InputError(f"{at}: '{text.strip()[:40]}' is not a number; leave the cell empty if unknown") from None


def _as_numbers_if_possible(values: Any) -> Any:
    numeric = str(values.type) in ("int64", "double")
    return np.asarray(values.to_pandas(), dtype=float if numeric else object)
