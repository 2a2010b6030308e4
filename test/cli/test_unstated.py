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


def test_a_motor_of_another_size_is_refused(tmp_path, capsys):
    run_file = tmp_path / "run.csv"
    run_file.write_text("time [s],motor_speed [rpm]\n0,1\n")
    out = tmp_path / "m.yaml"
    arguments = ["identify", "system", str(run_file), "--motor", "a6vm170", "--crane", "crane_150t", "--out", str(out)]
    assert run(arguments) == 2
    error = capsys.readouterr().err.strip()
    assert "model 'a6vm170' does not belong to crane 'crane_150t'" in error
    assert "largest displacement" in error
    assert "\n" not in error
    assert not out.exists()
