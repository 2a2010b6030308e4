"""Logs as spreadsheets: stored values of the fullest sheet; formulas without a stored value are said.

Sheets that hold the same times are one log, side by side.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.importing.cells import as_column, decimal_mark, is_missing
from winch_friction.importing.group_names import with_groups
from winch_friction.importing.layout import Layout, find_layout
from winch_friction.importing.log import Log, LogColumn, Place, listed, own_name, unique_names
from winch_friction.importing.units import bare_unit
from winch_friction.importing.workbook_sheets import OPEN_XML, ROWS_PEEKED, open_book, refuse_bombs, sheets_of
from winch_friction.physics.errors import InputError


def read_workbook_log(path: Path, settings: Mapping[str, Any] | None = None) -> Log:
    """A spreadsheet log; `settings` of an earlier look name the sheet and its rows."""
    given = dict(settings or {})
    refuse_bombs(path)
    sheets = sheets_of(path)
    name = given.get("sheet") or _fullest(path, sheets)
    if name not in sheets:
        raise InputError(f"{path}: no sheet '{name}'; found {listed(sheets)}")
    log = _read_sheet(path, sheets, name, given)
    if log is None:
        raise InputError(f"{path}: sheet '{name}' has no rows of numbers; the sheets are {listed(sheets)}")
    others = {each: _read_sheet(path, sheets, each, {}) for each in sheets if each != name}
    return _beside(log, name, {each: other for each, other in others.items() if other is not None}, list(others))


def _read_sheet(
    path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]], name: str, given: Mapping[str, Any]
) -> Log | None:
    """The table of one sheet, None where it has none."""
    rows = sheets[name]
    texts = (cell for row in rows[:ROWS_PEEKED] for cell in row if isinstance(cell, str))
    decimal, thousands = decimal_mark(texts, "\t")
    layout = find_layout(rows[:ROWS_PEEKED], decimal, thousands)
    if layout is None:
        return None
    if "first_row" in given:
        names, units, first = (int(given.get(key, 0)) - 1 for key in ("names_row", "unit_row", "first_row"))
        layout = Layout(names, units, first, layout.width)
    if layout.names >= 0:  # most rows are narrower where signals end early
        named = [k for k, cell in enumerate(rows[layout.names]) if not is_missing(cell)]
        layout = replace(layout, width=max(layout.width, named[-1] + 1 if named else 0))
    body = [(k + 1, row) for k, row in enumerate(rows) if k >= layout.first and not all(map(is_missing, row))]
    columns = _columns(rows, [row for _, row in body], layout, decimal, thousands)
    notes = _formulas_without_values(path, name, columns, [k for k, _ in body])
    found = {"kind": "workbook", "sheet": name, "names_row": layout.names + 1, "unit_row": layout.units + 1}
    place: Place = lambda row: f"row {body[row][0]}"
    return Log(path, tuple(columns), found | {"first_row": layout.first + 1}, place, tuple(notes))


def _beside(log: Log, name: str, others: Mapping[str, Log], every: Sequence[str]) -> Log:
    """A sheet's log with the columns of those that hold other signals at the same times; what is said of the others.

    Only the first column of a sheet is looked at for its times.
    """
    own = _signals(log)
    same = [
        each
        for each, other in others.items()
        if _same_times(log.columns[0], other.columns[0]) and not own & _signals(other)
    ]
    columns = [*log.columns, *(column for each in same for column in others[each].columns[1:])]
    names = unique_names([own_name(column.name) for column in columns])
    notes = [f"sheets {listed([name, *same])} hold the same times: read side by side"] if same else []
    if apart := [each for each in every if each not in same]:
        said = f"read from sheet '{name}'; the others are {listed(apart)}"
        again = [each for each in apart if each in others and _signals(others[each]) == own]
        if again:
            said += (
                f"; {listed(again)} with the same columns: another run, or the rows that follow? a file for each run"
            )
        elif any(each in others for each in apart):
            said += "; other signals of this run? join them by time into one sheet"
        notes.append(said)
    columns = [replace(column, name=told) for column, told in zip(columns, names, strict=True)]
    return replace(log, columns=tuple(columns), notes=(*notes, *log.notes))


def _signals(log: Log) -> set[str]:
    return {own_name(column.name) for column in log.columns[1:]}


def _same_times(first: LogColumn, other: LogColumn) -> bool:
    if first.numeric != other.numeric or len(first.values) != len(other.values):
        return False
    if first.numeric:
        return bool(np.array_equal(first.values, other.values, equal_nan=True))
    return list(first.text) == list(other.text)


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
    if not empty or path.suffix.lower() not in OPEN_XML:
        return []
    book = open_book(path, values=False)
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
