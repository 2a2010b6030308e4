"""A log and its map become a run in SI: every cell converted, what is no number named, nothing dropped silently."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.importing.log import Log, LogColumn, listed
from winch_friction.importing.mapping import Entry, LogMap
from winch_friction.importing.reading import WORKBOOK, read_log
from winch_friction.importing.time_base import to_seconds
from winch_friction.importing.units import CHANNEL_UNITS, conversion
from winch_friction.physics.channels import limits_of
from winch_friction.physics.errors import InputError, counted
from winch_friction.physics.signals import GROUP_CHANNELS, FloatArray, Run, held
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.run_checks import GAP, checked_run, rows_between
from winch_friction.records.unit_names import conversion_to_si

STRAY = 0.01  # share of cells that are no numbers, or that no sensor can give, up to which they are strays
_ORDER = 4  # of the low-pass before a derivative
_FEWEST_SMOOTHED = 3 * (_ORDER + 1) + 1  # rows, beyond what the filter takes at either end
_SHOWN = 5  # cells named in one message
_AT = {
    "motor_speed": 1.0,
    "speed_reference": 1.0,
    "motor_torque": -1.0,
    "load_torque": -1.0,
    "shaft_angle": 1.0,
}  # power of the gear ratio at the drum


@dataclass(frozen=True)
class Converted:
    """A log's columns in SI, with what was said and what is wrong (all of it, not only the first)."""

    columns: dict[str, FloatArray]
    warnings: tuple[str, ...]
    problems: tuple[str, ...]


def import_log(path: Path, log_map: LogMap, crane: Crane | None) -> Run:
    """A run from a log by a map; raises `InputError` with every problem at once."""
    log = open_with_map(path, log_map)
    done = convert(log, log_map, crane)
    if done.problems:
        raise InputError(f"{path}: {'; '.join(done.problems)}")
    metadata = {
        "source": path.name,
        "imported": {name: entry.constant or entry.source for name, entry in log_map.columns.items()},
    }
    warnings = tuple(f"{path.name}: {note}" for note in (*log.notes, *done.warnings))
    motion = {"heave_velocity"} <= set(done.columns) <= {"time", "heave_velocity"}
    if motion:
        warnings = (*warnings, f"{path.name}: a ship's motion alone: for a scenario, not a run of a winch")
    return checked_run(
        path.name, done.columns, place=log.place, crane=crane, complete=not motion, warnings=warnings, metadata=metadata
    )


def open_with_map(path: Path, log_map: LogMap) -> Log:
    """A log read as the map says; rows that are elsewhere than it says (a longer preamble) are found, and so is
    another encoding than that of the log which the map was made of."""
    wanted = {*log_map.time_from, *(e.source for e in log_map.columns.values() if not e.constant)}
    kind = str(log_map.log.get("kind", "")) or ("workbook" if _is_kind(path, "workbook") else "text")
    kept = (*log_map.log,) if _is_kind(path, kind) else ("clocks",)
    less = [key for key in kept if key in ("encoding", "delimiter", "sheet", "clocks")]
    problems = []
    for keys in dict.fromkeys((kept, tuple(less), tuple(key for key in less if key != "encoding"))):
        try:
            return _with_columns(read_log(path, {k: v for k, v in log_map.log.items() if k in keys}), wanted)
        except InputError as error:
            problems.append(error)
    raise problems[-1]  # read as itself: what is missing is told in its own letters


def _with_columns(log: Log, wanted: set[str]) -> Log:
    """The same log, which must have these columns."""
    if missing := wanted - {column.name for column in log.columns}:
        raise InputError(
            f"{log.path}: no column {listed(sorted(missing))}, which the map wants; "
            f"found {listed(c.name for c in log.columns)}"
        )
    return log


def _is_kind(path: Path, kind: str) -> bool:
    return (path.suffix.lower() in WORKBOOK) == (kind == "workbook")


def convert(
    log: Log, log_map: LogMap, crane: Crane | None, strict: bool = True, times: dict[Any, FloatArray] | None = None
) -> Converted:
    """All columns of a map in SI; problems are collected, not raised.

    `times` keeps this log's times for the next map that reads them in the same way.
    """
    columns: dict[str, FloatArray] = {}
    said: list[str] = []
    problems: list[str] = []
    for name, step in _steps(log, log_map, crane, said, problems, strict, {} if times is None else times):
        try:
            columns[name] = step()
        except InputError as error:
            problems.append(str(error))
    if "time" not in columns and not problems:
        problems.append("no time: set time.from to the column that holds it")
    columns = {"time": columns.pop("time"), **columns} if "time" in columns else columns
    if "time" in columns:
        columns = _without_footer(columns, log, said)
    return Converted(columns, tuple(said), tuple(problems))


