"""The rows of stored values of every sheet of a workbook: Excel's new and old kinds, OpenDocument's.

.xlsx and .xlsm by calamine, ten times as fast, or by openpyxl, which says what is wrong with a file; the others by
calamine alone.
"""

import contextlib
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from winch_friction.importing.cells import is_missing
from winch_friction.importing.optional import library
from winch_friction.physics.errors import InputError

LARGEST = 400 << 20  # bytes unpacked: Excel's million rows of ten numbers have less
ROWS_PEEKED = 300
OPEN_XML = (".xlsx", ".xlsm")  # that openpyxl reads
_RATIO = 200  # times smaller packed: a sheet of repeated text packs to a fiftieth
_COLUMNS = 1000  # no winch log has more; a sheet formatted to the last column (16384) has


def refuse_bombs(path: Path) -> None:
    """Raise `InputError` for a file that is no workbook, and for one that unpacks to more than any log holds."""
    if path.suffix.lower() == ".xls":
        return  # packed by nothing
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(member.file_size for member in archive.infolist())
    except (zipfile.BadZipFile, OSError) as error:
        raise InputError(
            f"{path}: not a readable {path.suffix.lower()} file ({str(error)[:80]}); save it as .xlsx or .csv"
        ) from error
    if size > min(LARGEST, max(32 << 20, _RATIO * path.stat().st_size)):
        raise InputError(
            f"{path}: unpacks from {path.stat().st_size >> 10} kB to {size >> 20} MB, which no log does; not read"
        )


def sheets_of(path: Path) -> dict[str, list[Sequence[Any]]]:
    """Rows of stored values of every sheet by its name; raises `InputError` for a file that cannot be read."""
    if path.suffix.lower() not in OPEN_XML:
        library("python_calamine", f"{path.suffix.lower()} logs")
        try:
            return _fast_sheets(path)
        except Exception as error:  # calamine raises what its parsers meet
            said = str(error)[:80] or type(error).__name__
            raise InputError(f"{path}: not a readable {path.suffix.lower()} file ({said}); save it as .xlsx") from error
    with contextlib.suppress(Exception):  # whatever it stumbles over is openpyxl's to read, or to refuse with a reason
        return _fast_sheets(path)
    book = open_book(path, values=True)
    try:
        return {sheet.title: _rows_of(path, sheet) for sheet in book.worksheets}
    except InputError:
        raise
    except Exception as error:  # openpyxl raises what its parsers meet
        raise InputError(f"{path}: a sheet cannot be read ({str(error)[:80] or type(error).__name__})") from error
    finally:
        book.close()


def _fast_sheets(path: Path) -> dict[str, list[Sequence[Any]]]:
    from python_calamine import CalamineWorkbook

    # by its content: Excel's new kind is often called .xls
    with path.open("rb") as file, CalamineWorkbook.from_filelike(file) as book:
        sheets = {name: book.get_sheet_by_name(name).to_python(skip_empty_area=False) for name in book.sheet_names}
    return {name: _as_openpyxl(rows) for name, rows in sheets.items()}


def _as_openpyxl(rows: Sequence[Sequence[Any]]) -> list[Sequence[Any]]:
    """Empty cells as None, and above the body whole numbers as such: a name there may be a year."""
    head = [[int(c) if isinstance(c, float) and c.is_integer() else c for c in row] for row in rows[:ROWS_PEEKED]]
    found = [[None if c == "" else c for c in row[:_COLUMNS]] for row in (*head, *rows[ROWS_PEEKED:])]
    while found and all(map(is_missing, found[-1])):
        found.pop()
    return list(found)


def open_book(path: Path, values: bool) -> Any:
    """A workbook by openpyxl, with stored values or with formulas."""
    openpyxl = library("openpyxl", ".xlsx logs")
    try:
        return openpyxl.load_workbook(path, read_only=True, data_only=values)
    except Exception as error:  # openpyxl raises what its parsers meet
        raise InputError(f"{path}: not a readable .xlsx file ({str(error)[:80] or type(error).__name__})") from error


def _rows_of(path: Path, sheet: Any) -> list[Sequence[Any]]:
    if sheet.max_column is not None and sheet.max_column > _COLUMNS:
        sheet.reset_dimensions()  # a formatted empty sheet says 16384 columns
    rows = [row[:_COLUMNS] for row in sheet.iter_rows(values_only=True)]
    while rows and all(map(is_missing, rows[-1])):
        rows.pop()
    return rows
