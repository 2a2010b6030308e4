"""Cells as people and programs write them: numbers with a decimal mark and thousands, missing values, dates."""

import re
from collections.abc import Iterable, Sequence
from datetime import date, datetime, time
from decimal import Decimal
from functools import lru_cache
from typing import Any

import numpy as np

from winch_friction.importing.log import LogColumn
from winch_friction.physics.signals import LARGEST, FloatArray

MISSING = (
    "",
    "nan",
    "na",
    "n/a",
    "#n/a",
    "#nv",
    "null",
    "none",
    "-nan",
    "-",
    "--",
    "---",
    "*",
    "nil",
    "inf",
    "-inf",
    "1.#qnan",
    "1.#ind",
)
# what historians, controllers and spreadsheets write where a sensor gave nothing
NO_VALUE = frozenset((
    *MISSING, "bad", "bad input", "no good", "no data", "nodata", "no value", "i/o timeout", "io timeout", "timeout",
    "invalid", "not connected", "comm fail", "error", "err", "fault", "overflow", "underflow", "over", "under", "ovl",
    "undefined", "undef", "missing", "void", "off-line", "offline", "?", "??", "???", "n.a.", "k.a.", "n.v.",
    "#div/0!", "#value!", "#wert!", "#verdi!", "#num!", "#zahl!", "#ref!", "#bezug!", "#name?", "#n/v",
))  # fmt: skip
_DATE = r"\d{1,4}[-./ ](?:\d{1,2}|[^\W\d_]{3,9})\.?[-./ ]\d{1,4}"
_CLOCK = r"(?:\d{1,3}:\d{2}(?::\d{2}(?:[.,:]\d+)?)?|\d{1,3}:\d{2}[.,]\d+)"
_IEC = r"(?:T|TIME|LT)#[\d.dhmsu_n]+"
TIME_LIKE = re.compile(
    rf"^\W?(?:{_DATE}(?:[T ,]+{_CLOCK})?|{_CLOCK}|{_IEC}|\d{{8}}[T ]\d{{4,6}})"
    r"\s*[AaPp]?[Mm]?\s*(?:Z|UTC|[+-]\d\d:?\d\d)?$"
)
_MARKS_KEPT = 200  # unreadable cells remembered per column: enough to tell a stray one from a column of text


@lru_cache(maxsize=8)
def number_pattern(decimal: str, thousands: str = "") -> re.Pattern[str]:
    """What a number looks like with this decimal mark and this mark of thousands ('' for none)."""
    mark, whole = re.escape(decimal), r"\d+"
    if thousands:
        whole = rf"(?:[1-9]\d{{0,2}}(?:{re.escape(thousands)}\d{{3}})+|\d+)"
    return re.compile(rf"^[+\-\u2212]?(?:{whole}(?:{mark}\d*)?|{mark}\d+)(?:[eE][+-]?\d+)?$")


def is_number(cell: Any, decimal: str, thousands: str = "") -> bool:
    """Whether a cell is a number."""
    if isinstance(cell, str):
        return bool(number_pattern(decimal, thousands).match(_signed(cell)))
    return isinstance(cell, (int, float)) and not isinstance(cell, bool)


def _signed(cell: str) -> str:
    """A number's text with its sign in front: bookkeepers put it behind, or the number in parentheses."""
    text = cell.strip().strip("'\"")
    if len(text) > 1 and text[-1] in "-)" and text[-2].isdigit():
        if text[-1] == "-" and text[0].isdigit():
            return f"-{text[:-1]}"
        if text[0] == "(":
            return f"-{text[1:-1]}"
    return text


def is_time(cell: Any) -> bool:
    """Whether a cell is a date, a time of day, or both."""
    if isinstance(cell, str):
        return bool(TIME_LIKE.match(cell.strip()))
    return isinstance(cell, (datetime, date, time))


def is_missing(cell: Any) -> bool:
    """Whether a cell says that there is no value."""
    return cell is None or (isinstance(cell, str) and cell.strip().lower() in MISSING)


