"""Which column of a log is its time: row numbers and times of day without colons were taken for seconds."""

import numpy as np
import pytest
from importing.logs import example, rows_of, write_text

from winch_friction.cli.main import run
from winch_friction.importing.log import LogColumn
from winch_friction.importing.propose import propose
from winch_friction.importing.time_base import TimeBase, guess_time, to_seconds
from winch_friction.importing.time_numbers import clock_of_numbers, counts_rows, is_clock, seconds_of_one
from winch_friction.physics.errors import InputError
from winch_friction.records.runs import read_run

CLOCK = 36_000.0 + np.arange(58.0, 63.0, 0.02)


def as_number(seconds):
    """A time of day as one number, 100058.02."""
    hours, rest = np.divmod(np.round(seconds, 2), 3600.0)
    minutes, rest = np.divmod(rest, 60.0)
    return np.round(10_000 * hours + 100 * minutes + rest, 2)


@pytest.fixture
def typed(tmp_path, capsys):
    """A log whose columns of time are given; what `import` answered: the status, and what it said."""
    rows = [row[1:] for row in rows_of(example("test_02"))]

    def ask(*columns, settings=()):
        table = [[*(each[k] for each in columns), *row] for k, row in enumerate(rows)]
        log = write_text(tmp_path / "log.csv", table)
        where = ["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs")]
        where += [*(x for s in settings for x in ("--set", s)), "--overwrite"]
        done = run([*where, "--propose", "--crane", "crane_150t"]) or run(where)
        return done, capsys.readouterr()

    ask.count = len(rows) - 1
    return ask


def test_a_column_that_counts_rows_is_asked_for_its_rate(typed, tmp_path):
    """50 rows a second became one: every acceleration a fiftieth."""
    numbers = ["Sample", *map(str, range(typed.count))]
    status, said = typed(numbers)
    assert status == 2
    assert "'Sample' rises by 1 from row to row" in said.err
    assert "--set 'time.unit=20 ms'" in said.err
    assert typed(numbers, settings=["time.unit=20 ms"])[0] == 0
    back = read_run(tmp_path / "runs" / "log.csv")
    assert np.diff(back.time) == pytest.approx(0.02)


def test_whole_seconds_under_the_name_of_a_time_are_seconds(typed):
    said = typed(["Zeit", *map(str, range(typed.count))])[1]
    assert "a step of 1 is taken for seconds" in said.out
    assert "count rows" not in said.err


@pytest.mark.parametrize(("unit", "seconds"), [("20 ms", 0.02), ("ms", 1e-3), ("0.5", 0.5), ("2 min", 120.0)])
def test_the_time_of_a_row_is_a_number_and_a_unit(unit, seconds):
    assert seconds_of_one(unit, "log") == pytest.approx(seconds)


@pytest.mark.parametrize("unit", ["0 s", "-1 s", "nan s", "inf s", "20 kg", "kg"])
def test_what_is_no_time_of_a_row_is_refused(unit):
    with pytest.raises(InputError, match="log"):
        seconds_of_one(unit, "log")


def test_times_of_day_as_one_number_are_no_seconds():
    """Each minute's end was a gap of 40 s."""
    numbers = as_number(CLOCK)
    assert is_clock(numbers)
    assert clock_of_numbers(numbers) == pytest.approx(CLOCK)
    guess = guess_time([LogColumn("Time", numbers)], "")
    assert guess is not None
    assert guess.base == TimeBase("clock")
    assert to_seconds([LogColumn("Time", numbers)], guess.base, "log", str) == pytest.approx(CLOCK)


def test_a_midnight_in_numbers_is_gone_over():
    numbers = np.array([235958.0, 235959.0, 0.0, 1.0])
    found = to_seconds([LogColumn("Time", numbers)], TimeBase("clock"), "log", str)
    assert np.diff(found) == pytest.approx(1.0)


@pytest.mark.parametrize(
    "values",
    [CLOCK, np.arange(0.0, 50.0), np.arange(0.0, 300.0, 0.5), 100.0 * np.arange(50.0), as_number(CLOCK)[:90]],
    ids=["seconds", "short", "minutes", "hundreds", "no minute's end"],
)
def test_seconds_are_no_times_of_day(values):
    assert not is_clock(values)


def test_only_whole_steps_of_one_count_rows():
    assert counts_rows(np.arange(5.0, 20.0))
    assert not counts_rows(np.arange(0.5, 20.0))
    assert not counts_rows(np.arange(0.0, 20.0, 2.0))


