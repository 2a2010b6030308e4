"""Where a table begins: the rows of its names and units above its first row of values, preamble left aside."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import dropwhile
from typing import Any

from winch_friction.importing.cells import is_missing, is_number, is_time
from winch_friction.importing.units import bare_unit, looks_like_unit

_SEEN = 300  # rows looked at for the beginning of the values
_RUN = 4  # rows of values in a row that make a beginning
_ALIKE = 0.9  # of the rows of values, that end in the same column or beside it unless cells stay empty
_LABELS = 0.25  # of a row's cells: words where values should be; a sensor that failed in the first row is one of many
_HEAD = 30  # rows above the values among which a row of labelled units is looked for
_TYPES = frozenset({
    "date", "datetime", "timestamp", "time", "d", "double", "f", "float", "real", "real32", "real64", "lreal", "i",
    "int", "int16", "int32", "int64", "dint", "uint", "word", "dword", "l", "long", "s", "str", "string", "text",
    "b", "bool", "boolean",
})  # fmt: skip  # how programs say what kind of value a column holds
STATISTICS = frozenset({
    "mittelwert", "mittel", "minimum", "maximum", "min", "max", "mean", "average", "avg", "std", "stdev", "stddev",
    "sum", "total", "summe", "standardabweichung", "median", "gjennomsnitt", "middelverdi", "snitt", "standardavvik",
    "rms", "count", "anzahl",
})  # fmt: skip  # what a row of its columns' statistics begins with
_PROPERTIES = STATISTICS | {
    "length",
    "länge",
    "lengde",
    "offset",
    "factor",
    "faktor",
    "scale",
    "startwert",
    "start value",
}
_ABOVE = 5  # rows above the values among which names and units are looked for

Row = Sequence[Any]


@dataclass(frozen=True)
class Layout:
    """Rows counted from 0; `names` and `units` are -1 when there is none; `notes_row`: a row of descriptions."""

    names: int
    units: int
    first: int
    width: int
    notes_row: int = -1


def find_layout(rows: Sequence[Row], decimal: str, thousands: str = "") -> Layout | None:
    """The layout of a table, or None when no run of rows with values is found."""
    seen = rows[:_SEEN]
    valued = [_share_of_values(row, decimal, thousands) >= 0.4 for row in seen]
    width_of = [_width(row) for row in seen]
    widths = Counter(w for w, has_values in zip(width_of, valued, strict=True) if has_values)
    if not widths:
        return None
    width = max(widths, key=lambda w: (widths[w], w))
    good = [has_values and abs(w - width) <= 1 for w, has_values in zip(width_of, valued, strict=True)]
    # a logger that writes changes leaves the other cells empty
    alike = sum(widths[w] for w in (width - 1, width, width + 1)) >= _ALIKE * sum(widths.values())
    alone = sum(_is_time_alone(row, decimal, thousands) for row in seen)
    if not alike or alone > (1.0 - _ALIKE) * len(seen):
        good = [_share_of_values(row, decimal, thousands, 1) >= 0.4 for row in seen]
    run = min(_RUN, sum(good))
    first = next((k for k in range(len(seen)) if all(good[k : k + run]) and len(good[k : k + run]) == run), None)
    if first is None:
        return None
    marks = decimal, thousands
    while first + run < len(seen) and _labels_values(seen[first], seen[first + 1 : first + _ABOVE + run], *marks):
        first += 1
    top = first
    while first + 1 < len(seen) and _is_property(seen[first], seen[-1]):
        first += 1
    above = [k for k in range(max(0, top - _ABOVE), first) if _is_heading(seen[k], width, *marks, len(seen[first]))]
    units = next((k for k in reversed(above) if _is_unit_row(seen[k])), -1)
    if units < 0:  # a program's head: a property a row, each behind its label
        head = range(max(0, first - _HEAD), first)
        units = next((k for k in reversed(head) if _is_labelled_unit_row(seen[k], width)), -1)
    texts = [k for k in above if k != units]
    names = _names_row(seen, texts)
    if names < 0 and units in above:  # symbols that are units too (t, n, d, pa): a table without names is rarer
        names, units = units, -1
    other = [k for k in texts if k != names and abs(k - names) <= 2]
    return Layout(names, units, first, width, other[-1] if other else -1)


def _labels_values(row: Row, below: Sequence[Row], decimal: str, thousands: str) -> bool:
    """Whether a row of numbers is one of a program's head, each behind its label (`Port; 851; Port; 851`): words stand
    where the rows below it, but for further ones with words in the same places, have values."""
    is_value = lambda cell: is_number(cell, decimal, thousands) or is_time(cell)
    is_word = lambda cell: not is_missing(cell) and not is_value(cell)
    labels = [k for k, cell in enumerate(row) if is_word(cell)]
    values = list(dropwhile(lambda b: all(k < len(b) and is_word(b[k]) for k in labels), below))[:_RUN]
    words = [k for k in labels if all(k < len(b) and is_value(b[k]) for b in values)] if values else []
    return len(words) > 1 and len(words) >= _LABELS * len(row)


def _is_property(row: Row, last: Row) -> bool:
    """Whether a row is a property of each column behind its label (`Length; 3000; 3000`), where rows of values have
    none: their first cell is empty."""
    return str(row[0] or "").strip().casefold().rstrip(" :.=") in _PROPERTIES and is_missing(last[0])


def _is_time_alone(row: Row, decimal: str, thousands: str) -> bool:
    """Whether a row has a time, and other cells with nothing in them."""
    empty = len(row) > 2 and all(is_missing(cell) for cell in row[1:])
    return empty and (is_number(row[0], decimal, thousands) or is_time(row[0]))


def _names_row(rows: Sequence[Row], candidates: list[int]) -> int:
    """The lowest row of the fullest ones: a title above the names fills few cells."""
    if not candidates:
        return -1
    filled = {k: len({str(c) for c in rows[k] if not is_missing(c)}) for k in candidates}
    most = max(filled.values())
    return max(k for k in candidates if filled[k] >= 0.8 * most)


def _width(row: Row) -> int:
    cells = list(row)
    while cells and is_missing(cells[-1]):
        cells.pop()
    return len(cells)


def _share_of_values(row: Row, decimal: str, thousands: str, fewest: int = 2) -> float:
    cells = [cell for cell in row if not is_missing(cell)]
    if len(cells) < fewest:
        return 0.0
    values = sum(is_number(cell, decimal, thousands) or is_time(cell) for cell in cells)
    return values / len(cells)


def _is_heading(row: Row, width: int, decimal: str, thousands: str, whole: int) -> bool:
    """A row of texts above values that end in column `width`, in rows of `whole` cells: names may stand above columns
    that have no value for long."""
    cells = [cell for cell in row if not is_missing(cell)]
    texts = [
        cell
        for cell in cells
        if isinstance(cell, str) and not is_number(cell, decimal, thousands) and not is_time(cell)
    ]
    fits = _width(row) <= width + 1 or (len(cells) == len(row) == whole)
    return len(cells) >= max(2, width // 2) and len(texts) >= 0.7 * len(cells) and fits


def _is_labelled_unit_row(row: Row, width: int) -> bool:
    """`Y_Unit_Label`, then the unit of each channel."""
    cells = [str(cell).strip() for cell in row]
    return (
        0 <= width - len(cells) <= 2 and bool(cells) and "unit" in cells[0].lower()
        and sum(looks_like_unit(cell) for cell in cells[1:] if cell) >= 0.6 * max(1, sum(map(bool, cells[1:])))
    )  # fmt: skip


def _is_unit_row(row: Row) -> bool:
    cells = [bare_unit(str(cell)) for cell in row if not is_missing(cell)]
    kinds = {cell.casefold() for cell in cells}
    if kinds <= _TYPES and max(map(len, kinds), default=0) > 1:  # `date; D; D`: D of a double, not of a day
        return False
    return len(cells) >= 2 and sum(looks_like_unit(cell) for cell in cells) >= 0.6 * len(cells)
