"""A log's time as seconds: which form its cells have, told from the values, and the way to seconds.

Forms: `seconds` (any unit, from any origin), `unix` (counted since 1970), `excel` and `matlab` (days), `filetime` and
`dotnet` (tenths of a microsecond since 1601 and since year 1), `datetime` (dates with a time of day, in one column or
two), `parts` (a column for each part of them) and `clock` (a time of day alone, as a text or a number like 95959.5).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np

from winch_friction.importing.calendar_columns import CLOCK, calendar_seconds
from winch_friction.importing.log import LogColumn, Place
from winch_friction.importing.summer_time import change_asked, from_utc, hour_back
from winch_friction.importing.ticks import rows_of_one_tick, spread_ticks
from winch_friction.importing.time_numbers import clock_of_numbers, is_clock, seconds_of_one
from winch_friction.importing.time_text import (
    before_second,
    clock_seconds,
    counts_milliseconds,
    days_since_1970,
    first_text,
    time_parts,
    with_zeros,
    zone_seconds,
)
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.records.unit_names import conversion_to_si

FORMS = ("seconds", "unix", "excel", "matlab", "filetime", "dotnet", "datetime", "parts", "clock")
ORDERS = ("ymd", "dmy", "mdy")
_DAY = 86_400.0
_EXCEL_EPOCH, _MATLAB_EPOCH = 25_569.0, 719_529.0  # days from 1899-12-30 and from year 0 to 1970-01-01
_TICK = 1e-7  # s
_EPOCHS = {"filetime": 11_644_473_600.0, "dotnet": 62_135_596_800.0}  # s from their origin to 1970
_TICK_YEARS = (9.4e8, 2.6e9)  # s: 2000 to 2052; before that nobody's log counts so
_UNIX_YEARS = (6.3e8, 2.6e9)  # s: 1990 to 2052


@dataclass(frozen=True)
class TimeBase:
    """How a column (or a date and a clock) becomes seconds.

    `form` one of FORMS; `unit` of numbers; `order` of a date's parts; `zone` for dates without an offset, '' where
    none is needed; `spread`: rows of one tick lie evenly between this tick and the next; `fraction`: unit of the last
    column, which holds what is beyond the others' whole seconds ('' for none).
    """

    form: str
    unit: str = "s"
    order: str = ""
    zone: str = ""
    spread: bool = False
    fraction: str = ""


@dataclass(frozen=True)
class TimeGuess:
    """A time base with its confidence 0 ... 1 and reason; `question` is what must be answered first, '' for nothing."""

    base: TimeBase
    confidence: float
    because: str
    question: str = ""


def guess_form(columns: Sequence[LogColumn], unit: str) -> TimeGuess | None:
    """How the cells of a column, or of a date and a clock beside it, can be read as times, whether they rise or not."""
    if columns[0].numeric:
        return _guess_parts(columns) if len(columns) > 1 else _guess_numbers(columns[0], unit)
    return _guess_text(columns)


def guess_time(columns: Sequence[LogColumn], unit: str) -> TimeGuess | None:
    """The time base of a column, or of a date and a clock beside it; None when the values are no time."""
    guess = guess_form(columns, unit)
    if guess is None:
        return None
    seconds = to_seconds(columns, guess.base, "", lambda row: f"row {row + 1}", strict=False)
    finite = seconds[np.isfinite(seconds)]
    back = hour_back(finite) if guess.base.zone else 0
    if len(finite) < 2 or (not back and (finite[-1] <= finite[0] or np.mean(np.diff(finite) < 0.0) > 0.02)):
        return None
    if guess.base.zone and not guess.question:
        guess = replace(guess, question=change_asked(finite, first_text(_joined(columns))))
    ticks = rows_of_one_tick(finite)
    if ticks > 1.5:
        return replace(
            guess,
            base=replace(guess.base, spread=True),
            because=f"{guess.because}; about {ticks:.3g} rows share a time, so the rows of a tick are spread evenly",
        )
    return guess


def _guess_parts(columns: Sequence[LogColumn]) -> TimeGuess:
    if len(columns) == CLOCK:
        return TimeGuess(TimeBase("parts"), 0.95, "a time of day in three columns, from midnight")
    return TimeGuess(TimeBase("parts", zone="UTC"), 0.95, "a date in six columns; no zone is given, taken for UTC")


def _guess_numbers(column: LogColumn, unit: str) -> TimeGuess | None:
    values = column.values[np.isfinite(column.values)]
    if len(values) < 2:
        return None
    low, high = float(values.min()), float(values.max())
    for form, origin in _EPOCHS.items():
        if _TICK_YEARS[0] < _TICK * low - origin and _TICK * high - origin < _TICK_YEARS[1]:
            return TimeGuess(TimeBase(form), 0.95, f"values of {low:.4g} are tenths of a microsecond ({form})")
    for name, factor in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if _UNIX_YEARS[0] < low * factor and high * factor < _UNIX_YEARS[1]:
            return TimeGuess(TimeBase("unix", name), 0.95, f"values of {low:.4g} are {name} since 1970")
    if not unit and low > 3.0e4 and high < 6.0e4 and high - low < 60.0:
        return TimeGuess(TimeBase("excel", "day"), 0.9, f"values of {low:.6g} are days as spreadsheets count them")
    if not unit and low > 7.2e5 and high < 7.6e5 and high - low < 60.0:
        return TimeGuess(TimeBase("matlab", "day"), 0.9, f"values of {low:.6g} are days as MATLAB counts them")
    if unit:
        return TimeGuess(TimeBase("seconds", unit), 0.97, f"unit '{unit}'")
    if is_clock(values):
        return TimeGuess(TimeBase("clock"), 0.85, f"numbers such as {values[0]:.10g} are times of day, from midnight")
    return _guess_bare_numbers(values)


def _guess_bare_numbers(values: FloatArray) -> TimeGuess:
    steps = np.diff(values)
    step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0  # rows may share a tick
    if 1e-4 <= step <= 1.5:
        return TimeGuess(TimeBase("seconds", "s"), 0.85, f"no unit; a step of {step:.4g} is taken for seconds")
    if 1.5 < step <= 2000.0:
        return TimeGuess(TimeBase("seconds", "ms"), 0.7, f"no unit; a step of {step:.4g} is taken for ms")
    if 0.0 < step < 1e-4:
        return TimeGuess(TimeBase("seconds", "day"), 0.6, f"no unit; a step of {step:.3g} is taken for days")
    return TimeGuess(TimeBase("seconds", "us"), 0.6, f"no unit; a step of {step:.4g} is taken for us")


def _guess_text(columns: Sequence[LogColumn]) -> TimeGuess | None:
    cells = _joined(columns)
    parts = [p for p in (time_parts(cell) for cell in _sample(cells)) if p is not None]
    if len(parts) < 0.8 * len(_sample(cells)):
        return None
    dated = sum(p[0] is not None for p in parts) > len(parts) / 2
    if not dated:
        return TimeGuess(TimeBase("clock"), 0.9, f"times of day such as '{first_text(cells)}', from midnight")
    if any(isinstance(c, (datetime, np.datetime64)) for c in _sample(cells)):
        return TimeGuess(TimeBase("datetime", order="ymd", zone="UTC"), 0.95, "dates; no zone is given, taken for UTC")
    order, sure = _order_of(parts)
    zoned = any(p[7] for p in parts)
    zone = "with its zone" if zoned else "no zone is given, taken for UTC (it only dates the run)"
    days = len({p[:3] for p in parts})
    because = f"dates such as '{first_text(cells)}', order {order}, {zone}"
    question = ""
    if not sure and days > 1:
        question = f"is '{first_text(cells)}' day or month first? set time.order to dmy or mdy"
    elif not sure:
        because += "; day or month first is open, which dates the run but changes no duration"
    return TimeGuess(
        TimeBase("datetime", order=order, zone="" if zoned else "UTC"), 0.95 if sure else 0.7, because, question
    )


def _order_of(parts: Sequence[Any]) -> tuple[str, bool]:
    """Order of year, month, day and whether it is sure."""
    dates = [p[:3] for p in parts if p[0] is not None]
    if max(_int(d[0]) for d in dates) > 31:
        return "ymd", True
    if any(not d[1].isdecimal() for d in dates):
        return "dmy", True
    if max(_int(d[0]) for d in dates) > 12:
        return "dmy", True
    if max(_int(d[1]) for d in dates) > 12:
        return "mdy", True
    point = any(p[8] == "." for p in parts)
    return "dmy", point


def to_seconds(
    columns: Sequence[LogColumn], base: TimeBase, where: str, place: Place, strict: bool = True
) -> FloatArray:
    """Seconds of every row; NaN where a cell is empty; raises `InputError` by row for a cell that is no time."""
    if base.fraction and len(columns) < 2:
        raise InputError(f"{where}: time.fraction is the unit of the last of several columns; time.from names one")
    if base.fraction:
        scale, _ = conversion_to_si(base.fraction, "s", where)
        *whole, beyond = columns
        return to_seconds(whole, replace(base, fraction=""), where, place, strict) + scale * beyond.values
    if base.form != "parts" and len(columns) > 1 and any(each.numeric for each in columns):
        raise InputError(
            f"{where}: time.from: a date and a time of day are joined where both are texts; column "
            f"'{next(each.name for each in columns if each.numeric)}' holds plain numbers: name one column"
        )
    if base.form == "parts":
        seconds = _from_parts(columns, base, where)
    elif columns[0].numeric:
        seconds = _from_numbers(columns[0].values, base, where)
    else:
        seconds = _from_text(columns, base, where, place, strict)
    return spread_ticks(seconds) if base.spread else seconds


def _from_parts(columns: Sequence[LogColumn], base: TimeBase, where: str) -> FloatArray:
    seconds, zone = calendar_seconds(columns, where), _zone(base, where)
    if len(columns) == CLOCK:
        return _over_midnight(seconds)
    return seconds if zone is None else seconds - from_utc(seconds, zone)


def _from_numbers(values: FloatArray, base: TimeBase, where: str) -> FloatArray:
    if base.form == "excel":
        return (values - _EXCEL_EPOCH) * _DAY
    if base.form == "matlab":
        return (values - _MATLAB_EPOCH) * _DAY
    if base.form in _EPOCHS:
        return _TICK * values - _EPOCHS[base.form]
    if base.form == "clock":
        return _over_midnight(clock_of_numbers(values))
    if base.form not in ("seconds", "unix"):
        raise InputError(
            f"{where}: time.form is '{base.form}', but the column holds plain numbers; use seconds or unix"
        )
    return values * seconds_of_one(base.unit or "s", where)


def _from_text(columns: Sequence[LogColumn], base: TimeBase, where: str, place: Place, strict: bool) -> FloatArray:
    cells = _joined(columns)
    if isinstance(columns[0].text, np.ndarray) and np.issubdtype(columns[0].text.dtype, np.datetime64):
        stamps = columns[0].text.astype("datetime64[ns]")
        return np.where(np.isnat(stamps), np.nan, stamps.astype(np.int64) * 1e-9)
    zone, counted = _zone(base, where), counts_milliseconds(cells)
    offsets = np.zeros(len(cells))  # s from UTC that the cells say themselves
    unzoned = np.zeros(len(cells), bool)
    known: dict[tuple[Any, ...], float] = {}
    minutes: dict[Any, tuple[float, float]] = {}  # what stands before a cell's seconds -> its day and its minute, s
    seconds = np.full(len(cells), np.nan)
    for row, cell in enumerate(cells):
        before, second = before_second(cell)
        if before in minutes:
            day, minute = minutes[before]
            seconds[row], unzoned[row] = day + (minute + float(second.replace(",", "."))), True
            continue
        parts = time_parts(cell)
        if parts is None or (base.form == "datetime" and parts[0] is None):
            if strict and cell is not None and str(cell).strip():
                raise InputError(f"{where}: {place(row)}: '{str(cell)[:40]}' is no time of the form '{base.form}'")
            continue
        if counted:
            parts = (*parts[:5], with_zeros(parts[5]), *parts[6:])
        key = parts[:3]
        if key not in known:
            day = days_since_1970(key, base.order or "ymd", where, strict) if parts[0] is not None else 0.0
            known[key] = day * _DAY
        seconds[row] = known[key] + clock_seconds(parts)
        if second and parts[5:8] == (second, None, None):
            minutes[before] = known[key], clock_seconds((*parts[:5], None, None))
        offsets[row], unzoned[row] = zone_seconds(parts[7]) if parts[7] else 0.0, not parts[7]
    if zone is not None:
        offsets[unzoned] = from_utc(seconds[unzoned], zone)
    return _over_midnight(seconds - offsets) if base.form == "clock" else seconds - offsets


def _over_midnight(seconds: FloatArray) -> FloatArray:
    """Times of day that fall from the end of a day to its beginning go on into the next one."""
    steps = np.diff(seconds, prepend=seconds[0])
    return seconds + _DAY * np.cumsum(np.nan_to_num(steps) < -0.9 * _DAY)


def _joined(columns: Sequence[LogColumn]) -> Any:
    if len(columns) == 1:
        return columns[0].text
    return [
        " ".join(str(part).removesuffix(" 00:00:00") for part in row)
        for row in zip(*(c.values if c.text is None else c.text for c in columns), strict=True)
    ]


def _sample(cells: Any) -> list[Any]:
    step = max(1, len(cells) // 200)
    return [cell for cell in list(cells[::step]) if cell is not None and str(cell).strip()]


def _zone(base: TimeBase, where: str) -> ZoneInfo | None:
    """The zone of dates without an offset, None for UTC."""
    if not base.zone or base.zone == "UTC" or base.form not in ("datetime", "parts"):
        return None
    try:
        return ZoneInfo(base.zone)
    except (ZoneInfoNotFoundError, ValueError, OSError) as error:
        raise InputError(f"{where}: time.zone '{base.zone}' is not known; write e.g. UTC or Europe/Oslo") from error


def _int(text: str) -> int:
    return int(text) if text.isdecimal() else 0