def _steps(log: Log, log_map: LogMap, crane: Crane | None, said: list[str], problems: list[str], strict: bool,
           times: dict[Any, FloatArray]) -> Any:  # fmt: skip
    if log_map.time_from:
        yield "time", lambda: _time(log, log_map, times)
    for name, entry in log_map.columns.items():
        channel = name.rpartition(".")[2]
        if channel not in CHANNEL_UNITS:
            problems.append(
                f"columns: '{name}' is no channel; use {', '.join(CHANNEL_UNITS)}, for a motor group GROUP.{channel}"
            )
            continue
        if (channel in GROUP_CHANNELS) != ("." in name):
            wanted = (
                f"of a motor group: write GROUP.{channel}" if "." not in name else f"of no motor group: '{channel}'"
            )
            problems.append(f"columns: '{name}' is {wanted}")
            continue
        yield (
            name,
            lambda n=name, e=entry, c=channel: _values(log, n, c, e, log_map, crane, said, problems, strict, times),
        )


def _time(log: Log, log_map: LogMap, times: dict[Any, FloatArray]) -> FloatArray:
    read_as = (tuple(log_map.time_from), log_map.time)
    if read_as not in times:
        columns = [log.column(name) for name in log_map.time_from]
        times[read_as] = to_seconds(columns, log_map.time, "time", log.place)
    return times[read_as].copy()


def _values(log: Log, name: str, channel: str, entry: Entry, log_map: LogMap, crane: Crane | None, said: list[str],
            problems: list[str], strict: bool, times: dict[Any, FloatArray]) -> FloatArray:  # fmt: skip
    if entry.constant:
        return np.full(len(log), constant_in_si(name, channel, entry, crane))
    column = log.column(entry.source)
    if not column.numeric:
        first = next((str(c) for c in column.text if c is not None and str(c).strip()), "nothing")
        raise InputError(f"{name}: column '{column.name}' holds text ('{first[:30]}'), no numbers")
    if strict:
        _say_bad_cells(log, name, column, log_map.bad_cells, said, problems)
    scale, offset = scale_and_offset(name, channel, entry, crane)
    values = _held(name, column, said if strict else []) * scale + offset
    if entry.differentiate:
        values = _rate(name, values, _time(log, log_map, times), entry.differentiate)
    kept = (said, problems) if strict else ([], [])
    return _within_limits(log, name, channel, column, values, *kept)


def _held(name: str, column: LogColumn, said: list[str]) -> FloatArray:
    """A column's numbers; one that is written in every n-th row only is held at its latest value between them."""
    usual = rows_between(column.values)
    if not usual:
        return column.values
    said.append(f"{name}: column '{column.name}' has a value in every {usual:g} rows: held at its latest value")
    return held(column.values)


def constant_in_si(name: str, channel: str, entry: Entry, crane: Crane | None) -> float:
    """The value of an entry without a column, such as the known weight of what hangs on the rope."""
    number, _, unit = entry.constant.strip().partition(" ")
    try:
        value = float(number)
    except ValueError:
        raise InputError(f"{name}: constant: '{entry.constant}' must be a number and its unit, e.g. 96 kg") from None
    scale, offset = scale_and_offset(name, channel, replace(entry, unit=unit.strip() or entry.unit), crane)
    low, high = limits_of(channel)
    if not low <= value * scale + offset <= high:
        raise InputError(f"{name}: constant: '{entry.constant}' is beyond what any winch has; is the unit right?")
    return value * scale + offset


def scale_and_offset(name: str, channel: str, entry: Entry, crane: Crane | None) -> tuple[float, float]:
    """What takes a map entry's numbers to SI."""
    own = CHANNEL_UNITS[channel][0]
    of = _share_of(entry.of, own, name) if entry.of else _default_share(channel, crane)
    radius = crane.drum.layer_radii[-1] if crane is not None else float("nan")
    gear = crane.gear_ratio if crane is not None else 1.0
    unit = f"{entry.unit or 'rad'}/s" if entry.differentiate else entry.unit or own
    found = conversion(channel, unit, name, of=of, rope_radius=radius, gear_ratio=gear)
    if entry.at == "drum" and channel != "drum_speed":
        if channel not in _AT:
            raise InputError(f"{name}: at: drum is for {', '.join(_AT)}; take it out")
        if crane is None:
            raise InputError(f"{name}: at: drum needs the crane's gear ratio; give the crane")
        found = type(found)(found.scale * gear ** _AT[channel], found.offset)
    factor = entry.sign * entry.factor
    return found.scale * factor, (found.offset + found.scale * entry.add) * factor


