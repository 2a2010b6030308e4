"""The columns of a text log, from its rows a block at a time."""

from array import array
from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from winch_friction.importing.cells import NO_VALUE, as_column, is_number, is_time, plain_numbers
from winch_friction.importing.group_names import with_groups
from winch_friction.importing.layout import STATISTICS, Layout
from winch_friction.importing.log import LogColumn, unique_names
from winch_friction.importing.text_rows import TextRows
from winch_friction.importing.units import bare_unit, looks_like_unit
from winch_friction.physics.errors import InputError, counted
from winch_friction.physics.signals import FloatArray

_BLOCK = 4096  # rows cut at once: a few MB of cells
FEW = 0.5  # of the columns: what has more cells is a row, whatever its first one says
_TOGETHER = 4  # columns of other cells than plain numbers that are kept whole at a time


class Body:
    """The rows of values below a layout's head; `numbers`: the line of each.

    The names and units that a logger writes again whenever it starts a page are left out (`repeated`: their lines), and
    so are its words between the rows or below them (`remarks`); `short`: lines with fewer cells than columns.
    """

    def __init__(self, rows: TextRows, layout: Layout, marks: tuple[str, str]) -> None:
        self._rows, self._layout, self._marks = rows, layout, marks
        self._heads = [rows.row(k) for k in (layout.names, layout.units) if k >= 0]
        names = rows.row(layout.names)
        self.width = max(layout.width, len([c for c in names if c.strip()]))
        self._valued = _is_value(next(iter(rows.row(layout.first)), ""), marks)  # the first cell of its rows
        self.numbers, self.repeated, self.short, self.remarks = array("l"), array("l"), array("l"), array("l")
        for n, row in enumerate(rows):
            if n < layout.first:
                continue
            number = rows.numbers[n]
            if row in self._heads:
                self.repeated.append(number)
            elif self._is_remark(row):
                self.remarks.append(number)
            else:
                self.numbers.append(number)
                if len(row) < self.width - 1:
                    self.short.append(number)

    def _is_remark(self, row: list[str]) -> bool:
        """Whether a row begins with a word where the others have a time or a number, and holds a few cells or a summary
        of the columns."""
        first = row[0].strip()
        if not self._valued or not first or first[0].isdigit() or first.lower() in NO_VALUE:
            return False
        few = sum(bool(cell.strip()) for cell in row) <= FEW * self.width
        return (few or first.casefold().rstrip(" :.=") in STATISTICS) and not _is_value(first, self._marks)

    def blocks(self) -> Iterator[list[list[str]]]:
        """The rows, all of one width, a block at a time."""
        body = (
            row for row in islice(self._rows, self._layout.first, None)
            if row not in self._heads and not self._is_remark(row)
        )  # fmt: skip
        while block := [padded(row, self.width) for row in islice(body, _BLOCK)]:
            yield block


def read_columns(rows: TextRows, layout: Layout, marks: tuple[str, str], delimiter: str,
                 notes: list[str]) -> tuple[list[LogColumn], Sequence[int]]:  # fmt: skip
    """The columns and the line of each of their cells; `marks`: of decimals and thousands.

    Raises `InputError` for more cells than names.
    """
    body = Body(rows, layout, marks)
    width = body.width
    if body.repeated:
        notes.append(
            f"the header stands {counted(len(body.repeated), 'time', 'times')} more (line {body.repeated[0]}): left out"
        )
    if body.remarks:
        said = " | ".join(cell for cell in rows.row(rows.index_of_line(body.remarks[0])) if cell.strip())[:60]
        notes.append(
            f"{counted(len(body.remarks), 'line is', 'lines are')} no row of values (line {body.remarks[0]}: "
            f"'{said}'): left out"
        )
    if body.short:
        shown = ", ".join(map(str, body.short[:3]))
        notes.append(
            f"{counted(len(body.short), 'line is', 'lines are')} shorter than the {width} columns (line {shown}): "
            "their cells are missing"
        )
    names = rows.row(layout.names)
    if layout.names >= 0 and layout.width > len(names) > 1:
        raise InputError(
            f"{rows.path}: line {body.numbers[0]} has {layout.width} cells under {len(names)} names; "
            f"does '{delimiter}' also stand inside cells (a decimal comma)? Quote such cells, or separate by ';'"
        )
    units, remarks = padded(rows.row(layout.units), width), padded(rows.row(layout.notes_row), width)
    if "unit" in units[0].lower() and not looks_like_unit(units[0]):
        units[0] = ""  # the label of a row of units
    told = unique_names(with_groups(padded(names, width), rows.row(layout.names - 1) if layout.names > 0 else ()))
    heads = [(name, bare_unit(units[k]), remarks[k].strip()) for k, name in enumerate(told)]
    found = {k: LogColumn(heads[k][0], values, heads[k][1], note=heads[k][2])
             for k, values in _numbers(body, marks).items()}  # fmt: skip
    others = [k for k in range(width) if k not in found]
    for at in range(0, len(others), _TOGETHER):
        for k, cells in _cells(body, others[at : at + _TOGETHER]).items():
            found[k] = as_column(heads[k][0], cells, *marks, heads[k][1], heads[k][2])
    return [found[k] for k in range(width)], body.numbers


def _is_value(cell: str, marks: tuple[str, str]) -> bool:
    return is_number(cell, *marks) or is_time(cell)


def _numbers(body: Body, marks: tuple[str, str]) -> dict[int, FloatArray]:
    """The columns of which every cell is a plain number or empty, by their place."""
    parts: dict[int, list[FloatArray]] = {k: [] for k in range(body.width)}
    for block in body.blocks():
        for k in list(parts):
            values = plain_numbers([row[k] for row in block], *marks)
            if values is None:
                del parts[k]
            else:
                parts[k].append(values)
    whole = {k: np.concatenate(each) for k, each in parts.items() if each}
    return {k: values for k, values in whole.items() if np.isfinite(values).any()}


def _cells(body: Body, wanted: Sequence[int]) -> dict[int, list[str]]:
    """All cells of some columns."""
    cells: dict[int, list[str]] = {k: [] for k in wanted}
    for block in body.blocks():
        for k in wanted:
            cells[k] += [row[k] for row in block]
    return cells


def padded(row: Sequence[str], width: int) -> list[str]:
    """A row of so many cells, empty ones put behind it."""
    return [*row[:width], *([""] * (width - len(row)))]
