"""Single habits of strangers' logs: each of these was once refused, read wrongly, or ended in a traceback."""

from types import SimpleNamespace

import numpy as np
import pytest
from importing.logs import write_workbook

from campaign.import_habits import became, kinds
from winch_friction.commissioning.check import quick_check
from winch_friction.importing.carry_out import import_log, open_with_map
from winch_friction.importing.cells import is_number
from winch_friction.importing.mapping import Entry, LogMap
from winch_friction.importing.names import name_concepts, name_score
from winch_friction.importing.orientation import _settle_load
from winch_friction.importing.text_log import read_text_log
from winch_friction.importing.units import header_readings
from winch_friction.importing.workbook_log import read_workbook_log
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run

MENDED = (
    "Dutch",
    "row of units in parentheses",
    "one name twice",
    "French",
    "Swedish",
    "units behind underscores",
    "two starts in one file",
    "header again in the middle",
    "a summary at the end",
    "units inside the cells",
    "parquet of strings",
    "mat v7.3",
    "load counts downwards",
    "a port is frozen",
    "groups as AHC and PHC",
    "LabVIEW measurement file",
    "MATLAB timetable v7.3",
    "WinCC archive, a row per value",
    "newest row first",
    ".NET ticks",
    "IEC time",
    "date, time and milliseconds apart",
    "seconds and nanoseconds apart",
    "slow channels with blanks",
    "negative numbers in parentheses",
    "zero bytes behind a power cut",
    "last line cut off",
    "tenths of a bar",
    "displacement negative",
    "MPa of one port, bar of the other",
)


@pytest.mark.parametrize("kind", [each for each in kinds() if each.name in MENDED], ids=lambda kind: kind.name)
def test_a_habit_is_imported_or_its_cause_is_said(kind, tmp_path):
    result = became(kind, tmp_path)
    assert result.good, f"{result.outcome}: {result.said}"


def semicolons(path, speeds):
    """A log in German: a semicolon between the cells, a comma before the decimals."""
    rows = [f"{k // 10},{k % 10};{speed};150,5" for k, speed in enumerate(speeds)]
    path.write_text("\n".join(["Zeit [s];Drehzahl [U/min];Druck A [bar]", *rows]) + "\n")
    return read_text_log(path).columns[1]


def test_thousands_at_the_begin_of_a_log_are_thousands(tmp_path):
    """The decimal mark was looked for at the end alone, where the winch stands."""
    column = semicolons(tmp_path / "log.csv", ["1.500"] * 50 + ["500"] * 600)
    assert column.values[:50].tolist() == [1500.0] * 50


@pytest.mark.parametrize("cell", ["1.500", "1_000"])
def test_what_only_python_takes_for_a_number_is_named_by_its_cell(tmp_path, cell):
    column = semicolons(tmp_path / "log.csv", ["500"] * 400 + [cell] + ["500"] * 400)
    assert column.bad == ((400, cell),)
    assert np.isnan(column.values[400])


def test_a_small_number_with_a_point_has_no_thousands():
    assert not is_number("0.500", ",", ".")
    assert is_number("1.500,5", ",", ".")


def test_how_a_map_by_hand_reads_a_log_holds_without_its_kind(tmp_path):
    """1,500 rpm is what a map says that it is."""
    (tmp_path / "log.csv").write_text("t [s];n [rpm]\n" + "".join(f"{k};1,500\n" for k in range(50)))
    for settings, value in (({}, 1.5), ({"decimal": ".", "thousands": ","}, 1500.0)):
        made = LogMap({"motor_speed": Entry("n [rpm]", "rpm")}, ("t [s]",), log=settings)
        assert open_with_map(tmp_path / "log.csv", made).columns[1].values[0] == value


@pytest.mark.parametrize(
    ("name", "said"),
    [("pressure_a", "of a motor group: write GROUP.pressure_a"), ("main.motor_speed", "of no motor group")],
)
def test_a_channel_is_of_a_group_or_is_not(tmp_path, name, said):
    (tmp_path / "log.csv").write_text("t [s],n [rpm]\n" + "".join(f"{k},5\n" for k in range(50)))
    made = LogMap({name: Entry("n [rpm]", "rpm")}, ("t [s]",))
    with pytest.raises(InputError, match=said):
        import_log(tmp_path / "log.csv", made, None)


