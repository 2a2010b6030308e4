"""Run files as other programs write them: dates as such, names in capitals."""

import json

import numpy as np
import pytest
import yaml
from run_strategies import make_run

from winch_friction.cli.inputs import run_paths
from winch_friction.cli.live import bag_frames
from winch_friction.importing.reading import read_log
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records.runs import read_run, write_run
from winch_friction.replay.recording import replay_recording


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


@pytest.mark.parametrize("kind", ["mcap", "db3"])
def test_a_bag_in_capitals_is_a_bag(tmp_path, kind, crane_150t, crane2_model):
    """It was listed as a run of the folder and refused as no kind of run file."""
    written = write_run(make_run(groups=("active", "passive"), rows=100), tmp_path / f"run.{kind}")
    path = written.rename(tmp_path / f"RUN.{kind.upper()}")
    assert len(read_run(path)) == 100
    (found,) = run_paths([tmp_path])
    assert len(read_run(found)) == 100
    assert len(replay_recording(path, crane_150t, crane2_model).compensator)
    assert len(read_log(path)) == 100
    for bag in (path, tmp_path):
        assert sum(len(frame["points"].get("speed", ())) for frame in bag_frames(bag, "", 0.0))


@pytest.mark.parametrize("start", [500.0, 1.7e9])
def test_rows_before_the_clock_was_set_are_left_out(tmp_path, start):
    """A run that began at 0 and went on in 1970 or 2023 was one with a gap of years."""
    run = make_run(rows=100)
    times = np.where(np.arange(100) < 5, 0.0, start + run.time)
    back = read_run(write_run(Run("x", {**run.columns, "time": times}), tmp_path / "x.csv"))
    assert np.array_equal(back.time, times[5:])
    (said,) = back.warnings
    assert "5 rows of time 0" in said
    assert "line 2, line 3, line 4 and 2 more" in said
    assert len(read_run(write_run(run, tmp_path / "from_zero.csv"))) == 100


SPOILT = ("{'crane': 'x'}", "[1, 2]", "")


@pytest.mark.parametrize("text", SPOILT)
def test_what_a_parquet_file_keeps_of_itself_and_is_no_json_is_said(tmp_path, text):
    """Another tool had written it anew: a traceback."""
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    path = write_run(Run("x", make_run(rows=100).columns, metadata={"crane": "c"}), tmp_path / "x.parquet")
    parquet.write_table(parquet.read_table(path).replace_schema_metadata({"winch_friction": text}), path)
    run = read_run(path)
    assert (len(run), dict(run.metadata)) == (100, {})
    assert sum("crane, settings" in each for each in run.warnings) == 1


@pytest.mark.parametrize("text", SPOILT)
def test_what_a_bag_keeps_of_itself_and_is_no_json_is_said(tmp_path, text):
    path = write_run(Run("x", make_run(rows=100).columns, metadata={"crane": "c"}), tmp_path / "x")
    file = path / "metadata.yaml"
    content = yaml.safe_load(file.read_text())
    assert json.loads(content["rosbag2_bagfile_information"]["custom_data"]["winch_friction"]) == {"crane": "c"}
    content["rosbag2_bagfile_information"]["custom_data"]["winch_friction"] = text
    file.write_text(yaml.safe_dump(content))
    run = read_run(path)
    assert (len(run), dict(run.metadata)) == (100, {})
    assert sum("crane, settings" in each for each in run.warnings) == 1


def test_a_replay_of_a_spoilt_folder_is_refused_in_one_line(tmp_path, crane_150t, crane2_model):
    """Its settings are looked for before it is opened."""
    path = write_run(make_run(rows=100), tmp_path / "x")
    (path / "metadata.yaml").write_text("rosbag2_bagfile_information: [")
    with pytest.raises(InputError, match="not a readable rosbag2 recording"):
        replay_recording(path, crane_150t, crane2_model)


def test_a_file_of_bytes_is_no_table(tmp_path):
    path = tmp_path / "log.csv"
    path.write_bytes(b"time,motor_speed\n0,1\n0.02,\x001\n")
    with pytest.raises(InputError, match="zero bytes.*expected CSV"):
        read_run(path)
