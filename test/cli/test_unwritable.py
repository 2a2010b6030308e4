"""A place that cannot be written is said before the work, in one line, and nothing is left there."""

import importlib

import pytest

from winch_friction.cli.main import run
from winch_friction.records.strict_yaml import config_directory

# the work that must not have begun; replaced by a defect
WORK = {
    "gap": "winch_friction.discrepancy.workflow.find_gap",
    "check": "winch_friction.commissioning.commissioning.check",
    "replay": "winch_friction.replay.recording.replay_recording",
    "simulate": "winch_friction.cli.simulate._simulate_to",
    "plot": "winch_friction.report.run_page.write_run_page",
    "compare": "winch_friction.cli.compare._on_grid",
    "show": "winch_friction.physics.winch.model_curve.model_curve",
    "motor": "winch_friction.identification.motor_identification.identify_motor",
    "system": "winch_friction.identification.system_identification.identify_system",
    "practice": "winch_friction.identification.practice.run_practice",
    "fleet": "winch_friction.cli.fleet._done",
    "demo": "winch_friction.cli.demo._planned",
}
RUN = str(config_directory() / "examples" / "practice_150t" / "test_02.parquet")
MACHINE = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]
WORDS = {
    "gap": ["gap", RUN, *MACHINE], "check": ["check", RUN, *MACHINE], "replay": ["replay", RUN, *MACHINE],
    "simulate": ["simulate", "ahc_55t_215"], "plot": ["plot", RUN],
    "compare": ["compare", "a6vm215_crane1", "a6vm215_crane2"], "show": ["show", "a6vm215_crane2"],
    "motor": ["identify", "motor", "a6vm215_generated"],
    "system": ["identify", "system", RUN, "--motor", "a6vm215", "--crane", "crane_150t"],
    "practice": ["identify", "practice", "practice_150t"], "fleet": ["fleet", "check", RUN, *MACHINE],
    "demo": ["demo"],
}  # fmt: skip
NAMES = {"replay": "x.csv", "simulate": "x.csv", "plot": "x.html", "compare": "x.html", "show": "x.html",
         "motor": "x.yaml", "system": "x.yaml"}  # fmt: skip


@pytest.mark.parametrize("verb", WORK)
@pytest.mark.parametrize("place", ["file/in_the_way", "/proc/none"])
def test_is_said_before_the_work(verb, place, tmp_path, monkeypatch, capsys):
    def begun(*_, **__):
        raise AssertionError("the work has begun")

    monkeypatch.chdir(tmp_path)
    module, _, name = WORK[verb].rpartition(".")
    monkeypatch.setattr(importlib.import_module(module), name, begun)
    (tmp_path / "file").touch()
    out = f"{place}/{NAMES[verb]}" if verb in NAMES else place
    assert run([*WORDS[verb], "--out", out]) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("warning")]
    assert len(lines) == 1
    assert out in lines[0]
    assert "give another" in lines[0] or "give a folder" in lines[0]
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_a_mistyped_demo_leaves_the_last_one_as_it_was(tmp_path, monkeypatch, capsys):
    for name in ("plan.json", "demo.html"):
        (tmp_path / name).write_text("the last one")
    assert run(["demo", "--scenario", "ahc_irregula", "--out", str(tmp_path)]) == 2
    assert "did you mean ahc_irregular" in capsys.readouterr().err
    assert {each.name for each in tmp_path.iterdir()} == {"plan.json", "demo.html"}


def test_a_picture_of_no_kind_is_refused_before_the_work(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run([*WORDS["replay"], "--out", "x.csv", "--picture", "x.foo"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("winch-friction: --picture x.foo: a report is written as .html, a still picture as .png")
    assert said.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_map_that_cannot_be_written_is_refused_before_the_logs_are_read(tmp_path, monkeypatch, capsys):
    """They were read first, and what was said then was `file: File exists`."""

    def begun(*_, **__):
        raise AssertionError("the work has begun")

    monkeypatch.setattr("winch_friction.importing.propose.propose", begun)
    (tmp_path / "file").write_text("x")
    place = tmp_path / "file" / "map.yaml"
    assert run(["import", RUN, "--propose", "--map", str(place)]) == 2
    assert f"--map {place}: {tmp_path / 'file'} is a file, no folder" in capsys.readouterr().err