def stamps(count, form):
    return [form.format(k // 3000, k // 50 % 60, k % 50 * 20) for k in range(count)]


def test_a_date_beside_the_clock_dates_the_run_although_day_and_month_are_open(typed, tmp_path):
    """The date was left aside, and the run began in 1970."""
    count = typed.count
    status, said = typed(["Date", *["03/01/2026"] * count], ["Time", *stamps(count, "10:{:02}:{:02}.{:03}")])
    assert status == 0, said.err
    assert "day or month first is open" in said.out
    assert read_run(tmp_path / "runs" / "log.csv").time[0] > 1.7e9


def test_a_column_of_remarks_is_no_part_of_the_time(typed):
    """`Zeitstempel + Bemerkung` was proposed, and the first remark was no time."""
    count, cells = typed.count, [""] * typed.count
    cells[count // 3] = "Start; gut"
    dated = stamps(count, "01.03.2026 10:{:02}:{:02},{:03}")
    status, said = typed(["Zeitstempel", *dated], ["Bemerkung", *cells])
    assert status == 0, said.err
    assert "time <- Zeitstempel (datetime)" in said.out


def test_times_that_no_form_reads_are_shown(typed):
    cells = stamps(typed.count, "Sun Mar 01 10:{:02}:{:02}.{:03} 2026")
    status, said = typed(["Time", *cells])
    assert status == 2
    assert "time <- no column found" in said.out
    assert "the cells of 'Time', such as 'Sun Mar 01 10:00:00.000 2026'" in said.err


def test_two_recordings_in_the_wrong_order_are_told_by_their_line(typed):
    """No column of times was said to be found."""
    half = typed.count // 2
    late, soon = stamps(typed.count - half, "11:{:02}:{:02}.{:03}"), stamps(half, "10:{:02}:{:02}.{:03}")
    status, said = typed(["Time", *(f"2026-03-01T{each}" for each in [*late, *soon])])
    assert status == 2
    assert "'Time' goes back by" in said.err
    assert f"at line {typed.count - half + 2}:" in said.err


def two_clocks(tmp_path, second, name):
    """A log with another clock beside its own: what `second` makes of the seconds since the first row."""
    run = example("test_02")
    told = [name, *(second(each) for each in run.time - run.time[0])]
    return write_text(
        tmp_path / "log.csv", [[*row, each] for row, each in zip(rows_of(run, decimal="."), told, strict=True)]
    )


@pytest.mark.parametrize(
    ("second", "name"),
    [
        (lambda s: f"{5.0 + 1.02 * s:.3f}", "time_plc [s]"),
        (lambda s: f"{1500.0 * s:.0f}", "PLC-Zeit [ms]"),
    ],
)
def test_two_times_that_differ_are_asked_about(second, name, tmp_path, crane_150t):
    """One of them was taken without a word: accelerations and delays by the other clock."""
    log = two_clocks(tmp_path, second, name)
    found = propose([log], crane_150t, "crane_150t")
    (asked,) = [each for each in found.problems if "tell two times" in each]
    assert name in asked
    assert "--set time.from=COLUMN" in asked
    assert "two tables side by side" in asked
    answered = propose([log], crane_150t, "crane_150t", ("time.from=Zeit",))
    assert not [each for each in answered.problems if "tell two times" in each]


@pytest.mark.parametrize(
    ("second", "name"),
    [
        (lambda s: f"{7000 + 1000 * s:.0f}", "PLC-Zeit [ms]"),
        (lambda s: f"{np.floor(0.04 + s):.0f}", "time_plc [s]"),
        (lambda s: f"{1.0 + 1.0001 * s:.6f}", "time_plc [s]"),
    ],
)
def test_two_times_that_agree_are_one(second, name, tmp_path, crane_150t):
    """Another origin, whole seconds, a quartz that is a tenth of a per mille off."""
    found = propose([two_clocks(tmp_path, second, name)], crane_150t, "crane_150t")
    assert not [each for each in found.problems if "tell two times" in each]


def test_a_clock_beside_the_time_may_have_cells_that_tell_none(tmp_path, crane_150t):
    """It is only held against the one that is taken."""
    second = lambda s: "read error" if 2.0 < s < 2.1 else f"2026-03-01 10:{int(s) // 60:02d}:{s % 60.0:06.3f}"
    log = two_clocks(tmp_path, second, "time_plc")
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:400]))
    found = propose([log], crane_150t, "crane_150t", ("time.from=Zeit",))
    assert found.log_map.time_from == ("Zeit",)


ZEIT = 1_772_359_200.0  # s since 1970 of the example's first row


def beside_each_other(tmp_path, second):
    """Two tables side by side: behind the second clock stand the pressures."""
    run = example("test_02")
    rows = rows_of(run, decimal=".")
    told = ["unix time [s]", *(second(each) for each in run.time - run.time[0])]
    half = len(rows[0]) // 2
    table = [[*row[:half], each, *row[half:]] for row, each in zip(rows, told, strict=True)]
    return write_text(tmp_path / "log.csv", table)


def test_a_second_table_whose_clock_has_another_origin_is_asked_about(tmp_path, crane_150t):
    """Its columns were taken to be of the first clock's instants, without a word."""
    log = beside_each_other(tmp_path, lambda s: f"{ZEIT + s + 1.4:.3f}")
    found = propose([log], crane_150t, "crane_150t")
    (asked,) = [each for each in found.problems if "two tables side by side" in each]
    assert "'unix time [s]' stands 1.4" in asked
    assert "s later than 'Zeit' in every row" in asked
    answered = propose([log], crane_150t, "crane_150t", ("time.from=Zeit",))
    assert not answered.problems


@pytest.mark.parametrize("second", [lambda s: f"{ZEIT + s:.3f}", lambda s: f"{ZEIT + s + 0.02:.3f}"])
def test_a_second_table_of_the_same_clock_is_none(second, tmp_path, crane_150t):
    found = propose([beside_each_other(tmp_path, second)], crane_150t, "crane_150t")
    assert not [each for each in (*found.problems, *found.notes) if "unix" in each and "stands" in each]


def test_another_origin_of_the_same_kind_is_said(tmp_path, crane_150t):
    log = two_clocks(tmp_path, lambda s: f"{ZEIT + 7.0 + s:.3f}", "unix time [s]")
    found = propose([log], crane_150t, "crane_150t")
    (said,) = [each for each in found.notes if "unix time" in each]
    assert "stands 7 s later than 'Zeit' in every row; 'Zeit' is taken" in said
    assert not found.problems


def test_a_date_beside_seconds_from_the_start_needs_no_word(tmp_path, crane_150t):
    found = propose([two_clocks(tmp_path, lambda s: f"{s + 7.0:.3f}", "time_plc [s]")], crane_150t, "crane_150t")
    assert not found.problems
    assert not [each for each in found.notes if "stands" in each]
