"""A long text log is cut a block at a time: the same columns as in one piece, in a small multiple of its size."""

import tracemalloc

import numpy as np
import pytest

from winch_friction.importing import text_columns
from winch_friction.importing.text_log import read_text_log

HEAD = "time [s];speed [rpm];pressure;state;load [t]"


def written(path, rows, **strange):
    """A log of so many rows; `strange`: rows that stand in place of the plain one, by their number."""
    lines = [f"{k * 0.02:.2f};{k % 700}.5;{k % 90} bar;ok;55.0" for k in range(rows)]
    for number, line in strange.items():
        lines[int(number[1:])] = line
    path.write_text("\n".join([HEAD, *lines]) + "\n")
    return path


STRANGE = {
    "a bad cell in a late block": {"_93": "1.86;***;3 bar;ok;55.0"},
    "numbers alone in the last block": {f"_{k}": f"{k}.0;text;3 bar;ok;55.0" for k in range(60)},
    "an infinite value": {"_50": "1.00;inf;3 bar;ok;55.0"},
    "the head again": {"_33": HEAD, "_66": HEAD},
    "short rows and blank lines": {"_20": "0.40;7", "_70": "", "_71": "1.42"},
    "a cell over two lines": {"_40": '0.80;7.0;3 bar;"o\nk";55.0'},
}


@pytest.mark.parametrize("name", STRANGE)
def test_blocks_are_the_whole(name, tmp_path, monkeypatch):
    path = written(tmp_path / "log.csv", 100, **STRANGE[name])
    whole = read_text_log(path)
    monkeypatch.setattr(text_columns, "_BLOCK", 7)
    monkeypatch.setattr(text_columns, "_TOGETHER", 1)
    blocks = read_text_log(path)
    assert (blocks.settings, blocks.notes) == (whole.settings, whole.notes)
    assert [blocks.place(k) for k in range(len(whole))] == [whole.place(k) for k in range(len(whole))]
    for ours, theirs in zip(blocks.columns, whole.columns, strict=True):
        assert (ours.name, ours.unit, ours.note, ours.bad) == (theirs.name, theirs.unit, theirs.note, theirs.bad)
        assert (ours.text is None) == (theirs.text is None)
        assert ours.text is None or list(ours.text) == list(theirs.text)
        np.testing.assert_array_equal(ours.values, theirs.values)


def test_a_cell_is_where_it_was_found(tmp_path):
    """By hand: line 42 of the file holds the row that the cell over two lines began, so that the next is line 43."""
    log = read_text_log(written(tmp_path / "log.csv", 100, **STRANGE["a cell over two lines"]))
    assert [log.place(k) for k in (39, 40, 41)] == ["line 41", "line 43", "line 44"]
    assert log.column("time [s]").values[41] == pytest.approx(0.82)


def test_memory_is_a_few_times_the_text(tmp_path):
    path, columns = tmp_path / "log.csv", [f"c{k}" for k in range(14)]
    rows = (",".join([f"{k * 0.02:.2f}", *(f"{k % 97}.{c}5432" for c in range(14))]) for k in range(20_000))
    path.write_text("\n".join([",".join(["time [s]", *columns]), *rows]) + "\n")
    read_text_log(path)  # with all that is imported on the way
    tracemalloc.start()
    try:
        read_text_log(path)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 8.0 * path.stat().st_size  # 5.5 times; 14.4 times with all cells at once
