"""CSV and Parquet run files: units, round trips, and one clear line for whatever is wrong."""

import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from run_strategies import make_run, runs, same

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.parquet_file import _doubles
from winch_friction.records.runs import read_run, read_runs, write_run

FEW = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
HEADER = (
    "time [ms],motor_speed [rpm],main.pressure_a [bar],main.pressure_b [MPa],main.displacement [cm^3/rev],"
    "hook_load [t],oil_temperature [degF]\n"
)
TABLE = HEADER + "0,60,210,2.5,215,55,104\n20,-60,211,2.5,215,55,104\n2000,120,212,2.5,215,55,104\n"
NO_SPEED = TABLE.replace("60,", ",").replace("-,", ",").replace("120,", ",")


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@FEW
@given(run=runs)
def test_a_run_comes_back_bit_for_bit(tmp_path, suffix, run):
    back = read_run(write_run(run, tmp_path / f"run{suffix}"))
    assert same(run, back)
    assert back.name == f"run{suffix}"


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_not_a_number_and_unknown_columns_come_back_and_are_said(tmp_path, suffix):
    run = make_run()
    holed = {**run.columns, "hook_load": np.where(np.arange(60) % 20 == 3, np.nan, run["hook_load"])}
    aside = {"operator": np.array(["ann", "bob"] * 30, dtype=object), "cabin noise [dB]": np.linspace(60, 70, 60)}
    back = read_run(write_run(Run("x", holed, aside=aside), tmp_path / f"run{suffix}"))
    assert same(Run("x", holed), back)
    assert list(back.aside["operator"][:2]) == ["ann", "bob"]
    np.testing.assert_array_equal(back.aside["cabin noise [dB]"], aside["cabin noise [dB]"])
    said = "\n".join(back.warnings)
    assert "unknown columns kept aside: operator, cabin noise [dB]" in said
    assert "column 'hook_load': 3 of 60 values are not numbers" in said
    assert ("line 5" if suffix == ".csv" else "row 4") in said


def test_an_unknown_column_with_underscores_stays_text(tmp_path):
    run = read_run(table(tmp_path, "time,motor_speed,motor_torque,batch\n0,1,2,1_000\n1,1,2,1_001\n"))
    assert list(run.aside["batch"]) == ["1_000", "1_001"]


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
@pytest.mark.parametrize("header", ["", " [bar]"])
def test_a_column_without_a_name_is_named_by_its_place(tmp_path, suffix, header):
    run = make_run()
    path = write_run(
        Run("x", run.columns, aside={"odd": np.arange(60), header: np.arange(60)}), tmp_path / f"x{suffix}"
    )
    place = len(run.columns) + 2
    assert [each for each in read_run(path).warnings if "aside" in each] == [
        f"x{suffix}: column {place} has no name and is kept aside",
        f"x{suffix}: unknown columns kept aside: odd",
    ]


def test_columns_without_a_name_are_named_by_their_places(tmp_path):
    path = table(tmp_path, "time,,motor_speed,motor_torque,\n0,1,2,3,\n1,1,2,3,\n")
    with pytest.raises(InputError) as caught:
        read_run(path)
    assert str(caught.value) == f"{path}: columns 2 and 5 have no name; name them in the header, or take them out"


def test_metadata_travels_in_parquet(tmp_path):
    run = Run("x", make_run().columns, metadata={"seed": 7, "scenario": "splash"})
    assert read_run(write_run(run, tmp_path / "x.parquet")).metadata == {"seed": 7, "scenario": "splash"}