def decimal_mark(cells: Iterable[str], delimiter: str) -> tuple[str, str]:
    """Decimal mark and mark of thousands under which most cells are numbers; a point where nothing tells."""
    texts = [_signed(cell) for cell in cells if isinstance(cell, str) and any(map(str.isdigit, cell))]
    choices = [
        (".", ""),
        (",", ""),
        (".", ","),
        (",", "."),
        (".", " "),
        (",", " "),
        (",", "'"),
        (".", "'"),
        (",", "\u00a0"),
    ]
    choices = [(d, t) for d, t in choices if delimiter not in (d, t) or any(d in x or t in x for x in texts)]
    every = "\0".join(texts)
    choices = [(d, t) for d, t in choices if t in every]  # one that nobody writes makes no more of them numbers
    counts = []
    for decimal, thousands in choices:
        counts.append(sum(map(bool, map(number_pattern(decimal, thousands).match, texts))))
        if counts[-1] == len(texts):  # no other makes more of them numbers
            break
    return choices[int(np.argmax(counts))] if counts else (".", "")


def as_column(
    name: str, cells: Sequence[Any], decimal: str, thousands: str, unit: str = "", note: str = ""
) -> LogColumn:
    """A column of cells: of numbers when at least half of those that are not missing are, else of text."""
    fast = _all_numbers(cells, decimal, thousands)
    if fast is not None:
        return LogColumn(name, fast, unit, note=note)
    values, bad, kept = np.full(len(cells), np.nan), [], 0
    for row, cell in enumerate(cells):
        if isinstance(cell, (int, float, Decimal)) and not isinstance(cell, bool):
            values[row] = float(cell)
            if not abs(values[row]) >= LARGEST:  # NaN is none either
                continue
            values[row], cell = np.nan, str(cell)
        if is_missing(cell) or (isinstance(cell, str) and cell.strip().lower() in NO_VALUE):
            continue
        if isinstance(cell, str) and is_number(cell, decimal, thousands):
            number = _number(cell, decimal, thousands)
            if abs(number) < LARGEST:
                values[row] = number
                continue
        kept += 1
        if kept <= _MARKS_KEPT:
            bad.append((row, str(cell).strip()[:60]))
    if kept > np.isfinite(values).sum():
        return LogColumn(name, np.full(len(cells), np.nan), unit, text=np.array(cells, dtype=object), note=note)
    return LogColumn(name, values, unit, bad=tuple(bad), note=note)


_GROUPED = re.compile(r"^\s*[+\-\u2212]?[1-9]\d{0,2}(?:\.\d{3})+\s*$")
_VALUE_AND_UNIT = re.compile(r"^([+\-\u2212]?[\d.,]+(?:[eE][+-]?\d+)?)\s*([^\d\s.,:;+\-][^\s]{0,11})$")


def units_in_cells(rows: Sequence[Sequence[str]]) -> dict[int, str]:
    """Columns whose cells bear their unit (`116.2 bar`): column -> unit; told from the last rows of a table."""
    found = {}
    for k in range(max((len(row) for row in rows), default=0)):
        cells = [row[k].strip() for row in rows if k < len(row) and not is_missing(row[k])]
        matched = [m for m in map(_VALUE_AND_UNIT.match, cells) if m]
        units = {m[2] for m in matched}
        if len(matched) > 0.8 * len(cells) and len(units) == 1 and len(matched) > 2:
            found[k] = units.pop()
    return found


def without_unit(cell: str, unit: str) -> str:
    """A cell without the unit behind its number."""
    text = cell.strip()
    return text.removesuffix(unit).rstrip() if text.endswith(unit) else cell


def _all_numbers(cells: Sequence[Any], decimal: str, thousands: str) -> FloatArray | None:
    """The cells as numbers when each one is a plain number or empty: a hundred times faster than one by one."""
    if not all(isinstance(cell, str) for cell in cells):
        return None
    values = plain_numbers(cells, decimal, thousands)
    return values if values is not None and np.isfinite(values).any() else None


def plain_numbers(cells: Sequence[str], decimal: str, thousands: str) -> FloatArray | None:
    """Texts as numbers, NaN where one is empty; None when one of them is none, infinite, or holds what Python alone
    reads past (`1_000`) or what may be a mark of thousands that was not found where the decimal mark was (`1.500`).
    """
    if thousands or any("_" in cell for cell in cells):
        return None
    dotted = [cell for cell in cells if "." in cell] if decimal != "." else []
    if dotted and all(map(_GROUPED.match, dotted)):
        return None
    try:
        values = np.array([cell.replace(decimal, ".") or "nan" for cell in cells], dtype=float)
    except ValueError:
        return None
    return None if (np.abs(values) >= LARGEST).any() else values


def _number(cell: str, decimal: str, thousands: str) -> float:
    text = _signed(cell).replace("\u2212", "-")
    if thousands:
        text = text.replace(thousands, "")
    return float(text.replace(decimal, "."))
