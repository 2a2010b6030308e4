"""What a cell, a unit, a local time and a map's entry become, in numbers by hand."""

import re
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np
import pytest

from winch_friction.importing.carry_out import (
    _rate,
    _say_bad_cells,
    _within_limits,
    _without_footer,
    constant_in_si,
    scale_and_offset,
)
from winch_friction.importing.cells import (
    as_column,
    decimal_mark,
    is_missing,
    is_number,
    is_time,
    plain_numbers,
    units_in_cells,
    without_unit,
)
from winch_friction.importing.draft import Draft
from winch_friction.importing.kinematics import along_speed, rope_over_motor
from winch_friction.importing.log import Log, LogColumn
from winch_friction.importing.map_text import map_text
from winch_friction.importing.mapping import Entry, LogMap, map_from_content, refuse_if_open, with_settings
from winch_friction.importing.propose import _bad_cells, _instead, _is_motion, _pooled, _say_of_changes, _settle_missing
from winch_friction.importing.summer_time import _hour_ahead, change_asked, from_utc, hour_back
from winch_friction.importing.text_rows import TextRows
from winch_friction.importing.time_base import TimeBase
from winch_friction.importing.unit_guess import _ask_odd_pair, _ask_strange_units, _set_unit, _usual_in
from winch_friction.importing.units import (
    ambiguity,
    bare_unit,
    conversion,
    fitting_si_unit,
    header_readings,
    is_foreign,
    is_share,
    looks_like_unit,
    says_unit,
    usual_units,
    worded,
)
from winch_friction.physics.channels import BAR, CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.errors import InputError


# -- cells
@pytest.mark.parametrize(
    ("cell", "marks", "value"),
    [
        ("12,5", (",", ""), 12.5), ("1.234,5", (",", "."), 1234.5), ("1,234.5", (".", ","), 1234.5),
        ("12.5-", (".", ""), -12.5), ("(12.5)", (".", ""), -12.5), ("\u221212.5", (".", ""), -12.5),
        ("+1e3", (".", ""), 1e3), (".5", (".", ""), 0.5), ("5.", (".", ""), 5.0), ("'7'", (".", ""), 7.0),
        ("1 234", (".", " "), 1234.0),
    ],
)  # fmt: skip
def test_a_number_is_read_however_its_sign_and_marks_are_written(cell, marks, value):
    assert is_number(cell, *marks)
    column = as_column("x", [cell, "stop", *[cell] * 2], *marks)
    assert column.values.tolist()[0] == value
    assert column.bad == ((1, "stop"),)


@pytest.mark.parametrize(
    ("cell", "marks"),
    [("1.2.3", (".", "")), ("12,34,5", (".", ",")), ("0,123", (".", ",")), ("1e", (".", "")), ("-", (".", "")),
     ("1_000", (".", "")), (True, (".", "")), ("12:30", (".", "")), ("(12", (".", ""))],
)  # fmt: skip
def test_what_only_looks_like_a_number_is_none(cell, marks):
    assert not is_number(cell, *marks)


@pytest.mark.parametrize(
    ("cells", "delimiter", "marks"),
    [
        (["1.5", "2.5"], ",", (".", "")), (["1,5", "2,5"], ";", (",", "")), (["1.234,5", "2,5"], ";", (",", ".")),
        (["1,234.5", "2.5"], ";", (".", ",")), (["1 234,5", "1,5"], ";", (",", " ")), (["1'234.5"], ";", (".", "'")),
        (["abc"], ";", (".", "")), ([], ";", (".", "")), (["1,5", "2.5", "3,5"], ";", (",", "")),
    ],
)  # fmt: skip
def test_the_marks_are_those_under_which_most_cells_are_numbers(cells, delimiter, marks):
    assert decimal_mark(cells, delimiter) == marks


@pytest.mark.parametrize(
    ("cells", "decimal", "thousands", "values"),
    [
        (["1.5", "", "-2"], ".", "", [1.5, np.nan, -2.0]), (["1,5", "2"], ",", "", [1.5, 2.0]),
        (["1.500", "2.500"], ",", "", None), (["1_000"], ".", "", None), (["inf"], ".", "", None),
        (["1"], ".", ",", None), (["1", "x"], ".", "", None),
    ],
)  # fmt: skip
def test_plain_numbers_are_those_that_need_no_second_look(cells, decimal, thousands, values):
    found = plain_numbers(cells, decimal, thousands)
    assert found is None if values is None else np.array_equal(found, values, equal_nan=True)


