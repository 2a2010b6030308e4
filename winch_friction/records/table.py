"""Small tables at the desk: CSV with units in brackets in the headers, every defect named by file, row and column."""

import csv
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError, Problems, counted
from winch_friction.physics.signals import FloatArray
from winch_friction.records.atomic import write_text
from winch_friction.records.csv_file import as_floats, parse_header, separator_of
from winch_friction.records.strict_yaml import utf_8_text
from winch_friction.records.unit_names import conversion_to_si

_SHOWN = 3  # places named of one kind of problem
_SPREADSHEETS = (".xlsx", ".xlsm", ".xls", ".ods")
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")


@dataclass(frozen=True)
class Table:
    """Columns as text with their units; numbers are made, converted and checked when a column is asked for.

    `rows` are the file's line numbers, counted from 1 with the header as the first.
    """

    path: Path
    cells: Mapping[str, tuple[str, ...]]
    units: Mapping[str, str]
    rows: tuple[int, ...]

    @property
    def name(self) -> str:
        """The table's identity: its file name."""
        return self.path.name

    def __contains__(self, column: str) -> bool:
        return column in self.cells

    def column(self, name: str, si_unit: str) -> FloatArray:
        """A column in SI; raises `InputError` for a missing one, an unknown unit, text and NaN."""
        if name not in self.cells:
            raise InputError(f"{self.path}: column '{name}' is missing; the table has {', '.join(self.cells)}")
        problems, values = Problems(), np.empty(len(self.rows))
        for k, (text, row) in enumerate(zip(self.cells[name], self.rows, strict=True)):
            with problems:
                values[k] = self._number(text, name, row)
        if len(problems.found) > _SHOWN:
            more = f" (and {len(problems.found) - _SHOWN} more like it in this column)"
            problems.found[_SHOWN - 1 :] = [problems.found[_SHOWN - 1] + more]
        problems.say()
        with np.errstate(over="ignore"):  # infinite is beyond any range too
            return values * _factor(self.units[name], si_unit, f"{self.path}: column '{name}'")

    def _number(self, text: str, column: str, row: int) -> float:
        try:
            value = float(as_floats([text])[0])
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            where = f"{self.path} row {row}: column '{column}'"
            if not text:
                raise InputError(f"{where} is empty; give a number, or leave the row out")
            advice = "; write it with a point" if _DECIMAL_COMMA.fullmatch(text) else ""
            raise InputError(f"{where} holds {text!r}, not a finite number{advice}")
        return value

    def refuse(self, column: str, bad: Any, reason: str) -> None:
        """Raise `InputError` at the first row where `bad` is true, with the rows of the others."""
        places = [int(k) for k in np.flatnonzero(bad)]
        if not places:
            return
        first, *others = places
        shown = ", ".join(str(self.rows[k]) for k in others[:_SHOWN])
        more = f" and {len(others) - _SHOWN} more" if len(others) > _SHOWN else ""
        also = f"; the same in row {shown}{more}" if others else ""
        cell = self.cells[column][first]
        raise InputError(f"{self.path} row {self.rows[first]}: column '{column}' = {cell} {reason}{also}")


def read_table(path: Path) -> Table:
    """A CSV file (comma, semicolon or tab) as a table; lines starting with # are comments."""
    if path.suffix.lower() in _SPREADSHEETS:
        raise InputError(f"{path}: a spreadsheet; save it as .csv, with a point in decimals, and give that")
    lines = utf_8_text(path).splitlines()
    numbered = [(k + 1, line) for k, line in enumerate(lines) if line.strip() and not line.startswith("#")]
    if len(numbered) < 2:
        raise InputError(
            f"{path}: a header and at least one row are needed, found {counted(len(numbered), 'line', 'lines')}"
        )
    records = list(csv.reader((line for _, line in numbered), delimiter=separator_of(numbered[0][1])))
    return _table(Path(path), records, [row for row, _ in numbered])


def _table(path: Path, records: list[list[str]], rows: list[int]) -> Table:
    headers = [_header(text, path) for text in records[0]]
    names = [name for name, _ in headers]
    doubled = [name for name in names if names.count(name) > 1]
    if doubled:
        raise InputError(f"{path} row {rows[0]}: column '{doubled[0]}' appears twice")
    for row, record in zip(rows[1:], records[1:], strict=True):
        if len(record) != len(names):
            raise InputError(f"{path} row {row}: {len(record)} cells, the header has {len(names)} columns")
    cells = {name: tuple(record[k].strip() for record in records[1:]) for k, name in enumerate(names)}
    return Table(path, cells, dict(headers), tuple(rows[1:]))


def _header(text: str, path: Path) -> tuple[str, str]:
    header = parse_header(text, str(path))
    return header.name.lower().replace(" ", "_"), header.unit


def _factor(unit: str, si_unit: str, where: str) -> float:
    """Factor from a header's unit to SI; no bracket means SI already."""
    return 1.0 if unit in ("", si_unit) else conversion_to_si(unit, si_unit, where)[0]


def write_table(path: Path, columns: Mapping[str, Iterable[Any]], comments: Iterable[str] = ()) -> Path:
    """Write a CSV table atomically; the keys are whole headers, `speed [rpm]`."""
    body = [",".join(map(str, row)) for row in zip(*columns.values(), strict=True)]
    head = [f"# {comment}" for comment in comments]
    return write_text(path, "\n".join([*head, ",".join(columns), *body]) + "\n")
