"""Small tables at the desk and the headers of run files: which row, which column, how many more."""

import math

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.records.csv_file import header_text, parse_header, read_csv_run, separator_of, with_count
from winch_friction.records.table import read_table, write_table

REMARKED = "# supplier's sheet\n\nSpeed Max [rpm],p [bar],eta\n# warm\n60,200,0.9\n120,,0.8\n180,x,0.7\n240,nan,0.6\n"


@pytest.fixture
def table(tmp_path):
    path = tmp_path / "sheet.csv"
    path.write_text(REMARKED + "300,inf,0.5\n360,300,0.4\n")
    return read_table(path)


def test_a_row_is_that_of_the_file_with_its_remarks(table):
    assert table.rows == (5, 6, 7, 8, 9, 10)
    assert table.name == "sheet.csv"
    assert list(table.cells) == ["speed_max", "p", "eta"]
    assert table.units == {"speed_max": "rpm", "p": "bar", "eta": ""}
    assert ("p" in table, "q" in table) == (True, False)


def test_a_column_is_in_si_and_bare_it_is_so_already(table):
    assert table.column("speed_max", "rad/s") == pytest.approx(np.arange(1, 7) * 2.0 * math.pi)
    assert table.column("eta", "1") == pytest.approx([0.9, 0.8, 0.7, 0.6, 0.5, 0.4])


def test_the_first_three_cells_that_are_no_numbers_are_told_and_how_many_more(table):
    with pytest.raises(InputError) as refused:
        table.column("p", "Pa")
    assert [each.partition("sheet.csv ")[2] for each in refused.value.problems] == [
        "row 6: column 'p' is empty; give a number, or leave the row out",
        "row 7: column 'p' holds 'x', not a finite number",
        "row 8: column 'p' holds 'nan', not a finite number (and 1 more like it in this column)",
    ]
    with pytest.raises(InputError, match="column 'q' is missing; the table has speed_max, p, eta"):
        table.column("q", "1")


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        ([], ""), ([2], "row 7: column 'eta' = 0.7 is odd"),
        ([0, 2, 5], "row 5: column 'eta' = 0.9 is odd; the same in row 7, 10"),
        ([0, 1, 2, 3, 4, 5], "row 5: column 'eta' = 0.9 is odd; the same in row 6, 7, 8 and 2 more"),
    ],
)  # fmt: skip
def test_what_is_refused_is_told_by_its_first_row_and_the_next_three(table, bad, said):
    odd = np.isin(np.arange(6), bad)
    if not said:
        table.refuse("eta", odd, "is odd")
        return
    with pytest.raises(InputError) as refused:
        table.refuse("eta", odd, "is odd")
    assert str(refused.value).endswith(f"sheet.csv {said}")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n", "a header and at least one row are needed, found 1 line$"),
        ("# a\n\n", "are needed, found 0 lines$"),
        ("# x\na,A\n1,2\n", "row 2: column 'a' appears twice"),
        ("# x\na,b\n1,2\n3\n", "row 4: 1 cells, the header has 2 columns"),
        ("a [b,c\n1,2\n", "opens a bracket"),
    ],
)
def test_a_table_that_is_none_is_refused_with_its_row(tmp_path, text, said):
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        read_table(path)


@pytest.mark.parametrize("ending", [".xlsx", ".XLS", ".ods"])
def test_a_spreadsheet_is_to_be_saved_as_text(tmp_path, ending):
    with pytest.raises(InputError, match="a spreadsheet; save it as .csv"):
        read_table(tmp_path / f"t{ending}")


def test_a_table_that_is_written_is_read_again(tmp_path):
    path = write_table(tmp_path / "t.csv", {"speed [rpm]": [60, 120], "eta": [0.5, 0.25]}, ["one", "two"])
    assert path.read_text() == "# one\n# two\nspeed [rpm],eta\n60,0.5\n120,0.25\n"
    again = read_table(path)
    assert again.column("speed", "rad/s") == pytest.approx([2.0 * math.pi, 4.0 * math.pi])
    assert again.rows == (4, 5)


# -- headers of run files
@pytest.mark.parametrize(
    ("text", "name", "unit", "known"),
    [("motor_speed [rpm]", "motor_speed", "rpm", True), (" hook_load[ t ] ", "hook_load", "t", True),
     ("pressure_a [bar]", "pressure_a", "bar", False), ("main.pressure_a", "main.pressure_a", "", True),
     ("noise [dB] ", "noise", "dB", False)],
)  # fmt: skip
def test_a_header_is_a_name_and_a_unit(text, name, unit, known):
    found = parse_header(text)
    assert (found.name, found.unit, found.known, found.text) == (name, unit, known, text.strip())


@pytest.mark.parametrize(
    ("text", "si"),
    [("oil_temperature [degF]", [0.0, 100.0]), ("oil_temperature", [32.0, 212.0]), ("main.pressure_a [bara]",
     [32e5 - 101325.0, 212e5 - 101325.0]), ("wire_layer", [32.0, 212.0]), ("hook_load [t]", [32e3, 212e3])],
)  # fmt: skip
def test_values_of_a_header_are_scaled_and_shifted_to_si(text, si):
    assert parse_header(text).to_si(np.array([32.0, 212.0]), "t") == pytest.approx(si)


@pytest.mark.parametrize(
    ("column", "written"),
    [("motor_speed", "motor_speed [rad/s]"), ("wire_layer", "wire_layer"), ("operator", "operator"),
     ("aft.displacement", "aft.displacement [m^3/rad]")],
)  # fmt: skip
def test_a_column_is_written_with_its_unit_where_it_has_one(column, written):
    assert header_text(column) == written


def test_how_many_more_there_are_stands_behind_the_last_that_is_shown():
    assert with_count(["a", "b"], 2, "lines") == ["a", "b"]
    assert with_count(["a", "b"], 5, "lines") == ["a", "b (and 3 more lines)"]


@pytest.mark.parametrize(("header", "separator"), [("a,b,c", ","), ("a;b,c;d", ";"), ("a\tb\tc,d", "\t"), ("a", ",")])
def test_what_stands_most_often_separates(header, separator):
    assert separator_of(header) == separator


@pytest.mark.parametrize("nothing", ["", " ", "nan", "NaN", "-nan", "NA", "n/a", "null", "None"])
def test_a_word_for_nothing_is_no_number_and_no_text(tmp_path, nothing):
    path = tmp_path / "run.csv"
    rows = [f"{0.02 * k:g},1,{nothing if k == 30 else 2}" for k in range(60)]
    path.write_text("\n".join(["time,motor_speed,motor_torque", *rows]) + "\n")
    assert np.flatnonzero(np.isnan(read_csv_run(path)["motor_torque"])).tolist() == [30]