def test_a_column_is_of_numbers_when_at_least_half_of_what_is_there_are():
    half = as_column("x", ["1", "2", "aus", "an", "", "Bad", None], ".", "", "bar", "a note")
    assert half.numeric
    np.testing.assert_array_equal(half.values, [1.0, 2.0, *[np.nan] * 5])
    assert (half.bad, half.unit, half.note) == (((2, "aus"), (3, "an")), "bar", "a note")
    less = as_column("x", ["1", "aus", "an"], ".", "", "bar", "a note")
    assert not less.numeric
    assert (less.text.tolist(), np.isnan(less.values).all(), less.unit) == (["1", "aus", "an"], True, "bar")
    long = as_column("x", ["7"] * 400 + ["y" * 90] * 300, ".", "")
    assert (len(long.bad), long.bad[-1]) == (200, (599, "y" * 60))


@pytest.mark.parametrize(
    ("cells", "found"),
    [
        (["116.2 bar", "3 bar", "4,5 bar"], {0: "bar"}), (["1 bar", "2 bar"], {}), (["1 bar", "2 bar", "3 psi"], {}),
        (["1 bar"] * 8 + ["x"] * 2, {}), (["1 bar"] * 9 + ["x"] * 2, {0: "bar"}),
        (["1 bar"] * 3 + [""] * 9, {0: "bar"}),
    ],
)  # fmt: skip
def test_cells_bear_a_unit_when_most_of_them_bear_the_same(cells, found):
    assert units_in_cells([[cell] for cell in cells]) == found


def test_a_unit_is_taken_off_a_cell_that_ends_with_it_alone():
    assert [without_unit(each, "bar") for each in (" 3.5 bar ", "bar 3", "3.5bar")] == ["3.5", "bar 3", "3.5"]


@pytest.mark.parametrize(
    ("cell", "time", "missing"),
    [("2026-11-27 02:30:00", True, False), ("27.11.2026", True, False), ("02:30", True, False), ("T#1h2m", True, False),
     ("20261127T0230", True, False), ("27.11", False, False), ("n/a", False, True), (" - ", False, True),
     (None, False, True), ("0", False, False), ("bad", False, False)],
)  # fmt: skip
def test_times_and_missing_values_are_told(cell, time, missing):
    assert (is_time(cell), is_missing(cell)) == (time, missing)


def test_rows_have_the_line_that_they_end_in_and_units_go_into_the_head():
    lines = ["sep=;", "t;p", "", *(f"{k};{k + 1.5} bar" for k in range(6))]
    rows = TextRows(Path("log.csv"), lines, ";")
    assert (len(rows), list(rows.numbers)) == (7, [2, 4, 5, 6, 7, 8, 9])
    assert (rows.row(-1), rows.row(0), rows.row(4)) == ([], ["t", "p"], ["3", "4.5 bar"])
    assert (rows.index_of_line(4), rows.index_of_line(3)) == (1, -1)
    notes = []
    rows.take_units_out(notes)
    assert list(rows) == rows.head == rows.tail == [["t", "p [bar]"], *([str(k), f"{k + 1.5}"] for k in range(6))]
    assert notes == ["cells of 1 columns bear their unit: taken off (bar)"]


# -- units
@pytest.mark.parametrize(
    ("channel", "unit", "scale", "offset"),
    [
        ("motor_speed", "rpm", RPM, 0.0), ("motor_speed", "m/s", 250.0 / 0.8, 0.0), ("motor_speed", "%", 0.02, 0.0),
        ("pressure_a", "bar", BAR, 0.0), ("displacement", "cm^3/rev", CM3_PER_REV, 0.0),
        ("displacement", "-", 2.0, 0.0), ("hook_load", "t", 1e3, 0.0), ("hook_load", "kN", 1e3 / GRAVITY, 0.0),
        ("oil_temperature", "degF", 5.0 / 9.0, -32.0 * 5.0 / 9.0), ("rope_force", "kN", 1e3, 0.0),
    ],
)  # fmt: skip
def test_a_channels_numbers_become_si_by_its_physics(channel, unit, scale, offset):
    found = conversion(channel, unit, "", of=2.0, rope_radius=0.8, gear_ratio=250.0)
    assert (found.scale, found.offset) == pytest.approx((scale, offset), abs=1e-12)


@pytest.mark.parametrize(
    ("channel", "unit", "said"),
    [
        ("motor_speed", "bar", "x: unit 'bar' is no unit of motor_speed; write e.g."), ("motor_speed", "%", "of what"),
        ("motor_speed", "m/s", "is a speed of the rope; give the crane"), ("heave_velocity", "m", "differentiate: HZ"),
    ],
)  # fmt: skip
def test_what_a_unit_lacks_is_said(channel, unit, said):
    with pytest.raises(InputError, match=said):
        conversion(channel, unit, "x")


