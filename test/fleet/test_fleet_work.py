"""What a fleet says of one piece of work, and when it must be done again."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
from own_term_files import TERM, forgotten, own_model, own_terms

from winch_friction.cli import main
from winch_friction.cli.fleet_work import plan
from winch_friction.fleet.recordings import find_recordings
from winch_friction.fleet.store import read_store, write_store
from winch_friction.records.runs import write_run
from winch_friction.records.strict_yaml import shipped
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

FILES = ["--crane", "crane_150t", "--model", "a6vm215_crane2", "--workers", "0", "--json"]


@pytest.fixture(scope="module")
def run(crane_150t, crane2_model):
    scenario = load_scenario("ahc_irregular").override({"duration": 30.0})
    return simulate(scenario, crane_150t, crane2_model, seed=3).run


def fleet(capsys, *arguments):
    status = main.run(["fleet", *map(str, arguments), *FILES])
    said = capsys.readouterr()
    assert said.out, said.err
    return status, json.loads(said.out)


def test_a_mended_crane_or_model_is_other_work(tmp_path):
    (tmp_path / "north").mkdir()
    (tmp_path / "north" / "a.csv").write_text("time\n")
    crane, model, mine = tmp_path / "crane.yaml", tmp_path / "model.yaml", tmp_path / "mine.py"
    shutil.copy(shipped("cranes", "crane_150t"), crane)
    shutil.copy(shipped("models", "a6vm215_crane2"), model)
    mine.write_text("")

    def key():
        recordings = find_recordings([str(tmp_path / "north")])
        options = ["--terms-file", str(mine)]
        (task,) = plan("check", recordings, tmp_path, str(crane), str(model), options, {})
        return task.key

    keys = [key()]
    for each in (crane, model, mine):
        each.write_text(each.read_text() + "\n# mended\n")
        keys.append(key())
    assert len(set(keys)) == 4
    assert key() == keys[-1]


def test_what_contradicts_the_crane_is_told_of_a_recording(tmp_path, run, capsys):
    wrong = replace(run, columns={**run.columns, "motor_speed": 2.0 * np.pi * run["motor_speed"]})
    write_run(wrong, tmp_path / "north" / "a.parquet")
    status, found = fleet(capsys, "check", tmp_path / "north", "--out", tmp_path / "out")
    assert status == 2
    assert "motor_speed" in found["outcomes"][0]["message"]


def test_a_fleet_among_its_recordings_goes_on_where_it_was(tmp_path, run, capsys):
    write_run(run, tmp_path / "north" / "a.parquet")
    for _ in range(2):
        status, found = fleet(capsys, "replay", tmp_path, "--out", tmp_path / "fleet")
        assert status == 0
        assert len(found["outcomes"]) == 1
    assert found["notes"] == ["no recording has a Unix time: nothing can be followed over the months"]


def test_a_verb_that_looks_at_no_recording_by_itself_says_nothing_of_dates(tmp_path, monkeypatch, capsys):
    from winch_friction.cli import fleet as verb
    from winch_friction.fleet.ledger import Outcome

    (tmp_path / "north").mkdir()
    (tmp_path / "north" / "a.csv").write_text("time\n")
    done = lambda task: Outcome(task.key, "north", "a", 0, 0.1, {"verb": None, "traits": []}, "")
    monkeypatch.setattr(verb, "carry_out", done)
    _, found = fleet(capsys, "identify", tmp_path / "north", "--out", tmp_path / "out")
    assert found["notes"] == []


def test_a_suppliers_table_among_the_logs_is_no_recording(tmp_path, monkeypatch, capsys):
    """It stopped the whole crane: 'no column time'."""
    from winch_friction.cli import fleet as verb
    from winch_friction.fleet.ledger import Outcome

    (tmp_path / "north").mkdir()
    (tmp_path / "north" / "a.csv").write_text("time\n")
    table = "# of the makers\nspeed [rpm];pressure [bar];displacement [cm^3/rev];efficiency [%]\n1000;100;215;93\n"
    (tmp_path / "north" / "motor.csv").write_text(table)
    seen = []
    done = lambda task: seen.append(task) or Outcome(task.key, "north", "a", 0, 0.1, {"verb": None, "traits": []}, "")
    monkeypatch.setattr(verb, "carry_out", done)
    status, found = fleet(capsys, "identify", tmp_path / "north", "--out", tmp_path / "out")
    assert status == 0
    assert [[each.name for each in task.recordings] for task in seen] == [["a"]]
    assert found["notes"] == [f"{tmp_path}/north/motor.csv: a supplier's table and no recording: left out"]
    (tmp_path / "north" / "a.csv").unlink()
    assert main.run(["fleet", "identify", str(tmp_path / "north"), "--out", str(tmp_path / "o"), *FILES]) == 2
    assert "'identify motor' reads it" in capsys.readouterr().err


def test_a_cranes_name_of_digits_stays_a_name(tmp_path):
    row = {"recording": "a", "time": 1.7e9, "kind": "trait", "name": "friction", "value": 1.0, "std": 0.1, "unit": "%"}
    write_store(tmp_path, [{**row, "crane": "007"}, {**row, "crane": "012"}])
    assert sorted(read_store(tmp_path)["crane"]) == ["007", "012"]


def test_a_model_with_own_terms_is_read_where_their_file_is_given(tmp_path, run, capsys):
    """Whether the model can be read is for the worker to say, who is given the terms."""
    write_run(run, tmp_path / "north" / "a.parquet")
    own = [*FILES, "--model", str(own_model(tmp_path)), "--option", f"terms-file={own_terms(tmp_path)}"]
    with forgotten(TERM):
        status = main.run(["fleet", "check", str(tmp_path / "north"), "--out", str(tmp_path / "out"), *own])
    said = capsys.readouterr()
    assert status == 0, said.err
    assert json.loads(said.out)["outcomes"][0]["status"] == 0
