"""Which columns of a log are its time, and what to say where none is."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from winch_friction.importing.calendar_columns import calendar_columns
from winch_friction.importing.draft import Draft
from winch_friction.importing.log import Log, LogColumn, listed
from winch_friction.importing.ticks import fraction_unit
from winch_friction.importing.time_base import TimeBase, TimeGuess, guess_form, guess_time, to_seconds
from winch_friction.importing.time_names import is_named, says_time, time_reading
from winch_friction.importing.time_numbers import counts_rows
from winch_friction.importing.units import fitting_si_unit
from winch_friction.physics.signals import FloatArray

_DATED = 0.3  # a date beside the clock: worth more than the order of day and month, if open, makes it unsure
_PARTS = 3  # columns of a time whose parts stand apart, at least; their names have said what they are
_CLOCKS = (
    2e-3  # by which two clocks may differ: a quartz is a tenth of it off, no sensor tells so small an error of a rate
)
_FULL = 0.5  # of the rows
_STEPS = 2.0  # a clock of whole seconds begins and ends within a step of another


def settle_time(draft: Draft) -> None:
    """Put the likeliest time into the draft's map, or say why no column is one."""
    best: tuple[float, tuple[LogColumn, ...], TimeGuess] | None = None
    for columns in _time_candidates(draft.logs[0]):
        bare, unit = time_reading(columns[0])
        if unit and fitting_si_unit("time", unit) is None:
            continue
        named = says_time(bare) if len(columns) < _PARTS or columns[0].text is not None else 1.0
        guess = guess_time(columns, unit)
        if guess is None or (not named and not _steady(draft.logs[0], columns)):
            continue
        worth = 0.3 + named + 0.2 * (not columns[0].numeric) + _DATED * (len(columns) > 1) + guess.confidence
        if best is None or worth > best[0]:
            because = f"name '{columns[0].name}', {guess.because}" if named else f"rises steadily, {guess.because}"
            best = (
                worth,
                tuple(columns),
                replace(guess, because=because, confidence=guess.confidence * (1.0 if named else 0.7)),
            )
    if best is None:
        draft.problems.append(f"time: {_why_none(draft.logs[0])}")
        return
    _, columns, guess = best
    columns, guess = _with_fraction(draft.logs[0], columns, guess)
    draft.log_map = replace(
        draft.log_map, time_from=tuple(c.name for c in columns), time=guess.base, time_confidence=guess.confidence,
        time_because=guess.because,
    )  # fmt: skip
    if guess.question:
        draft.questions.append(f"time: {guess.question}")
    _look_at_rivals(draft, columns, guess)
    first = columns[0]
    if (
        len(columns) == 1
        and first.numeric
        and not is_named(first)
        and counts_rows(first.values[np.isfinite(first.values)])
    ):
        draft.questions.append(
            f"time: '{first.name}' rises by 1 from row to row: does it count rows? say the time from one to the next, "
            "--set 'time.unit=20 ms' for 50 rows a second; --set time.unit=s if it counts seconds"
        )


def _look_at_rivals(draft: Draft, columns: tuple[LogColumn, ...], guess: TimeGuess) -> None:
    """Ask where another column of the name of a time says that the log lasts longer, or less long, or that the columns
    behind it are of other instants; say it where it merely counts from another origin."""
    log = draft.logs[0]
    taken = to_seconds(columns, guess.base, "time", log.place, strict=False)
    for other in log.columns:
        rival = None if other in columns or not is_named(other) else guess_time([other], time_reading(other)[1])
        if rival is None:
            continue
        told = to_seconds([other], rival.base, "time", log.place, strict=False)
        both = np.isfinite(taken) & np.isfinite(told)
        own, its = (np.ptp(each[both]) if both.any() else 0.0 for each in (taken, told))
        if abs(own - its) > _CLOCKS * own + _STEPS * max(_step(taken[both]), _step(told[both])):
            names = " + ".join(c.name for c in columns)
            draft.questions.append(
                f"time: '{names}' and '{other.name}' tell two times, {own:.6g} s and {its:.6g} s from the first row to "
                "the last: which is it? --set time.from=COLUMN; where each belongs to the columns beside it (two "
                "tables side by side), --set log.clocks=held"
            )
            return
        if _kind(rival.base) == _kind(guess.base) and both.any():
            _look_at_origin(draft, columns, other, float(np.median((told - taken)[both])), _step(taken[both]))