@pytest.mark.parametrize(
    ("header", "first"),
    [
        ("n_motor [1/min]", ("n_motor", "1/min")), ("Druck A (bar) roh", ("Druck A roh", "bar")),
        ("speed_rpm", ("speed", "rpm")), ("displacement_cc_rev", ("displacement", "cc/rev")),
        ("Last, t", ("Last", "t")), ("pressure in bar", ("pressure", "bar")), ("Ventil [auf]", ("Ventil [auf]", "")),
        ("layer", ("layer", "")), ("p <0,1 bar>", ("p", "0.1 bar")),
    ],
)  # fmt: skip
def test_a_header_is_a_name_and_a_unit(header, first):
    assert header_readings(header)[0] == first
    assert (header, "") in header_readings(header)


def test_units_are_told_from_ports_brackets_and_words():
    assert [bare_unit(each) for each in ("[bar(a)]", "(kN)", " t ", "[(m)]", "[m")] == ["bar(a)", "kN", "t", "m", "[m"]
    assert says_unit("load [t]", "t")
    assert says_unit("load in t", "t")
    assert says_unit("load_kg", "kg")
    assert not says_unit("load t", "t")
    assert not says_unit("pressure [A]", "A")
    assert worded(" cm3_per_rev ") == "cm3/rev"
    assert worded("N per m") == "N/m"
    assert ambiguity("hook_load", "ton") != ""
    assert ambiguity("hook_load", "kg") == ""
    assert fitting_si_unit("hook_load", "kN") == "N"
    assert fitting_si_unit("hook_load", "bar") is None
    assert [usual_units(each)[0] for each in ("hook_load", "rope_force", "pressure_b", "wire_layer")] == [
        "t", "kN", "bar", "-",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("header", "first"),
    [
        ("Flow [l/min]", ("Flow", "l/min")), ("deck [m/s^2]", ("deck", "m/s^2")), ("Spannung [V]", ("Spannung", "V")),
        ("rate, bar/s", ("rate", "bar/s")), ("Ventil [auf]", ("Ventil [auf]", "")), ("p [bar(a)] x", ("p x", "bar(a)")),
        ("current_mA", ("current", "mA")), ("Last / kN", ("Last", "kN")), ("T; °C", ("T", "°C")),
    ],
)  # fmt: skip
def test_a_unit_of_what_no_channel_is_is_a_unit_all_the_same(header, first):
    assert header_readings(header)[0] == first
    assert is_foreign(first[1]) == (first[1] in ("l/min", "m/s^2", "V", "bar/s"))


def test_a_unit_in_words_is_long_and_a_port_is_none_in_either_case():
    assert looks_like_unit("omdreininger/min")
    assert looks_like_unit("metrische Tonnen", marked=False)
    assert looks_like_unit("kg*m^2/s^2/m", marked=False)
    assert not looks_like_unit("")
    assert not looks_like_unit("hook")
    assert not any(says_unit(f"pressure [{each}]", each) for each in "abAB")


def test_a_share_is_of_something_but_where_the_channel_is_a_bare_number():
    shares = ("motor_speed", "drum_speed", "displacement", "motor_torque", "motor_current")
    assert all(is_share(each, "%") for each in shares)
    assert all(is_share(each, "-") for each in shares)
    assert not is_share("wire_layer", "-")
    assert not any(is_share(each, "%") for each in ("hook_load", "pressure_a", "rope_speed", "rope_force"))


@pytest.mark.parametrize(
    ("channel", "unit", "what"),
    [
        ("displacement", "%", "share of 2 m^3/rad"), ("motor_current", "%", "share of 2 A"), ("hook_load", "t", ""),
        ("hook_load", "kN", "mass = force / 9.81 m/s^2"),
        ("motor_speed", "m/s", "rope speed * gear 250 / radius 0.8 m"),
    ],
)  # fmt: skip
def test_how_a_number_became_si_is_told_in_words(channel, unit, what):
    assert conversion(channel, unit, "", of=2.0, rope_radius=0.8, gear_ratio=250.0).what == what


@pytest.mark.parametrize("unit", ["cm3", "cm^3", "cm³", "ccm"])
def test_a_displacement_that_is_a_volume_is_of_one_revolution(unit):
    assert conversion("displacement", unit, "").scale == pytest.approx(CM3_PER_REV)


