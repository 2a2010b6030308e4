"""A model that names a user's own term is read where the term's file is given."""

import pytest
import yaml
from own_term_files import forgotten, own_model, own_terms

from winch_friction.cli import main
from winch_friction.records.strict_yaml import config_directory


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


@pytest.mark.parametrize(
    "words",
    [
        ["show", "MODEL"], ["show", "gap_drag"], ["terms", "gap_drag"],
        ["compare", "a6vm215_crane2", "MODEL", "--crane", "crane_150t"],
        ["simulate", "SCENARIO", "--model", "MODEL", "--out", "run.csv"],
        ["plot", "RUN", "--crane", "crane_150t", "--model", "MODEL", "--out", "page.html"],
    ],
    ids=lambda words: " ".join(words[:2]),
)  # fmt: skip
def test_every_verb_that_reads_a_model_reads_one_with_own_terms(words, tmp_path, model, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scenario = yaml.safe_load((config_directory() / "scenarios" / "ahc_55t_215.yaml").read_text())
    (tmp_path / "short.yaml").write_text(yaml.safe_dump({**scenario, "duration": 10}))
    test = config_directory() / "examples" / "practice_150t" / "test_02.parquet"
    names = {"MODEL": str(model), "RUN": str(test), "SCENARIO": "short.yaml"}
    arguments = [names.get(word, word) for word in words]
    assert main.run(arguments) == 2
    with forgotten("gap_drag"):
        own = own_terms(tmp_path, "gap_drag", "k_gap")
        assert main.run([*arguments, "--terms-file", str(own)]) == 0, capsys.readouterr().err


def test_a_parameter_of_a_term_that_is_not_known_is_no_problem_of_its_own(model, capsys):
    assert main.run(["show", str(model)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "'gap_drag' is not known" in line
    assert "--terms-file" in line
