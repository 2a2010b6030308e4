"""Run files as other programs write them: dates as such, names in capitals."""

import numpy as np
import pytest
from run_strategies import make_run

from winch_friction.physics.errors import InputError
from winch_friction.records.runs import read_run, write_run


@pytest.mark.parametrize("unit", ["ns", "us", "ms"])
def test_dates_of_a_parquet_file_are_seconds(tmp_path, unit):
    """As pandas writes an index of times: nanoseconds were read as seconds."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    ticks = (20 * np.arange(100)).astype("timedelta64[ms]").astype(f"timedelta64[{unit}]")
    columns = {name: values[:1].repeat(100) for name, values in make_run().columns.items()}
    for name, times in (("dates", np.datetime64("2026-03-01T10:00", unit) + ticks), ("durations", ticks)):
        path = tmp_path / f"{name}.parquet"
        parquet.write_table(pyarrow.table({**columns, "time": times}), path)
        assert np.diff(read_run(path).time) == pytest.approx(np.full(99, 0.02), abs=1e-6)
    assert read_run(tmp_path / "dates.parquet").time[0] == 1_772_359_200.0
    parquet.write_table(pyarrow.table({**columns, "time": 0.02 * np.arange(100), "hook_load": ticks}), path)
    with pytest.raises(InputError, match="hook_load.*are not numbers"):
        read_run(path)


def test_a_logger_under_windows_writes_capitals(tmp_path):
    run = write_run(make_run(rows=3), tmp_path / "log.csv")
    assert len(read_run(run.rename(tmp_path / "LOG.CSV"))) == 3
