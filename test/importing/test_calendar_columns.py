"""Times whose parts stand in columns of their own: the seconds alone were taken, or a run became 60 us long."""

import numpy as np
import pytest
from importing.logs import example, rows_of, write_text

from winch_friction.cli.main import run
from winch_friction.importing.calendar_columns import calendar_columns, calendar_seconds
from winch_friction.importing.log import LogColumn
from winch_friction.importing.time_base import TimeBase, guess_time, to_seconds
from winch_friction.physics.errors import InputError
from winch_friction.records.runs import read_run

BEGIN = 1_772_359_150.0  # 2026-03-01 09:59:10 UTC
CLOCK = BEGIN % 86_400.0


def parts_of(seconds):
    """Year, month, day, hour, minute and second of Unix times, each a list of texts."""
    stamps = (np.round(np.asarray(seconds) * 1e3)).astype("datetime64[ms]")
    texts = [str(each) for each in stamps]
    return [[t[a:b].lstrip("0") or "0" for t in texts] for a, b in ((0, 4), (5, 7), (8, 10), (11, 13), (14, 16))] + [
        [t[17:23] for t in texts]
    ]


def columns_of(names, seconds):
    return [LogColumn(n, np.array(list(map(float, cells)))) for n, cells in zip(names, parts_of(seconds), strict=True)]


@pytest.mark.parametrize(
    "names",
    [
        ("Year", "Month", "Day", "Hour", "Minute", "Second"),
        ("Jahr", "Monat", "Tag", "Stunde", "Minute", "Sekunde [s]"),
        ("år", "måned", "dag", "time", "minutt", "sekund"),
        ("YYYY", "Mon", "DD", "hh", "mi", "ss"),
    ],
)
def test_a_column_for_each_part_is_one_time(names):
    seconds = BEGIN + np.arange(0.0, 200.0, 0.02)
    found = calendar_columns([LogColumn("Speed", np.ones(len(seconds))), *columns_of(names, seconds)])
    assert [c.name for c in found] == list(names)
    guess = guess_time(found, "")
    assert guess is not None
    assert guess.base == TimeBase("parts", zone="UTC")
    assert to_seconds(found, guess.base, "log", str) == pytest.approx(seconds, abs=1e-3)


def test_a_log_with_its_time_in_seven_columns_is_imported(tmp_path, capsys):
    """The ms apart, the seconds whole: of six columns one was taken, and 3000 rows became 60 us."""
    rows = rows_of(example("test_02"))
    base = example("test_02").time
    *parts, second = parts_of(BEGIN + base)
    cut = [[s[:2] for s in second], [s[3:6] for s in second]]
    heads = ["Jahr", "Monat", "Tag", "Stunde", "Minute", "Sekunde", "ms"]
    times = [heads, *zip(*parts, *cut, strict=True)]
    log = write_text(tmp_path / "log.csv", [[*t, *row[1:]] for t, row in zip(times, rows, strict=True)])
    where = ["import", str(log), "--map", str(tmp_path / "map.yaml"), "--out", str(tmp_path / "runs")]
    assert run([*where, "--propose", "--crane", "crane_150t"]) == 0, capsys.readouterr().err
    assert run(where) == 0, capsys.readouterr().err
    assert read_run(tmp_path / "runs" / "log.csv").time == pytest.approx(BEGIN + base, abs=1.1e-3)


def test_a_time_of_day_in_three_columns_goes_over_midnight():
    seconds = 86_400.0 - 30.0 + np.arange(0.0, 60.0, 0.5)
    found = calendar_columns(columns_of(("y", "m", "d", "Hour", "Minute", "Second"), seconds)[3:])
    guess = guess_time(found, "")
    assert guess is not None
    assert to_seconds(found, guess.base, "log", str) == pytest.approx(seconds, abs=1e-3)


def test_a_zone_dates_the_parts_as_it_dates_a_text():
    names = ("Year", "Month", "Day", "Hour", "Minute", "Second")
    columns = columns_of(names, BEGIN + np.arange(0.0, 10.0))
    at = to_seconds(columns, TimeBase("parts", zone="Europe/Oslo"), "log", str)
    assert at == pytest.approx(BEGIN - 3600.0 + np.arange(0.0, 10.0))


def test_years_of_two_digits_are_of_the_last_century_or_of_this_one():
    names = ("Year", "Month", "Day", "Hour", "Minute", "Second")
    _, *others = columns_of(names, BEGIN + np.arange(2.0))
    short = LogColumn("Year", np.array([26.0, 71.0]))
    found = calendar_seconds([short, *others], "log")
    assert found[0] == pytest.approx(BEGIN)
    assert found[1] == pytest.approx(np.datetime64("1971-03-01T09:59:11").astype(float))


def test_columns_that_cannot_be_such_parts_are_none():
    seconds = BEGIN + np.arange(0.0, 10.0)
    hour, minute, second = columns_of(("a", "b", "c", "Hour", "Minute", "Second"), seconds)[3:]
    assert calendar_columns([hour, minute, second])
    assert calendar_columns([hour, minute]) == ()
    assert calendar_columns([hour, minute, second, second]) == ()
    assert calendar_columns([LogColumn("Hour", hour.values + 20.0), minute, second]) == ()
    assert calendar_columns([LogColumn("Hour", hour.values + 0.5), minute, second]) == ()


@pytest.mark.parametrize("count", [1, 2, 4, 5])
def test_another_number_of_parts_is_refused(count):
    columns = columns_of(("Year", "Month", "Day", "Hour", "Minute", "Second"), BEGIN + np.arange(3.0))
    with pytest.raises(InputError, match=f"found {count}"):
        calendar_seconds(columns[:count], "log: time")


def test_parts_that_make_no_date_are_refused():
    columns = columns_of(("Year", "Month", "Day", "Hour", "Minute", "Second"), BEGIN + np.arange(3.0))
    wrong = [columns[0], LogColumn("Month", np.full(3, 2.0)), LogColumn("Day", np.full(3, 31.0)), *columns[3:]]
    with pytest.raises(InputError, match=r"log: time: time\.from: the parts make no date"):
        calendar_seconds(wrong, "log: time")


def test_whole_seconds_that_rows_share_are_seconds_without_a_unit():
    """The usual step between two rows is nothing: it was taken for us, and an hour for 4 ms."""
    guess = guess_time([LogColumn("Time", np.floor(np.arange(0.0, 60.0, 0.02)))], "")
    assert guess is not None
    assert guess.base == TimeBase("seconds", "s", spread=True)


def test_an_hour_that_parts_have_twice_is_asked_about():
    seconds = np.concatenate([BEGIN + np.arange(0.0, 20.0), BEGIN - 3580.0 + np.arange(0.0, 20.0)])
    guess = guess_time(columns_of(("Year", "Month", "Day", "Hour", "Minute", "Second"), seconds), "")
    assert guess is not None
    assert "goes back by an hour at row 21: the end of summer time?" in guess.question