def test_the_units_that_are_tried_begin_with_the_most_usual():
    first = {"motor_speed": "rpm", "drum_speed": "rpm", "rope_speed": "m/s", "speed_reference": "rpm",
             "pressure_a": "bar", "displacement": "cm^3/rev", "motor_torque": "N*m", "load_torque": "N*m",
             "mechanical_power": "kW", "motor_current": "A", "heave_velocity": "m/s", "oil_temperature": "degC",
             "wire_out": "m", "shaft_angle": "rad"}  # fmt: skip
    assert {each: usual_units(each)[0] for each in first} == first
    assert usual_units("pressure_a")[:2] == ("bar", "Pa")  # psi only where neither fits
    assert usual_units("rope_force")[:2] == ("kN", "N")
    assert all(fitting_si_unit(each, unit) for each in first for unit in usual_units(each))


# -- entries of a map
@pytest.mark.parametrize(
    ("channel", "entry", "scale", "offset"),
    [
        ("motor_speed", Entry("x", "rpm", sign=-1, factor=2.0, add=3.0), -2.0 * RPM, -6.0 * RPM),
        ("wire_layer", Entry("x", "-", add=1.0), 1.0, 1.0), ("motor_speed", Entry("x", "rad/s", at="drum"), 250.0, 0.0),
        ("motor_torque", Entry("x", "kN*m", at="drum"), 4.0, 0.0), ("drum_speed", Entry("x", "rad/s", at="drum"), 1, 0),
        ("motor_speed", Entry("x", "m/s"), 250.0 / 1.136, 0.0), ("motor_speed", Entry("x", "%", of="90 rad/s"), 0.9, 0),
        ("motor_speed", Entry("x", "rev", differentiate=2.0), 2.0 * np.pi, 0.0), ("hook_load", Entry("x"), 1.0, 0.0),
        ("displacement", Entry("x", "%"), 2.15 * CM3_PER_REV, 0.0),
        ("oil_temperature", Entry("x", "degF", sign=-1), -5.0 / 9.0, 32.0 * 5.0 / 9.0),
    ],
)  # fmt: skip
def test_an_entry_is_a_scale_and_an_offset(channel, entry, scale, offset, crane_150t):
    assert scale_and_offset(channel, channel, entry, crane_150t) == pytest.approx((scale, offset), abs=1e-12)


def test_a_constant_has_its_own_unit_or_the_entrys(crane_150t):
    def of(text, unit=""):
        return constant_in_si("hook_load", "hook_load", Entry("", unit, constant=text), crane_150t)

    assert (of("2.5 t"), of("96 kg", "t"), of("3", "t"), of("7")) == pytest.approx((2500.0, 96.0, 3000.0, 7.0))
    with pytest.raises(InputError, match="must be a number and its unit"):
        of("t 3")
    with pytest.raises(InputError, match="beyond what any winch has"):
        of("1e9 t")


def log_of(*columns, name="log.csv"):
    return Log(Path(name), tuple(columns), {}, lambda row: f"line {row + 2}")


@pytest.mark.parametrize(
    ("bad", "rows", "policy", "stops"),
    [(3, 20, "missing", False), (4, 20, "missing", True), (10, 1000, "missing", False), (11, 1000, "missing", True),
     (1, 1000, "refuse", True)],
)  # fmt: skip
def test_a_few_bad_cells_are_strays_and_many_are_a_mistake(bad, rows, policy, stops):
    column = LogColumn("p", np.zeros(rows), bad=tuple((k, f"x{k}") for k in range(bad)))
    said, problems = [], []
    _say_bad_cells(log_of(column), "pressure_a", column, policy, said, problems)
    (text,) = problems if stops else said
    assert len(said) + len(problems) == 1
    cells = "1 cell is no number" if bad == 1 else f"{bad} cells are no numbers"
    assert text.startswith(f"pressure_a: column 'p': {cells}: line 2 'x0'")
    assert (f" and {bad - 5} more" in text) == (bad > 5)
    assert "'x5'" not in text
    assert text.endswith("mend them, or map another column" if stops else "taken as missing")


@pytest.mark.parametrize(("out", "rows", "stops"), [(3, 20, False), (4, 20, True), (10, 1000, False), (11, 1000, True)])
def test_a_few_values_that_no_sensor_gives_become_missing_and_many_are_a_wrong_unit(out, rows, stops):
    logged = np.where(np.arange(rows) < out, 9e4, 100.0)
    column = LogColumn("p", logged)
    said, problems, values = [], [], 1e5 * logged
    found = _within_limits(log_of(column), "main.pressure_a", "pressure_a", column, values, said, problems)
    assert values.tolist() == (1e5 * logged).tolist()  # what came in stays
    assert np.isnan(found).sum() == (0 if stops else out)
    assert np.nanmin(found) == 1e7
    (text,) = problems if stops else said
    assert len(said) + len(problems) == 1
    assert f"{out} values that no sensor gives" in text
    assert "line 2 '90000'" in text


