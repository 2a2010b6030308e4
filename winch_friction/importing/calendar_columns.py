"""A time whose parts stand in columns of their own: year, month, day, hour, minute, second; or the last three alone.

The columns are found by name and by what such a part can be; `parts` in a map lists them in this order.
"""

from collections.abc import Sequence

import numpy as np

from winch_friction.importing.log import LogColumn
from winch_friction.importing.names import tokens
from winch_friction.importing.units import header_readings
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray

# folded words of each part, English, German, Norwegian and their neighbours, and the least and the largest number
_PARTS: dict[str, tuple[frozenset[str], float, float]] = {
    "year": (frozenset({"year", "yr", "yyyy", "yy", "jahr", "ar", "annee", "jaar", "ano"}), 0.0, 2100.0),
    "month": (frozenset({"month", "mon", "monat", "maned", "manad", "mois", "maand", "mes"}), 1.0, 12.0),
    "day": (frozenset({"day", "dd", "tag", "dag", "jour", "dia"}), 1.0, 31.0),
    "hour": (frozenset({"hour", "hours", "hr", "hh", "h", "stunde", "std", "time", "timer", "timme", "heure", "uur",
                        "hora"}), 0.0, 24.0),
    "minute": (frozenset({"minute", "minutes", "min", "mi", "minutt", "minut", "minuut", "minuto"}), 0.0, 59.0),
    "second": (frozenset({"second", "seconds", "sec", "s", "ss", "sekunde", "sek", "sekund", "seconde", "segundo"}),
               0.0, 60.999),
}  # fmt: skip
_DATE, CLOCK = 6, 3  # columns of a date with a time of day, and of a time of day alone
_SHORT_YEAR, _THIS_CENTURY = 100.0, 70.0  # a year of two digits; below the second it is after 2000
_HOUR, _MINUTE = 3600.0, 60.0  # s


def calendar_columns(columns: Sequence[LogColumn]) -> tuple[LogColumn, ...]:
    """The columns of a log that are the parts of its time, the year or the hour first; empty where there are none.

    A part that two columns could be is none.
    """
    found = {part: [c for c in columns if _is_part(c, part)] for part in _PARTS}
    for parts in (list(_PARTS), list(_PARTS)[CLOCK:]):
        if all(len(found[part]) == 1 for part in parts):
            return tuple(found[part][0] for part in parts)
    return ()


def _is_part(column: LogColumn, part: str) -> bool:
    words, low, high = _PARTS[part]
    names = {tuple(tokens(bare)) for bare, _ in header_readings(column.name)}
    if not column.numeric or not any(len(name) == 1 and name[0] in words for name in names):
        return False
    values = column.values[np.isfinite(column.values)]
    whole = part == "second" or bool(np.all(values % 1.0 == 0.0))
    return bool(len(values)) and whole and low <= float(values.min()) and float(values.max()) <= high


def calendar_seconds(columns: Sequence[LogColumn], where: str) -> FloatArray:
    """Seconds since 1970 of a date's six parts, or since midnight of a time of day's three; NaN where one is missing.

    Raises `InputError` for another number of columns, for text, and for parts that are no date.
    """
    if len(columns) not in (_DATE, CLOCK) or not all(c.numeric for c in columns):
        raise InputError(
            f"{where}: time.form 'parts' wants six columns of numbers in time.from, year, month, day, hour, minute and "
            f"second, or the last three; found {len(columns)}"
        )
    hour, minute, second = (c.values for c in columns[-CLOCK:])
    clock = np.asarray(_HOUR * hour + _MINUTE * minute + second, dtype=np.float64)
    return clock if len(columns) == CLOCK else clock + _dates(columns[:CLOCK], where)


def _dates(columns: Sequence[LogColumn], where: str) -> FloatArray:
    """Seconds from 1970 to the midnight of each row's date."""
    year, month, day = (c.values for c in columns)
    known = np.isfinite(year) & np.isfinite(month) & np.isfinite(day)
    year = np.where(year < _SHORT_YEAR, year + np.where(year < _THIS_CENTURY, 2000.0, 1900.0), year)
    seconds = np.full(len(year), np.nan)
    dates, row_of = np.unique(np.column_stack([year, month, day])[known], axis=0, return_inverse=True)
    try:
        days = [np.datetime64(f"{y:04.0f}-{m:02.0f}-{d:02.0f}", "s").astype(np.int64) for y, m, d in dates]
    except ValueError as error:
        raise InputError(f"{where}: time.from: the parts make no date ({error})") from error
    seconds[known] = np.asarray(days, dtype=np.float64)[row_of.ravel()]
    return seconds