def table(tmp_path, text, name="log.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_units_become_si(tmp_path):
    run = read_run(table(tmp_path, TABLE))
    assert run.time == pytest.approx([0.0, 0.02, 2.0])
    assert run["motor_speed"] == pytest.approx([2 * math.pi, -2 * math.pi, 4 * math.pi])
    assert run["main.pressure_a"] == pytest.approx([2.10e7, 2.11e7, 2.12e7])
    assert run["main.pressure_b"] == pytest.approx([2.5e6] * 3)
    assert run["main.displacement"] == pytest.approx([215e-6 / (2 * math.pi)] * 3)
    assert run["hook_load"] == pytest.approx([55e3] * 3)
    assert run["oil_temperature"] == pytest.approx([40.0] * 3)


@pytest.mark.parametrize(("separator", "mark", "end"), [(";", "", "\r\n"), ("\t", "\ufeff", "\n"), (",", "", "\n\n\n")])
def test_other_separators_line_ends_and_a_byte_order_mark(tmp_path, separator, mark, end):
    text = TABLE.replace(",", separator).replace("\n", "\r\n" if end == "\r\n" else "\n")
    run = read_run(table(tmp_path, mark + text + end))
    assert len(run) == 3
    assert run["hook_load"] == pytest.approx([55e3] * 3)


def test_drum_speed_is_converted_by_the_gear(tmp_path):
    path = table(tmp_path, TABLE.replace("motor_speed", "drum_speed"))
    run = read_run(path, load_crane("crane_150t"))
    assert run["motor_speed"] == pytest.approx(250 * np.array([1, -1, 2]) * 2 * math.pi)
    with pytest.raises(InputError, match="gear ratio"):
        read_run(path)


def changed(line, old, new):
    lines = TABLE.splitlines()
    lines[line - 1] = lines[line - 1].replace(old, new)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "empty"),
        ("\n\n", "empty"),
        ("time,motor_speed,motor_torque\n", "no rows under the header; a run needs at least two"),
        ("time,motor_speed,motor_torque\n0,1,2\n", "1 row is too few"),
        (changed(1, "[rpm]", "[bar]"), "'motor_speed [bar]': unit 'bar' cannot be read as rad/s, e.g. 'rpm'"),
        (changed(1, "[rpm]", "[Hz]"), "unit 'Hz'"),
        (changed(1, "[cm^3/rev]", "[cm^3]"), "unit 'cm^3' cannot be read as m^3/rad, e.g. 'cm^3/rev'"),
        (changed(1, "[rpm]", "[furlong)"), "bracket"),
        (changed(1, "[bar]", "[bart]"), "unit 'bart'"),
        (changed(1, "[t]", "[kN]"), "unit 'kN'"),
        (changed(1, "motor_speed [rpm]", "speed"), "'motor_speed' (or 'drum_speed') is missing"),
        (changed(1, "time [ms]", "t"), "column 'time' is missing"),
        ("Zeit;Drehzahl\n1;2\n2;2\n", "is missing; found no known column; a log with names of its own becomes a run"),
        (changed(1, "hook_load [t]", "motor_speed"), "column 'motor_speed' stands twice"),
        (changed(1, "main.displacement [cm^3/rev]", "displacement"), "group 'main' lacks main.displacement"),
        (changed(3, ",55,", ",55,55,"), "line 3: 8 values for 7 columns"),
        (changed(3, ",55,", ","), "line 3: 6 values for 7 columns"),
        (changed(3, "20,-60", "20,fast"), "line 3, column 'motor_speed [rpm]': 'fast' is not a number"),
        (changed(3, "20,", ","), "line 3, column 'time': no time"),
        (changed(4, "2000,", "10,"), "line 4, column 'time': time goes back by 0.01 s, from 0.02 s to 0.01 s;"),
        (NO_SPEED, "column 'motor_speed' is there but holds no number; it is required"),
        (NO_SPEED.replace(",motor", ",drum"), "column 'drum_speed' is there but holds no number; it is required"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_in_one_line(tmp_path, text, said):
    with pytest.raises(InputError) as caught:
        read_run(table(tmp_path, text))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    assert "log.csv" in str(caught.value)


HEADER_LACKS = "time,motor_speed,main.pressure_a,main.pressure_b\n0,1,,2e6\n1,1,,2e6\n"


@pytest.mark.parametrize(
    ("text", "crane", "said"),
    [
        (HEADER, "crane_150t", ["log.csv: no rows under the header; a run needs at least two"]),
        (
            HEADER_LACKS,
            "crane_150t",
            [
                "log.csv: column 'main.pressure_a' is there but holds no number; it is required: fill it in",
                "log.csv: motor group 'main' lacks main.displacement: add the column, or name it so",
            ],
        ),
        (
            "time,motor_speed,main.pressure_a,main.pressure_b,main.displacement\n0,1,,,\n1,1,,,\n",
            "crane_150t",
            [
                f"log.csv: column 'main.{each}' is there but holds no number; it is required: fill it in"
                for each in ("pressure_a", "pressure_b", "displacement")
            ],
        ),
        (
            "time,motor_speed,motor_torque\n0,1,\n1,1,\n",
            "emps",
            ["log.csv: column 'motor_torque' is there but holds no number; it is required: fill it in"],
        ),
        (
            "time,motor_speed,main.pressure_a\n0,1,\n1,1,\n",
            "",
            ["log.csv: column 'main.pressure_a' is there but holds no number; it is required: fill it in"],
        ),
    ],
)
def test_a_column_without_numbers_is_empty_and_not_missing(tmp_path, text, crane, said):
    with pytest.raises(InputError) as caught:
        read_run(table(tmp_path, text), load_crane(crane) if crane else None)
    # by its path, for two folders may hold a log.csv; its name is what the run is called
    assert list(caught.value.problems) == [f"{tmp_path}/{each}" for each in said]


@pytest.mark.parametrize(
    ("text", "crane"),
    [
        ("time,motor_speed,motor_torque,main.pressure_a\n0,1,2,\n1,1,2,\n", "emps"),
        (
            "time,motor_speed,main.pressure_a,main.pressure_b,main.displacement,aft.pressure_a\n"
            "0,1,2e7,2e6,3e-5,\n1,1,2e7,2e6,3e-5,\n",
            "",
        ),
    ],
)
def test_an_empty_pressure_of_what_does_not_drive_is_no_obstacle(tmp_path, text, crane):
    run = read_run(table(tmp_path, text), load_crane(crane) if crane else None)
    assert len(run) == 2


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        (
            TABLE.replace(",", ";").replace(";55;", ";55,5;"),
            "column 'hook_load [t]' (as '55,5', line 2); winch-friction import",
        ),
        ("time;motor_speed;motor_torque\n10:00:00;1;2\n10:00:01;1;2\n", "'10:00:00' is not a number; winch-friction"),
        (changed(3, "20,-60", "20,fast"), "'fast' is not a number; leave the cell empty if unknown"),
        (changed(4, "2000,", "2_000,"), "line 4, column 'time [ms]': '2_000' is not a number; write it without '_'"),
    ],
)
def test_numbers_that_are_written_in_another_way_are_for_import(tmp_path, text, advice):
    with pytest.raises(InputError) as caught:
        read_run(table(tmp_path, text))
    assert advice in str(caught.value)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".mcap", ".db3", ".txt"])
