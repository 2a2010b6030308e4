"""Tables with a row per value: a signal's name, a time and the value, as archives of controllers and databases have it.

Each signal becomes a column, all of them on one clock; what cannot be told apart surely stays as it is and is refused.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.importing.log import Log, LogColumn
from winch_friction.importing.names import NAMED, name_concepts, name_score
from winch_friction.importing.one_clock import Signal, draws_lines, on_one_clock
from winch_friction.importing.time_base import TimeBase, guess_form, to_seconds
from winch_friction.importing.time_names import is_clock_of
from winch_friction.importing.units import CHANNEL_UNITS
from winch_friction.physics.errors import counted
from winch_friction.physics.signals import FloatArray

_SIGNALS = 500  # names of one archive
_FEWEST = 5  # values of each signal, in the mean; of fewer a text beside the rows is a remark
_PEEKED = 5000  # cells that are looked at first: dates of a long log are all different
_VALUE = re.compile(r"value|wert|verdi|värde", re.IGNORECASE)
_UNIT = re.compile(r"^_?(?:unit|einheit|enhet|uom)s?$", re.IGNORECASE)
_SAME = 0.01  # of a signal's times that may be those of the row before: of more the clock is too coarse for it
# s per unit of a finer clock beside a date of whole seconds: s, ms, and the millionths of a day of WinCC's `Time_ms`
_SCALES, _WHOLE = (1.0, 1e-3, 0.0864), 1.0
_DAYS = 3e10, 6e10  # millionths of a day since 1900 that are of a winch's time: in ms nobody counts for a year
_TELLING = 20.0  # s that both must last for their scales to be told apart


def names_of_signals(log: Log) -> tuple[LogColumn, tuple[str, ...]] | None:
    """The column whose cells name the signals, again and again, and these names; None where no column does."""
    for column in log.columns:
        if column.text is None or len({str(each) for each in column.text[:_PEEKED]}) > _SIGNALS:
            continue
        cells = _words(column).tolist()
        names = dict.fromkeys(cells)
        if not 2 <= len(names) <= min(_SIGNALS, len(cells) // _FEWEST):
            continue
        spoken = [c for name in names if (c := name_concepts(name))]
        if sum(any(name_score(ch, c) > NAMED for ch in CHANNEL_UNITS if ch != "time") for c in spoken) >= 2:
            return column, tuple(names)
    return None


def with_column_per_signal(log: Log, said: str = "") -> Log:
    """The log with a column for each signal that its rows name, on one clock; the same log where it is no such table,
    or its times or values are not told surely. `said` as for `with_own_clocks`."""
    found = None if said == "one" else names_of_signals(log)
    value = _value(log) if found is not None else None
    if found is None or value is None:
        return log
    column, names = found
    cells, units = _words(column), [_words(c) for c in log.columns if c.text is not None and _UNIT.match(c.name)]
    rows = {name: np.flatnonzero((cells == name) & np.isfinite(value.values)) for name in names if name}
    rows = {name: at for name, at in rows.items() if len(at) > 1}
    told = _seconds(log, value, list(rows.values()))
    if told is None or len(rows) < 2:
        return log
    seconds, base = told
    signals = []
    for name, at in rows.items():
        at = at[np.argsort(seconds[at], kind="stable")]
        unit = set(units[0][at]) if units else set()
        signals.append(Signal(name, value.values[at], unit.pop() if len(unit) == 1 else value.unit, seconds[at]))
    lines = said == "lines" or (not said and draws_lines(signals))
    columns, notes = on_one_clock(signals, lines, steady=True)
    if value.bad:
        row, cell = value.bad[0]
        many = counted(len(value.bad), "cell is no number", "cells are no numbers")
        notes.append(f"column '{value.name}': {many}, first {log.place(row)} '{cell}': left out")
    if base.zone:
        notes.append(f"dates of the order {base.order}, {base.zone} where no zone is given")
    notes.append(f"a row per value, of the {len(rows)} signals that '{column.name}' names: a column for each")
    return replace(
        log, columns=tuple(columns), settings={**log.settings, "clocks": "lines" if lines else "held"},
        place=lambda row: f"sample {row + 1}", notes=(*log.notes, *notes),
    )  # fmt: skip


def _words(column: LogColumn) -> np.ndarray:
    return np.array([str(each).strip() for each in column.text], dtype=object)


def _value(log: Log) -> LogColumn | None:
    """The column of the values: the one that is called so, else the only one of numbers beside the times."""
    named = [each for each in log.columns if _VALUE.search(each.name)]
    left = named or [each for each in log.columns if each.numeric and not is_clock_of(each)[0]]
    return left[0] if len(left) == 1 and left[0].numeric else None


def _seconds(log: Log, value: LogColumn, rows: Sequence[np.ndarray]) -> tuple[FloatArray, TimeBase] | None:
    """The time of every row, s, NaN where it has none, and how it is told; None where no clock tells the rows (of each
    signal) apart."""
    clocks = [each for each in log.columns if each is not value and is_clock_of(each)[0]]
    for clock in sorted(clocks, key=lambda each: each.numeric):  # dates first: they have no unit to be mistaken in
        guess = guess_form([clock], is_clock_of(clock)[1])
        if guess is None or guess.question or (clock.numeric and _counts_days(clock)):
            continue
        seconds = to_seconds([clock], guess.base, "time", log.place, strict=False)
        for finer in (seconds, *(_finer(each, seconds) for each in clocks if each.numeric)):
            if finer is not None and all(_tells_apart(finer[at]) for at in rows):
                return finer, guess.base
    return None


def _counts_days(clock: LogColumn) -> bool:
    known = clock.values[np.isfinite(clock.values)]
    return len(known) > 0 and bool(_DAYS[0] < known.min() and known.max() < _DAYS[1])


def _tells_apart(seconds: FloatArray) -> bool:
    steps = np.diff(np.sort(seconds))
    return bool(np.isfinite(seconds).all() and (steps <= 0.0).mean() <= _SAME)


def _finer(clock: LogColumn, seconds: FloatArray) -> FloatArray | None:
    """The times of a clock that runs as whole seconds do, with these as their date; None where it does not."""
    known = np.isfinite(seconds) & np.isfinite(clock.values)
    if not known.any() or np.ptp(seconds[known]) < _TELLING:
        return None
    for scale in _SCALES:
        ahead = scale * clock.values - seconds
        if np.ptp(ahead[known]) <= _WHOLE + 1e-3:
            return np.asarray(scale * clock.values - ahead[known].min())
    return None
