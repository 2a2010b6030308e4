"""What a verb assumes where a model does not say it is said; a motor of another size is refused."""

import pytest

from winch_friction.cli.main import run
from winch_friction.records.model_file import load_model, save_model


@pytest.fixture
def bare(tmp_path):
    return str(save_model(load_model("a6vm215_crane2").with_covariance(None), tmp_path / "bare.yaml"))


@pytest.mark.parametrize("verb", ["gap", "replay"])
def test_a_model_without_std_is_said(verb, bare, tmp_path, capsys):
    run_file = tmp_path / "run.csv"
    run_file.write_text("time [s],motor_speed [rpm]\n0,1\n")
    assert run([verb, str(run_file), "--crane", "crane_150t", "--model", bare]) == 2
    said = capsys.readouterr().err
    assert "warning: model 'a6vm215_crane2' states no std: 20 % of each value is assumed" in said
    assert run([verb, str(run_file), "--crane", "crane_150t", "--model", "a6vm215_crane2"]) == 2
    assert "assumed" not in capsys.readouterr().err


@pytest.fixture
def short(tmp_path):
    """A run that every crane could have, too short for an answer."""
    run_file = tmp_path / "run.csv"
    run_file.write_text("time [s],motor_speed [rpm]\n0,1\n")
    return str(run_file)


@pytest.mark.parametrize("crane", ["emps", "winch_100kw"])
def test_gap_asks_which_model_of_a_crane_that_has_no_usual_one(crane, short, tmp_path, capsys):
    """The 150 t crane's model is nobody else's."""
    assert run(["gap", short, "--crane", crane, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert f"which model of crane '{crane}'? Give --model" in said
    assert {"emps": "emps_symmetric, emps_viscous", "winch_100kw": "rope_force_alone"}[crane] in said
    assert "a6vm215" not in said


def test_gap_says_that_it_takes_the_150_t_crane_and_its_model(short, capsys):
    assert run(["gap", short]) == 2
    said = capsys.readouterr().err
    assert "no --crane and no --model: taken as crane 'crane_150t' and model 'a6vm215_crane2'" in said
    assert run(["gap", short, "--crane", "crane_150t"]) == 2
    assert "no --model: taken as 'a6vm215_crane2', of crane 'crane_150t'" in capsys.readouterr().err


def test_a_motor_of_another_size_is_refused(tmp_path, capsys):
    run_file = tmp_path / "run.csv"
    run_file.write_text("time [s],motor_speed [rpm]\n0,1\n")
    out = tmp_path / "m.yaml"
    arguments = ["identify", "system", str(run_file), "--motor", "a6vm170", "--crane", "crane_150t", "--out", str(out)]
    assert run(arguments) == 2
    (error,) = [each for each in capsys.readouterr().err.splitlines() if "a6vm170" in each]
    assert "model 'a6vm170' does not belong to crane 'crane_150t'" in error
    assert "largest displacement" in error
    assert not out.exists()


def test_a_model_is_not_drawn_on_another_crane(short, capsys):
    assert run(["show", "a6vm215_crane2", "--crane", "emps"]) == 2
    assert run(["plot", short, "--model", "emps_viscous", "--crane", "crane_150t"]) == 2
    said = capsys.readouterr().err
    assert said.count("does not belong to crane") == 2


def test_the_crane_that_a_model_without_one_is_drawn_on_is_said(capsys):
    assert run(["show", "a6vm215"]) == 0
    assert "model 'a6vm215' names none: drawn on 'crane_150t'" in capsys.readouterr().err
    assert run(["show", "a6vm215_crane2"]) == 0
    assert "drawn on" not in capsys.readouterr().err
