"""A model that names a user's own term is read where the term's file is given."""

import pytest
from own_term_files import forgotten, own_model, own_terms

from winch_friction.cli import main


@pytest.fixture
def model(tmp_path):
    return own_model(tmp_path, "gap_drag", "k_gap")


def test_gap_takes_a_model_that_an_own_effect_has_repaired(tmp_path, model, capsys):
    arguments = ["gap", "no_such_run.csv", "--model", str(model), "--out", str(tmp_path / "out")]
    assert main.run(arguments) == 2
    assert "'gap_drag' is not known" in capsys.readouterr().err
    with forgotten("gap_drag"):
        own = own_terms(tmp_path, "gap_drag", "k_gap")
        assert main.run([*arguments, "--effects", str(own)]) == 2
    assert "no_such_run.csv: no such file" in capsys.readouterr().err  # the model was read


def test_a_missing_effects_file_is_one_line(tmp_path, model, capsys):
    assert main.run(["gap", "run.csv", "--model", str(model), "--effects", str(tmp_path / "missing.py")]) == 2
    error = capsys.readouterr().err.strip()
    assert "missing.py: not a readable Python file of terms" in error
    assert len(error.splitlines()) == 1
