"""What is checked of every run that is read, and said by row and column.

Refused with an `InputError`: a required column missing, a row without time, time that goes back, fewer than two rows,
a required column without any value. Said as a warning of the run: values that are NaN, infinite or beyond 1e100 (kept
as NaN), an optional column without any value (left out), repeated times (the later rows left out), gaps in time, a run
shorter than a second, columns that are not of the contract (kept aside), and what gives away that somebody meant
another unit by a column without one, which is SI.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from winch_friction.physics.channels import plausible
from winch_friction.physics.errors import InputError, Problems, counted, meant
from winch_friction.physics.signals import GROUP_CHANNELS, FloatArray, Run, column_unit, readable
from winch_friction.physics.winch.crane import ELECTRIC, HYDRAULIC, Crane, Drive

# -- columns without a unit

# channel -> (smallest, largest) largest magnitude that a winch's log in SI has, and the unit that is meant outside it
_USUAL = {
    "motor_speed": (0.0, 600.0, "rpm"),  # 5700 rpm: no motor of a winch turns faster
    "speed_reference": (0.0, 600.0, "rpm"),
    "pressure_a": (2.0e4, 1.0e8, "bar"),  # 0.2 bar: the boost alone is a hundred times that
    "pressure_b": (2.0e4, 1.0e8, "bar"),
    "displacement": (0.0, 1.0e-3, "cm^3/rev"),  # 6300 cm^3/rev
    "hook_load": (100.0, 1.0e7, "t"),  # an empty hook of an offshore crane weighs more than 100 kg
}


def remarks_on_bare_columns(name: str, columns: Mapping[str, FloatArray], bare: Iterable[str]) -> list[str]:
    """What to say of columns whose header has no unit; raises `InputError` for values that no sensor in SI can give."""
    said, impossible = [], []
    for column in bare:
        channel = column.rpartition(".")[2]
        if channel not in _USUAL or column not in columns:
            continue
        values = np.abs(columns[column][np.isfinite(columns[column])])
        if not values.size or not values.any():
            continue
        lower, upper, meant = _USUAL[channel]
        largest, unit = float(values.max()), column_unit(column)
        text = f"column '{column}' has no unit and is read in {unit}: {largest:.4g} {unit} at most; if it is {meant},"
        if not plausible(channel, float(np.median(values))):
            impossible.append(f"{text} write '{column} [{meant}]'")
        elif not lower <= largest <= upper:
            said.append(f"{name}: {text} write '{column} [{meant}]'")
    if impossible:
        raise InputError(
            f"{name}: no sensor gives this: {'; '.join(impossible + [s.partition(': ')[2] for s in said])}"
        )
    return said


# -- columns that a slower logger writes in every n-th row only
SPARSE = 0.67  # of the rows: what has a value in more of them has holes
RHYTHM = 10  # values from which on a rhythm is one
LONGEST = 5.0  # usual steps between values that are held; beyond them there is a hole


def rows_between(values: FloatArray) -> float:
    """The usual number of rows from one value to the next of a column written in every n-th row; 0 for any other."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < RHYTHM or len(known) > SPARSE * len(values):
        return 0.0
    steps = np.diff(known)
    usual = float(np.median(steps))
    ends = max(known[0], len(values) - 1 - known[-1])
    return 0.0 if max(steps.max(), ends) > LONGEST * usual else usual  # holes, not a slower channel


# -- the checks
GAP = 5.0  # times the median step counts as a gap
SHORT = 1.0  # s
NO_TIME_YET = 10.0  # s; rows of time 0 so long before the next are of a clock that was not set: no recorder pauses then
_SHOWN = 3  # places named in one warning

Columns = dict[str, FloatArray]
Place = Callable[[int], str]  # index of a row -> how the file's reader finds it


