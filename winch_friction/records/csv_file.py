"""Run files as CSV: one header line with units, one row per sample; comma, semicolon or tab. Needs no library."""

import codecs
import csv
import io
import itertools
from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError, Problems, no_cells
from winch_friction.physics.signals import FloatArray, Run, column_unit
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.atomic import atomic_path
from winch_friction.records.decimal_comma import has_decimal_commas, refuse_decimal_commas
from winch_friction.records.run_checks import Place, checked_run
from winch_friction.records.unit_names import conversion_to_si

_SHOWN = 3  # places named of one kind of problem
BLOCK = 10_000  # rows that are texts at one time: 20 MB of a log with 30 columns
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
    table = _Table(path)
    problems = Problems()
    with problems:
        table.check_width()
    ragged = bool(problems.found)
    headers = read_headers(path, table.header, problems)
    if ragged:
        problems.say()
    place: Place = lambda row: f"line {table.lines[row]}"
    columns, aside, commas = {}, {}, dict[str, str]()
    bare = [header.name for header in headers if header.known and not header.unit]
    for header, cells in zip(headers, table.columns, strict=True):
        if header.known:
            numbers = _numbers(path, header, cells, place, problems, commas)
            columns[header.name] = numbers
            with problems:
                columns[header.name] = header.to_si(numbers, str(path))
        else:
            aside[header.text] = cells.numbers_or_text()
    if commas:
        refuse_decimal_commas(path, commas, problems)
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
    columns = [["" if each != each else each for each in np.asarray(values).tolist()] for values in content.values()]
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
            raise InputError(
                f"{path}: column '{name}' stands twice, as '{seen[name].text}' and '{header.text}'; leave one"
            )
        seen[name] = header
    return headers


def with_count(said: list[str], count: int, of: str) -> list[str]:
    """The problems that are shown, the last of them with how many more there are."""
    more = count - len(said)
    return [*said[:-1], f"{said[-1]} (and {more} more {of})"] if more else said


def _content(path: Path) -> bytes:
    """The file in UTF-8, without a mark in front and blank lines behind: those are nobody's data."""
    content = path.read_bytes()
    try:
        blank = not content.strip() or not (content.isascii() or content.decode("utf-8-sig").strip())
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: not a text file (byte {error.start} is not UTF-8); expected CSV (import reads others)"
        ) from error
    if b"\0" in content:
        raise InputError(f"{path}: not a text file (it holds zero bytes); expected CSV")
    if blank:
        raise InputError(f"{path}: the file is empty; expected a header line with column names")
    return content.removeprefix(codecs.BOM_UTF8).rstrip(b"\r\n") + b"\n"


def separator_of(header: str) -> str:
    """What separates the cells of a file with this header line."""
    return max(",;\t", key=header.count)


@dataclass
class _Cells:
    """A column's cells, block by block: as numbers where all of a block are, else as they stand."""

    known: bool  # what the contract does not know may be text anywhere, and stays as it stands
    blocks: list[Any] = field(default_factory=list)

    def add(self, texts: Sequence[str]) -> None:
        """The next block."""
        try:
            self.blocks.append(as_floats(texts) if self.known else texts)
        except ValueError:  # a cell that is empty, or no number
            self.blocks.append(texts)

    def numbers(self) -> tuple[FloatArray, list[tuple[int, str]]]:
        """All as numbers, and the row and text of each cell that is none: NaN there, and where a cell is empty."""
        parts, bad, first = [np.empty(0)], list[tuple[int, str]](), 0
        for block in self.blocks:
            numbers = block if isinstance(block, np.ndarray) else [_number(text) for text in block]
            bad += [(first + k, block[k]) for k, number in enumerate(numbers) if number is None]
            parts.append(np.array(numbers, dtype=float))  # NaN for None
            first += len(block)
        return np.concatenate(parts), bad

    def numbers_or_text(self) -> Any:
        """All as numbers where all are or are empty, else as texts."""
        texts = list(itertools.chain.from_iterable(self.blocks))
        try:
            return as_floats([text or "nan" for text in texts])
        except ValueError:
            return np.array(texts, dtype=object)


