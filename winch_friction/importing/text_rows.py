"""The rows of a text log, cut from their lines on demand: all cells at once take ten times the text."""

import csv
from array import array
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

from winch_friction.importing.cells import units_in_cells, without_unit
from winch_friction.importing.units import looks_like_unit
from winch_friction.physics.errors import InputError, no_cells

SEEN = 300  # rows at either end that tell delimiter, decimal mark, layout and units


class TextRows:
    """Rows of cells; a `sep=` line and blank lines are no rows. Raises `InputError` for what csv cannot read.

    `numbers`: the line that each row ends in, from 1; `head`, `tail`: the first and last rows.
    """

    def __init__(self, path: Path, lines: Sequence[str], delimiter: str) -> None:
        self.path, self._lines, self._delimiter = path, lines, delimiter
        self._units: dict[int, str] = {}
        self._bears = 0
        self.numbers = array("l")
        self.head: list[list[str]] = []
        last: deque[list[str]] = deque(maxlen=SEEN)
        for number, row in self._cut():
            self.numbers.append(number)
            last.append(row)
            if len(self.head) < SEEN:
                self.head.append(row)
        self.tail = list(last)

    def __len__(self) -> int:
        return len(self.numbers)

    def __iter__(self) -> Iterator[list[str]]:
        return (self._changed(n, row) for n, (_, row) in enumerate(self._cut()))

    def row(self, index: int) -> list[str]:
        """One row, from 0; none for an index below."""
        if index < 0:
            return []
        return self.head[index] if index < len(self.head) else next(islice(self, index, None))

    def index_of_line(self, number: int) -> int:
        """The row that ends in a line, -1 for none."""
        return self.numbers.index(number) if number in self.numbers else -1

    def take_units_out(self, notes: list[str]) -> None:
        """Cells that bear their unit become numbers; the unit stands above them, in the row before the first."""
        found = {k: unit for k, unit in units_in_cells(self.tail).items() if looks_like_unit(unit)}
        if not found:
            return
        bears = lambda row: any(k < len(row) and without_unit(row[k], unit) != row[k] for k, unit in found.items())
        self._bears = next(
            n for n, row in enumerate(self) if bears(row) and any(c.isdigit() for cell in row for c in cell)
        )
        self._units = found
        start = len(self) - len(self.tail)
        self.head = [self._changed(n, list(row)) for n, row in enumerate(self.head)]
        self.tail = [self._changed(start + n, list(row)) for n, row in enumerate(self.tail)]
        notes.append(
            f"cells of {len(found)} columns bear their unit: taken off ({', '.join(dict.fromkeys(found.values()))})"
        )

    def _changed(self, n: int, row: list[str]) -> list[str]:
        if self._units and n == self._bears - 1:
            for k, unit in self._units.items():
                if k < len(row):
                    row[k] = f"{row[k]} [{unit}]"
        elif self._units and n >= max(self._bears, 1):
            for k, unit in self._units.items():
                if k < len(row):
                    row[k] = without_unit(row[k], unit)
        return row

    def _cut(self) -> Iterator[tuple[int, list[str]]]:
        if self._delimiter == " ":
            yield from ((k + 1, line.split()) for k, line in enumerate(self._lines) if line.strip())
            return
        reader = csv.reader((f"{line}\n" for line in self._lines), delimiter=self._delimiter)
        begun = 0
        try:
            for row in reader:
                begun = reader.line_num
                if any(map(str.strip, row)) and not (reader.line_num == 1 and row[0].lower().startswith("sep=")):
                    yield reader.line_num, row
        except csv.Error as error:
            raise InputError(f"{self.path}: line {begun + 1}: {no_cells(error)}") from error
