"""Tables with a row per value become a column per signal where names, times and values are told surely."""

from pathlib import Path

import numpy as np
import pytest

from winch_friction.importing.log import Log, LogColumn, number_column
from winch_friction.importing.rows_of_values import with_column_per_signal

TIMES = {"MotorSpeed": 0.1 * np.arange(400), "PressureA": 0.3 + 0.2 * np.arange(150)}
UNITS = {"MotorSpeed": "rpm", "PressureA": "bar"}
BEGIN = np.datetime64("2026-03-01T10:00:00.000")


def texts(name: str, cells) -> LogColumn:
    return LogColumn(name, np.full(len(cells), np.nan), text=np.array(cells, dtype=object))


def table(time, value="Value", units: bool = True, more=()) -> Log:
    """A row per value, 2 t + 1 of the one signal and t of the other; two rows of the first are out of order."""
    rows = sorted((t, name) for name, times in TIMES.items() for t in times.tolist())
    rows[-6], rows[-5] = rows[-5], rows[-6]
    cells = [2.0 * t + 1.0 if name == "MotorSpeed" else t for t, name in rows]
    columns = [texts("Tag", [name for _, name in rows]), *time([t for t, _ in rows]), number_column(value, cells)]
    columns += [texts("Unit", [UNITS[name] for _, name in rows])] if units else []
    columns += [each(rows) for each in more]
    return Log(Path("log.csv"), tuple(columns), {"kind": "text"}, str)


def dates(times, unit="ms"):
    at = [BEGIN + np.timedelta64(round(1e3 * t), "ms") for t in times]
    return [texts("TimeStamp", [str(each.astype(f"datetime64[{unit}]")) for each in at])]


def days(times):
    return number_column("Time_ms", [1e6 * (46082.4 + t / 86400.0) for t in times])


def lasting(rows):
    return number_column("Index", np.arange(float(len(rows))))


KINDS = {
    "seconds": lambda times: [number_column("Time [s]", times)],
    "dates": dates,
    "dates to the second beside a finer clock": lambda times: [*dates(times, "s"), days(times)],
}


@pytest.mark.parametrize("kind", KINDS)
def test_each_signal_becomes_a_column_at_its_own_times(kind):
    log = with_column_per_signal(table(KINDS[kind]))
    assert [each.name for each in log.columns] == ["time", "MotorSpeed", "PressureA"]
    assert [each.unit for each in log.columns] == ["s", "rpm", "bar"]
    times = log.column("time").values - log.column("time").values[0]
    assert times == pytest.approx(TIMES["MotorSpeed"], abs=2e-3)
    assert log.column("MotorSpeed").values == pytest.approx(2.0 * TIMES["MotorSpeed"] + 1.0)
    pressure = log.column("PressureA").values
    assert np.isnan(pressure[:3]).all()  # nothing is known before its first value
    assert pressure[5] == pytest.approx(0.5)
    assert log.settings["clocks"] == "held"
    assert any("a row per value, of the 2 signals that 'Tag' names" in each for each in log.notes)
    assert any("UTC where no zone is given" in each for each in log.notes) is kind.startswith("dates")


def test_a_whole_columns_unit_is_each_signals_where_no_other_is_said():
    log = table(KINDS["seconds"], units=False)
    assert {each.unit for each in with_column_per_signal(log).columns[1:]} == {""}


UNTOLD = {
    "a clock too coarse for its rows": table(lambda times: dates(times, "s")),
    "a clock in ms that counts millionths of a day": table(lambda times: [days(times)]),
    "two columns of numbers, neither called a value": table(KINDS["seconds"], "X", more=[lasting]),
    "values that are no numbers": table(
        KINDS["seconds"], "X", more=[lambda rows: texts("Value", ["1,5"] * len(rows)), lasting]
    ),
    "no time": table(lambda times: []),
}


@pytest.mark.parametrize("kind", UNTOLD)
def test_what_is_not_told_surely_stays_as_it_is(kind):
    assert with_column_per_signal(UNTOLD[kind]) is UNTOLD[kind]


def test_rows_that_are_said_to_be_instants_stay_rows():
    log = table(KINDS["seconds"])
    assert with_column_per_signal(log, "one") is log
    assert with_column_per_signal(log, "lines").settings["clocks"] == "lines"