def checked_run(
    name: str,
    columns: Columns,
    *,
    place: Place,
    crane: Crane | None = None,
    complete: bool = True,
    aside: Mapping[str, Any] | None = None,
    warnings: Sequence[str] = (),
    metadata: Mapping[str, Any] | None = None,
    bare: Sequence[str] = (),
) -> Run:
    """A run of columns in SI after all checks; `complete=False` asks for `time` alone. Raises `InputError`.

    `bare` names the columns whose header had no unit.
    """
    said, aside = [*warnings, *remarks_on_bare_columns(name, columns, bare)], dict(aside or {})
    named = [column for column in aside if column.partition("[")[0].strip()]  # the others: by their places
    if named:
        said.append(f"{name}: unknown columns kept aside: {', '.join(named)}")
    _check_rows(name, columns, aside)
    columns = {column: readable(values) for column, values in columns.items()}
    problems = Problems()
    with problems:
        _check_time(name, columns, place)
    if complete:
        _check_columns(name, columns, crane, aside, problems)
    problems.say()
    rows = _rows_of_new_time(name, columns["time"], place, said)
    columns = {column: values[rows] for column, values in columns.items()}
    aside = {column: np.asarray(values)[rows] for column, values in aside.items()}
    place = _place_after(rows, place)
    columns = _with_finite_values(name, columns, place, said)
    if complete:
        columns = _with_motor_speed(name, columns, crane)
    _note_gaps(name, columns["time"], place, said)
    return Run(name=name, columns=columns, aside=aside, warnings=tuple(said), metadata=dict(metadata or {}))


def _check_columns(
    name: str, columns: Columns, crane: Crane | None, aside: Mapping[str, Any], problems: Problems
) -> None:
    """Whether all that a run needs is there, with a value."""
    there = {column: values for column, values in columns.items() if np.isfinite(values).any() or column == "time"}
    empty = [column for column in columns if column not in there]
    with problems:
        there = _with_motor_speed(name, there, crane, aside, empty)
    with problems:
        _check_required(name, there, crane, empty)


def _check_rows(name: str, columns: Columns, aside: Mapping[str, Any]) -> None:
    lengths = [len(values) for values in (*columns.values(), *aside.values())]
    if lengths and not any(lengths):
        raise InputError(f"{name}: no rows under the header; a run needs at least two")


def _check_time(name: str, columns: Columns, place: Place) -> None:
    if "time" not in columns:
        raise InputError(f"{name}: column 'time' is missing; found {', '.join(columns) or 'no known column'}")
    time = columns["time"]
    if len(time) < 2:
        raise InputError(f"{name}: {counted(len(time), 'row is', 'rows are')} too few; a run needs at least two")
    missing = np.flatnonzero(~np.isfinite(time))
    if missing.size:
        raise InputError(f"{name}: {place(missing[0])}, column 'time': no time; fill it in or remove the row")
    back = np.flatnonzero(np.diff(time) < 0.0)
    if back.size:
        k = back[0]
        raise InputError(
            f"{name}: {place(k + 1)}, column 'time': time goes back by {time[k] - time[k + 1]:.4g} s, from "
            f"{time[k]:.14g} s to {time[k + 1]:.14g} s; sort the rows or split the file there"
        )


def _rows_of_new_time(name: str, time: FloatArray, place: Place, said: list[str]) -> Any:
    keep = np.concatenate(([True], np.diff(time) > 0.0))
    timeless = int(np.argmax(time != 0.0))  # 0 also where all are
    if timeless and time[timeless] > NO_TIME_YET:
        said.append(
            f"{name}: column 'time': {counted(timeless, 'row', 'rows')} of time 0, {time[timeless]:.4g} s before the "
            f"next, left out: the clock was not set yet, {_places(np.arange(timeless), place)}"
        )
        keep[:timeless] = True
    else:
        timeless = 0
    repeated = np.flatnonzero(~keep)
    if repeated.size:
        times = counted(repeated.size, "repeated time", "repeated times")
        ticks = "; winch-friction import spreads rows that share a tick" if 2 * repeated.size > len(time) else ""
        said.append(f"{name}: column 'time': {times} left out, {_places(repeated, place)}{ticks}")
    if keep.sum() < 2:
        raise InputError(f"{name}: column 'time': all rows have the same time")
    return np.flatnonzero(keep)[timeless:]


def _place_after(rows: Any, place: Place) -> Place:
    """The reader's place of a row among those that were kept."""
    return lambda row: place(int(rows[row]))


def _with_finite_values(name: str, columns: Columns, place: Place, said: list[str]) -> Columns:
    kept = {}
    for column, values in columns.items():
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size == len(values):
            said.append(f"{name}: column '{column}' has no value at all and is left out")
            continue
        usual = rows_between(values)
        if usual:
            said.append(f"{name}: column '{column}' has a value in every {usual:g} rows only")
        elif bad.size:
            share = counted(
                bad.size, f"of {len(values)} values is not a number", f"of {len(values)} values are not numbers"
            )
            said.append(f"{name}: column '{column}': {share}, {_places(bad, place)}")
        if bad.size:
            values = np.where(np.isfinite(values), values, np.nan)
        kept[column] = values
    return kept


