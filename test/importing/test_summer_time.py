"""Local times of the nights in which clocks are changed, and cells that hold no time."""

import datetime as dt
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from logs import example, rows_of, write_text

from winch_friction.cli.main import run
from winch_friction.importing.log import LogColumn
from winch_friction.importing.time_base import TimeBase, guess_time, to_seconds
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import read_run

AUTUMN = dt.datetime(2026, 10, 25, 0, 59, 50, tzinfo=dt.UTC)  # ten seconds before clocks go back from 3 to 2 in Oslo
LATER = AUTUMN + dt.timedelta(seconds=3590)
SPRING = dt.datetime(2026, 3, 29, 0, 59, 50, tzinfo=dt.UTC)
OSLO = TimeBase("datetime", order="ymd", zone="Europe/Oslo")


def local(start, seconds, zone="Europe/Oslo"):
    times = [(start + dt.timedelta(seconds=float(s))).astimezone(ZoneInfo(zone)) for s in seconds]
    cells = [each.replace(tzinfo=None).isoformat(timespec="milliseconds") for each in times]
    return LogColumn("Zeit", np.full(len(cells), np.nan), text=np.array(cells, dtype=object))


@pytest.mark.parametrize("start", [AUTUMN, SPRING, LATER, AUTUMN - dt.timedelta(days=1)])
@pytest.mark.parametrize("length", [5.0, 20.0, 3700.0])
def test_a_log_through_the_change_of_clocks_loses_no_hour(start, length):
    given = np.arange(0.0, length, 0.5)
    found = to_seconds([local(start, given)], OSLO, "log", str)
    np.testing.assert_allclose(np.diff(found), 0.5, atol=2e-3)
    if start != LATER:  # nothing tells the second of two equal hours from the first
        np.testing.assert_allclose(found, start.timestamp() + given, atol=2e-3)


def test_a_logger_that_is_not_changed_over_keeps_the_zone_that_it_began_with():
    given = np.arange(0.0, 20.0, 0.5)
    cells = [(dt.datetime(2026, 10, 25, 2, 59, 50) + dt.timedelta(seconds=s)).isoformat() for s in given]
    column = LogColumn("Zeit", np.full(len(cells), np.nan), text=np.array(cells, dtype=object))
    found = to_seconds([column], OSLO, "log", str)
    np.testing.assert_allclose(np.diff(found), 0.5)


def test_an_hour_back_is_asked_about():
    guess = guess_time([local(AUTUMN, np.arange(0.0, 20.0, 0.5))], "")
    assert guess is not None
    assert "goes back by an hour at row 21: the end of summer time? set time.zone" in guess.question


def test_a_log_of_that_night_is_imported_by_the_answer(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rows = rows_of(example("test_01"))
    times = np.arange(len(rows) - 1) * 0.02
    for row, cell in zip(rows[1:], local(AUTUMN, times).text, strict=True):
        row[0] = cell
    write_text(tmp_path / "nacht.csv", rows)
    assert run(["import", "nacht.csv", "--propose", "--crane", "crane_150t", "--map", "m.yaml"]) == 2
    assert "end of summer time?" in capsys.readouterr().err
    answer = ["--set", "time.zone=Europe/Oslo"]
    assert run(["import", "nacht.csv", "--map", "m.yaml", "--out", "runs", *answer]) == 0
    imported = read_run(tmp_path / "runs" / "nacht.csv", load_crane("crane_150t"))
    np.testing.assert_allclose(np.diff(imported.time), 0.02, atol=2e-3)


def test_a_timestamp_that_is_missing_is_no_time():
    stamps = np.array(["2026-03-01T10:00:00", "NaT", "2026-03-01T10:00:02"], dtype="datetime64[ns]")
    column = LogColumn("time", np.full(3, np.nan), text=stamps)
    found = to_seconds([column], TimeBase("datetime", order="ymd"), "log", str)
    assert np.isnan(found[1])
    assert found[2] - found[0] == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("start", "zone", "asked"),
    [
        (SPRING, "Europe/Oslo", True),
        (dt.datetime(2026, 3, 8, 6, 59, 50, tzinfo=dt.UTC), "America/New_York", True),
        (SPRING, "UTC", False),
        (SPRING - dt.timedelta(hours=12), "Asia/Dubai", False),
    ],
)
def test_an_hour_that_lacks_in_the_night_of_the_change_is_asked_for_its_zone(start, zone, asked):
    guess = guess_time([local(start, np.arange(0.0, 20.0, 0.5), zone)], "")
    assert ("leaps by an hour at row 21, in the small hours of a Sunday" in guess.question) == asked


@pytest.mark.parametrize(("day", "hour", "asked"), [(29, 1, True), (28, 1, False), (29, 9, False)])
def test_a_logger_that_rested_for_an_hour_at_another_time_is_not(day, hour, asked):
    begin = dt.datetime(2026, 3, day, hour, 59, 50, tzinfo=dt.UTC)
    given = np.concatenate([np.arange(0.0, 10.0, 0.5), np.arange(3610.0, 3620.0, 0.5)])
    assert bool(guess_time([local(begin, given, "UTC")], "").question) == asked


def test_a_later_log_that_goes_back_by_an_hour_is_told_of_summer_time(crane_150t):
    """Only the first log of a set was asked; of another "several recordings in one file?" was said."""
    from winch_friction.importing.contradiction import contradictions

    time = np.concatenate([np.arange(0.0, 10.0, 0.5), np.arange(-3590.0, -3580.0, 0.5)])
    (said,) = contradictions({"b.csv": {"time": time}}, crane_150t)
    assert "b.csv: time goes back by an hour after sample 20: the end of summer time? --set time.zone=" in said
    (said,) = contradictions({"b.csv": {"time": time % 10.0}}, crane_150t)
    assert "several recordings in one file?" in said