def test_rows_behind_the_last_time_with_next_to_nothing_in_them_are_a_footer():
    nan = np.nan
    columns = {"time": np.array([0.0, nan, 2.0, nan, nan]), "a": np.array([1.0, 2.0, 3.0, nan, 9.0]),
               **{name: np.array([1.0, 2.0, 3.0, nan, nan]) for name in "bcd"}}  # fmt: skip
    said = []
    found = _without_footer(columns, log_of(), said)
    assert {name: len(values) for name, values in found.items()} == dict.fromkeys(("time", *"abcd"), 3)
    assert said == ["2 rows at the end are no samples (from line 5): left out"]
    columns["b"][4] = 9.0  # two of four: a sample whose time is missing
    assert len(_without_footer(columns, log_of(), said)["time"]) == 5


def test_the_slope_of_a_position_is_its_speed_and_fast_noise_is_left_out():
    time = 100.0 + 0.02 * np.arange(2000)
    slow, fast = np.sin(2.0 * np.pi * 0.1 * time), 0.01 * np.sin(2.0 * np.pi * 5.0 * time)
    found = _rate("x", slow + fast, time, 1.0)
    expected = 0.2 * np.pi * np.cos(2.0 * np.pi * 0.1 * time)
    assert np.abs(found - expected)[200:-200].max() < 1e-3
    half = _rate("x", np.sin(2.0 * np.pi * time), time, 1.0)  # at the cut-off: half of it, forth and back
    assert np.abs(half)[500:-500].max() == pytest.approx(np.pi, rel=0.02)


@pytest.mark.parametrize("step", [0.0, -0.02, np.nan])
def test_a_position_has_no_slope_where_its_times_do_not_rise(step):
    """A clock that was set back once, or rows of one tick: the slope there is of another sign or none."""
    time = np.cumsum(np.append(np.full(100, 0.02), step if np.isfinite(step) else 0.02))
    time[-1] += 0.0 if np.isfinite(step) else np.nan
    with pytest.raises(InputError, match="rows or more whose times rise"):
        _rate("x", np.sin(np.arange(101.0)), time, 1.0)


# -- the rope beside the motor
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_rope_is_set_against_the_motor_by_gear_and_drum(sign, crane_150t):
    time = np.arange(0.0, 40.0, 0.1)
    speed, radius = 50.0 * np.sin(0.5 * time), 1.136 / 250.0
    out = 100.0 * radius * (np.cos(0.5 * time) - 1.0)  # hoisting takes the wire in
    columns = {"time": time, "motor_speed": speed, "wire_out": 40.0 + 2.0 * sign * out, "heave_velocity": -speed}
    found = rope_over_motor(columns, crane_150t)
    assert (found.by, found.value) == ("wire_out", pytest.approx(2.0 * sign, rel=2e-3))
    del columns["wire_out"]
    columns["heave_velocity"] = -3.0 * sign * speed * radius
    found = rope_over_motor(columns, crane_150t)
    assert (found.by, found.value) == ("heave_velocity", pytest.approx(3.0 * sign))
    columns |= {"shaft_angle": -200.0 * sign * np.cos(0.5 * time), "speed_reference": 0.5 * sign * speed}
    assert along_speed(columns, "speed_reference") == pytest.approx(0.5 * sign)
    assert along_speed(columns, "shaft_angle") == pytest.approx(2.0 * sign, rel=2e-3)
    columns["speed_reference"] = np.cos(0.5 * time)  # a quarter of a wave apart
    assert along_speed(columns, "speed_reference") is None
    assert rope_over_motor({"time": time, "wire_out": out}, crane_150t) is None


# -- clocks that are changed
AUTUMN, SPRING = 1_792_893_590.0, 1_774_749_590.0  # 2026-10-25 and 2026-03-29 01:59:50, read as UTC
OSLO = ZoneInfo("Europe/Oslo")


