"""A slip in a command line costs a line on stderr, never a file that was there."""

import shutil

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.cli.main import run
from winch_friction.physics.signals import Run
from winch_friction.records.runs import write_run
from winch_friction.records.strict_yaml import config_directory


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A run, a model, a supplier's table, as a stranger has them."""
    monkeypatch.chdir(tmp_path)
    crane, model = wf.load_crane("crane_150t"), wf.load_model("a6vm215_crane2")
    write_run(wf.simulate("normal_joystick", crane, model, duration=40.0).run, tmp_path / "run.csv")
    shutil.copy(config_directory() / "models" / "a6vm215_crane2.yaml", tmp_path / "model.yaml")
    shutil.copy(config_directory() / "suppliers" / "a6vm215_generated.csv", tmp_path / "table.csv")
    return tmp_path


MODEL = ("--crane", "crane_150t", "--model", "model.yaml")
SLIPS = {
    "replay onto its recording": (["replay", "run.csv", *MODEL, "--out", "run.csv"], "run.csv"),
    "plot onto its run": (["plot", "run.csv", "--out", "run.csv"], "run.csv"),
    "a page onto its model": (["show", "model.yaml", "--out", "model.yaml"], "model.yaml"),
    "a page onto a model": (["compare", "a6vm215_crane1", "model.yaml", "--out", "model.yaml"], "model.yaml"),
    "a model onto its table": (["identify", "motor", "table.csv", "--out", "table.csv"], "table.csv"),
    "a model onto a run": (["identify", "motor", "table.csv", "--out", "run.csv"], "run.csv"),
    "a model onto its motor": (
        ["identify", "system", "run.csv", "--motor", "model.yaml", "--crane", "crane_150t", "--out", "model.yaml"],
        "model.yaml",
    ),
    "a repaired model onto its seed": (["gap", "run.csv", *MODEL, "--out", "."], "model.yaml"),
    "a converted run onto itself": (["convert", "run", "run.csv", "run.csv"], "run.csv"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_nothing_that_was_there_is_overwritten(slip, here, capsys):
    arguments, lost = SLIPS[slip]
    before = {path.name: path.read_bytes() for path in here.iterdir()}
    assert run(arguments) == 2
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert lost in said
    assert "--out" in said
    assert {path.name: path.read_bytes() for path in here.iterdir()} == before


EARLIER = {
    "replay": (["replay", "run.csv", *MODEL, "--out", "there.csv"], "there.csv"),
    "a picture of a replay": (["replay", "run.csv", *MODEL, "--picture", "there.html"], "there.html"),
    "plot": (["plot", "run.csv", "--out", "there.html"], "there.html"),
    "show": (["show", "model.yaml", "--out", "there.html"], "there.html"),
    "compare": (["compare", "a6vm215_crane1", "model.yaml", "--out", "there.html"], "there.html"),
    "convert": (["convert", "run", "run.csv", "new.csv", "there.parquet"], "there.parquet"),
    "motor": (["identify", "motor", "table.csv", "--out", "there.yaml"], "there.yaml"),
    "system": (
        ["identify", "system", "run.csv", "--motor", "a6vm215", "--crane", "crane_150t", "--out", "there.yaml"],
        "there.yaml",
    ),
}


@pytest.mark.parametrize("verb", EARLIER)
def test_an_earlier_result_is_replaced_only_when_told_so(verb, here, capsys):
    arguments, there = EARLIER[verb]
    (here / there).write_text("an earlier result")
    assert run(arguments) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("warning")]
    assert said == [f"winch-friction: --out {there}: exists already; give another name, or --overwrite to replace it"]
    assert (here / there).read_text() == "an earlier result"
    assert not (here / "new.csv").exists()


def test_an_earlier_result_is_replaced_when_told_so_and_a_bag_never(here, capsys):
    for name in ("there.csv", "there.mcap"):
        (here / name).write_text("an earlier result")
    assert run(["convert", "run", "run.csv", "there.csv", "--overwrite"]) == 0
    assert (here / "there.csv").read_text() != "an earlier result"
    assert run(["convert", "run", "run.csv", "there.mcap", "--overwrite"]) == 2
    assert "bag is never replaced" in capsys.readouterr().err


def test_a_kind_that_cannot_be_written_is_said_before_the_others_are(here, capsys):
    assert run(["convert", "run", "run.csv", "new.parquet", "new.xlsx"]) == 2
    assert "new.xlsx: cannot write this kind of file" in capsys.readouterr().err
    assert not (here / "new.parquet").exists()


def test_a_replay_makes_no_bag_under_the_name_of_a_spreadsheet(here, capsys):
    """`--out replayed.xlsx` became a folder with a bag in it."""
    assert run(["replay", "run.csv", *MODEL, "--out", "replayed.xlsx"]) == 2
    assert "replayed.xlsx: cannot write this kind of file" in capsys.readouterr().err
    assert not (here / "replayed.xlsx").exists()


def test_a_log_that_is_no_run_file_is_sent_to_import(here, capsys):
    (here / "log.csv").write_text("time,ground_speed,force\n" + "".join(f"{k},1.0,2.0\n" for k in range(9)))
    (here / "log.xlsx").write_bytes(b"PK")
    for name in ("log.csv", "log.xlsx"):
        assert run(["check", name, "--crane", "crane_150t"]) == 2
        assert "winch-friction import" in capsys.readouterr().err


def test_a_practice_that_is_not_there_is_said_to_be_none(here, capsys):
    assert run(["identify", "practice", "practise_150t", "--out", "done"]) == 2
    assert "practise_150t: no such folder, and no shipped example" in capsys.readouterr().err


def test_copies_of_a_run_prove_nothing(here, capsys):
    """A copy among the locked runs would prove the model on what it was fitted to."""
    for name in ("a", "b", "c"):
        shutil.copy("run.csv", f"{name}.csv")
    assert run(["gap", "run.csv", "a.csv", "b.csv", "c.csv", *MODEL, "--out", "out"]) == 2
    said = capsys.readouterr().err
    assert "run.csv and a.csv hold the same samples: a copy" in said
    assert not (here / "out").exists()


def test_a_copy_with_its_ports_exchanged_is_said_so(here, capsys):
    run_csv = wf.read_run("run.csv")
    ports = {"main.pressure_a": run_csv["main.pressure_b"], "main.pressure_b": run_csv["main.pressure_a"]}
    write_run(Run("swap", {**run_csv.columns, **ports}), here / "swap.csv")
    assert run(["gap", "run.csv", "swap.csv", *MODEL, "--out", "out"]) == 2
    said = capsys.readouterr().err
    assert "run.csv and swap.csv hold the same samples, ports A and B of main exchanged in one of them" in said


def test_a_test_that_is_kept_out_must_not_be_among_those_that_are_fitted(here, capsys):
    shutil.copy("run.csv", "again.csv")
    arguments = ["identify", "system", "run.csv", "--motor", "a6vm215", "--crane", "crane_150t", "--out", "m.yaml"]
    assert run([*arguments, "--held-out", "again.csv"]) == 2
    assert "run.csv and again.csv hold the same samples" in capsys.readouterr().err


def test_models_of_two_cranes_are_not_compared_without_a_word(capsys):
    assert run(["compare", "emps_viscous", "a6vm215_crane2"]) == 2
    said = capsys.readouterr().err
    assert "'emps_viscous' is of crane 'emps', 'a6vm215_crane2' of crane 'crane_150t'" in said


def test_a_motor_compared_with_a_winch_is_said(capsys):
    assert run(["compare", "a6vm215_crane2", "a6vm215"]) == 0
    assert "model 'a6vm215' has no losses of gear and drum" in capsys.readouterr().err


def test_a_log_taken_for_a_crane_is_answered_in_a_short_line(here, capsys):
    assert run(["check", "run.csv", "--crane", "run.csv"]) == 2
    said = capsys.readouterr().err.strip()
    assert len(said) < 300
    assert "run.csv" in said
    assert "crane" in said


def test_every_sample_is_looked_at_before_runs_count_as_copies():
    from winch_friction.cli.inputs import refuse_copies

    time = np.arange(50.0)
    one = Run("one", {"time": time, "motor_speed": np.sin(time)})
    two = Run("two", {"time": time, "motor_speed": np.sin(time) + 1e-9 * (time == 30)})
    refuse_copies([one, two])


def test_a_suppliers_table_taken_for_a_run_is_told_apart(here, capsys):
    assert run(["check", "table.csv", "--crane", "crane_150t"]) == 2
    said = capsys.readouterr().err
    assert "line 1 is a remark" in said
    assert "identify motor" in said


def test_a_folder_of_runs_is_not_one_recording(here, capsys):
    assert run(["replay", ".", "--crane", "crane_150t", "--model", "a6vm215_crane2"]) == 2
    assert "replay takes one recording" in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["dashboard", "watch"])
def test_a_bag_that_is_not_there_is_said_at_once(verb, here, capsys):
    assert run([verb, "--bag", "nothere", *(["--port", "0"] if verb == "dashboard" else [])]) == 2
    assert "nothere: no such bag" in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["dashboard", "watch"])
def test_what_is_no_bag_is_said_at_once(verb, here, capsys):
    """The page stood empty for as long as somebody waited."""
    pytest.importorskip("rosbags")
    (here / "run.csv").write_text("time\n")
    (here / "empty").mkdir()
    port = ["--port", "0"] if verb == "dashboard" else []
    for name, said in (("run.csv", "not a readable rosbag2 recording"), ("empty", "not a rosbag2 folder")):
        assert run([verb, "--bag", name, *port]) == 2
        found = capsys.readouterr()
        assert said in found.err
        assert not found.out
