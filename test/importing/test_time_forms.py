"""Forms of a log's time, each on a few cells: what a number counts, what a text says, what is left open."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from winch_friction.importing.draft import Draft
from winch_friction.importing.log import Log, LogColumn
from winch_friction.importing.mapping import LogMap
from winch_friction.importing.ticks import fraction_unit, spread_ticks
from winch_friction.importing.time_base import TimeBase, guess_form, guess_time, to_seconds
from winch_friction.importing.time_text import clock_seconds, time_parts, zone_seconds
from winch_friction.physics.errors import InputError

NOON = np.datetime64("2024-06-15T12:00:00", "s").astype(float)  # UTC, s since 1970


def texts(*cells):
    return LogColumn("t", np.full(len(cells), np.nan), text=np.array(cells, dtype=object))


def numbers(values, name="t"):
    return LogColumn(name, np.array(values, float))


def seconds(base, *columns):
    return to_seconds(columns, base, "log", str)


@pytest.mark.parametrize(
    ("form", "noon"),
    [("excel", 45_458.5), ("matlab", 739_418.5), ("filetime", 133_629_264e9), ("dotnet", 638_540_496e9),
     ("unix", NOON), ("seconds", NOON)],
)  # fmt: skip
def test_every_way_of_counting_says_the_same_noon(form, noon):
    assert seconds(TimeBase(form), numbers([noon])) == pytest.approx([NOON], abs=1e-3)


@pytest.mark.parametrize(
    ("cell", "said"),
    [("T#1m2s345ms", 62.345), ("TIME#1h1ms", 3600.001), ("LT#2s500us", 2.0005), ("02:03,5", 123.5),
     ("1:02:03.5", 3723.5), ("1d", None)],
)  # fmt: skip
def test_what_controllers_and_spreadsheets_write_of_a_time(cell, said):
    parts = time_parts(cell)
    assert (parts is None) is (said is None)
    assert said is None or clock_seconds(parts) == pytest.approx(said)


@pytest.mark.parametrize("cell", ["20240615T120000", "20240615 120000", "20240615_12:00:00", "20240615-12:00:00"])
def test_a_date_and_a_clock_without_marks_are_read(cell):
    assert seconds(TimeBase("datetime"), texts(cell)) == pytest.approx([NOON])


def test_a_zone_of_half_an_hour_is_one():
    assert zone_seconds("+0530") == 19_800.0


def test_ms_behind_a_third_colon_are_counted_where_they_have_no_zeros():
    """`5:7` is 7 ms behind 5 s where others have three digits, and .7 s where all have as many."""
    counted = seconds(TimeBase("clock"), texts("12:00:05:7", "12:00:05:57", "12:00:05:107"))
    assert counted - counted[0] == pytest.approx([0.0, 0.05, 0.1])
    padded = seconds(TimeBase("clock"), texts("12:00:05:007", "12:00:05:057", "12:00:05:107"))
    assert padded == pytest.approx(counted)
    tenths = seconds(TimeBase("clock"), texts("12:00:05:7", "12:00:05:8", "12:00:05:9"))
    assert np.diff(tenths) == pytest.approx([0.1, 0.1])


@pytest.mark.parametrize(("unit", "most"), [("ms", 1e3), ("us", 1e6), ("ns", 1e9)])
def test_a_column_of_fractions_is_added_in_its_unit(unit, most):
    whole, beyond = np.repeat([100.0, 101.0, 102.0], 4), np.tile([0.0, 0.25, 0.5, 0.75], 3) * most
    assert fraction_unit(whole, numbers(beyond)) == unit
    found = seconds(TimeBase("seconds", fraction=unit), numbers(whole), numbers(beyond, "f"))
    assert np.diff(found) == pytest.approx(0.25)


def test_what_goes_on_over_the_whole_seconds_is_no_fraction_of_them():
    whole = np.repeat([100.0, 101.0, 102.0], 4)
    assert fraction_unit(whole, numbers(np.linspace(0.0, 900.0, 12))) == ""


def test_a_clock_goes_on_over_midnight_and_not_over_a_late_row():
    over = seconds(TimeBase("clock"), texts("23:59:59", "00:00:00", "00:00:01"))
    assert np.diff(over) == pytest.approx([1.0, 1.0])
    late = seconds(TimeBase("clock"), texts("12:00:02", "12:00:01", "12:00:03"))
    assert np.diff(late) == pytest.approx([-1.0, 2.0])


# -- what is guessed
@pytest.mark.parametrize(
    ("cells", "order", "asked"),
    [
        (("2024-03-04 10:00:00", "2024-03-05 10:00:00"), "ymd", False),
        (("25/03/2024 10:00:00", "26/03/2024 10:00:00"), "dmy", False),
        (("03/25/2024 10:00:00", "03/26/2024 10:00:00"), "mdy", False),
        (("03/04/2024 10:00:00", "03/05/2024 10:00:00"), "dmy", True),
        (("03.04.2024 10:00:00", "04.04.2024 10:00:00"), "dmy", False),  # points are of those who say the day first
        (("04 Mar 2024 10:00:00", "05 Mar 2024 10:00:00"), "dmy", False),
    ],
)
def test_the_order_of_a_date_is_told_by_what_can_be_no_month_or_is_asked(cells, order, asked):
    guess = guess_time([texts(*cells)], "")
    assert guess.base.order == order
    assert bool(guess.question) is asked


@pytest.mark.parametrize(
    ("step", "unit"), [(0.02, "s"), (1.0, "s"), (20.0, "ms"), (1000.0, "ms"), (20_000.0, "us"), (2.3e-7, "day")]
)
def test_a_bare_number_counts_what_makes_a_usual_step_of_it(step, unit):
    assert guess_time([numbers(step * np.arange(50.0))], "").base.unit == unit


def test_what_falls_as_often_as_it_rises_is_no_time():
    rng = np.random.default_rng(0)
    assert guess_time([numbers(np.cumsum(rng.normal(0.2, 1.0, 500)))], "") is None


# -- ticks
def test_rows_before_a_gap_stay_in_their_tick():
    """A pause of a minute is no tick of a minute: its rows are not laid across it."""
    ticks = np.concatenate([np.repeat(np.arange(5.0), [10, 9, 11, 12, 10]), np.repeat(65.0 + np.arange(4.0), 10)])
    spread = spread_ticks(ticks)
    assert spread[51] < 5.0
    assert spread[52] == 65.0
    assert np.all(np.diff(spread) > 0.0)


def test_a_steady_logger_is_laid_at_its_rate_and_no_row_leaves_its_tick():
    """9 and 11 rows in turn at 10 Hz; of rows that come in bursts each stays where it was."""
    steady = np.floor(0.1 * np.arange(200.0) + 0.04)
    steps = np.diff(spread_ticks(steady))
    assert steps == pytest.approx(steps[0])
    assert steps[0] == pytest.approx(0.1, rel=0.01)
    bursts = np.repeat(np.arange(8.0), [2, 18, 3, 17, 2, 18, 3, 17])
    laid = spread_ticks(bursts)
    assert np.all((laid >= bursts) & (laid < bursts + 1.0))


def test_the_last_tick_is_cut_short_and_no_slower():
    ticks = np.repeat(np.arange(6.0), [20, 5, 20, 5, 20, 3])
    assert np.diff(spread_ticks(ticks))[-1] <= 1.0 / 12.0


@pytest.mark.parametrize(("form", "noon"), [("filetime", 133_629_264e9), ("dotnet", 638_540_496e9)])
def test_tenths_of_a_microsecond_tell_from_their_size_since_when(form, noon):
    assert guess_time([numbers(noon + 2e5 * np.arange(9))], "").base.form == form
    assert guess_time([numbers(3.0 * noon + 2e5 * np.arange(9))], "").base.form != form


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "s"), (1e3, "ms"), (1e6, "us"), (1e9, "ns")])
def test_a_count_since_1970_is_told_by_its_size_and_none_of_another_century_is(factor, unit):
    told = guess_time([numbers(factor * (NOON + 0.1 * np.arange(9)))], "").base
    assert (told.form, told.unit) == ("unix", unit)
    late = guess_time([numbers(factor * (2.0 * NOON + 0.1 * np.arange(9)))], "")
    assert late is None or (late.base.form, late.base.unit) != ("unix", unit)


@pytest.mark.parametrize(
    ("base", "cells"),
    [
        (TimeBase("datetime", order="ymd"), ["2026-03-01T10:00:01.5", "2026-03-01T10:00:02", "2026-03-01T10:00:03,25",
                                             "2026-03-01 10:01", "2026-03-01T10:01:04", "2026-03-02T10:01:04"]),
        (TimeBase("datetime", order="ymd"), ["2026-03-01T10:00:01+02:00", "2026-03-01T10:00:01+03:00",
                                             "2026-03-01T10:00:01"]),
        (TimeBase("datetime", order="ymd"), ["2026-03-01T10:00:30+05:30", "2026-03-01T10:00:30+05:45"]),
        (TimeBase("datetime", order="dmy", zone="Europe/Oslo"), ["01.07.2026 10:00:01", "01.07.2026 10:00:02 pm",
                                                                 "01.07.2026 10:00:03", "02.07.2026 10:00:03"]),
        (TimeBase("clock"), ["12:05.5", "12:05", "12:06.5", "12:06:30", "12:06:31", " 12:06:32", "12:06:33 "]),
        (TimeBase("clock"), ["10:00:05:07", "10:00:05:08", "10:00:05:17"]),
    ],
)  # fmt: skip
def test_a_cell_is_read_the_same_whatever_stands_above_it(base, cells):
    """A cell whose text before its seconds was read above is not taken apart again."""
    alone = [seconds(base, texts(cell))[0] for cell in cells]
    assert seconds(base, texts(*cells)).tolist() == alone


def test_a_draft_reads_the_times_anew_where_they_are_read_in_another_way():
    log = Log(Path("log.csv"), (numbers([0.0, 20.0, 40.0]),), {}, str)
    draft = Draft([log], None, LogMap({}, ("t",), TimeBase("seconds", "s")))
    assert draft.converted()[0].columns["time"].tolist() == [0.0, 20.0, 40.0]
    draft.log_map = replace(draft.log_map, time=TimeBase("seconds", "ms"))
    for _ in range(2):
        assert draft.converted()[0].columns["time"] == pytest.approx([0.0, 0.02, 0.04])


def test_each_log_of_a_draft_has_times_of_its_own():
    logs = [Log(Path(f"{k}.csv"), (numbers([k, k + 1.0]),), {}, str) for k in range(2)]
    draft = Draft(logs, None, LogMap({}, ("t",), TimeBase("seconds", "s")))
    assert [each.columns["time"].tolist() for each in draft.converted()] == [[0.0, 1.0], [1.0, 2.0]]


# -- from which numbers and texts on a form is another one
@pytest.mark.parametrize(
    ("values", "form", "unit"),
    [
        ([30_001.0, 30_002.0], "excel", "day"),
        ([59_998.0, 59_999.0], "excel", "day"),
        ([45_000.0, 45_059.0], "excel", "day"),
        ([45_000.0, 45_061.0], "seconds", "ms"),  # more than two months
        ([29_998.0, 29_999.0], "seconds", "s"),
        ([60_001.0, 60_002.0], "seconds", "s"),
        ([720_001.0, 720_002.0], "matlab", "day"),
        ([759_998.0, 759_999.0], "matlab", "day"),
        ([760_001.0, 760_002.0], "seconds", "s"),
        ([719_000.0, 719_001.0], "seconds", "s"),
        ([739_000.0, 739_061.0], "seconds", "ms"),
        ([6.31e8, 6.31e8 + 1.0], "unix", "s"),
        ([6.29e8, 6.29e8 + 1.0], "seconds", "s"),
        ([2.59e9, 2.59e9 + 1.0], "unix", "s"),
        ([0.0, 1e-4], "seconds", "s"),
        ([0.0, 9e-5], "seconds", "day"),
        ([0.0, 1.5], "seconds", "s"),
        ([0.0, 1.6], "seconds", "ms"),
        ([0.0, 2000.0], "seconds", "ms"),
        ([0.0, 2001.0], "seconds", "us"),
        ([5.0, 5.0], "seconds", "us"),
    ],
)
def test_the_size_and_the_step_of_a_number_tell_what_it_counts(values, form, unit):
    guess = guess_form([numbers(values)], "")
    assert (guess.base.form, guess.base.unit) == (form, unit)


def test_a_unit_that_is_said_is_taken_before_days_and_after_what_counts_from_an_origin():
    assert guess_form([numbers([45_000.0, 45_001.0])], "ms").base == TimeBase("seconds", "ms")
    assert guess_form([numbers([45_000.0, 45_001.0])], "ms").confidence == 0.97
    assert guess_form([numbers([1e3 * NOON, 1e3 * NOON + 20.0])], "ms").base == TimeBase("unix", "ms")
    assert guess_form([numbers([45_000.0])], "ms") is None
    assert guess_form([numbers([45_000.0, np.nan])], "ms") is None


@pytest.mark.parametrize(
    ("values", "confidence", "said"),
    [
        ([0.0, 0.02, 0.04], 0.85, "no unit; a step of 0.02 is taken for seconds"),
        ([0.0, 20.0, 40.0], 0.7, "no unit; a step of 20 is taken for ms"),
        ([0.0, 2e4, 4e4], 0.6, "no unit; a step of 2e+04 is taken for us"),
        ([0.0, 2e-7, 4e-7], 0.6, "no unit; a step of 2e-07 is taken for days"),
        ([45_458.5, 45_458.6], 0.9, "values of 45458.5 are days as spreadsheets count them"),
        ([739_418.5, 739_418.6], 0.9, "values of 739418 are days as MATLAB counts them"),
        ([NOON, NOON + 1.0], 0.95, f"values of {NOON:.4g} are s since 1970"),
    ],
)
def test_a_guess_says_why_and_how_surely(values, confidence, said):
    guess = guess_form([numbers(values)], "")
    assert (guess.confidence, guess.because, guess.question) == (confidence, said, "")


def test_rows_that_share_a_tick_are_spread_and_their_number_is_said():
    guess = guess_time([numbers(np.repeat(np.arange(40.0), 10))], "s")
    assert guess.base == TimeBase("seconds", "s", spread=True)
    assert guess.because == "unit 's'; about 10 rows share a time, so the rows of a tick are spread evenly"
    assert not guess_time([numbers(np.arange(40.0))], "s").base.spread


@pytest.mark.parametrize(
    ("values", "is_time"),
    [
        ([0.0, 1.0, 2.0], True),
        ([0.0, np.nan, 2.0], True),
        ([2.0, 1.0, 0.0], False),
        ([5.0, 5.0, 5.0], False),
        ([*range(100), -1.0], False),  # where it ends before it began
        ([0.0, 1.0, 0.0], False),
        ([*range(50), 48.5, *range(50, 100)], True),  # one row that is late
        ([*range(20), 18.5, *range(20, 30)], False),  # three in a hundred
    ],
)
def test_a_time_rises_but_for_a_row_now_and_then(values, is_time):
    assert (guess_time([numbers(values)], "s") is not None) is is_time


@pytest.mark.parametrize(
    ("cells", "base", "confidence"),
    [
        (["12:00:00", "12:00:01"], TimeBase("clock"), 0.9),
        (["2024-03-04 10:00:00", "2024-03-04 10:00:01"], TimeBase("datetime", order="ymd", zone="UTC"), 0.95),
        (["2024-03-04T10:00:00Z", "2024-03-04T10:00:01Z"], TimeBase("datetime", order="ymd"), 0.95),
        (["03/04/2024 10:00:00", "03/04/2024 10:00:01"], TimeBase("datetime", order="dmy", zone="UTC"), 0.7),
        (["12:00:00", "no", "12:00:02", "12:00:03", "12:00:04"], TimeBase("clock"), 0.9),  # four of five
    ],
)
def test_a_text_is_a_date_or_a_time_of_day(cells, base, confidence):
    guess = guess_form([texts(*cells)], "")
    assert (guess.base, guess.confidence) == (base, confidence)


def test_texts_of_which_more_than_a_fifth_is_no_time_are_none():
    assert guess_form([texts("12:00:00", "no", "12:00:02", "no")], "") is None
    assert guess_form([texts("a", "b")], "") is None


def test_a_guess_of_texts_shows_the_first_and_says_what_is_open():
    one = guess_form([texts("03/04/2024 10:00:00", "03/04/2024 10:00:01")], "")
    assert one.because.startswith("dates such as '03/04/2024 10:00:00', order dmy, no zone is given, taken for UTC")
    assert one.because.endswith("; day or month first is open, which dates the run but changes no duration")
    several = guess_form([texts("03/04/2024 10:00:00", "03/05/2024 10:00:00")], "")
    assert several.question == "is '03/04/2024 10:00:00' day or month first? set time.order to dmy or mdy"
    years = guess_form([texts("03/04/2024 10:00:00", "03/04/2025 10:00:00")], "")
    assert years.question == several.question
    zoned = guess_form([texts("2024-03-04T10:00:00Z", "2024-03-04T10:00:01+01:00")], "")
    assert zoned.because == "dates such as '2024-03-04T10:00:00Z', order ymd, with its zone"


def test_a_date_and_a_clock_beside_it_are_joined_and_a_midnight_of_the_date_is_none():
    dates, clocks = texts("2024-06-15 00:00:00", "2024-06-15 00:00:00"), texts("12:00:00", "12:00:01")
    assert seconds(TimeBase("datetime", order="ymd"), dates, clocks) == pytest.approx([NOON, NOON + 1.0])


@pytest.mark.parametrize(("month", "ahead"), [("06", 2.0), ("12", 1.0)])
def test_a_date_without_an_offset_is_of_its_zone_and_one_with_is_of_its_own(month, ahead):
    cells = texts(f"2024-{month}-15 12:00:00", f"2024-{month}-15T12:00:00Z", f"2024-{month}-15T12:00:00-03:00")
    noon = np.datetime64(f"2024-{month}-15T12:00:00", "s").astype(float)
    base = TimeBase("datetime", order="ymd", zone="Europe/Oslo")
    assert seconds(base, cells) - noon == pytest.approx([-ahead * 3600.0, 0.0, 3.0 * 3600.0])
    assert seconds(replace(base, zone="UTC"), cells)[0] == noon


def test_stamps_of_a_library_are_seconds_and_what_is_none_of_them_is_missing():
    stamps = np.array(["2024-06-15T12:00:00.25", "NaT"], "datetime64[us]")
    found = seconds(TimeBase("datetime"), LogColumn("t", np.full(2, np.nan), text=stamps))
    assert found[0] == pytest.approx(NOON + 0.25, abs=1e-6)
    assert np.isnan(found[1])
    rising = np.array(["2024-06-15T12:00:00", "2024-06-15T12:00:01"], "datetime64[ms]")
    guess = guess_form([LogColumn("t", np.full(2, np.nan), text=rising)], "")
    assert (guess.base, guess.confidence) == (TimeBase("datetime", order="ymd", zone="UTC"), 0.95)


@pytest.mark.parametrize(
    ("base", "columns", "said"),
    [
        (TimeBase("datetime"), [numbers([1.0])], "log: time.form is 'datetime', but the column holds plain numbers"),
        (TimeBase("seconds", "s", fraction="ms"), [numbers([1.0])],
         "log: time.fraction is the unit of the last of several columns; time.from names one"),
        (TimeBase("datetime", zone="Nowhere/Atall"), [texts("2024-06-15 12:00:00")],
         "log: time.zone 'Nowhere/Atall' is not known; write e.g. UTC or Europe/Oslo"),
        (TimeBase("datetime", order="ymd"), [texts("2024-06-15 12:00:00", "12:00:01")],
         "log: 1: '12:00:01' is no time of the form 'datetime'"),
        (TimeBase("datetime"), [texts("2024-06-15"), numbers([1.0], "clock")],
         "log: time.from: a date and a time of day are joined where both are texts; column 'clock' holds plain"),
    ],
)  # fmt: skip
def test_what_is_no_time_is_told_with_its_row_and_the_form(base, columns, said):
    with pytest.raises(InputError) as refused:
        seconds(base, *columns)
    assert str(refused.value).startswith(said)


def test_an_empty_cell_and_where_nothing_is_strict_a_bad_one_are_missing():
    cells = texts("12:00:00", "", None, "12:00:03")
    assert np.isnan(seconds(TimeBase("clock"), cells)).tolist() == [False, True, True, False]
    bad = to_seconds([texts("12:00:00", "no", "12:00:02")], TimeBase("clock"), "log", str, strict=False)
    assert bad - bad[0] == pytest.approx([0.0, np.nan, 2.0], nan_ok=True)


def test_the_unit_of_numbers_and_the_spread_of_ticks_are_applied():
    assert seconds(TimeBase("seconds", "min"), numbers([0.0, 1.5])) == pytest.approx([0.0, 90.0])
    assert seconds(TimeBase("seconds", ""), numbers([0.0, 1.5])) == pytest.approx([0.0, 1.5])
    ticks = numbers(np.repeat(np.arange(8.0), 5))
    assert np.diff(seconds(TimeBase("seconds", spread=True), ticks)) == pytest.approx(0.2, rel=0.02)


@pytest.mark.parametrize(("zone", "ahead"), [("", 0.0), ("UTC", 0.0), ("Europe/Oslo", 2.0), ("America/Houston", None)])
def test_a_date_in_six_columns_is_of_its_zone(zone, ahead):
    parts = [numbers([value]) for value in (2024, 6, 15, 12, 0, 0)]
    if ahead is None:
        with pytest.raises(InputError, match="time.zone 'America/Houston' is not known"):
            seconds(TimeBase("parts", zone=zone), *parts)
    else:
        assert seconds(TimeBase("parts", zone=zone), *parts) == pytest.approx([NOON - 3600.0 * ahead])


def test_a_time_of_day_has_no_zone():
    assert seconds(TimeBase("clock", zone="Europe/Oslo"), texts("12:00:00")) == pytest.approx([43_200.0])
    assert seconds(TimeBase("clock", zone="Nowhere"), texts("12:00:00")) == pytest.approx([43_200.0])


@pytest.mark.parametrize(("form", "origin"), [("filetime", 11_644_473_600.0), ("dotnet", 62_135_596_800.0)])
def test_nobody_counts_ticks_of_before_the_century_or_after_its_first_half(form, origin):
    for year, told in (("1985", False), ("2005", True), ("2045", True), ("2060", False)):
        since = np.datetime64(f"{year}-01-01", "s").astype(float)
        guess = guess_form([numbers(1e7 * (since + origin + 0.1 * np.arange(5)))], "")
        assert (guess.base.form == form) is told