def test_an_hour_that_is_there_twice_or_lacks_is_found_at_its_row():
    steady = np.arange(0.0, 40.0, 1.0)
    back = AUTUMN + 3600.0 + steady - 3600.0 * (steady >= 10.0)
    ahead = SPRING + steady + 3600.0 * (steady >= 10.0)
    assert (hour_back(back), _hour_ahead(back)) == (10, 0)
    assert (hour_back(ahead), _hour_ahead(ahead)) == (0, 10)
    assert (hour_back(AUTUMN + steady), _hour_ahead(SPRING + steady)) == (0, 0)
    assert _hour_ahead(ahead + 86400.0) == 0  # a Monday
    assert _hour_ahead(ahead + 6.0 * 3600.0) == 0  # by day
    assert hour_back(back - 600.0 * (steady >= 10.0)) == 0
    twice = back - 3600.0 * (steady >= 20.0)
    assert hour_back(twice) == 0
    assert "'x' goes back by an hour at row 11: the end" in change_asked(back, "x")
    assert "'x' leaps by an hour at row 11, in the small hours" in change_asked(ahead, "x")
    assert change_asked(steady, "x") == ""


def test_local_times_are_an_hour_before_utc_in_winter_and_two_in_summer():
    steady = np.arange(0.0, 40.0, 1.0)
    july, january = 1_783_000_000.0, 1_768_000_000.0
    assert set(from_utc(july + steady, OSLO)) == {7200.0}
    assert set(from_utc(january + steady, OSLO)) == {3600.0}
    back = AUTUMN + 3600.0 + steady - 3600.0 * (steady >= 10.0)  # 02:59:50 to 02:00:30
    assert from_utc(back, OSLO).tolist() == [7200.0] * 10 + [3600.0] * 30
    ahead = SPRING + steady + 3600.0 * (steady >= 10.0)
    assert from_utc(ahead, OSLO).tolist() == [3600.0] * 10 + [7200.0] * 30
    holes = np.where(steady == 3.0, np.nan, july + steady)
    found = from_utc(holes, OSLO)
    assert (found[3], found[4]) == (0.0, 7200.0)
    assert from_utc(np.full(2, np.nan), OSLO).tolist() == [0.0, 0.0]


# -- what is asked
def draft(crane=None, logs=(), **columns):
    return Draft(list(logs), crane, LogMap({name.replace("__", "."): entry for name, entry in columns.items()}))


def test_two_channels_in_odd_units_are_asked_about_together():
    guessed = {"because": "no unit is said: of the usual ones only this gives a usual size"}
    members = {"pressures": ["main.pressure_a"], "hook_load": ["hook_load"], "motor_speed": ["motor_speed"]}

    def asked(pressure, load, **more):
        own = draft(main__pressure_a=Entry("p", pressure, **guessed), hook_load=Entry("m", load, **(more or guessed)),
                    motor_speed=Entry("n", "rad/s", **guessed))  # fmt: skip
        _ask_odd_pair(own, members)
        return own.questions

    assert asked("bar", "kg") == asked("psi", "t") == asked("psi", "kg", because="said") == []
    both = asked("psi", "kg")
    assert [each.split(":")[0] for each in both] == ["main.pressure_a", "hook_load"]
    assert "'p' says no unit, and only main.pressure_a in psi and hook_load in kg together" in both[0]


def test_a_unit_that_nobody_knows_is_asked_about_where_another_was_guessed():
    own = draft(
        hook_load=Entry("Last [sh tn]", "t", because="no unit is said"),
        wire_out=Entry("Seil [qz12]", "m", because="no unit is said"),
        motor_speed=Entry("n [sh tn]", "rpm", because="the header says it"),
    )
    _ask_strange_units(own)
    (said,) = own.questions
    assert said.startswith("hook_load: 'Last [sh tn]' says 'sh tn', which is no unit that is known here; t is guessed")


@pytest.mark.parametrize(
    ("options", "chosen", "unit", "sure", "why"),
    [
        (["bar"], None, "bar", 0.76, "no unit is said: of the usual ones only bar gives a usual size"),
        (["bar", "psi"], "psi", "psi", 0.64, "psi closes the balance best or is the most usual (bar possible)"),
        (["bar", "psi"], None, "bar", 0.64, "bar closes the balance best or is the most usual (psi possible)"),
    ],
)
def test_a_guessed_unit_is_less_sure_where_another_is_possible(options, chosen, unit, sure, why):
    own = draft(main__pressure_a=Entry("p", confidence=0.8, because="name"))
    _set_unit(own, "main.pressure_a", options, chosen)
    entry = own.log_map.columns["main.pressure_a"]
    assert (entry.unit, entry.confidence) == (unit, pytest.approx(sure))
    assert entry.because.startswith("name; no unit is said")
    assert why in entry.because
    said = draft(main__pressure_a=Entry("p", "kPa"))
    _set_unit(said, "main.pressure_a", options, chosen)
    assert said.log_map.columns["main.pressure_a"].unit == "kPa"