def test_symbols_that_are_units_too_are_names_where_there_are_no_others(tmp_path):
    (tmp_path / "log.csv").write_text("\n".join(["t;n;pa;d", *(f"{k};5;7;9" for k in range(50))]) + "\n")
    assert [each.name for each in read_text_log(tmp_path / "log.csv").columns] == ["t", "n", "pa", "d"]


def test_a_byte_order_mark_is_no_part_of_a_name(tmp_path):
    """The map was made of a log without one."""
    (tmp_path / "two.csv").write_bytes(b"\xef\xbb\xbft [s],n [rpm]\n" + b"".join(b"%d,5\n" % k for k in range(50)))
    assert read_text_log(tmp_path / "two.csv", {"encoding": "utf-8"}).columns[0].name == "t [s]"


@pytest.mark.parametrize("first", ["cp1252", "utf-8"])
@pytest.mark.parametrize("later", ["cp1252", "utf-8", "utf-16"])
def test_a_later_log_of_a_set_may_have_another_encoding(tmp_path, first, later):
    """Two programs, or versions, wrote the set: 'Seillänge' was not found beside 'SeillÃ¤nge', or no text at all."""
    text = "\n".join(["Zeit [s];Seillänge [m]", *(f"{k};5" for k in range(50))])
    (tmp_path / "one.csv").write_bytes(text.encode(first))
    (tmp_path / "two.csv").write_bytes(text.encode(later))
    (tmp_path / "other.csv").write_bytes(text.replace("Seil", "Kabel").encode(later))
    settings = read_text_log(tmp_path / "one.csv").settings
    made = LogMap({"wire_out": Entry("Seillänge [m]", "m")}, ("Zeit [s]",), log=settings)
    assert len(open_with_map(tmp_path / "two.csv", made)) == 50
    with pytest.raises(InputError, match=r"other\.csv: no column 'Seillänge \[m\]'.*'Kabellänge \[m\]'"):
        open_with_map(tmp_path / "other.csv", made)


def test_rows_below_a_longer_preamble_are_found_by_the_same_map(tmp_path):
    rows = ["t [s],n [rpm]", *(f"{k},5" for k in range(50))]
    for name, preamble in (("one.csv", []), ("two.csv", ["crane 7", "logged by Kim"])):
        (tmp_path / name).write_text("\n".join([*preamble, *rows]) + "\n")
    settings = read_text_log(tmp_path / "one.csv").settings
    made = LogMap({"motor_speed": Entry("n [rpm]", "rpm")}, ("t [s]",), log=settings)
    assert len(open_with_map(tmp_path / "two.csv", made)) == 50


def test_a_map_by_hand_need_not_name_every_row_of_a_spreadsheet(tmp_path):
    pytest.importorskip("openpyxl")
    path = write_workbook(tmp_path / "log.xlsx", [["t [s]", "n [rpm]"], *([k, 5] for k in range(50))])
    log = read_workbook_log(path, {"kind": "workbook", "names_row": 1, "first_row": 2})
    assert [each.name for each in log.columns] == ["t [s]", "n [rpm]"]


@pytest.mark.parametrize(
    ("header", "name", "unit"),
    [
        ("displacement_cc_rev", "displacement", "cc/rev"),
        ("motor_speed_rad_s", "motor_speed", "rad/s"),
        ("t_s", "t", "s"),
    ],
)
def test_a_unit_of_two_words_is_read_behind_an_underscore(header, name, unit):
    assert header_readings(header)[0] == (name, unit)


WORDS = {"Motortoerental": "motor_speed", "Cylindrée": "displacement", "Charge au crochet": "hook_load"}


@pytest.mark.parametrize(("word", "channel"), WORDS.items())
def test_a_neighbours_word_names_its_channel(word, channel):
    assert name_score(channel, name_concepts(word)) > 0.6


