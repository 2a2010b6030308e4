"""Rows of a text log and of a workbook's sheet, from made-up lines and cells: their lines, heads, units and ends."""

import zipfile
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.importing import text_columns, text_log, workbook_log, workbook_sheets
from winch_friction.importing.log import LogColumn
from winch_friction.importing.text_rows import SEEN, TextRows
from winch_friction.importing.workbook_sheets import ROWS_PEEKED, _as_openpyxl, _rows_of, refuse_bombs
from winch_friction.physics.errors import InputError


def rows_of(lines, delimiter=";"):
    return TextRows(Path("log.csv"), lines, delimiter)


# -- text
def test_a_long_log_has_a_head_a_tail_and_any_row_between():
    rows = rows_of(["t;p", *(f"{k};{2 * k}" for k in range(1000))])
    assert (len(rows.head), len(rows.tail), len(rows)) == (SEEN, SEEN, 1001)
    assert SEEN >= 100  # what is told from them needs as many
    for index in (0, 1, SEEN - 1, SEEN, SEEN + 1, 700, 1000):
        assert rows.row(index) == (["t", "p"] if index == 0 else [str(index - 1), str(2 * index - 2)])
    assert (rows.head[-1], rows.tail[0], rows.tail[-1]) == (rows.row(299), rows.row(701), rows.row(1000))


def test_units_in_cells_go_above_the_first_that_bears_one_in_a_long_log_too():
    named = ["note;bar;", "t;p;q"]
    rows = rows_of([*named, *(f"{k};{k} bar;{k} x9" for k in range(1000))])
    notes = []
    rows.take_units_out(notes)
    assert rows.head[:4] == [["note", "bar", ""], ["t", "p [bar]", "q"], ["0", "0", "0 x9"], ["1", "1", "1 x9"]]
    assert rows.tail[0] == rows.row(702) == ["700", "700", "700 x9"]
    assert [row[1] for row in rows][-1] == rows.tail[-1][1] == "999"
    assert notes == ["cells of 1 columns bear their unit: taken off (bar)"]
    bare = rows_of(["t;p", *(f"{k};{k} bar" for k in range(400)), *(f"{k};{k}" for k in range(600))])
    bare.take_units_out(notes)  # at the end none: what stands above is no unit of the column's
    assert (bare.row(1), len(notes)) == (["0", "0 bar"], 1)
    headless = rows_of([f"{k};{k} bar" for k in range(5)])
    headless.take_units_out([])
    assert list(headless) == [["0", "0 bar"], *([str(k), str(k)] for k in range(1, 5))]


def test_blank_lines_are_counted_and_are_no_rows():
    spaced = rows_of(["a  b", "", "1   2", "  ", "3 4"], " ")
    assert (list(spaced), list(spaced.numbers)) == ([["a", "b"], ["1", "2"], ["3", "4"]], [1, 3, 5])
    commas = rows_of(["sep=,", "a,b", ",", '"1', '2",3', "sep=x,4"], ",")
    assert (list(commas), list(commas.numbers)) == (
        [["a", "b"], ["1\n2", "3"], ["sep=x", "4"]], [2, 5, 6],
    )  # fmt: skip
    with pytest.raises(InputError, match=r"^log.csv: line 2: "):
        rows_of(["a,b", "1," + "9" * 200_000], ",")


# -- workbooks
def test_a_sheets_years_above_and_numbers_below_are_what_they_were():
    body = [[float(k), "", 1.5] for k in range(ROWS_PEEKED + 20)]
    found = _as_openpyxl([["t", 2026.0, True], *body, ["", "", ""], ["-", "n/a", ""]])
    assert ROWS_PEEKED >= 100
    assert found[0] == ["t", 2026, True]
    assert type(found[0][1]) is int
    assert len(found) == 1 + len(body)
    assert found[1] == [0, None, 1.5]
    assert [row[0] for row in found[1:]] == [row[0] for row in body]
    assert (type(found[ROWS_PEEKED - 1][0]), type(found[ROWS_PEEKED][0])) == (int, float)
    assert len(_as_openpyxl([["x"] * 1500])[0]) == 1000


