"""Runs in and out: files, bags, pandas and xarray."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.api.arguments import checked, vacant
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.crane import Crane


@checked
def read_run(path: str | Path, crane: Crane | None = None, **bag_options: Any) -> Run:
    r"""A run in SI from .csv, .parquet, or a rosbag2 (folder, .mcap, .db3).

    The crane is needed where the file speaks of the drum or of displacement fractions. What was noticed while reading
    is in `run.warnings`. Raises `InputError` in one line with file, row and column.

    >>> import tempfile, winch_friction as wf
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = f"{folder}/test.csv"
    ...     header = "time [s],motor_speed [rpm],motor_torque [N*m]"
    ...     _ = open(path, "w").write(header + "\n0,60,5\n0.1,60,5\n0.2,60,6\n")
    ...     run = wf.read_run(path, wf.load_crane("emps"))
    >>> run["motor_speed"].round(3)
    array([6.283, 6.283, 6.283])
    """
    from winch_friction.records.runs import read_run as read

    return read(path, crane, **bag_options)


@checked
def write_run(run: Run, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a run by suffix: .csv, .parquet, .mcap, .db3 or a bag folder; atomically, SI units in the headers.

    A file that is there is replaced with `overwrite` alone, a bag never. Raises `InputError`.

    >>> import tempfile, winch_friction as wf
    >>> run = wf.from_frame({"time": [0.0, 0.1], "motor_speed [rpm]": [60.0, 90.0], "motor_torque": [5.0, 6.0]}, "a")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     wf.write_run(run, f"{folder}/a.csv").read_text().splitlines()[0]
    'time [s],motor_speed [rad/s],motor_torque [N*m]'
    """
    from winch_friction.records.runs import write_run as write

    return write(run, vacant(path, overwrite))


def from_frame(data: Any, name: str = "frame", crane: Crane | None = None) -> Run:
    """A run from a pandas DataFrame, an xarray Dataset or a mapping of columns.

    Headers may carry their unit in brackets (`motor_speed [rpm]`); otherwise the units in `data.attrs["units"]`
    (pandas) or in each variable's `attrs["units"]` (xarray) count, without them SI. The index or the coordinate is
    `time` where no column is. Unknown columns are kept aside, with a warning. Raises `InputError`.

    >>> import winch_friction as wf
    >>> run = wf.from_frame({"time": [0.0, 1.0], "motor_speed [rpm]": [0.0, 600.0], "motor_torque": [0.0, 1.0]}, "ramp")
    >>> run.to_frame()["motor_speed"].round(2).tolist(), run.to_frame().attrs["units"]["motor_speed"]
    ([0.0, 62.83], 'rad/s')
    """
    from winch_friction.records.csv_file import parse_header, said_of_nameless
    from winch_friction.records.run_checks import checked_run

    columns, aside, headers = {}, {}, []
    for text, (values, unit) in _columns(data, name).items():
        header = parse_header(text if "[" in text or unit in ("", "1") else f"{text} [{unit}]", name)
        headers.append(header)
        if header.known:
            columns[header.name] = header.to_si(_numbers(values, text, name), name)
        else:
            aside[header.text] = np.asarray(values)
    return checked_run(
        name,
        columns,
        place=lambda row: f"row {row}",
        crane=crane,
        aside=aside,
        warnings=said_of_nameless(headers, name),
    )


def _columns(data: Any, name: str) -> dict[str, tuple[Any, str]]:
    """Values and unit by header; the index or coordinate `time` first."""
    if hasattr(data, "data_vars"):  # xarray
        every = {"time": data["time"], **data.data_vars} if "time" in data.coords else dict(data.data_vars)
        return {str(key): (value.values, str(value.attrs.get("units", ""))) for key, value in every.items()}
    if hasattr(data, "iterrows"):  # pandas
        units = data.attrs.get("units", {})
        named = data.reset_index() if data.index.name and str(data.index.name).startswith("time") else data
        return {str(key): (named[key].to_numpy(), str(units.get(key, ""))) for key in named.columns}
    if isinstance(data, Mapping):
        return {str(key): (values, "") for key, values in data.items()}
    raise InputError(
        f"{name}: a {type(data).__name__} is no table; give a DataFrame, a Dataset or a mapping of columns"
    )


def _numbers(values: Any, column: str, name: str) -> Any:
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: column '{column}' holds something that is not a number ({error})") from error
