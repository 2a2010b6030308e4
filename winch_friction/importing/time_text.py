"""A cell that holds a date, a time of day, or both: its parts, and what they are in days and seconds."""

import math
import re
from datetime import date, datetime, time, timedelta
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError

_MONTHS = {
    name: k + 1
    for k, names in enumerate(
        ("jan", "feb", "mar mär mae", "apr", "may mai", "jun", "jul", "aug", "sep", "oct okt", "nov", "dec dez des")
    )
    for name in names.split()
}
_STAMP = re.compile(
    r"^\W?(?:(\d{1,4})(?:[-./ ]|\. )(\d{1,2}|[^\W\d_]{3,9})\.?(?:[-./ ]|\. )(\d{1,4}))?[T ,]*"
    r"(?:(\d{1,3}):(\d{2})(?::(\d{2}(?:[.,:]\d+)?))?)?\s*([AaPp][Mm])?\s*(Z|UTC|[+-]\d\d:?\d\d)?\W?$"
)
_COMPACT = re.compile(r"^(\d{4})(\d\d)(\d\d)[T _-](\d\d):?(\d\d):?(\d\d)")

_SECOND = re.compile(r"\d\d([.,]\d+)?")
_MINUTES = re.compile(r"^(\d{1,3}):(\d{2}[.,]\d+)$")  # what a spreadsheet shows of a short time
_IEC = re.compile(
    r"^(?:T|TIME|LT)#(?:([\d.]+)d_?)?(?:([\d.]+)h_?)?(?:([\d.]+)m_?)?(?:([\d.]+)s_?)?(?:([\d.]+)ms_?)?(?:([\d.]+)us)?$",
    re.IGNORECASE,
)  # a controller's T#1m2s345ms
_MILLI = 3  # digits of a count of ms
_SHORT_YEAR, _THIS_CENTURY = 2, 70  # digits; years of so few digits below it are after 2000
_IEC_SECONDS = (86_400.0, 3600.0, 60.0, 1.0, 1e-3, 1e-6)


def time_parts(cell: Any) -> tuple[Any, ...] | None:
    """Three parts of the date (or None), hour, minute, second, am/pm, zone, and the date's mark."""
    if isinstance(cell, np.datetime64):
        cell = cell.astype("datetime64[us]").item()
    if isinstance(cell, timedelta):
        total = cell.total_seconds()
        return None, None, None, "0", "0", str(total), None, None, ""
    if isinstance(cell, (datetime, date, time)):
        cell = cell.isoformat()
    text = _COMPACT.sub(r"\1-\2-\3 \4:\5:\6", str(cell).strip()) if cell is not None else ""
    minutes, spoken = _MINUTES.match(text), _IEC.match(text)
    if minutes:
        return None, None, None, "0", minutes[1], minutes[2], None, None, ""
    if spoken and any(spoken.groups()):
        total = sum(s * float(part or 0) for s, part in zip(_IEC_SECONDS, spoken.groups(), strict=True))
        return None, None, None, "0", "0", str(total), None, None, ""
    match = _STAMP.match(text)
    if not text or match is None or (match[1] is None and match[4] is None):
        return None
    mark = text[len(match[1])] if match[1] and len(match[1]) < len(text) else ""
    return (*match.groups(), mark)


def before_second(cell: Any) -> tuple[tuple[str, bool] | None, str]:
    """What stands before the last colon of a text and how the second behind it is written, and the second; else
    (None, ''). Cells that are alike in the first have the same day and minute where `time_parts` finds that second."""
    head, _, second = cell.rpartition(":") if isinstance(cell, str) else ("", "", "")
    plain = _SECOND.fullmatch(second)
    return ((head, plain[1] is None), second) if plain else (None, "")


def clock_seconds(parts: tuple[Any, ...]) -> float:
    """Seconds since midnight of a cell's parts."""
    hour, minute = float(parts[3] or 0), float(parts[4] or 0)
    second = float((parts[5] or "0").replace(",", ".").replace(":", "."))
    if parts[6]:
        hour = hour % 12 + (12 if parts[6].lower() == "pm" else 0)
    return hour * 3600.0 + minute * 60.0 + second


def days_since_1970(key: tuple[str, str, str], order: str, where: str, strict: bool = True) -> float:
    """Days since 1970 of a date's three parts in an order; NaN for what is no date, or `InputError` where `strict`."""
    named = dict(zip(order, key, strict=True))
    month = named["m"]
    number = int(month) if month.isdecimal() else _MONTHS.get(month[:3].lower(), 0)
    year = int(named["y"])
    if len(named["y"]) <= _SHORT_YEAR:
        year += 2000 if year < _THIS_CENTURY else 1900
    try:
        return (datetime(year, number, int(named["d"])) - datetime(1970, 1, 1)).days
    except ValueError as error:
        if not strict:
            return math.nan
        raise InputError(f"{where}: '{'-'.join(key)}' is no date of the order {order}; set time.order") from error


def zone_seconds(zone: str) -> float:
    """Offset of a zone such as +02:00 from UTC, s."""
    if zone in ("Z", "UTC"):
        return 0.0
    digits = zone[1:].replace(":", "")
    return (1.0 if zone[0] == "+" else -1.0) * (int(digits[:2]) * 3600.0 + int(digits[2:]) * 60.0)


def first_text(cells: Any) -> str:
    """The first cell that holds anything, as text, cut short for a message."""
    return str(next((cell for cell in cells if cell is not None and str(cell).strip()), ""))[:40]


def counts_milliseconds(cells: Any) -> bool:
    """Whether what stands behind a third colon is a count without zeros before it: 12:00:05:7 is 7 ms behind 5 s."""
    if first_text(cells).count(":") != 3:
        return False
    behind = {len(str(cell).strip().rpartition(":")[2]) for cell in cells if str(cell).count(":") == 3}
    return len(behind) > 1 and max(behind) == _MILLI


def with_zeros(second: Any) -> Any:
    """A second whose count of ms, behind a colon, has its zeros."""
    whole, colon, count = str(second).partition(":")
    return f"{whole}:{count:0>{_MILLI}}" if colon else second
