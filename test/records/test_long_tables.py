"""Long CSV files: block by block, told by their own lines, and never whole in memory as text."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.runs import read_run, write_run


def _table(folder: Path, text: str) -> Path:
    path = folder / "run.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def small_blocks(monkeypatch):
    monkeypatch.setattr("winch_friction.records.csv_file.BLOCK", 2)


def test_a_long_file_is_read_block_by_block_and_told_by_its_own_lines(tmp_path, small_blocks):
    head = "time,motor_speed,motor_torque,batch\n"
    run = read_run(_table(tmp_path, head + "0,1,2,7\n1,,3,8\n2,5,4,\n3,6,5,x\n4,7,6,9\n"))
    np.testing.assert_array_equal(run["motor_speed"], [1.0, np.nan, 5.0, 6.0, 7.0])
    assert run["motor_torque"].tolist() == [2.0, 3.0, 4.0, 5.0, 6.0]
    assert list(run.aside["batch"]) == ["7", "8", "", "x", "9"]
    with pytest.raises(InputError, match=r"line 5, column 'motor_torque': '4,5'.*and 1 more") as caught:
        read_run(_table(tmp_path, head + '0,1,2,7\n1,1,3,8\n2,5,4,\n3,6,"4,5",x\n4,7,a,9\n5,7,b,9\n6,7,c,9\n'))
    assert "line 8" not in str(caught.value)
    with pytest.raises(InputError, match="line 6: 3 values for 4 columns"):
        read_run(_table(tmp_path, head + "0,1,2,7\n1,1,3,8\n2,5,4,\n3,6,5,x\n4,7,6\n5,7,a,9\n"))


def test_a_long_file_is_not_held_as_text(tmp_path):
    """A million rows of fifteen columns took 1.9 GB, five times what their text and their numbers do."""
    rows = 60_000
    columns = {"time": np.arange(rows) * 0.01, "motor_speed": np.linspace(0.1, 99.9, rows) / 3.0}
    path = write_run(Run("x", columns | {"motor_torque": np.linspace(1, 2, rows) / 3.0}), tmp_path / "long.csv")
    tracemalloc.start()
    read_run(path)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2.5 * path.stat().st_size + 8 * 3 * rows + 4e6, peak / path.stat().st_size
