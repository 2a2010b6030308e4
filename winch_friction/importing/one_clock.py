"""Signals of rates of their own put on one clock, the densest signal's.

Between two of its values a signal is held at the latest one, as a node sees it; a record that a historian has
compressed to the corners of straight lines is drawn along them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.importing.log import LogColumn, listed, number_column, unique_names
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray

TIME = "time"  # the name given to the times of the clock that all signals are put on
_SILENT, _SHORT = 5.0, 1.0  # usual steps and s that a signal may say nothing without a word
_PEEKED = 300  # cells of a column of text whose decimal mark is looked at
_UNSTEADY = 3.0  # times the shortest usual step that a clock's longest usual one is where its rows come as they like
_TENTHS = (10, 90)  # percentiles of the steps that are called the shortest and the longest usual one
_MOST_ROWS = 10_000_000  # of a clock of our own: two days at 50 Hz
_MOVES = 0.2  # of its largest value: the range of a signal that moves
_VOTING = 20  # values of a signal that can tell how a historian writes
_CLIMB = 3  # steps of a climb, at least: two of one sign are often noise
_WAITED, _LEAP = 5.0, 0.1  # shortest steps, and of a signal's range, that make a leap behind a silence


@dataclass(frozen=True)
class Signal:
    """A signal with its unit and its own times in s, or None where the file gives no times."""

    name: str
    values: Any
    unit: str = ""
    times: FloatArray | None = None
    note: str = ""


def on_one_clock(
    signals: Sequence[Signal], lines: bool = False, steady: bool = False, base: FloatArray | None = None
) -> tuple[list[LogColumn], list[str]]:
    """The densest signal's times as a column, every signal at these, and what is to be said of it; all have times.

    `lines`: along straight lines between a signal's values, else held at the latest. `steady`: where the densest times
    come as they like they are replaced by steady ones of the shortest usual step. `base`: other times than the densest.
    """
    clocks = [np.asarray(each.times, dtype=float) for each in signals]
    base = max(clocks, key=len) if base is None else base
    others = sum(not np.array_equal(each, base) for each in clocks)
    notes = []
    if others:
        how = "straight lines between their values" if lines else "held at their latest value"
        notes.append(f"{others} signals have times of their own: {how} on the times of the densest")
    if steady and not is_steady(base):
        base = _steady_clock(clocks)
        notes.append(f"no clock is steady: put on one of {base[1] - base[0]:.3g} s, the shortest usual step")
    columns = [number_column(TIME, base, "s")]
    names = unique_names([TIME, *(each.name for each in signals)])[1:]
    columns += [column_of(name, each, base, lines) for name, each in zip(names, signals, strict=True)]
    silent = [said for each in signals if not lines and (said := _silence(each, base))]
    notes += [f"signals that say nothing for long, their last value held: {'; '.join(silent)}"] if silent else []
    return columns, notes


def is_steady(times: FloatArray) -> bool:
    """Whether rows come by a clock, and not as values change."""
    short, long = np.percentile(np.diff(times), _TENTHS)
    return bool(long <= _UNSTEADY * short)


def draws_lines(signals: Sequence[Signal]) -> bool:
    """Whether values leap behind silences, of which straight lines make a motion, in half or more of the signals.

    A logger of changes writes each step of a ramp, so its values never leap when they have not changed for long.
    """
    clocks = [np.asarray(each.times, dtype=float) for each in signals]
    shortest = _shortest(clocks)
    votes = []
    for times, signal in zip(clocks, signals, strict=True):
        values = np.asarray(signal.values)
        if len(values) < _VOTING or values.dtype.kind not in "biuf" or is_steady(times):
            continue
        if not np.ptp(values) > _MOVES * np.abs(values).max():
            continue  # its steps are noise
        steps, soon = np.diff(values), np.diff(times) <= _WAITED * shortest
        leaps = ~soon & (np.abs(steps) > _LEAP * np.ptp(values))
        leapt, climbed = float(np.abs(steps[leaps]).sum()), _climbed(steps, soon, _LEAP * float(np.ptp(values)))
        if leapt or climbed:
            votes.append(leapt > climbed)
    return bool(votes) and sum(votes) >= len(votes) / 2


def _climbed(steps: FloatArray, soon: np.ndarray, least: float) -> float:
    """How far values went by steps that follow each other soon and the same way, by `least` and more together."""
    way = np.sign(steps) * soon
    begins = np.flatnonzero(np.diff(way, prepend=np.nan) != 0.0)
    heights = np.abs(np.add.reduceat(steps, begins))
    counts = np.diff(begins, append=len(steps))
    return float(heights[(way[begins] != 0.0) & (counts >= _CLIMB) & (heights > least)].sum())


def _shortest(clocks: Sequence[FloatArray]) -> float:
    """The shortest usual step, s."""
    return min(float(np.percentile(np.diff(each), _TENTHS[0])) for each in clocks if len(each) > 1)


def _steady_clock(clocks: Sequence[FloatArray]) -> FloatArray:
    begin, end = min(each[0] for each in clocks), max(each[-1] for each in clocks)
    rows = int((end - begin) / max(_shortest(clocks), 1e-6)) + 1
    if rows > _MOST_ROWS:
        raise InputError(f"{rows} rows on one clock: its shortest usual step is too short for how long the log lasts")
    return np.asarray(begin + max(_shortest(clocks), 1e-6) * np.arange(rows), dtype=np.float64)


def _silence(signal: Signal, base: FloatArray) -> str:
    """A signal's name with its longest silence up to the log's end, '' for one that goes on as it does."""
    if signal.times is None or np.array_equal(signal.times, base):
        return ""
    times = np.append(signal.times, base[-1])
    steps = np.diff(times)
    longest = int(np.argmax(steps))
    usual = float(np.median(steps[:-1])) if len(steps) > 1 else 0.0
    if not steps[longest] > max(_SILENT * usual, _SHORT):
        return ""
    return f"{signal.name} for {steps[longest]:.4g} s, {times[longest] - times[0]:.4g} s after its first value"


def of_one_length(signals: Sequence[Signal]) -> tuple[list[LogColumn], list[str]]:
    """Signals without times, of the length that most of them have, and what is left out."""
    lengths = [len(each.values) for each in signals]
    length = max(set(lengths), key=lambda n: (lengths.count(n), n))
    kept = [each for each in signals if len(each.values) == length]
    names = unique_names([each.name for each in kept])
    left = [f"{each.name} ({len(each.values)})" for each in signals if len(each.values) != length]
    notes = [f"arrays of another length than {length} left out: {listed(left)}"] if left else []
    return [column_of(name, each) for name, each in zip(names, kept, strict=True)], notes


def column_of(name: str, signal: Signal, base: FloatArray | None = None, lines: bool = False) -> LogColumn:
    """A signal as a column: its values as they are, or at the times `base` in s."""
    values = np.asarray(signal.values)
    if base is not None and signal.times is not None and not np.array_equal(signal.times, base):
        if lines and values.dtype.kind in "biuf":
            values = np.interp(base, signal.times, values, left=np.nan)
        else:
            index = np.searchsorted(signal.times, base, side="right") - 1
            nothing: Any = np.nan if values.dtype.kind in "biuf" else None
            values = np.where(index >= 0, values[np.maximum(index, 0)], nothing)
    if np.issubdtype(values.dtype, np.datetime64):
        return LogColumn(name, np.full(len(values), np.nan), signal.unit, text=values, note=signal.note)
    if values.dtype.kind in "biuf":
        return number_column(name, values, signal.unit, signal.note)
    from winch_friction.importing.cells import as_column, decimal_mark

    cells = values.tolist()
    decimal, thousands = decimal_mark(cells[-_PEEKED:], "\t")
    return as_column(name, cells, decimal, thousands, signal.unit, signal.note)
