"""`winch-friction simulate`."""

import json

import numpy as np
import pytest

from winch_friction.cli.main import run
from winch_friction.records.runs import read_run


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.yaml"
    path.write_text(
        "schema: winch_friction.scenario/1\nname: short\nduration: 8\nmode: ahc\nload: {value: 55, unit: t}\n"
        "displacement: {value: 215, unit: cm^3/rev}\nsea: {kind: regular, amplitude: 1.0, period: 8}\n"
    )
    return str(path)


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".mcap"])
def test_a_scenario_becomes_a_run_that_reads_back(short, tmp_path, suffix, capsys):
    out = tmp_path / f"run{suffix}"
    assert run(["simulate", short, "--out", str(out), "--seed", "3", "--json"]) == 0
    written = json.loads(capsys.readouterr().out)["runs"][0]
    read = read_run(out)
    assert len(read) == written["samples"] == 401
    assert read.groups == ("active", "passive")
    assert np.isfinite(read["motor_speed"]).all()


def test_hidden_effects_and_truth(short, tmp_path):
    for name, extra in (("a", []), ("b", ["--hide", "brake_drag=2"])):
        assert run(["simulate", short, "--out", str(tmp_path / f"{name}.csv"), "--truth", *extra]) == 0
    plain, hidden = (read_run(tmp_path / "truth" / f"{name}_truth.csv", complete=False) for name in "ab")
    assert np.abs(hidden.aside["friction_torque"]).max() > 50.0 + np.abs(plain.aside["friction_torque"]).max()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["no_such_scenario"], "neither a file nor a shipped name"),
        (["{short}", "--hide", "rust"], "--hide rust: not an effect"),
        (["{short}", "--hide", "brake_drag=much"], "'much' is not a number"),
        (["{short}", "--hide", "brake_drag=-1"], "--hide brake_drag=-1: brake_drag only takes and cannot be negative"),
        (["gap_campaign", "--out", "one.csv"], "needs a folder"),
        (["{short}", "--format", "xlsx"], "not a kind of run file"),
        (["{short}", "--crane", "emps"], "electric"),
        ([], "which scenario?"),
        (["{short}", "--out", "run.xlsx"], "cannot write this kind of file"),
    ],
)
def test_bad_input_is_one_line(arguments, message, short, tmp_path, capsys):
    arguments = [argument.format(short=short) for argument in arguments]
    out = [] if "--out" in arguments else ["--out", str(tmp_path / "x.csv")]
    assert run(["simulate", *arguments, *out]) == 2
    error = capsys.readouterr().err.strip()
    assert message in error
    assert "\n" not in error


def test_runs_are_not_overwritten(short, tmp_path, capsys):
    out = tmp_path / "run.csv"
    out.write_text("precious")
    assert run(["simulate", short, "--out", str(out)]) == 2
    assert out.read_text() == "precious"
    assert "--overwrite" in capsys.readouterr().err
    assert run(["simulate", short, "--out", str(out), "--overwrite"]) == 0  # as at every other verb
    assert run(["simulate", short, "--out", str(out), "--force"]) == 0  # its name before


def test_a_place_for_the_truth_is_asked_for_before_the_work(short, tmp_path, capsys):
    (tmp_path / "truth").write_text("a file of this name")
    assert run(["simulate", short, "--out", str(tmp_path / "run.csv"), "--truth"]) == 2
    assert "is a file, no folder" in capsys.readouterr().err
    assert not (tmp_path / "run.csv").exists()


def test_a_format_that_the_files_name_contradicts_is_refused(short, tmp_path, capsys):
    assert run(["simulate", short, "--out", str(tmp_path / "run.csv"), "--format", "parquet"]) == 2
    assert "--format parquet" in capsys.readouterr().err
    assert run(["simulate", short, "--out", str(tmp_path / "run.csv"), "--format", "csv"]) == 0


def test_an_earlier_truth_is_not_overwritten(short, tmp_path, capsys):
    """Its run was taken elsewhere, where it needs it still."""
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "run_truth.csv").write_text("precious")
    words = ["simulate", short, "--out", str(tmp_path / "run.csv"), "--truth"]
    assert run(words) == 2
    assert "run_truth.csv: exists already" in capsys.readouterr().err
    assert (tmp_path / "truth" / "run_truth.csv").read_text() == "precious"
    assert run([*words, "--force"]) == 0


def test_a_bag_is_never_replaced_and_nobody_is_told_that_it_could_be(short, tmp_path, capsys):
    """--force was advised, worked for the length of the simulation, and was refused."""
    out = tmp_path / "run.mcap"
    out.write_text("precious")
    for force in ([], ["--force"]):
        assert run(["simulate", short, "--out", str(out), *force]) == 2
        said = capsys.readouterr().err
        assert "a bag is never replaced" in said
        assert "--force" not in said
        assert "--overwrite" not in said


def test_effects_are_listed(capsys):
    assert run(["simulate", "--effects", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 27


def test_an_interrupted_set_is_told_to_be_no_whole_one(tmp_path, monkeypatch, capsys):
    """Six of twelve runs lay in the folder, and nothing had said that they are not all."""
    from winch_friction.cli import simulate

    def ended(path, scenario, crane, model, seed, hidden, truth):
        if path.name.startswith("run_03"):
            raise KeyboardInterrupt
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
        return {"run": str(path)}

    monkeypatch.setattr(simulate, "_simulate_to", ended)
    out = tmp_path / "runs"
    assert run(["simulate", "gap_campaign", "--out", str(out)]) == 130
    assert f"{out}: 2 of 12 runs were written, which is not the whole set" in capsys.readouterr().err
    assert run(["simulate", "gap_campaign", "--out", str(out)]) == 2
    assert "and 1 more of 12: exists already" in capsys.readouterr().err
