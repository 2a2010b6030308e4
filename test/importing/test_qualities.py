"""Values that a log calls bad itself, in a column behind them, are none; any other column of words is left alone."""

import numpy as np
import pytest
from importing.logs import example, rows_of, write_text, write_workbook

from winch_friction.importing.log import LogColumn, _bad_by
from winch_friction.importing.reading import read_log

LOST = (40, 41, 700)  # rows


@pytest.fixture(scope="module")
def rows():
    return rows_of(example("test_02"))


def with_quality(rows, head, good, bad, at=3):
    """A column of qualities behind number `at`, whose values are 0 where they are bad."""
    out = [[*rows[0][: at + 1], head, *rows[0][at + 1 :]]]
    for k, row in enumerate(rows[1:]):
        cells = [*row[:at], "0" if k in LOST else row[at]]
        out.append([*cells, bad if k in LOST else good, *row[at + 1 :]])
    return out


@pytest.mark.parametrize("write", [write_text, write_workbook])
@pytest.mark.parametrize(
    ("head", "good", "bad"),
    [("Quality", "Good", "Bad"), ("Druck A Qualität", "gut", "unsicher"), ("PT101_Quality", "192", "24")],
)
def test_what_a_log_calls_bad_is_no_value(write, head, good, bad, rows, tmp_path):
    """A layer of 0 and pressures of 0, each beside 'Bad', were read as data."""
    log = read_log(
        write(tmp_path / ("a.csv" if write is write_text else "a.xlsx"), with_quality(rows, head, good, bad))
    )
    values = log.columns[3].values
    assert np.flatnonzero(np.isnan(values)).tolist() == list(LOST)
    (said,) = [each for each in log.notes if "not good by" in each]
    assert said.startswith(f"3 values of '{log.columns[3].name}' not good by '{log.columns[4].name}', first in ")
    assert np.isfinite(log.columns[2].values).all()


@pytest.mark.parametrize(
    ("head", "good", "bad"),
    [("Status", "Good", "Bad"), ("Quality", "Betrieb", "Bad"), ("Oil quality", "17", "24"), ("Equality", "192", "0")],
)
def test_another_column_says_nothing_of_the_one_before_it(head, good, bad, rows, tmp_path):
    log = read_log(write_text(tmp_path / "a.csv", with_quality(rows, head, good, bad)))
    assert np.isfinite(log.columns[3].values).all()


def test_a_quality_of_which_nothing_is_good_is_none():
    """Then it is more likely that its words mean something else than that a whole log is bad."""
    words = np.array(["Bad", "", "Bad"], dtype=object)
    assert _bad_by(LogColumn("Quality", np.full(3, np.nan), text=words)) is None
    assert _bad_by(LogColumn("Quality", np.array([0.0, 0.0, 24.0]))) is None
