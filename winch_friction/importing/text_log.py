"""Logs as text: any encoding, delimiter, decimal mark and preamble; .gz and .zip with one table as well."""

import csv
import gzip
import io
import zipfile
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from winch_friction.importing.cells import as_column, decimal_mark, is_missing, is_number, units_in_cells, without_unit
from winch_friction.importing.layout import Layout, find_layout
from winch_friction.importing.log import Log, LogColumn, Place, listed, unique_names
from winch_friction.importing.units import looks_like_unit
from winch_friction.physics.errors import InputError

LARGEST = 1 << 30  # bytes of text: ten hours of ten channels at 100 Hz; more is split first
_PACKED = 64 << 20  # bytes from which a packed file is looked at more closely
_RATIO = 100  # times smaller packed than unpacked: numbers of a log pack to a third or a tenth
_WIDEST = 1 << 16  # characters of one line: a header of a thousand columns has a quarter of it
_DELIMITERS = (";", ",", "\t", "|")
_SAMPLE = 300  # lines looked at for delimiter, decimal mark and layout


def read_text_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A text log; `settings` of an earlier look (encoding, delimiter, decimal, thousands, rows) or found anew."""
    given = dict(settings or {})
    raw = _unpacked(path)
    encoding = given.get("encoding") or _encoding(path, raw)
    lines, notes = _lines(path, raw, encoding)
    delimiter = given.get("delimiter") or _delimiter(lines)
    lines = _without_empty_tail(lines, delimiter, notes)
    rows, numbers = _split(path, lines, delimiter)
    _take_units_out(rows, notes)
    if "decimal" in given:
        decimal, thousands = given["decimal"], given.get("thousands", "")
    else:
        decimal, thousands = decimal_mark((cell for row in rows[-_SAMPLE:] for cell in row), delimiter)
    layout = _layout(path, given, rows, numbers, decimal, thousands)
    rows, numbers = _without_repeated_heads(rows, numbers, layout, notes)
    columns = _columns(path, rows, numbers, layout, decimal, thousands, notes, delimiter)
    found = {"kind": "text", "encoding": encoding, "delimiter": delimiter, "decimal": decimal, "thousands": thousands}
    row_numbers = {"names_row": layout.names, "unit_row": layout.units, "first_row": layout.first}
    found |= {key: numbers[row] if row >= 0 else 0 for key, row in row_numbers.items()}
    body = numbers[layout.first :]
    place: Place = lambda row: f"line {body[row]}"
    return Log(path, tuple(columns), found, place, tuple(notes))


def _unpacked(path: Path) -> bytes:
    if path.stat().st_size > LARGEST:
        raise InputError(f"{path}: {path.stat().st_size >> 20} MB of text; split the log, or bring it as Parquet")
    if path.suffix.lower() == ".gz":
        return _gunzipped(path)
    if path.suffix.lower() == ".zip":
        return _unzipped(path)
    return path.read_bytes()


def _gunzipped(path: Path) -> bytes:
    limit = max(_PACKED, _RATIO * path.stat().st_size)
    try:
        with gzip.open(path) as stream:
            content = stream.read(min(limit, LARGEST) + 1)
    except (OSError, EOFError, ValueError) as error:
        raise InputError(f"{path}: not a readable .gz file ({str(error)[:80]})") from error
    if len(content) > min(limit, LARGEST):
        raise InputError(f"{path}: unpacks to more than {min(limit, LARGEST) >> 20} MB, which no log does; not read")
    return content


def _unzipped(path: Path) -> bytes:
    try:
        with zipfile.ZipFile(path) as archive:
            members = [m for m in archive.infolist() if not m.is_dir() and not m.filename.startswith("__MACOSX")]
            if len(members) != 1:
                raise InputError(
                    f"{path}: holds {len(members)} files; unpack it and name the logs: "
                    f"{listed(m.filename for m in members)}"
                )
            if members[0].file_size > min(LARGEST, max(_PACKED, _RATIO * path.stat().st_size)):
                raise InputError(f"{path}: unpacks to {members[0].file_size >> 20} MB, which no log does; not read")
            return archive.read(members[0])
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError) as error:
        raise InputError(f"{path}: not a readable .zip file ({str(error)[:80]})") from error


def _encoding(path: Path, raw: bytes) -> str:
    for mark, name in ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if raw.startswith(mark):
            return name
    head = raw[:4000]
    if head.count(0) > len(head) // 3:  # text of two bytes a letter without its mark
        return "utf-16-le" if head[1:2] == b"\0" else "utf-16-be"
    if 0 in raw:
        raise InputError(f"{path}: not a text file (a zero byte at {raw.index(0)}); which program wrote it?")
    for name in ("utf-8", "cp1252"):
        try:
            raw.decode(name)
        except UnicodeDecodeError:
            continue
        return name
    return "latin-1"


def _lines(path: Path, raw: bytes, encoding: str) -> tuple[list[str], list[str]]:
    try:
        text = raw.decode(encoding)
    except (UnicodeDecodeError, LookupError) as error:
        raise InputError(
            f"{path}: cannot be read as {encoding} ({str(error)[:80]}); set log.encoding in the map"
        ) from error
    lines = text.splitlines()
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: the file is empty")
    longest = max(range(len(lines)), key=lambda k: len(lines[k]))
    if len(lines[longest]) > _WIDEST:
        raise InputError(f"{path}: line {longest + 1} has {len(lines[longest])} characters; that is no table")
    return lines, []


def _delimiter(lines: Sequence[str]) -> str:
    """What a `sep=` line says, else the mark that cuts most lines into the same number of mostly numeric cells."""
    if lines[0].strip().strip('"').lower().startswith("sep="):
        return lines[0].strip().strip('"')[4:5] or ";"
    sample = [line for line in lines[: 2 * _SAMPLE] if line.strip()][-_SAMPLE:]
    best, delimiter = 0.0, " "
    for each in (*_DELIMITERS, " "):
        score = _delimiter_score(sample, each)
        if score > best:
            best, delimiter = score, each
    return delimiter


def _delimiter_score(sample: Sequence[str], delimiter: str) -> float:
    rows = [_cut(line, delimiter) for line in sample]
    widths = Counter(len(row) for row in rows if len(row) > 1)
    if not widths:
        return 0.0
    width, count = widths.most_common(1)[0]
    cells = [cell for row in rows if len(row) == width for cell in row if not is_missing(cell)]
    decimal, thousands = decimal_mark(cells, delimiter)
    numeric = sum(is_number(cell, decimal, thousands) for cell in cells) / max(1, len(cells))
    penalty = 0.8 if delimiter == " " else 1.0  # blanks also stand inside dates and names
    return penalty * count / len(rows) * (0.3 + 0.7 * numeric)


def _cut(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    try:
        return next(csv.reader([line], delimiter=delimiter), [])
    except csv.Error:
        return []


def _without_empty_tail(lines: list[str], delimiter: str, notes: list[str]) -> list[str]:
    """Lines without the empty columns of another program's delimiter at their ends (`-10.6,,`)."""
    for mark in _DELIMITERS:
        ended = sum(line.endswith(mark) for line in lines if line.strip())
        if mark != delimiter and ended > 0.8 * sum(1 for line in lines if line.strip()):
            notes.append(f"lines end with '{mark}' although '{delimiter}' separates the columns: taken off the ends")
            return [line.rstrip(mark) for line in lines]
    return lines