def test_a_frozen_pressure_is_told_only_of_the_port_that_holds_the_load(crane_150t):
    time = np.arange(0.0, 60.0, 0.05)
    steady = np.ones(len(time))
    columns = {
        "time": time, "motor_speed": 80.0 * np.sin(0.5 * time), "main.pressure_a": 150e5 + 10e5 * np.sin(0.5 * time),
        "main.pressure_b": 25e5 * steady, "main.displacement": 3.4e-5 * steady, "hook_load": 77e3 * steady,
    }  # fmt: skip
    stuck = lambda changed: [
        each for each in quick_check([Run("r", {**columns, **changed})], crane_150t) if each.cause == "stuck"
    ]
    assert not stuck({})  # a boost pressure that a simulation holds
    assert stuck({"main.pressure_a": 150e5 * steady})[0].channel == "main.pressure_a"


@pytest.mark.parametrize(("empty", "turned"), [(-20.0, []), (-60e3, [-1])])
def test_a_load_is_turned_where_it_is_negative_throughout(empty, turned):
    """A cell whose zero is a bit low shows less than nothing while nothing hangs."""
    loads, signs = np.repeat([empty, 55e3 if not turned else -55e3], 500), []
    draft = SimpleNamespace(
        converted=lambda: [SimpleNamespace(columns={"hook_load": loads})],
        change=lambda _, **to: signs.append(to["sign"]),
    )
    _settle_load(draft)
    assert signs == turned


@pytest.mark.parametrize("head", [(), ("crane 7", "logged by Kim, at sea")])
def test_commas_between_marks_that_cut_every_line_are_of_decimals(head, tmp_path):
    """Of one value a row, `;N;-461,8` was cut at the comma: half of the cells were numbers then, and a third before."""
    rows = [f"2026-05-13 08:00:{k % 60:02d}.{k:03d};N;-461,{k}" for k in range(100)]
    (tmp_path / "log.csv").write_text("\n".join([*head, "Zeit;Signal;Wert", *rows]) + "\n")
    time, _, value = read_text_log(tmp_path / "log.csv").columns
    assert (time.name, value.name, value.values[7]) == ("Zeit", "Wert", -461.7)
    (tmp_path / "log.csv").write_text("\n".join(["t,n,p", *(f"{k},{k % 7},150;" for k in range(100))]) + "\n")
    assert [each.name for each in read_text_log(tmp_path / "log.csv").columns] == ["t", "n", "p"]


@pytest.mark.parametrize("text", ["OK;RUN", "a\tb", "on|off", "1;2", "1|2", "lift; slow; 55 t", "a;b;c;d;e;f;g"])
def test_another_mark_in_a_text_of_every_line_does_not_cut_a_table_of_commas(text, tmp_path):
    """A state that was written OK;RUN in every row cut the lines alike: "no rows of numbers found"."""
    rows = [f"{0.1 * k:.1f},{k % 7},{150 + k}.5,{text}" for k in range(100)]
    (tmp_path / "log.csv").write_text("\n".join(["t,n,p,state", *rows]) + "\n")
    columns = read_text_log(tmp_path / "log.csv").columns
    assert [each.name for each in columns] == ["t", "n", "p", "state"]
    assert columns[2].values[7] == 157.5


@pytest.mark.parametrize("properties", [(), ("Length", "Minimum", "Maximum", "Offset", "Factor", "Mean:")])
def test_labelled_properties_of_columns_are_no_values(properties, tmp_path):
    """Of `Length; 3000` in the column of the time it was said that the time goes back by 3000 s."""
    head = ["Name;Zeit;Drehzahl;pA", "Unit;s;1/min;bar", *(f"{each};3000;3000;3000" for each in properties)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join([*head, *(f"{'brake off' * (k == 0)};{k},5;7,5;100,5" for k in range(50))]) + "\n")
    columns = read_text_log(path).columns[1:]
    assert [(each.name, each.unit, each.values[0], len(each.values)) for each in columns] == [
        ("Zeit", "s", 0.5, 50), ("Drehzahl", "1/min", 7.5, 50), ("pA", "bar", 100.5, 50)
    ]  # fmt: skip