class _Table:
    """A file's cells by columns, read a block of rows at a time: as texts those of a million rows would take ten times
    what the file does.

    `header`: the cells of its first line; `lines`: the number of each further row's last line.
    """

    def __init__(self, path: Path) -> None:
        content = _content(path)
        separator = separator_of(content.partition(b"\n")[0].decode())
        reader = csv.reader(io.TextIOWrapper(io.BytesIO(content), encoding="utf-8", newline=""), delimiter=separator)
        del content  # the stream's own now
        self._path, self.lines, self._ragged, self.header = path, array("q"), list[tuple[int, int]](), list[str]()
        try:
            self.header = next(reader)
            named = (cell.partition("[")[0].strip() for cell in self.header)
            self.columns = [_Cells(column_unit(name) is not None) for name in named]
            while rows := self._block(reader):
                self._add(rows)
        except csv.Error as error:
            begun = self.lines[-1] + 1 if self.lines else 1 + bool(self.header)
            raise InputError(f"{path}: line {begun}: {no_cells(error)}") from error

    def _block(self, reader: Any) -> list[list[str]]:
        rows = []
        for row in itertools.islice(reader, BLOCK):
            self.lines.append(reader.line_num)
            rows.append(row)
        return rows

    def _add(self, rows: list[list[str]]) -> None:
        width, first = len(self.header), len(self.lines) - len(rows)
        self._ragged += [(self.lines[first + k], len(row)) for k, row in enumerate(rows) if len(row) != width]
        if not self._ragged:
            for cells, texts in zip(self.columns, zip(*rows, strict=True), strict=True):
                cells.add(texts)

    def check_width(self) -> None:
        """Raise `InputError` for a first line that is no header, and for rows of another length."""
        path, width = self._path, len(self.header)
        if self.header and self.header[0].startswith("#"):
            raise InputError(
                f"{path}: line 1 is a remark; a run's first line is its header (winch-friction import reads logs with "
                "lines above it; a supplier's table is for winch-friction identify motor)"
            )
        if not width:
            raise InputError(f"{path}: line 1 is blank; expected the header line there")
        said = [
            f"{path}: line {line}: {count} values for {width} columns; put the cells right or take the line out"
            if count
            else f"{path}: line {line}: blank line; take it out"
            for line, count in self._ragged[:_SHOWN]
        ]
        if said:
            raise InputError(*with_count(said, len(self._ragged), "lines"))


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


def _numbers(
    path: Path, header: Header, cells: _Cells, place: Place, problems: Problems, commas: dict[str, str]
) -> FloatArray:
    """A column's numbers; a cell that is none is gathered, and NaN. One of decimal commas is noted in `commas`."""
    numbers, bad = cells.numbers()
    if len(bad) > 1 and has_decimal_commas(bad, _number):
        commas[header.text] = f"'{bad[0][1].strip()[:40]}', {place(bad[0][0])}"
    elif bad:
        at = [f"{path}: {place(row)}, column '{header.text}': '{text.strip()[:40]}'" for row, text in bad[:_SHOWN]]
        foreign = len(bad) == len(numbers) or _number(bad[0][1].replace(",", ".")) is not None
        advice = "winch-friction import reads other ways of writing" if foreign else "leave the cell empty if unknown"
        if header.name == "time":  # which no row is without; between its neighbours, for what else is wrong with it
            advice = advice if foreign else "fill it in or remove the row"
            rows, lost = np.arange(len(numbers)), [row for row, _ in bad]
            numbers[lost] = np.interp(lost, np.delete(rows, lost), np.delete(numbers, lost)) if not foreign else lost
        if all(_number(text.replace("_", "")) is not None for _, text in bad[:_SHOWN]):
            advice = "write it without '_'"
        said = [f"{each} is not a number; {advice}" for each in at]
        with problems:
            raise InputError(*with_count(said, len(bad), "like it in this column"))
    return numbers


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
