"""Run files as CSV: one header line with units, one row per sample; comma, semicolon or tab. Needs no library."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.signals import FloatArray, Run, column_unit
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import atomic_path
from winch_friction.records.run_checks import Place, checked_run
from winch_friction.records.unit_names import conversion_to_si

_SHOWN = 3  # places named of one kind of problem
_MISSING = ("", "nan", "na", "n/a", "null", "none", "-nan")


@dataclass(frozen=True)
class Header:
    """One header: `text` as it stands, the column's `name`, the `unit` in brackets (empty: SI)."""

    text: str
    name: str
    unit: str

    @property
    def known(self) -> bool:
        """Whether the name is one of the contract's columns."""
        return column_unit(self.name) is not None

    def to_si(self, values: FloatArray, where: str) -> FloatArray:
        """Values of a known column in SI; raises `InputError` for a unit that does not fit."""
        expected = column_unit(self.name) or "1"
        if self.unit in ("", expected):
            return values
        scale, offset = conversion_to_si(self.unit, expected, f"{where}: column '{self.text}'")
        with np.errstate(over="ignore"):  # infinite is told with its row, as what is not finite in the file
            return values * scale + offset if offset else values * scale


def parse_header(text: str, where: str = "") -> Header:
    """Name and unit of a header; a bracket that does not close raises `InputError`."""
    name, bracket, rest = text.strip().partition("[")
    if bracket and not rest.rstrip().endswith("]"):
        raise InputError(
            f"{where}: header '{text}' opens a bracket that does not close; write e.g. 'motor_speed [rpm]'"
        )
    return Header(text.strip(), name.strip(), rest.strip().removesuffix("]").strip())


def said_of_nameless(headers: Iterable[Header], name: str) -> list[str]:
    """What is said of columns without a name, by their places from 1: nothing else tells them."""
    places = (place for place, header in enumerate(headers, 1) if not header.name)
    return [f"{name}: column {place} has no name and is kept aside" for place in places]


def header_text(column: str) -> str:
    """The header that this package writes for a column: with its SI unit, bare for an unknown one or a plain number."""
    unit = column_unit(column)
    return column if unit in (None, "1") else f"{column} [{unit}]"


def read_csv_run(path: Path, crane: Crane | None = None, complete: bool = True) -> Run:
    """A run from a CSV file; raises `InputError` with line and column for whatever cannot be read."""
    lines, rows = _rows(path, _text(path))
    problems = Problems()
    with problems:
        _check_width(path, lines, rows)
    ragged = bool(problems.found)
    headers = read_headers(path, rows[0], problems)
    if ragged:
        problems.say()
    place: Place = lambda row: f"line {lines[row + 1]}"
    cells = list(zip(*rows[1:], strict=True)) or [()] * len(headers)
    columns, aside = {}, {}
    bare = [header.name for header in headers if header.known and not header.unit]
    for header, values in zip(headers, cells, strict=True):
        if header.known:
            numbers = _numbers(path, header, values, place, problems)
            columns[header.name] = numbers
            with problems:
                columns[header.name] = header.to_si(numbers, str(path))
        else:
            aside[header.text] = _numbers_or_text(values)
    with problems:
        run = checked_run(
            path.name, columns, place=place, crane=crane, complete=complete, aside=aside, bare=bare,
            warnings=said_of_nameless(headers, path.name),
        )  # fmt: skip
    problems.say()
    return run


def write_csv_run(run: Run, path: Path) -> Path:
    """Write a run atomically, SI units in the headers, every digit kept; metadata has no place in a CSV file."""
    content = {header_text(name): values for name, values in run.columns.items()} | dict(run.aside)
    columns = [_written(np.asarray(values)) for values in content.values()]
    with atomic_path(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(content)
        writer.writerows(zip(*columns, strict=True))
    return path


def unique_headers(headers: list[Header], path: Path) -> list[Header]:
    """The headers, when no two name the same column; else `InputError`."""
    nameless = [str(place) for place, header in enumerate(headers, 1) if not header.text]
    if len(nameless) > 1:
        at = f"{', '.join(nameless[:-1])} and {nameless[-1]}"
        raise InputError(f"{path}: columns {at} have no name; name them in the header, or take them out")
    seen: dict[str, Header] = {}
    for header in headers:
        name = header.name if header.known else header.text
        if name in seen:
            raise InputError(f"{path}: column '{name}' stands twice, as '{seen[name].text}' and '{header.text}'")
        seen[name] = header
    return headers


def with_count(said: list[str], count: int, of: str) -> list[str]:
    """The problems that are shown, the last of them with how many more there are."""
    more = count - len(said)
    return [*said[:-1], f"{said[-1]} (and {more} more {of})"] if more else said


def _text(path: Path) -> str:
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: not a text file (byte {error.start} is not UTF-8); expected CSV (import reads others)"
        ) from error
    if "\0" in text:
        raise InputError(f"{path}: not a text file (it holds zero bytes); expected CSV")
    if not text.strip():
        raise InputError(f"{path}: the file is empty; expected a header line with column names")
    return text.rstrip("\r\n") + "\n"  # blank lines at the end are nobody's data


