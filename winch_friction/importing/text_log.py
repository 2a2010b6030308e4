"""Logs as text: any encoding, delimiter, decimal mark and preamble; .gz and .zip with one table as well."""

import csv
import gzip
import re
import zipfile
import zlib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from winch_friction.importing.cells import decimal_mark, is_missing, is_number
from winch_friction.importing.layout import Layout, find_layout
from winch_friction.importing.log import Log, Place, listed
from winch_friction.importing.text_columns import read_columns
from winch_friction.importing.text_rows import SEEN, TextRows
from winch_friction.physics.errors import InputError, counted

LARGEST = 1 << 30  # bytes of text: ten hours of ten channels at 100 Hz; more is split first
_PACKED = 64 << 20  # bytes from which a packed file is looked at more closely
_RATIO = 100  # times smaller packed than unpacked: numbers of a log pack to a third or a tenth
_WIDEST = 1 << 16  # characters of one line: a header of a thousand columns has a quarter of it
_HEAD = 4000  # bytes that tell an encoding
_WESTERN = ("cp1252", "latin-1")  # what any bytes can be read as
_HEAD_LINES, _ACCENTED = 5, 0.4  # lines with the names; of letters: no Western language has a fifth of them accented
_MOST_COLUMNS = 1000  # no winch log has more
_DELIMITERS = (";", ",", "\t", "|")
_DECIMAL = re.compile(r"[^,]*\d,\d[^,]*")
_CUT = 0.95  # of the lines, that a mark between columns cuts alike; what is left is a preamble


