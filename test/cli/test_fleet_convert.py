"""The verbs fleet and convert, as a person calls them."""

import json

import numpy as np
import pytest

from winch_friction.cli import main
from winch_friction.records.runs import read_run, write_run
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

CRANE = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]


@pytest.fixture(scope="module")
def runs(tmp_path_factory, crane_150t, crane2_model):
    folder = tmp_path_factory.mktemp("fleet")
    scenario = load_scenario("ahc_irregular").override({"duration": 4.0})
    for seed, name in ((1, "one.csv"), (2, "two"), (3, "three.mcap")):
        write_run(simulate(scenario, crane_150t, crane2_model, seed=seed).run, folder / name)
    (folder / "bad.csv").write_text("not,a\nrun,file\n")
    return folder


def fleet(folder, out, capsys, names, *options):
    status = main.run(
        ["fleet", "replay", *(str(folder / n) for n in names), *CRANE, "--out", str(out), *options, "--json"]
    )
    return status, {each["recording"]: each for each in json.loads(capsys.readouterr().out)}


def test_one_bad_recording_does_not_stop_the_others(runs, tmp_path, capsys):
    names = ["one.csv", "two", "three.mcap", "bad.csv"]
    status, found = fleet(runs, tmp_path / "out", capsys, names, "--workers", "0", "--option", "no-learn")
    assert status == 2
    assert [found[str(runs / name)]["status"] for name in names] == [0, 0, 0, 2]
    assert "bad.csv" in found[str(runs / "bad.csv")]["message"]
    assert found[str(runs / "two")]["result"]["samples"] > 150
    assert {each.name for each in (tmp_path / "out").iterdir()} == {
        "one.parquet",
        "two.parquet",
        "three.parquet",
        "fleet.json",
    }


@pytest.mark.slow
def test_dask_gives_what_one_process_gives(runs, tmp_path, capsys):
    pytest.importorskip("dask.distributed")
    names = ["one.csv", "two"]
    status, there = fleet(runs, tmp_path / "dask", capsys, names, "--workers", "1")
    _, here = fleet(runs, tmp_path / "here", capsys, names, "--workers", "0")
    assert status == 0
    assert {k: v["result"] for k, v in there.items()} == {k: v["result"] for k, v in here.items()}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["weld", "x.csv"], "knows the verbs"),
        (["replay", "a/x.csv", "b/x.csv"], "rename one"),
    ],
)
def test_what_a_fleet_cannot_do_is_said(tmp_path, capsys, arguments, said):
    assert main.run(["fleet", *arguments, *CRANE, "--out", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err


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
