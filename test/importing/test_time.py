"""A log's time: what its cells say, in which form, and what is asked where they leave it open."""

import numpy as np
import pytest

from winch_friction.importing.cells import as_column
from winch_friction.importing.log import LogColumn
from winch_friction.importing.ticks import spread_ticks
from winch_friction.importing.time_base import TimeBase, guess_time, to_seconds
from winch_friction.importing.time_text import clock_seconds, days_since_1970, time_parts, zone_seconds
from winch_friction.physics.errors import InputError

NOON_2024 = 1_718_452_800.0  # 15 June 2024, 12:00 UTC


def texts(*cells):
    return LogColumn("t", np.full(len(cells), np.nan), text=np.array(cells, dtype=object))


def numbers(*values):
    return LogColumn("t", np.array(values, float))


def seconds(column, base):
    return to_seconds([column], base, "log", str)


@pytest.mark.parametrize(
    ("cell", "hours"),
    [("12:00:00 AM", 0.0), ("12:30:00 PM", 12.5), ("1:15:00 pm", 13.25), ("11:00:00 AM", 11.0), ("13:15:00", 13.25)],
)
def test_noon_and_midnight_are_twelve_hours_apart(cell, hours):
    assert clock_seconds(time_parts(cell)) == pytest.approx(3600.0 * hours)


@pytest.mark.parametrize(
    ("cell", "year"), [("15.06.24", 2024), ("15.06.69", 2069), ("15.06.98", 1998), ("15.06.1998", 1998)]
)
def test_a_year_of_two_digits_is_of_the_last_century_or_of_this_one(cell, year):
    """A log of 1998 was dated to the year 98."""
    (found,) = seconds(texts(f"{cell} 12:00:00"), TimeBase("datetime", order="dmy"))
    assert found == pytest.approx(np.datetime64(f"{year}-06-15T12", "s").astype(float))


@pytest.mark.parametrize(
    ("zone", "hours"), [("Z", 0.0), ("UTC", 0.0), ("+02:00", 2.0), ("-0530", -5.5), ("+0100", 1.0)]
)
def test_a_zone_east_of_greenwich_is_ahead(zone, hours):
    assert zone_seconds(zone) == 3600.0 * hours
    if zone[0] in "+-":
        base = TimeBase("datetime", order="ymd")
        found = seconds(texts(f"2024-06-15 12:00:00{zone}", f"2024-06-15 12:00:01{zone}"), base)
        assert found == pytest.approx([NOON_2024 - 3600.0 * hours, NOON_2024 - 3600.0 * hours + 1.0])


@pytest.mark.parametrize("zone", ["UTC", "Europe/Oslo"])
@pytest.mark.parametrize("cells", [("12:00:00", "12:00:01"), ("abc", "abd")])
def test_a_cell_without_a_date_is_no_date(cells, zone):
    with pytest.raises(InputError, match=f"'{cells[0]}' is no time of the form 'datetime'"):
        seconds(texts(*cells), TimeBase("datetime", order="ymd", zone=zone))


def test_columns_that_cannot_be_joined_are_refused():
    date = texts("2024-06-15", "2024-06-15")
    with pytest.raises(InputError, match="holds plain numbers"):
        to_seconds([date, numbers(1.0, 2.0)], TimeBase("datetime", order="ymd"), "log", str)
    with pytest.raises(InputError, match="holds plain numbers"):
        to_seconds([numbers(1.0, 2.0), numbers(3.0, 4.0)], TimeBase("seconds"), "log", str)
    with pytest.raises(InputError, match="time.fraction is the unit of the last of several columns"):
        seconds(numbers(1.0, 2.0), TimeBase("unix", fraction="ms"))


