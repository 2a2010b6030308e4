"""Logs as spreadsheets (.xlsx, .xlsm): stored values of the fullest sheet; formulas without a stored value are said."""

import contextlib
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from winch_friction.importing.cells import as_column, decimal_mark, is_missing
from winch_friction.importing.group_names import with_groups
from winch_friction.importing.layout import Layout, find_layout
from winch_friction.importing.log import Log, LogColumn, Place, listed, unique_names
from winch_friction.importing.optional import library
from winch_friction.importing.units import bare_unit
from winch_friction.physics.errors import InputError

LARGEST = 400 << 20  # bytes unpacked: Excel's million rows of ten numbers have less
_RATIO = 200  # times smaller packed: a sheet of repeated text packs to a fiftieth
_COLUMNS = 1000  # no winch log has more; a sheet formatted to the last column (16384) has
_ROWS_PEEKED = 300


def read_workbook_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A spreadsheet log; `settings` of an earlier look name the sheet and its rows."""
    given = dict(settings or {})
    _refuse_bombs(path)
    sheets = _sheets(path)
    name = given.get("sheet") or _fullest(path, sheets)
    if name not in sheets:
        raise InputError(f"{path}: no sheet '{name}'; found {listed(sheets)}")
    rows = sheets[name]
    texts = (cell for row in rows[:_ROWS_PEEKED] for cell in row if isinstance(cell, str))
    decimal, thousands = decimal_mark(texts, "\t")
    layout = find_layout(rows[:_ROWS_PEEKED], decimal, thousands)
    if layout is None:
        raise InputError(f"{path}: sheet '{name}' has no rows of numbers; the sheets are {listed(sheets)}")
    if "first_row" in given:
        names, units, first = (int(given.get(key, 0)) - 1 for key in ("names_row", "unit_row", "first_row"))
        layout = Layout(names, units, first, layout.width)
    body = [(k + 1, row) for k, row in enumerate(rows) if k >= layout.first and not all(map(is_missing, row))]
    columns = _columns(rows, [row for _, row in body], layout, decimal, thousands)
    notes = (
        [f"read from sheet '{name}'; the others are {listed(s for s in sheets if s != name)}"]
        if len(sheets) > 1
        else []
    )
    notes += _formulas_without_values(path, name, columns, [k for k, _ in body])
    found = {"kind": "workbook", "sheet": name, "names_row": layout.names + 1, "unit_row": layout.units + 1}
    place: Place = lambda row: f"row {body[row][0]}"
    return Log(path, tuple(columns), found | {"first_row": layout.first + 1}, place, tuple(notes))


def _refuse_bombs(path: Path) -> None:
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(member.file_size for member in archive.infolist())
    except (zipfile.BadZipFile, OSError) as error:
        raise InputError(f"{path}: not a readable .xlsx file ({str(error)[:80]}); save it as .xlsx or .csv") from error
    if size > min(LARGEST, max(32 << 20, _RATIO * path.stat().st_size)):
        raise InputError(
            f"{path}: unpacks from {path.stat().st_size >> 10} kB to {size >> 20} MB, which no log does; not read"
        )


def _sheets(path: Path) -> dict[str, list[Sequence[Any]]]:
    """Rows of stored values of every sheet: by calamine, ten times as fast, where it is there and can read the file."""
    with contextlib.suppress(Exception):  # whatever it stumbles over is openpyxl's to read, or to refuse with a reason
        return _fast_sheets(path)
    book = _open(path, values=True)
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

    with CalamineWorkbook.from_path(path) as book:
        sheets = {name: book.get_sheet_by_name(name).to_python(skip_empty_area=False) for name in book.sheet_names}
    return {name: _as_openpyxl(rows) for name, rows in sheets.items()}


def _as_openpyxl(rows: Sequence[Sequence[Any]]) -> list[Sequence[Any]]:
    """Empty cells as None, and above the body whole numbers as such: a name there may be a year."""
    head = [[int(c) if isinstance(c, float) and c.is_integer() else c for c in row] for row in rows[:_ROWS_PEEKED]]
    found = [[None if c == "" else c for c in row[:_COLUMNS]] for row in (*head, *rows[_ROWS_PEEKED:])]
    while found and all(map(is_missing, found[-1])):
        found.pop()
    return list(found)


def _open(path: Path, values: bool) -> Any:
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


def _fullest(path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]]) -> str:
    """The sheet with the most numbers."""
    counts = {
        name: sum(isinstance(c, (int, float)) for row in rows for c in row) or len(rows)
        for name, rows in sheets.items()
    }
    if not any(counts.values()):
        raise InputError(f"{path}: the workbook is empty; its sheets are {listed(sheets)}")
    return max(counts, key=lambda name: counts[name])


def _columns(rows: Sequence[Sequence[Any]], body: Sequence[Sequence[Any]], layout: Layout, decimal: str,
             thousands: str) -> list[LogColumn]:  # fmt: skip
    def head(row: int) -> list[str]:
        cells = rows[row] if row >= 0 else ()
        return [
            "" if is_missing(c) else str(c) for c in [*cells[: layout.width], *[None] * (layout.width - len(cells))]
        ]

    plain, units, remarks = head(layout.names), head(layout.units), head(layout.notes_row)
    names = unique_names(with_groups(plain, rows[layout.names - 1] if layout.names > 0 else ()))
    cells = list(zip(*([*row[: layout.width], *[None] * (layout.width - len(row))] for row in body), strict=True))
    return [
        as_column(name, cells[k], decimal, thousands, bare_unit(units[k]), remarks[k]) for k, name in enumerate(names)
    ]


def _formulas_without_values(path: Path, sheet: str, columns: Sequence[LogColumn], rows: Sequence[int]) -> list[str]:
    """What to say of cells that are empty because their formula was never calculated."""
    empty = [(k, int((column.values != column.values).argmax())) for k, column in enumerate(columns)
             if column.numeric and (column.values != column.values).any()]  # fmt: skip
    empty += [(k, 0) for k, column in enumerate(columns) if not column.numeric and is_missing(column.text[0])]
    if not empty:
        return []
    book = _open(path, values=False)
    try:
        said = []
        for column, row in empty:
            found = list(book[sheet].iter_rows(rows[row], rows[row], column + 1, column + 1, values_only=True))
            if found and isinstance(found[0][0], str) and found[0][0].startswith("="):
                said.append(
                    f"column '{columns[column].name}' holds a formula without a stored value (row {rows[row]}: "
                    f"{found[0][0][:40]}); open the file in a spreadsheet program and save it"
                )
        return said
    finally:
        book.close()