def _split(path: Path, lines: Sequence[str], delimiter: str) -> tuple[list[list[str]], list[int]]:
    """Rows of cells and the number of each row's line; a `sep=` line and blank lines are no rows."""
    rows, numbers = [], []
    if delimiter == " ":
        kept = [(k + 1, line.split()) for k, line in enumerate(lines) if line.strip()]
        return [row for _, row in kept], [k for k, _ in kept]
    reader = csv.reader(io.StringIO("\n".join(lines) + "\n"), delimiter=delimiter)
    try:
        for row in reader:
            if any(cell.strip() for cell in row) and not (reader.line_num == 1 and row[0].lower().startswith("sep=")):
                rows.append(row)
                numbers.append(reader.line_num)
    except csv.Error as error:
        raise InputError(f"{path}: line {reader.line_num}: {error}") from error
    return rows, numbers


def _take_units_out(rows: list[list[str]], notes: list[str]) -> None:
    """Cells that bear their unit become numbers; the unit stands above them, in the row before the first of them."""
    found = {k: unit for k, unit in units_in_cells(rows[-_SAMPLE:]).items() if looks_like_unit(unit)}
    if not found:
        return
    bears = lambda row: any(k < len(row) and without_unit(row[k], unit) != row[k] for k, unit in found.items())
    first = next(n for n, row in enumerate(rows) if bears(row) and any(c.isdigit() for cell in row for c in cell))
    for row in rows[max(first, 1) :]:
        for k, unit in found.items():
            if k < len(row):
                row[k] = without_unit(row[k], unit)
    head = rows[first - 1] if first else []
    for k, unit in found.items():
        if k < len(head):
            head[k] = f"{head[k]} [{unit}]"
    notes.append(
        f"cells of {len(found)} columns bear their unit: taken off ({', '.join(dict.fromkeys(found.values()))})"
    )