def _look_at_origin(draft: Draft, columns: tuple[LogColumn, ...], other: LogColumn, apart: float, step: float) -> None:
    """What to say of another clock of the same kind that runs as the time does, but stands `apart` s from it."""
    if abs(apart) <= _STEPS * step:
        return
    names, shown = " + ".join(c.name for c in columns), f"{abs(apart):.6g} s {'later' if apart > 0.0 else 'earlier'}"
    if _begins_a_table(draft.logs[0], columns, other):
        draft.questions.append(
            f"time: '{other.name}' stands {shown} than '{names}' in every row, and columns of its own stand behind it: "
            "where these are of its times (two tables side by side), --set log.clocks=held; where all columns "
            f"of a row are of one instant, --set time.from={columns[0].name!r}"
        )
    else:
        draft.notes.append(
            f"time: '{other.name}' stands {shown} than '{names}' in every row; '{names}' is taken, --set time.from="
            "COLUMN for the other one"
        )


def _kind(base: TimeBase) -> str:
    """What a time counts from: a date, midnight, or any origin. Only of one kind can two be compared."""
    return base.form if base.form in ("clock", "seconds") else "date"


def _begins_a_table(log: Log, columns: tuple[LogColumn, ...], other: LogColumn) -> bool:
    """Whether signals stand between the time and another clock, and behind the later one of them."""
    at = sorted([log.columns.index(columns[-1]), log.columns.index(other)])
    return at[1] - at[0] > 1 and at[1] < len(log.columns) - 1


def _step(seconds: FloatArray) -> float:
    steps = np.diff(seconds)
    return float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0


def _why_none(log: Log) -> str:
    """Why no column is the time: it falls, it goes back, its cells are read by no form, or there is none."""
    named = [c for c in log.columns if is_named(c)]
    turned = lambda c: replace(c, values=c.values[::-1], text=None if c.text is None else c.text[::-1])
    for column in named:
        if guess_time([turned(column)], time_reading(column)[1]) is not None:
            return f"'{column.name}' falls from row to row, the newest first; sort the log by time"
    for column in named:
        form = guess_form([column], time_reading(column)[1])
        if form is not None:
            seconds = to_seconds([column], form.base, "time", log.place, strict=False)
            if np.nanmin(np.diff(seconds)) > 0.0:
                unit = time_reading(column)[1]
                return f"'{column.name}' rises like one, but '{unit}' is no unit of a time; take it out of the log"
            if np.nanmin(np.diff(seconds)) == 0.0:
                same = float(np.mean(np.diff(seconds) == 0.0))
                return (
                    f"'{column.name}' stands still in {100.0 * same:.3g} % of the rows: written with too few digits? "
                    "export it with more, or name another column by --set time.from=COLUMN"
                )
            back = int(np.nanargmin(np.diff(seconds)))
            return (
                f"'{column.name}' goes back by {seconds[back] - seconds[back + 1]:.6g} s at {log.place(back + 1)}: "
                "several recordings in one file, or rows out of order? cut the log there, or sort it by time"
            )
    for column in named:
        cell = "" if column.text is None else next((str(c) for c in column.text if str(c).strip()), "")
        if cell:
            return (
                f"no form of time reads the cells of '{column.name}', such as '{cell[:40]}'; write them as "
                "2026-03-01T10:00:00.000, or as seconds"
            )
    return f"no column of times found among {listed(c.name for c in log.columns)}"


def _with_fraction(
    log: Log, columns: tuple[LogColumn, ...], guess: TimeGuess
) -> tuple[tuple[LogColumn, ...], TimeGuess]:
    """The time with the column that holds its fractions of a second, where the log keeps them apart."""
    whole = to_seconds(columns, replace(guess.base, spread=False), "time", log.place, strict=False)
    for column in log.columns:
        unit = "" if column in columns else fraction_unit(whole, column)
        if unit:
            because = f"{guess.because.partition('; about')[0]}; '{column.name}' holds their fractions in {unit}"
            base = replace(guess.base, spread=False, fraction=unit)
            return (*columns, column), replace(guess, base=base, because=because)
    return columns, guess


def _time_candidates(log: Log) -> list[tuple[LogColumn, ...]]:
    single = [(c,) for c in log.columns]
    texts = [c for c in log.columns if not c.numeric and _is_full(c)]
    parts = calendar_columns(log.columns)
    return ([parts] if parts else []) + single + [(a, b) for a in texts for b in texts if a is not b]


def _is_full(column: LogColumn) -> bool:
    """Whether most rows of a text say something: half of a time does, a remark here and there is none."""
    cells = () if column.text is None else column.text
    return sum(cell is not None and bool(str(cell).strip()) for cell in cells) > _FULL * len(cells)


def _steady(log: Log, columns: Sequence[LogColumn]) -> bool:
    """Whether a column without the name of a time rises like one: by the same step from row to row, or as dates."""
    if not columns[0].numeric:
        return True
    steps = np.diff(columns[0].values)
    usual = float(np.median(steps)) if len(steps) else 0.0
    return usual > 0.0 and float(np.mean(np.abs(steps - usual) < 0.5 * usual)) > 0.9 and columns[0] is log.columns[0]
