"""Rows that are no values, between these or below, and rows that hold only what has changed."""

import numpy as np
import pytest
from importing.logs import example, rows_of, write_text

from winch_friction.importing.layout import find_layout
from winch_friction.importing.propose import propose
from winch_friction.importing.reading import read_log
from winch_friction.importing.text_log import read_text_log


@pytest.fixture(scope="module")
def rows():
    return rows_of(example("test_02"))


@pytest.mark.parametrize(
    "words", [["# Logger neu gestartet"], ["Anzahl Werte", "4980"], ["Ende der Aufzeichnung", "", ""]]
)
def test_a_remark_of_the_logger_is_no_row_of_values(words, rows, tmp_path):
    """'Anzahl Werte' below the rows was refused as no time, in every log of a set."""
    whole = read_text_log(write_text(tmp_path / "whole.csv", rows))
    log = read_text_log(write_text(tmp_path / "log.csv", [*rows[:200], words, *rows[200:], words]))
    assert [len(each.values) for each in log.columns] == [len(rows) - 1] * len(rows[0])
    (said,) = [each for each in log.notes if "no row of values" in each]
    assert said == f"2 lines are no row of values (line 201: '{' | '.join(w for w in words if w)}'): left out"
    assert log.place(199) == "line 202"  # the lines of what is left are the file's
    assert whole.notes == ()


@pytest.mark.parametrize("first", ["Bad", "", "?", "17"])
def test_a_row_whose_first_cell_has_no_value_stays(first, rows, tmp_path):
    lost = [first, *[""] * (len(rows[0]) - 1)]
    lost[1] = rows[5][1]
    log = read_text_log(write_text(tmp_path / "log.csv", [*rows[:200], lost, *rows[200:]]))
    assert len(log.columns[0].values) == len(rows)


def test_a_summary_below_the_rows_is_none_of_them(tmp_path, crane_150t):
    """'Mittelwert;;112,3;...' was refused as no time: it has as many cells as a row."""
    run = example("test_02")
    rows = rows_of(run)
    log = write_text(tmp_path / "log.csv", [*rows, ["Mittelwert:", *rows[5][1:]], ["MAX", *rows[6][1:]]])
    read = read_log(log)
    assert len(read) == len(run)
    assert any("2 lines are no row of values" in each and "Mittelwert" in each for each in read.notes)


def test_a_row_of_types_says_no_units(tmp_path, crane_150t):
    """'D', a double, was a day, in which no channel is, and the time went back 'by -0.1 s'."""
    names, *rows = rows_of(example("test_02"), decimal=".")
    kinds = [["#TYPES"], ["date", *["D"] * (len(names) - 1)], ["#ROWS", str(len(rows))]]
    log = write_text(tmp_path / "log.csv", [["#NAMES"], names, *kinds, *rows], ",")
    read = read_log(log)
    assert {each.unit for each in read.columns} == {""}
    assert propose([log], crane_150t, "crane_150t").log_map.time_from == ("Zeit",)


def test_a_table_that_begins_with_words_has_no_remarks(rows, tmp_path):
    named = [["Anlage", *rows[0]], *(["Kran 2", *row] for row in rows[1:])]
    few = ["Kran 2", rows[5][0], *[""] * (len(rows[0]) - 1)]
    log = read_text_log(write_text(tmp_path / "log.csv", [*named[:200], few, *named[200:]]))
    assert len(log.columns[1].values) == len(rows)


def changes_only(rows):
    """What a logger writes that reports by exception: the last columns, which hardly change, in its first row alone."""
    kept = np.random.default_rng(3).random((len(rows), len(rows[0]))) < 0.3
    kept[0], kept[1], kept[:, 0], kept[2:, -3:] = True, True, True, False
    return [[cell if k else "" for cell, k in zip(row, own, strict=True)] for row, own in zip(rows, kept, strict=True)]


def test_a_log_of_changes_alone_keeps_its_names(rows, tmp_path, crane_150t):
    """Its header was left out as wider than the table, and another one was "no rows of numbers"."""
    log = read_text_log(write_text(tmp_path / "log.csv", changes_only(rows)))
    assert [each.name.partition(" [")[0] for each in log.columns] == [each.partition(" [")[0] for each in rows[0]]
    made = propose([log.path], crane_150t, "crane_150t")
    assert {"motor_speed", "main.pressure_a", "main.displacement"} <= set(made.log_map.columns)


def test_names_may_stand_above_columns_without_a_value_for_long():
    rows = [["time", "speed", "layer"], *([f"{0.02 * k:.2f}", f"{k}.5", ""] for k in range(50))]
    wide = [[*row, "", "", ""] for row in rows]
    wide[0][3:] = ["oil", "load", "wire"]
    assert find_layout(wide, ".").names == 0
    wide[0][4] = ""
    assert find_layout(wide, ".").names == -1  # a note beside the table


@pytest.mark.parametrize("labels", [["Port"], ["Port", "Size"], ["Port", "Size", "Kind", "Rate"]])
def test_every_row_of_a_programs_head_is_above_the_values(labels):
    """Each of them has numbers, behind labels; of several the first one was taken for the first row of values."""
    names, head = ["Name", "speed", "Name", "load"], [[label, "851", label, "8"] for label in labels]
    values = [[str(k), f"{0.1 * k:.1f}", str(k), f"{0.3 * k:.1f}"] for k in range(40)]
    found = find_layout([names, *head, *values], ".")
    assert (found.names, found.first) == (0, 1 + len(labels))


@pytest.mark.parametrize(("names", "asked"), [(["rope speed [m/s]", "motor speed [rpm]"], False),
                                              (["rope speed [m/s]", "oil temperature [degC]"], True)])  # fmt: skip
def test_a_ropes_speed_without_a_crane_is_asked_about_where_no_motors_is_there(names, asked, tmp_path):
    speed = np.sin(0.1 * np.arange(100))
    table = [
        ["time [s]", *names],
        *([f"{0.1 * k:.1f}", f"{v:.3f}", f"{40.0 + 9 * v:.2f}"] for k, v in enumerate(speed)),
    ]
    made = propose([write_text(tmp_path / "log.csv", table)], None, None)
    assert any("is a speed of the rope; give --crane" in each for each in made.log_map.questions) == asked


def test_columns_of_words_are_no_head_however_long_they_last():
    rows = [["time", "state", "mode", "speed"], *([f"{0.02 * k:.2f}", "OFF", "AHC", f"{k}.5"] for k in range(40))]
    assert find_layout(rows, ".").first == 1
