"""Comparing two models where the crane never is."""

import json

import numpy as np
import pytest

from winch_friction.cli.main import run
from winch_friction.physics.signals import Run
from winch_friction.physics.winch.model_curve import model_curve
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.records.runs import read_run, write_run
from winch_friction.records.strict_yaml import config_directory


@pytest.mark.parametrize(("loads", "warned"), [("15,55,100", False), ("55,5000", True)])
def test_a_load_beyond_the_crane_is_said_with_what_its_file_gives(capsys, loads, warned):
    assert run(["compare", "a6vm215_crane1", "a6vm215_crane2", "--loads", loads]) == 0
    said = capsys.readouterr().err
    assert ("--loads 5000: beyond what crane 'crane_150t' holds" in said) == warned
    assert ("0 to 540 t" in said) == warned


def test_a_curve_beyond_the_crane_is_said_to_be(capsys):
    assert run(["show", "a6vm215_crane2", "--load", "5000"]) == 0
    assert "--load 5000: beyond what crane 'crane_150t' holds" in capsys.readouterr().err


def test_a_small_crane_is_drawn_at_loads_of_its_own(tmp_path, monkeypatch, capsys):
    """The papers' 15, 55 and 100 t are what a crane for 150 t carries; one for a tonne differed most at 100 t."""
    monkeypatch.chdir(tmp_path)
    own = ["--load", "1", "--motors", "1", "--displacement", "28", "--gear-ratio", "25", "--radius", "0.15"]
    assert run(["init", "crane", "--name", "k", *own, "--layers", "1", "--active", "0", "--wire", "10"]) == 0
    assert run(["init", "model", "--crane", "k.yaml"]) == 0
    stronger = (tmp_path / "seed_k.yaml").read_text().replace("value: 1.823", "value: 2.5")
    (tmp_path / "other.yaml").write_text(stronger.replace("name: seed_k", "name: other"))
    capsys.readouterr()
    found = compared(capsys, "--crane", "k.yaml", first="seed_k.yaml", second="other.yaml")
    assert [row["load [t]"] for row in found["rows"]] == [0.1, 0.37, 0.67]
    assert run(["show", "seed_k.yaml", "--crane", "k.yaml", "--json"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["load_t"] == 0.37
    assert "extrapolated" not in said.err
    assert run(["show", "seed_k.yaml", "--crane", "k.yaml", "--out", "k.html"]) == 0
    page = (tmp_path / "k.html").read_text()
    assert "0.67 t" in page
    assert "55 t" not in page


def test_a_small_drives_curve_is_drawn_without_the_papers_load(capsys):
    assert run(["show", "emps_viscous", "--json"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out)["load_t"] == 0.0  # EMPS lifts nothing; 55 t was what its curve was drawn at
    assert said.err == ""


def test_a_load_that_is_no_mass_is_refused(capsys):
    assert run(["compare", "a6vm215_crane1", "a6vm215_crane2", "--loads=-3"]) == 2
    assert "hanging mass" in capsys.readouterr().err


def compared(capsys, *options, first="a6vm215_crane1", second="a6vm215_crane2"):
    assert run(["compare", first, second, "--json", *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_the_difference_is_the_second_model_minus_the_first_at_the_loads_that_were_asked_for(capsys):
    crane, models = load_crane("crane_150t"), [load_model(f"a6vm215_crane{k}") for k in (1, 2)]
    found = compared(capsys, "--loads", "15,100")
    for row, load in zip(found["rows"], (15e3, 100e3), strict=True):
        first, second = (model_curve(each, crane, load=load) for each in models)
        difference = second.torque - first.torque
        k = int(np.abs(difference).argmax())
        assert row["largest [N*m]"] == pytest.approx(difference[k])
        assert row["of [N*m]"] == pytest.approx(first.torque[k])
        assert row["RMS [N*m]"] == pytest.approx(np.sqrt(np.mean(difference**2)))
        assert row["in sigmas"] == pytest.approx(abs(difference[k]) / np.hypot(first.std[k], second.std[k]))


def test_a_difference_is_more_than_the_models_do_not_know_from_two_sigma_on(capsys):
    found = compared(capsys, "--loads", "55")
    more = found["rows"][0]["in sigmas"] > 2.0
    assert (", more than what they do not know" in found["said"]) is more
    assert (", within what they do not know" in found["said"]) is not more


def test_a_run_without_a_row_that_holds_everything_is_refused(tmp_path, capsys):
    read = read_run(config_directory() / "examples" / "practice_150t" / "test_02.parquet")
    load, speed = read["hook_load"].copy(), read["motor_speed"].copy()
    load[: len(load) // 2], speed[len(load) // 2 :] = np.nan, np.nan
    write_run(Run("apart", {**read.columns, "hook_load": load, "motor_speed": speed}), tmp_path / "apart.csv")
    words = ["compare", "a6vm215_crane1", "a6vm215_crane2", str(tmp_path / "apart.csv"), "--crane", "crane_150t"]
    assert run(words) == 2
    assert "apart.csv: no row has speed, load and pressures all at once" in capsys.readouterr().err


def test_models_that_read_no_load_are_compared_on_runs_that_have_none(tmp_path, capsys):
    time = np.arange(0.0, 10.0, 0.01)
    speed = 20.0 * np.sin(time)
    write_run(Run("el", {"time": time, "motor_speed": speed, "motor_torque": 200.0 * speed}), tmp_path / "el.csv")
    text = (config_directory() / "models" / "emps_viscous.yaml").read_text()
    (tmp_path / "half.yaml").write_text(text.replace("203.5", "101.75"))
    half, whole = load_model(tmp_path / "half.yaml"), load_model("emps_viscous")
    words = ["compare", "emps_viscous", str(tmp_path / "half.yaml"), str(tmp_path / "el.csv"), "--json"]
    assert run(words) == 0
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    difference = (half.value("C5") - whole.value("C5")) * 20.0
    assert abs(row["largest [N*m]"]) == pytest.approx(abs(difference), rel=1e-3)