def test_times_of_day_go_on_past_midnight():
    found = seconds(texts("23:59:58", "23:59:59", "00:00:00", "00:00:01"), TimeBase("clock"))
    assert np.diff(found) == pytest.approx([1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("form", "value"),
    [
        ("excel", 45_458.5),
        ("matlab", 739_418.5),
        ("unix", NOON_2024),
        ("filetime", (NOON_2024 + 11_644_473_600.0) * 1e7),
        ("dotnet", (NOON_2024 + 62_135_596_800.0) * 1e7),
    ],
)
def test_every_form_of_numbers_dates_the_same_noon(form, value):
    assert seconds(numbers(value, value), TimeBase(form)) == pytest.approx([NOON_2024] * 2, abs=1e-3)


@pytest.mark.parametrize(
    ("last", "order", "asked"),
    [("06/05/2024", "dmy", True), ("25/05/2024", "dmy", False), ("05/25/2024", "mdy", False)],
)
def test_day_or_month_first_is_asked_where_several_days_leave_it_open(last, order, asked):
    guess = guess_time([texts("05/05/2024 10:00:00", "05/05/2024 10:00:01", f"{last} 10:00:00")], "")
    assert guess is not None
    assert guess.base.order == order
    assert bool(guess.question) is asked


@pytest.mark.parametrize(("cell", "value"), [("5.5-", -5.5), ("(3.2)", -3.2), ("\u22121.5", -1.5), ("7", 7.0)])
def test_a_sign_is_read_wherever_a_bookkeeper_writes_it(cell, value):
    assert as_column("x", [cell, "1", "2"], ".", "").values.tolist() == [value, 1.0, 2.0]


def test_rows_of_a_first_tick_that_was_joined_late_lie_at_its_end():
    """Five rows a second, and a pause that no steady clock has: the two rows of the first second are its last ones."""
    found = spread_ticks(np.concatenate([np.zeros(2), np.repeat([1.0, 2.0, 3.0, 20.0, 21.0, 22.0], 5)]))
    assert found[:3] == pytest.approx([0.6, 0.8, 1.0])


def test_a_gap_in_a_log_of_whole_seconds_stays_a_gap():
    """The rows of the second before were laid evenly up to the end of the gap: nobody saw it."""
    ticks = np.repeat([0.0, 1.0, 2.0, 3.0, 20.0, 21.0, 22.0], 5)
    steps = np.diff(spread_ticks(ticks))
    assert np.delete(steps, 19) == pytest.approx(0.2)
    assert steps[19] == pytest.approx(16.2)


def test_ticks_that_come_now_and_then_keep_their_rows_between_them():
    found = spread_ticks(np.repeat([0.0, 1.0, 2.0, 5.0, 6.0], 5))
    assert found[10:16] == pytest.approx([2.0, 2.6, 3.2, 3.8, 4.4, 5.0])


def test_milliseconds_behind_a_colon_are_counted():
    """12:00:05:7 is 7 ms behind, where other rows say 12:00:05:107: it was read as 0.7 s, and the time went back."""
    millis = 7 + 50 * np.arange(100)
    for form, width in (("{}", 0), ("{:03}", 3)):
        cells = [f"12:00:{10 + each // 1000}:{form.format(each % 1000)}" for each in millis]
        guess = guess_time([texts(*cells)], "")
        assert guess is not None, width
        assert seconds(texts(*cells), guess.base) == pytest.approx(43_210.0 + 1e-3 * millis)
    hundredths = texts("12:00:05:07", "12:00:05:12", "12:00:06:02")
    assert seconds(hundredths, TimeBase("clock")) == pytest.approx([43_205.07, 43_205.12, 43_206.02])


def test_a_date_as_it_is_spoken_is_read():
    assert days_since_1970(time_parts("17. März 2026 10:00:00")[:3], "dmy", "log") == 20_529
    assert time_parts("1. 3. 2026 10:00:00")[:3] == ("1", "3", "2026")


def test_a_month_of_digits_that_are_no_number_is_no_date():
    with pytest.raises(InputError, match="is no date of the order dmy"):
        days_since_1970(("17", "²²²", "2026"), "dmy", "log")


@pytest.mark.parametrize(
    "cells",
    [
        ["12-LIFT-2026"] * 4, ["1-abc-2026 10:00:00", "2-abc-2026 10:00:01"], ["12-45-2026", "12-46-2026"],
        ["31-02-2024", "32-02-2024"], ["1-²²²-2026", "2-²²²-2026"],
    ],
)  # fmt: skip
def test_numbers_of_jobs_and_parts_are_no_times(cells):
    """A log with a column of job numbers, 12-LIFT-2026, was refused for them: "no date of the order dmy"."""
    assert guess_time([texts(*cells)], "") is None


def test_one_date_that_cannot_be_leaves_the_others_a_time():
    cells = [f"30-01-2026 10:00:{k:02d}" for k in range(20)]
    guess = guess_time([texts(*cells[:9], "30-02-2026 10:00:09", *cells[10:])], "")
    assert guess is not None
    assert guess.base.form == "datetime"
    with pytest.raises(InputError, match="30-02-2026' is no date"):
        seconds(texts(*cells[:9], "30-02-2026 10:00:09"), guess.base)