@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n\0\0\xff\xfe garbage" * 50, b"a\0b,c\n1,2\n"])
def test_binary_garbage_is_refused(tmp_path, suffix, content):
    path = tmp_path / f"log{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_run(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_rows_that_share_a_tick_are_told_what_spreads_them(tmp_path):
    """A clock of whole seconds under a log of 50 Hz: 4880 of 4980 rows were left out, and no more was said."""
    head = "time [s],motor_speed [rad/s],main.pressure_a [Pa],main.pressure_b [Pa],main.displacement [m^3/rad]\n"
    path = tmp_path / "ticks.csv"
    path.write_text(head + "".join(f"{k // 50},{k},2e7,2e6,3e-5\n" for k in range(500)))
    assert "490 repeated times left out, line 3" in read_run(path).warnings[0]
    assert read_run(path).warnings[0].endswith("; winch-friction import spreads rows that share a tick")


def test_repeated_times_gaps_and_short_runs_are_warned_of(tmp_path):
    rows = [f"{t},1,2" for t in (0, 0.02, 0.02, 0.04, 0.06, 0.08, 0.5, 0.52)]
    run = read_run(table(tmp_path, "\n".join(["time,motor_speed,motor_torque", *rows])))
    assert len(run) == 7
    assert "1 repeated time left out, line 4" in run.warnings[0]
    assert "1 gap (widest 0.42 s, usual step 0.02 s), before line 8" in run.warnings[1]
    assert "only 0.52 s long" in run.warnings[2]


