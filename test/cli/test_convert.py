"""The verb convert, as a person calls them."""

import json
from dataclasses import replace

import numpy as np
import pytest

from winch_friction.cli import main
from winch_friction.records.runs import read_run, write_run
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate


@pytest.fixture(scope="module")
def runs(tmp_path_factory, crane_150t, crane2_model):
    folder = tmp_path_factory.mktemp("fleet")
    scenario = load_scenario("ahc_irregular").override({"duration": 4.0})
    for seed, name in ((1, "one.csv"), (2, "two"), (3, "three.mcap")):
        write_run(simulate(scenario, crane_150t, crane2_model, seed=seed).run, folder / name)
    return folder


def test_convert_keeps_every_digit(runs, tmp_path, capsys):
    targets = [str(tmp_path / name) for name in ("a.csv", "a.parquet", "a.mcap", "a")]
    assert main.run(["convert", "run", str(runs / "one.csv"), *targets, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["written"] == targets
    first = read_run(runs / "one.csv")
    for target in targets:
        back = read_run(target)
        for column in first.columns:
            np.testing.assert_allclose(back[column], first[column], rtol=1e-12, atol=1e-9)
    assert main.run(["convert", "run", str(runs / "one.csv"), targets[-1]]) == 2
    assert "exists already" in capsys.readouterr().err
    assert main.run(["convert", "emps", str(runs / "one.csv"), str(tmp_path / "e.csv")]) == 2


def test_a_measurement_that_is_not_there_is_said_so(tmp_path, capsys):
    assert main.run(["convert", "emps", str(tmp_path / "none.mat"), str(tmp_path / "e.csv")]) == 2
    assert capsys.readouterr().err == f"winch-friction: {tmp_path / 'none.mat'}: no such file\n"


def test_what_a_bag_cannot_carry_is_said(runs, tmp_path, capsys):
    run = read_run(runs / "one.csv")
    more = {**run.columns, "active.pressure_drop_simulated": np.ones(len(run))}
    source = write_run(replace(run, columns=more, aside={"note": np.arange(len(run))}), tmp_path / "more.parquet")
    assert main.run(["convert", "run", str(source), str(tmp_path / "a.csv"), str(tmp_path / "b.mcap")]) == 0
    (said,) = [line for line in capsys.readouterr().err.splitlines() if "no topic" in line]
    assert said.endswith("b.mcap: a bag has no topic for active.pressure_drop_simulated, note: left out")
