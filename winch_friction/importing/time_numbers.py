"""Times that are plain numbers: rows that are only counted, times of day written without colons."""

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.records.unit_names import conversion_to_si

_HOUR, _MINUTE = 10_000, 100  # what an hour and a minute count in 235959
_LEAP = 40.0  # from 59 to 100: what such a number gains with each minute beside the seconds


def counts_rows(values: FloatArray) -> bool:
    """Whether finite values are whole numbers that rise by one from row to row: a row's number, or seconds."""
    return bool(np.all(values % 1.0 == 0.0) and np.all(np.diff(values) == 1.0))


def is_clock(values: FloatArray) -> bool:
    """Whether finite numbers are times of day such as 95959.5: none has 60 seconds, and a minute's end leaps by 40."""
    whole = np.floor(values)
    if whole.min() < 0.0 or whole.max() >= 24 * _HOUR or max((whole % 100).max(), (whole // _MINUTE % 100).max()) > 59:
        return False
    steps = np.diff(values)
    minutes = np.diff(whole // _MINUTE) > 0
    usual = np.median(steps)
    return bool(minutes.any() and np.all(steps[minutes] >= _LEAP) and 0.0 < usual < _LEAP / 2)


def clock_of_numbers(values: FloatArray) -> FloatArray:
    """Seconds since midnight of times of day written as one number each, 95959.5 as 9 h 59 min 59.5 s."""
    hour, rest = np.divmod(values, _HOUR)
    minute, second = np.divmod(rest, _MINUTE)
    return np.asarray(3600.0 * hour + 60.0 * minute + second)


def seconds_of_one(unit: str, where: str) -> float:
    """Seconds of one count: of a unit (`ms`), or of so many (`20 ms`), which a column that counts rows needs.

    Raises `InputError` for what is no time above zero.
    """
    number, _, rest = unit.strip().partition(" ")
    try:
        count = float(number)
    except ValueError:
        return conversion_to_si(unit, "s", where)[0]
    if not 0.0 < count < float("inf"):
        raise InputError(f"{where}: time.unit '{unit}': a row lasts longer than nothing; write e.g. 20 ms")
    return count * conversion_to_si(rest.strip() or "s", "s", where)[0]