def test_a_size_that_fits_no_unit_is_told():
    own = draft(logs=[log_of(LogColumn("p", np.full(40, -3e9)))], main__pressure_a=Entry("p"))
    _set_unit(own, "main.pressure_a", [], None)
    (said,) = own.questions
    assert "'p' says no unit, and 3e+09 is no usual size in bar, Pa, MPa" in said
    assert said.endswith("; set main.pressure_a.unit")


def test_a_usual_size_is_told_in_the_logs_unit(crane_150t):
    low, high = (float(each) for each in _usual_in("pressure_a", "Pa", crane_150t).split(" Pa")[0].split(" to "))
    shown = _usual_in("pressure_a", "bar", crane_150t)
    assert shown == f"{low / 1e5:.3g} to {high / 1e5:.3g} bar"
    assert _usual_in("displacement", "%", crane_150t).endswith(" %")
    assert _usual_in("motor_speed", "m/s", crane_150t).endswith(" rad/s")


# -- what a proposal says
def test_what_a_run_lacks_is_told_with_what_is_left_over(crane_150t):
    pooled = log_of(
        LogColumn("n", np.zeros(3)), LogColumn("T", np.array([0.0, np.nan, 1.0])), LogColumn("leer", np.full(3, np.nan))
    )
    own = draft(crane_150t, [pooled], motor_speed=Entry("n", "rpm"), main__pressure_a=Entry("p", "bar"))
    _settle_missing(own, pooled)
    (said,) = own.problems
    assert said.startswith("main.pressure_b, main.displacement: no column found; not used are ")
    assert "'n'" not in said.split("not used are")[1].split(";")[0]
    (hollow,) = re.findall(r"\(([^()]*) without a number in it\)", said)
    assert ("leer" in hollow, "T" in hollow) == (True, False)
    assert "name one by --set main.pressure_b.from=COLUMN" in said
    assert "--set 'main.displacement.constant=215 cm^3/rev'" in said
    none = draft(crane_150t, [pooled], hook_load=Entry("T", "t"))
    _settle_missing(none, pooled)
    assert none.problems[0].startswith("motor_speed (or drum_speed), pressures and displacement of a motor group: no")
    assert "--set motor_speed.from=COLUMN" in none.problems[0]
    group = {f"main__{name}": Entry(name) for name in ("pressure_a", "pressure_b", "displacement")}
    whole = draft(crane_150t, [pooled], motor_speed=Entry("n", "%"), **group)
    _settle_missing(whole, pooled)
    assert whole.problems == []
    assert whole.questions == ["motor_speed: 'n' is in %; of what? --set 'motor_speed.of=NUMBER rpm'"]
    group["main__displacement"] = Entry("d", "%")  # of the crane's largest
    told = draft(crane_150t, [pooled], motor_speed=Entry("n", "%", of="2000 rpm"), **group)
    _settle_missing(told, pooled)
    drum = draft(crane_150t, [pooled], drum_speed=Entry("n", "rpm"), **group)
    _settle_missing(drum, pooled)
    assert told.problems == told.questions == drum.problems == drum.questions == []


def test_a_pressure_drop_alone_is_told_how_to_be_taken(crane_150t):
    assert "A - B alone: --set 'main.pressure_b.constant=0 bar'" in _instead(["main.pressure_b"], [], crane_150t)
    assert _instead(["motor_speed"], ["angle [deg]"], crane_150t) == ""
    assert "constant=NUMBER cm^3/rev" in _instead(["main.displacement"], [], None)


def test_a_ships_motion_has_a_heave_and_nothing_of_a_winch():
    assert _is_motion({"heave_velocity"})
    assert _is_motion({"heave_velocity", "oil_temperature"})
    assert not any(_is_motion({"heave_velocity", each}) for each in ("motor_speed", "drum_speed", "hook_load"))
    assert not _is_motion({"oil_temperature"})


def test_logs_are_pooled_column_by_column_and_thinned():
    long = log_of(LogColumn("a", np.arange(60_000.0)), LogColumn("b", np.zeros(60_000)))
    short = log_of(LogColumn("b", np.ones(3)), LogColumn("a", np.array([7.0, 8.0, 9.0])))
    pooled = _pooled([long, short])
    assert pooled.columns[0].values.tolist() == [*np.arange(0.0, 60_000.0, 3.0), 7.0, 8.0, 9.0]
    assert pooled.columns[1].values.sum() == 3.0