def _rate(name: str, values: FloatArray, time: FloatArray, cutoff: float) -> FloatArray:
    """Time derivative behind a zero-phase Butterworth low-pass.

    Raises `InputError` for gaps, for times that do not rise, for too few rows and for a cut-off beyond half the
    sampling rate.
    """
    from scipy.signal import butter, filtfilt

    steps = np.diff(time)
    if len(time) < _FEWEST_SMOOTHED or not steps.min() > 0.0:  # NaN too
        raise InputError(
            f"{name}: differentiate: needs {_FEWEST_SMOOTHED} rows or more whose times rise; where several share a "
            "tick, set time.spread"
        )
    period = float(np.median(steps))
    if not np.isfinite(values).all() or steps.max() > GAP * period or cutoff * period >= 0.5:
        raise InputError(
            f"{name}: differentiate: {cutoff:g} Hz needs a gapless position and more than {2 * cutoff:g} samples/s"
        )
    smooth = filtfilt(*butter(_ORDER, 2.0 * cutoff * period), values)
    return np.asarray(np.gradient(smooth, time - time[0]), dtype=np.float64)


def _share_of(text: str, si_unit: str, name: str) -> float:
    value, _, unit = text.strip().partition(" ")
    try:
        number = float(value)
    except ValueError:
        raise InputError(f"{name}: of: '{text}' must be a number and its unit, e.g. 215 cm^3/rev") from None
    scale, _ = conversion_to_si(unit.strip() or si_unit, si_unit, f"{name}: of")
    if not 0.0 < number < float("inf"):
        raise InputError(f"{name}: of: '{text}': a share is of something above 0")
    return number * scale


def _default_share(channel: str, crane: Crane | None) -> float:
    """A displacement's share is of the crane's largest; nothing else is known to be a share of."""
    return (
        crane.max_displacement
        if channel == "displacement" and crane is not None and crane.max_displacement
        else float("nan")
    )


def _say_bad_cells(log: Log, name: str, column: LogColumn, policy: str, said: list[str], problems: list[str]) -> None:
    if not column.bad:
        return
    shown = ", ".join(f"{log.place(row)} '{cell}'" for row, cell in column.bad[:_SHOWN])
    more = f" and {len(column.bad) - _SHOWN} more" if len(column.bad) > _SHOWN else ""
    cells = counted(len(column.bad), "cell is no number", "cells are no numbers")
    text = f"{name}: column '{column.name}': {cells}: {shown}{more}"
    if policy == "refuse" or len(column.bad) > max(3, STRAY * len(column.values)):
        problems.append(f"{text}; mend them, or map another column")
    else:
        said.append(f"{text}; taken as missing")


def _within_limits(log: Log, name: str, channel: str, column: LogColumn, values: FloatArray, said: list[str],
                   problems: list[str]) -> FloatArray:  # fmt: skip
    """Values beyond what any sensor gives: few are strays and become missing by name, many are a wrong unit."""
    low, high = limits_of(channel)
    out = np.flatnonzero(np.isfinite(values) & ((values < low) | (values > high)))
    if not out.size:
        return values
    shown = ", ".join(f"{log.place(int(row))} '{column.values[row]:.6g}'" for row in out[:_SHOWN])
    usual = f"{low:g} to {high:g} {CHANNEL_UNITS[channel][0]}"
    how_many = counted(out.size, "value", "values")
    text = f"{name}: column '{column.name}': {how_many} that no sensor gives ({usual}): {shown}"
    if out.size > max(3, STRAY * len(values)):
        problems.append(f"{text}; is the unit right?")
        return values
    said.append(f"{text}; taken as missing")
    values = values.copy()
    values[out] = np.nan
    return values


def _without_footer(columns: Mapping[str, FloatArray], log: Log, said: list[str]) -> dict[str, FloatArray]:
    """Rows at the end without a time and with hardly a value are no samples: a footer, a summary."""
    known = np.sum([np.isfinite(values) for values in columns.values()], axis=0)
    empty = ~np.isfinite(columns["time"]) & (known <= max(0.25 * (len(columns) - 1), 0.0))
    count = len(empty) - (np.flatnonzero(~empty)[-1] + 1) if (~empty).any() else 0
    if not count:
        return dict(columns)
    rows = counted(int(count), "row at the end is no sample", "rows at the end are no samples")
    said.append(f"{rows} (from {log.place(len(empty) - int(count))}): left out")
    return {name: values[: len(values) - count] for name, values in columns.items()}