@pytest.mark.parametrize(("columns", "reset"), [(16384, 1), (1000, 0), (None, 0)])
def test_a_sheet_that_says_it_is_wide_is_asked_again_and_cut(columns, reset):
    asked = []
    rows = [tuple(range(1200)), (None, ""), (None, None)]
    sheet = SimpleNamespace(max_column=columns, reset_dimensions=lambda: asked.append(1),
                            iter_rows=lambda values_only: iter(rows))  # fmt: skip
    assert _rows_of(Path("a.xlsx"), sheet) == [tuple(range(1000))]
    assert len(asked) == reset


@pytest.mark.parametrize(("packed", "unpacked", "refused"), [
    (100 << 10, 32 << 20, False), (100 << 10, (32 << 20) + 1, True), (1 << 20, 199 << 20, False),
    (1 << 20, 201 << 20, True), (9 << 20, 399 << 20, False), (9 << 20, 401 << 20, True),
])  # fmt: skip
def test_a_workbook_that_unpacks_beyond_its_size_is_refused_unread(packed, unpacked, refused, tmp_path, monkeypatch):
    path = tmp_path / "log.xlsx"
    path.write_bytes(b"")
    half = SimpleNamespace(file_size=unpacked - 7), SimpleNamespace(file_size=7)

    class Archive:
        def __init__(self, path):
            self.infolist = lambda: half

        __enter__ = lambda self: self
        __exit__ = lambda self, *error: None

    monkeypatch.setattr(zipfile, "ZipFile", Archive)
    monkeypatch.setattr(Path, "stat", lambda self, **_: SimpleNamespace(st_size=packed))
    if not refused:
        refuse_bombs(path)
        refuse_bombs(path.with_suffix(".XLS"))
        return
    with pytest.raises(InputError, match=rf"unpacks from {packed >> 10} kB to {unpacked >> 20} MB"):
        refuse_bombs(path)
    refuse_bombs(path.with_suffix(".xls"))  # packed by nothing


@pytest.mark.parametrize("values", [True, False])
def test_a_book_is_opened_for_its_values_or_for_its_formulas(values, monkeypatch):
    asked = []
    library = SimpleNamespace(load_workbook=lambda path, **options: asked.append(options))
    monkeypatch.setattr(workbook_sheets, "library", lambda *_: library)
    workbook_sheets.open_book(Path("a.xlsx"), values)
    assert asked == [{"read_only": True, "data_only": values}]


@pytest.mark.parametrize(("cells", "sideways"), [(1200, False), (1600, True)])
def test_a_table_lies_on_its_side_where_its_rows_have_ten_times_as_many_cells_as_there_are_rows(cells, sideways):
    """150 rows: of more than 1000 cells each, and of more than 1500."""
    lines = [";".join([f"channel {k}", *["1.5"] * (cells - 1)]) for k in range(150)]
    with pytest.raises(InputError, match="the channels stand in rows") if sideways else nullcontext():
        text_log._refuse_channels_in_rows(Path("log.csv"), lines, ";")


def test_a_row_has_as_many_cells_as_the_table_is_wide():
    assert text_columns.padded(["1", "2", "3"], 2) == ["1", "2"]
    assert text_columns.padded(["1"], 3) == ["1", "", ""]


@pytest.mark.parametrize("cell", ["=A1", 5.0])
def test_a_workbook_that_was_opened_for_its_formulas_is_closed(cell, monkeypatch):
    closed = []
    sheet = SimpleNamespace(iter_rows=lambda *place, **more: [(cell,)])
    book = type("Book", (dict,), {"close": lambda self: closed.append(True)})(Data=sheet)
    monkeypatch.setattr(workbook_log, "open_book", lambda path, values: book)
    column = LogColumn("load", np.array([1.0, np.nan]))
    said = workbook_log._formulas_without_values(Path("log.xlsx"), "Data", [column], [2, 3])
    assert closed == [True]
    assert len(said) == (cell == "=A1")
