"""Units that a Parquet file says beside its names, in the three ways in which programs write them."""

import json
import time
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from winch_friction.importing.reading import read_log
from winch_friction.physics.channels import RPM
from winch_friction.physics.errors import InputError
from winch_friction.records.crane_file import load_crane
from winch_friction.records.parquet_units import said_units
from winch_friction.records.runs import read_run

UNITS = {"motor_speed": "rpm", "main.pressure_a": "bar", "main.pressure_b": "kPa", "main.displacement": "cm^3/rev",
         "hook_load": "t", "wire_layer": "-", "other": "furlong"}  # fmt: skip
TIME = np.linspace(0.0, 9.0, 10)
VALUES = {"time": TIME, "motor_speed": 100.0 * TIME, "main.pressure_a": 200.0 + TIME, "main.pressure_b": 2500.0 + TIME,
          "main.displacement": 215.0 + 0.0 * TIME, "hook_load": 55.0 + TIME, "wire_layer": 6.0 + 0.0 * TIME,
          "other": TIME}  # fmt: skip


def by_column(units, key="unit"):
    notes = {name: {key: unit} for name, unit in units.items()}
    fields = [pa.field(name, pa.float64(), metadata=notes.get(name)) for name in VALUES]
    return pa.table(list(VALUES.values()), schema=pa.schema(fields))


def by_file(key, content):
    return pa.table(VALUES).replace_schema_metadata({key: json.dumps(content)})


@pytest.mark.parametrize(
    "table",
    [by_column(UNITS), by_column(UNITS, "Units"), by_file("units", UNITS), by_file("PANDAS_ATTRS", {"units": UNITS})],
    ids=["unit", "Units", "file", "pandas"],
)
def test_a_run_is_read_in_the_units_that_the_file_says(tmp_path, table):
    pq.write_table(table, tmp_path / "r.parquet")
    run = read_run(tmp_path / "r.parquet", load_crane("crane_150t"))
    assert run["motor_speed"][-1] == pytest.approx(900.0 * RPM)
    assert run["main.pressure_b"][0] == pytest.approx(2.5e6)
    assert run["hook_load"][0] == pytest.approx(55e3)
    assert list(run.aside) == ["other"]
    units = {column.name: column.unit for column in read_log(tmp_path / "r.parquet").columns}
    assert units == {"time": ""} | UNITS


def test_a_bracket_goes_before_a_note_and_a_unit_that_does_not_fit_is_refused(tmp_path):
    speed = pa.field("motor_speed [rad/s]", pa.float64(), metadata={"unit": "rpm"})
    noted = pa.schema([pa.field("time", pa.float64()), speed])
    pq.write_table(pa.table([TIME, TIME], schema=noted), tmp_path / "r.parquet")
    assert read_run(tmp_path / "r.parquet", complete=False)["motor_speed"][-1] == 9.0
    pq.write_table(by_column({"motor_speed": "bar"}), tmp_path / "w.parquet")
    with pytest.raises(InputError, match=r"motor_speed \[bar\]"):
        read_run(tmp_path / "w.parquet", complete=False)


@pytest.mark.parametrize("content", ["rpm", "[1, 2]", '{"motor_speed": 7, "hook_load": " "}'])
def test_notes_that_are_no_units_say_nothing(content):
    assert said_units(pa.table(VALUES).replace_schema_metadata({"units": content}).schema) == {}


def test_what_a_table_took_is_given_back_once_it_is_gone(tmp_path, monkeypatch):
    """A table is as large as its run, and a pool keeps what it has unless it is asked when the table is no more."""
    path, pool, left = tmp_path / "long.parquet", pa.default_memory_pool(), []
    pq.write_table(pa.table({"time": np.arange(20000) * 0.02, "motor_speed": np.ones(20000)}), path)
    before = pool.bytes_allocated()

    def release_unused():
        end = time.monotonic() + 2.0  # the file's own threads let go of what they read in their time
        while pool.bytes_allocated() > before and time.monotonic() < end:
            time.sleep(0.01)
        left.append(pool.bytes_allocated() - before)

    asked = SimpleNamespace(release_unused=release_unused)
    monkeypatch.setattr(pa, "default_memory_pool", lambda: asked)
    assert len(read_run(path, complete=False)) == 20000
    assert left == [0]
