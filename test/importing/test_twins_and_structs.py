"""Columns of one name, decimals of databases, Simulink's structures: nothing is lost or taken for something else."""

from decimal import Decimal

import numpy as np
import pytest
from logs import EXAMPLES, example, rows_of, write_text

from winch_friction.cli.main import run
from winch_friction.importing.carry_out import import_log
from winch_friction.importing.propose import propose
from winch_friction.records.crane_file import load_crane

OTHER = 1.1  # times: another cell, of the same load


def proposed(path):
    return propose([path], load_crane("crane_150t"), "crane_150t")


@pytest.mark.parametrize("factor", [1.0, OTHER])
def test_a_column_that_stands_twice_is_no_other_channel(tmp_path, factor):
    own = example("test_01")
    rows = rows_of(own)
    at = rows[0].index("Hakenlast [t]")
    rows = [row[: at + 1] + [row[at] if factor == 1.0 or n == 0 else f"{factor * own['hook_load'][n - 1] / 1e3:.3f}"
            .replace(".", ",")] + row[at + 1 :] for n, row in enumerate(rows)]  # fmt: skip
    rows = [row[: len(rows[0])] for row in rows]
    found = proposed(write_text(tmp_path / "log.csv", rows))
    twins = {"Hakenlast [t]", "Hakenlast [t] #2"}
    assert [c for c, e in found.log_map.columns.items() if e.source in twins] == ["hook_load"]
    asked = [each for each in found.problems if "bear one name and differ; set hook_load.from to one" in each]
    assert len(asked) == (factor != 1.0)


def test_decimals_of_a_database_are_numbers(tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_parquet(EXAMPLES / "test_01.parquet")
    name = next(each for each in frame.columns if each.startswith("hook_load"))
    frame[name] = [Decimal(f"{value:.3f}") for value in frame[name]]
    frame.to_parquet(tmp_path / "log.parquet")
    found = proposed(tmp_path / "log.parquet")
    assert found.log_map.columns["hook_load"].source == name


@pytest.mark.parametrize("labelled", [True, False])
def test_simulink_s_structure_with_time_has_its_signals(tmp_path, labelled):
    from scipy.io import savemat

    own = example("test_01")
    signals = {"Motor speed [rad/s]": "motor_speed", "Pressure A [Pa]": "main.pressure_a",
               "Pressure B [Pa]": "main.pressure_b", "Displacement [m^3/rad]": "main.displacement",
               "Hook load [kg]": "hook_load"}  # fmt: skip
    array = np.empty(len(signals), dtype=[("values", "O"), ("label", "O")])
    for k, (label, channel) in enumerate(signals.items()):
        array[k] = (own[channel].reshape(-1, 1), label if labelled else "")
    path = tmp_path / "log.mat"
    savemat(path, {"simout": {"time": own.time, "signals": array}})
    found = proposed(path)
    if not labelled:
        assert "simout.signals.5.values" in " ".join(found.problems)
        return
    assert not found.problems
    run_of_it = import_log(path, found.log_map, load_crane("crane_150t"))
    for channel in signals.values():
        np.testing.assert_allclose(run_of_it[channel], own[channel])


def test_a_map_in_which_nothing_was_found_says_so(tmp_path, monkeypatch, capsys):
    from scipy.io import savemat

    monkeypatch.chdir(tmp_path)
    own = example("test_01")
    savemat("log.mat", {"data": np.c_[own.time, own["motor_speed"], own["hook_load"]]})
    assert run(["import", "log.mat", "--propose", "--crane", "crane_150t", "--map", "m.yaml"]) == 2
    capsys.readouterr()
    assert run(["import", "log.mat", "--map", "m.yaml", "--out", "runs"]) == 2
    assert "m.yaml: columns: no channel is mapped" in capsys.readouterr().err
    settings = ["--set", "motor_speed.from=data.2", "--set", "motor_speed.unit=rad/s"]
    again = ["import", "log.mat", "--propose", "--crane", "crane_150t", "--map", "m.yaml", "--overwrite"]
    assert run([*again, *settings]) == 2
    assert "name one by --set main.pressure_a.from=COLUMN" in capsys.readouterr().err