_NO_RUN = "; a log with names of its own becomes a run file by winch-friction import"


def _with_motor_speed(
    name: str,
    columns: Columns,
    crane: Crane | None,
    aside: Mapping[str, Any] | None = None,
    empty: Sequence[str] = (),
) -> Columns:
    if "motor_speed" in columns:
        return columns
    if "drum_speed" not in columns:
        _refuse_empty(name, [each for each in ("motor_speed", "drum_speed") if each in empty][:1])
        near = [said for said in aside or {} if meant("motor_speed", [said.partition("[")[0].strip()])]
        found = f"found {', '.join(columns) or 'no known column'}" + (
            _NO_RUN if set(columns) <= {"time"} and aside else ""
        )
        slip = f"'{near[0]}': did you mean motor_speed?" if near else found
        raise InputError(f"{name}: column 'motor_speed' (or 'drum_speed') is missing; {slip}")
    if crane is None:
        raise InputError(f"{name}: 'drum_speed' needs the crane's gear ratio to become 'motor_speed'; give the crane")
    rest = {column: values for column, values in columns.items() if column != "drum_speed"}
    return {"time": rest.pop("time"), "motor_speed": columns["drum_speed"] * crane.gear_ratio, **rest}


def _refuse_empty(name: str, required: Iterable[str]) -> None:
    """Raise `InputError` for columns that a run must have and that stand in it without a single number."""
    said = [f"{name}: column '{each}' is there but holds no number; it is required: fill it in" for each in required]
    if said:
        raise InputError(*said)


def _groups_of(columns: Iterable[str]) -> list[str]:
    parts = (column.rpartition(".") for column in columns)
    return list(dict.fromkeys(group for group, dot, channel in parts if dot and channel in GROUP_CHANNELS))


def _check_required(name: str, columns: Columns, crane: Crane | None, empty: Sequence[str]) -> None:
    groups = _groups_of(columns)
    if groups:
        _check_groups(name, groups, columns, crane, empty)
    drive = crane.drive if crane is not None else Drive(HYDRAULIC if groups else ELECTRIC)
    pressures = not groups and (drive.hydraulic or crane is None)
    _refuse_empty(name, [each for each in empty if each in drive.channels or (pressures and _groups_of([each]))])
    for channel in drive.channels:
        if channel not in columns:
            other = "" if crane is not None else " (or the pressures of a motor group)"
            raise InputError(f"{name}: column '{channel}'{other} is missing; the drive's torque comes from it")
    if drive.hydraulic and not groups:
        raise InputError(
            f"{name}: no motor group: <group>.pressure_a, .pressure_b and .displacement are required with crane "
            f"'{crane.name if crane else ''}'"
        )


def _check_groups(
    name: str, groups: Sequence[str], columns: Columns, crane: Crane | None, empty: Sequence[str]
) -> None:
    """Whether each motor group has all of its columns, and the crane each of the groups."""
    problems = Problems()
    for group in groups:
        lacking = [each for each in (f"{group}.{channel}" for channel in GROUP_CHANNELS) if each not in columns]
        missing = [each for each in lacking if each not in empty]
        with problems:
            _refuse_empty(name, [each for each in lacking if each in empty])
        with problems:
            if missing:
                raise InputError(
                    f"{name}: motor group '{group}' lacks {', '.join(missing)}: add the column, or name it so"
                )
        with problems:
            if crane is not None and crane.drive.hydraulic and group not in crane.groups:
                known = ", ".join(crane.groups)
                raise InputError(f"{name}: crane '{crane.name}' has no motor group '{group}'; it has {known}")
    problems.say()


def _note_gaps(name: str, time: FloatArray, place: Place, said: list[str]) -> None:
    steps = np.diff(time)
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP * usual)
    if gaps.size:
        widest = f"widest {steps[gaps].max():.3g} s, usual step {usual:.3g} s"
        said.append(
            f"{name}: column 'time': {counted(gaps.size, 'gap', 'gaps')} ({widest}), before {_places(gaps + 1, place)}"
        )
    if time[-1] - time[0] < SHORT:
        said.append(f"{name}: only {time[-1] - time[0]:.3g} s long ({len(time)} rows)")


def _places(rows: Any, place: Place) -> str:
    shown = ", ".join(place(int(row)) for row in rows[:_SHOWN])
    return shown if len(rows) <= _SHOWN else f"{shown} and {len(rows) - _SHOWN} more"