def read_text_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A text log; `settings` of an earlier look (encoding, delimiter, decimal, thousands, rows) or found anew."""
    given, notes = dict(settings or {}), list[str]()
    encoding, lines = _decoded(path, given.get("encoding"), notes)
    delimiter = given.get("delimiter") or _delimiter(lines)
    _refuse_channels_in_rows(path, lines, delimiter)
    rows = TextRows(path, _without_empty_tail(lines, delimiter, notes), delimiter)
    del lines
    rows.take_units_out(notes)
    if "decimal" in given:
        marks = given["decimal"], given.get("thousands", "")
    else:
        marks = decimal_mark((cell for row in (*rows.head, *rows.tail) for cell in row), delimiter)
    layout = _layout(given, rows, *marks)
    columns, body = read_columns(rows, layout, marks, delimiter, notes)
    found = {"kind": "text", "encoding": encoding, "delimiter": delimiter, "decimal": marks[0], "thousands": marks[1]}
    row_numbers = {"names_row": layout.names, "unit_row": layout.units, "first_row": layout.first}
    found |= {key: rows.numbers[row] if row >= 0 else 0 for key, row in row_numbers.items()}
    place: Place = lambda row: f"line {body[row]}"
    return Log(path, tuple(columns), found, place, tuple(notes))


def _decoded(path: Path, encoding: str | None, notes: list[str]) -> tuple[str, list[str]]:
    """Encoding and lines; the bytes are not kept."""
    raw = _unpacked(path)
    padding = len(raw) - len(raw.rstrip(b"\0"))
    if padding > 1 and 0 not in raw[:_HEAD]:  # a logger that lost its power leaves the room it had taken
        notes.append(f"{padding} zero bytes at the end are no text: left out")
        raw = raw[: len(raw) - padding]
    told, encoding = encoding, encoding or _encoding(path, raw)
    lines = _lines(path, raw, encoding)
    letters = [c for c in "".join(lines[:_HEAD_LINES]) if c.isalpha()]
    if not told and encoding in _WESTERN and sum(not c.isascii() for c in letters) > _ACCENTED * len(letters):
        notes.append(f"read as {encoding}, in which its names make no words: save it as UTF-8 if they should be read")
    return encoding, lines


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
    except (OSError, EOFError, ValueError, zlib.error) as error:
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
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError, EOFError, zlib.error) as error:
        raise InputError(f"{path}: not a readable .zip file ({str(error)[:80]})") from error


def _encoding(path: Path, raw: bytes) -> str:
    for mark, name in ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if raw.startswith(mark):
            return name
    head = raw[:_HEAD]
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


def _lines(path: Path, raw: bytes, encoding: str) -> list[str]:
    try:
        text = raw.decode(encoding).removeprefix("\ufeff")  # the map's encoding is that of another log
    except (UnicodeDecodeError, LookupError) as error:
        raise InputError(
            f"{path}: cannot be read as {encoding} ({str(error)[:80]}); set log.encoding in the map"
        ) from error
    lines = text.splitlines()
    if text.lstrip("\ufeff \t\r\n")[:9].lower().startswith(("<html", "<!doctype", "<?xml", "<table")):
        raise InputError(f"{path}: an HTML or XML page, no table of text; save it as .csv or .xlsx where it was made")
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: the file is empty")
    longest = max(range(len(lines)), key=lambda k: len(lines[k]))
    if len(lines[longest]) > _WIDEST:
        raise InputError(f"{path}: line {longest + 1} has {len(lines[longest])} characters; that is no table")
    return lines


def _delimiter(lines: Sequence[str]) -> str:
    """What a `sep=` line says, else the mark that cuts most lines into the same number of mostly numeric cells."""
    if lines[0].strip().strip('"').lower().startswith("sep="):
        return lines[0].strip().strip('"')[4:5] or ";"
    sample = [line for line in lines[: 2 * SEEN] if line.strip()][-SEEN:]
    best, delimiter = 0.0, " "
    by_others = any(_cuts_all(sample, each) and _of_decimals(sample, each) for each in _DELIMITERS if each != ",")
    for each in (*(each for each in _DELIMITERS if not (each == "," and by_others)), " "):
        score = _delimiter_score(sample, each)
        if score > best:
            best, delimiter = score, each
    return delimiter


def _cuts_all(sample: Sequence[str], delimiter: str) -> bool:
    """Whether a mark cuts nearly every line into as many cells, two or more of them with something in it."""
    widths = Counter(len(row) for row in (_cut(line, delimiter) for line in sample) if sum(map(bool, row)) > 1)
    return bool(widths) and widths.most_common(1)[0][1] >= _CUT * len(sample)


def _of_decimals(sample: Sequence[str], delimiter: str) -> bool:
    """Whether the commas that another mark leaves in its cells stand there for decimals, one between digits."""
    commas = [cell for line in sample for cell in _cut(line, delimiter) if "," in cell]
    return 2 * sum(_DECIMAL.fullmatch(cell) is not None for cell in commas) >= len(commas)


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


def _refuse_channels_in_rows(path: Path, lines: Sequence[str], delimiter: str) -> None:
    """A table that lies on its side: few rows, each a channel's name and all its values."""
    rows = [_cut(line, delimiter) for line in lines if line.strip()] if len(lines) <= _MOST_COLUMNS else []
    wide = [row for row in rows if len(row) > max(_MOST_COLUMNS, 10 * len(rows))]
    if len(wide) > 1 and 2 * len(wide) > len(rows):
        names = listed(row[0][:40] for row in wide)
        raise InputError(f"{path}: the channels stand in rows ({names}), {len(wide[0]) - 1} values each; transpose it")


def _without_empty_tail(lines: list[str], delimiter: str, notes: list[str]) -> list[str]:
    """Lines without the empty columns of another program's delimiter at their ends (`-10.6,,`)."""
    for mark in _DELIMITERS:
        ended = sum(line.endswith(mark) for line in lines if line.strip())
        if mark != delimiter and ended > 0.8 * sum(1 for line in lines if line.strip()):
            notes.append(f"lines end with '{mark}' although '{delimiter}' separates the columns: taken off the ends")
            return [line.rstrip(mark) for line in lines]
    return lines


def _layout(given: Mapping[str, Any], rows: TextRows, decimal: str, thousands: str) -> Layout:
    found = find_layout(rows.head, decimal, thousands)
    if found is None:
        first = "; ".join(" | ".join(row)[:60] for row in rows.head[:2])
        raise InputError(
            f"{rows.path}: no rows of numbers found in {counted(len(rows), 'line', 'lines')}; it begins with: {first}"
        )
    if "first_row" not in given:  # nothing is known of this log's rows
        return found
    places = [rows.index_of_line(int(given.get(key, 0) or 0)) for key in ("names_row", "unit_row", "first_row")]
    return Layout(places[0], places[1], places[2] if places[2] >= 0 else found.first, found.width, found.notes_row)