def test_an_infinite_value_is_kept_as_none_and_said_by_line(tmp_path):
    rows = [f"{0.02 * k:g},1,{'inf' if k == 3 else '-inf' if k == 5 else 2}" for k in range(80)]
    run = read_run(table(tmp_path, "\n".join(["time,motor_speed,motor_torque", *rows])))
    assert np.flatnonzero(np.isnan(run["motor_torque"])).tolist() == [3, 5]
    assert np.nanmax(np.abs(run["motor_torque"])) == 2.0
    assert "'motor_torque': 2 of 80 values are not numbers, line 5, line 7" in run.warnings[0]


def test_the_crane_decides_what_is_required(tmp_path):
    path = table(tmp_path, TABLE)
    with pytest.raises(InputError, match="'motor_torque'"):
        read_run(path, load_crane("emps"))
    with pytest.raises(InputError, match="no motor group 'aft'"):
        read_run(table(tmp_path, TABLE.replace("main.", "aft."), "b.csv"), load_crane("crane_150t"))
    electric = table(tmp_path, "time,motor_speed,motor_torque\n0,1,2\n1,1,2\n", "c.csv")
    with pytest.raises(InputError, match="no motor group"):
        read_run(electric, load_crane("crane_150t"))
    assert read_run(electric, load_crane("emps"))["motor_torque"] == pytest.approx([2.0, 2.0])


def test_two_runs_of_one_name_are_refused(tmp_path):
    for folder in ("a", "b"):
        write_run(make_run(), tmp_path / folder / "x.csv")
    with pytest.raises(InputError, match="two runs"):
        read_runs([tmp_path / "a" / "x.csv", tmp_path / "b" / "x.csv"])


def test_a_failed_write_leaves_the_good_file(tmp_path):
    path = write_run(make_run(), tmp_path / "x.parquet")
    before = path.read_bytes()
    with pytest.raises(Exception):  # noqa: B017
        write_run(Run("x", make_run().columns, aside={"odd": np.arange(3)}), path)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["x.parquet"]


def test_doubles_of_a_sliced_column_in_chunks_are_its_values():
    pyarrow = pytest.importorskip("pyarrow")
    values = [0.0, -0.0, float("nan"), float("inf"), *np.random.default_rng(0).normal(size=20).tolist()]
    column = pyarrow.chunked_array([values[:7], [], values[7:]]).slice(2, 15)
    ours = _doubles(column)
    assert ours.tobytes() == np.array(values[2:17]).tobytes()
    assert ours.flags.writeable
    assert len(_doubles(pyarrow.chunked_array([], pyarrow.float64()))) == 0


def test_a_parquet_run_is_read_without_pandas(tmp_path):
    pytest.importorskip("pyarrow")
    path = write_run(make_run(), tmp_path / "x.parquet")
    program = (
        "import sys; from pathlib import Path; from winch_friction.records.runs import read_run;"
        f"read_run(Path({str(path)!r})); assert 'pandas' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_a_word_beside_a_number_with_an_underscore_gets_no_advice_of_the_other(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [s],motor_speed [rpm]\n0,1_00\n0.1,abc\n0.2,10\n")
    with pytest.raises(InputError) as refused:
        read_run(path)
    assert "'abc' is not a number" in str(refused.value)
    assert "without '_'" not in str(refused.value)