def separator_of(header: str) -> str:
    """What separates the cells of a file with this header line."""
    return max(",;\t", key=header.count)


def _rows(path: Path, text: str) -> tuple[list[int], list[list[str]]]:
    """The number of each row's last line, and its cells."""
    header = text.partition("\n")[0]
    # a StringIO would hold four bytes a letter
    stream = io.TextIOWrapper(io.BytesIO(text.encode()), encoding="utf-8", newline="")
    reader = csv.reader(stream, delimiter=separator_of(header))
    lines, rows = [], []
    try:
        for row in reader:
            lines.append(reader.line_num)
            rows.append(row)
    except csv.Error as error:
        raise InputError(f"{path}: line {reader.line_num}: {error}") from error
    return lines, rows


def read_headers(path: Path, cells: Sequence[str], problems: Problems) -> list[Header]:
    """The headers of a file's columns; what is wrong with any of them is gathered."""
    headers = []
    for cell in cells:
        own = Header(cell.strip(), cell.partition("[")[0].strip(), "")  # where its bracket does not close
        with problems:
            own = parse_header(cell, str(path))
        headers.append(own)
    with problems:
        unique_headers(headers, path)
    return headers


def _check_width(path: Path, lines: Sequence[int], rows: Sequence[Sequence[str]]) -> None:
    width = len(rows[0])
    if rows[0] and rows[0][0].startswith("#"):
        raise InputError(
            f"{path}: line 1 is a remark; a run's first line is its header (winch-friction import reads logs with "
            "lines above it; a supplier's table is for winch-friction identify motor)"
        )
    if not width:
        raise InputError(f"{path}: line 1 is blank; expected the header line there")
    bad = [(line, row) for line, row in zip(lines, rows, strict=True) if len(row) != width]
    if bad:
        said = [
            f"{path}: line {line}: {len(row)} values for {width} columns" if row else f"{path}: line {line}: blank line"
            for line, row in bad[:_SHOWN]
        ]
        raise InputError(*with_count(said, len(bad), "lines"))


def _numbers(path: Path, header: Header, values: Sequence[str], place: Place, problems: Problems) -> FloatArray:
    """A column's numbers; a cell that is none is gathered, and NaN."""
    try:
        return as_floats(values)
    except ValueError:  # a cell that is empty, or no number
        numbers = [_number(text) for text in values]
    bad = [row for row, number in enumerate(numbers) if number is None]
    if bad:
        at = [f"{path}: {place(row)}, column '{header.text}': '{values[row].strip()[:40]}'" for row in bad[:_SHOWN]]
        foreign = len(bad) == len(values) or _number(values[bad[0]].replace(",", ".")) is not None
        advice = "winch-friction import reads other ways of writing" if foreign else "leave the cell empty if unknown"
        if all(_number(values[row].replace("_", "")) is not None for row in bad[:_SHOWN]):
            advice = "write it without '_'"
        said = [f"{each} is not a number; {advice}" for each in at]
        with problems:
            raise InputError(*with_count(said, len(bad), "like it in this column"))
    return np.array([np.nan if number is None else number for number in numbers])


def as_floats(values: Sequence[str]) -> FloatArray:
    """Texts as numbers, `1_000` being none: it is a number in Python alone. Raises `ValueError`."""
    if "_" in "".join(values):
        raise ValueError("no number has an underscore")
    return np.array(values, dtype=float)


def _number(text: str) -> float | None:
    """The cell's number, NaN for an empty one, None for what is no number."""
    if text.strip().lower() in _MISSING:
        return float("nan")
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


def _numbers_or_text(values: Sequence[str]) -> Any:
    try:
        return as_floats([text or "nan" for text in values])
    except ValueError:
        return np.array(values, dtype=object)


def _written(values: Any) -> list[Any]:
    """Plain values; NaN as an empty cell."""
    return ["" if value != value else value for value in values.tolist()]