def _without_repeated_heads(
    rows: list[list[str]], numbers: list[int], layout: Layout, notes: list[str]
) -> tuple[list[list[str]], list[int]]:
    """Rows without the names and units that a logger writes again whenever it starts a page."""
    heads = [rows[k] for k in (layout.names, layout.units) if k >= 0]
    again = {k for k in range(layout.first, len(rows)) if rows[k] in heads}
    if not again:
        return rows, numbers
    notes.append(f"the header stands {len(again)} times more (line {numbers[min(again)]}): left out")
    kept = [k for k in range(len(rows)) if k not in again]
    return [rows[k] for k in kept], [numbers[k] for k in kept]


def _layout(path: Path, given: Mapping[str, Any], rows: Sequence[Sequence[str]], numbers: Sequence[int], decimal: str,
            thousands: str) -> Layout:  # fmt: skip
    found = find_layout(rows, decimal, thousands)
    if found is None:
        first = "; ".join(" | ".join(row)[:60] for row in rows[:2])
        raise InputError(f"{path}: no rows of numbers found in {len(rows)} lines; it begins with: {first}")
    if not given:
        return found
    index = {number: k for k, number in enumerate(numbers)}
    rows_of = [index.get(int(given.get(key, 0) or 0), -1) for key in ("names_row", "unit_row", "first_row")]
    return Layout(rows_of[0], rows_of[1], rows_of[2] if rows_of[2] >= 0 else found.first, found.width, found.notes_row)


def _columns(path: Path, rows: Sequence[Sequence[str]], numbers: Sequence[int], layout: Layout, decimal: str,
             thousands: str, notes: list[str], delimiter: str) -> list[LogColumn]:  # fmt: skip
    body = rows[layout.first :]
    heads = {k: list(rows[k]) if k >= 0 else [] for k in (layout.names, layout.units, layout.notes_row)}
    width = max(layout.width, len([c for c in heads[layout.names] if c.strip()]))
    ragged = [numbers[layout.first + k] for k, row in enumerate(body) if len(row) < width - 1]
    if ragged:
        shown = ", ".join(map(str, ragged[:3]))
        notes.append(
            f"{len(ragged)} lines are shorter than the {width} columns (line {shown}): their cells are missing"
        )
    if layout.names >= 0 and layout.width > len(heads[layout.names]) > 1:
        raise InputError(
            f"{path}: line {numbers[layout.first]} has {layout.width} cells under {len(heads[layout.names])} names; "
            f"does '{delimiter}' also stand inside cells (a decimal comma)? Quote such cells, or separate by ';'"
        )
    names = unique_names(_padded(heads[layout.names], width))
    units, remarks = _padded(heads[layout.units], width), _padded(heads[layout.notes_row], width)
    cut = [_padded(row, width) for row in body]
    cells = list(zip(*cut, strict=True))
    return [
        as_column(name, cells[k], decimal, thousands, units[k].strip().strip("[]()"), remarks[k].strip())
        for k, name in enumerate(names)
    ]


def _padded(row: Sequence[str], width: int) -> list[str]:
    return [*row[:width], *([""] * (width - len(row)))]