def test_bad_cells_are_told_of_columns_that_are_used():
    log = log_of(LogColumn("p", np.zeros(9), bad=((4, "x"), (6, "y"))), LogColumn("q", np.zeros(9), bad=((1, "z"),)))
    found = _bad_cells([log], LogMap({"hook_load": Entry("p")}))
    assert found == ["log.csv: hook_load: 2 cells of 'p' are no numbers: line 6 'x'"]


def test_a_log_of_changes_is_told_of():
    generator = np.random.default_rng(1)
    values = np.where(generator.random(4000) < 0.02, 5.0, np.nan)
    log = log_of(LogColumn("n", np.ones(4000)), LogColumn("T", values))
    share = 100.0 * np.isfinite(values).mean()
    own = draft(None, [log], motor_speed=Entry("n"), oil_temperature=Entry("T"), hook_load=Entry("", constant="3 t"))
    (said,) = _say_of_changes(own)
    assert said.startswith(f"log.csv: a value in some rows only: 'T' ({share:.2g} %); the others stay empty")
    own = draft(None, [log], motor_speed=Entry("n"))
    assert _say_of_changes(own) == []


# -- the map's text and its settings
def test_a_map_says_what_each_column_becomes_and_is_read_back():
    import yaml

    everything = LogMap(
        {"main.pressure_a": Entry("p", "bar", sign=-1, factor=0.1 / 3.0, add=-0.25, at="motor", confidence=0.123),
         "hook_load": Entry("", constant="96 kg"), "wire_layer": Entry("L", add=1.0),
         "motor_speed": Entry("n", "%", of="2000 rpm", at="rope", differentiate=0.5)},
        ("t", "ms"), TimeBase("unix", unit="ms", fraction="us"), time_confidence=0.25, time_because="counts up",
        bad_cells="refuse", questions=("a?", "b?"),
    )  # fmt: skip
    text = map_text(everything)
    back = map_from_content(yaml.safe_load(text), "map")
    assert back.columns["main.pressure_a"] == Entry(
        "p", "bar", sign=-1, factor=float(f"{0.1 / 3.0:.12g}"), add=-0.25, confidence=0.12
    )
    assert {name: back.columns[name] for name in ("hook_load", "wire_layer", "motor_speed")} == {
        name: everything.columns[name] for name in ("hook_load", "wire_layer", "motor_speed")
    }
    assert (back.time, back.time_from, back.bad_cells) == (everything.time, ("t", "ms"), "refuse")
    assert (back.time_confidence, back.time_because, back.questions) == (0.25, "counts up", ("a?", "b?"))
    assert "  main.pressure_a:   # becomes Pa\n" in text
    assert "  wire_layer:\n" in text


def test_a_setting_answers_the_questions_of_its_channel_alone():
    own = LogMap({"hook_load": Entry("m")}, ("t",), TimeBase("datetime", order="ymd"), questions=(
        "hook_load: t or kg?", "hook_load_2: which?", "time: which zone?"))  # fmt: skip
    changed = with_settings(own, ["hook_load.unit=t"])
    assert changed.questions == ("hook_load_2: which?", "time: which zone?")
    assert changed.columns["hook_load"] == Entry("m", "t")
    changed = with_settings(own, [" time.zone = UTC "])
    assert (changed.time.zone, changed.time.order, changed.time_from) == ("UTC", "ymd", ("t",))
    assert changed.questions == own.questions[:2]
    assert with_settings(own, ["hook_load.unit=a=b"]).columns["hook_load"].unit == "a=b"
    assert with_settings(own, ["motor_speed.constant=3 rpm"]).columns["motor_speed"] == Entry("", constant="3 rpm")


def test_a_map_is_open_while_it_asks_but_not_by_what_contradicted_the_crane():
    refuse_if_open(LogMap({}, questions=("crane: the load is beyond it",)), "m.yaml")
    with pytest.raises(InputError, match=r"^m.yaml: hook_load: t\? \| time: zone\? \(answer by"):
        refuse_if_open(LogMap({}, questions=("hook_load: t?", "crane: no", "time: zone?")), "m.yaml")


def test_a_change_of_a_draft_adds_its_reason_and_may_leave_no_confidence_at_all():
    made = draft(hook_load=Entry("load", confidence=0.9, because="its name"))
    made.change("hook_load", unit="t")
    assert made.log_map.columns["hook_load"] == Entry("load", "t", confidence=0.9, because="its name")
    made.change("hook_load", 0.0, "nothing closes")
    entry = made.log_map.columns["hook_load"]
    assert (entry.confidence, entry.because, entry.unit) == (0.0, "its name; nothing closes", "t")
