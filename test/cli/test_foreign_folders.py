"""A folder with somebody else's files of the same names is refused before the work; an earlier result is replaced."""

import importlib
import json
import signal
import subprocess
import sys

import pytest

from winch_friction.cli.inputs import refuse_foreign
from winch_friction.cli.main import run
from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import config_directory

RUN = str(config_directory() / "examples" / "practice_150t" / "test_02.parquet")
MACHINE = ["--crane", "crane_150t", "--model", "a6vm215_crane2"]
# verb -> words, the work that must not have begun, a file that it would write, its mark
VERBS = {
    "gap": (["gap", RUN, *MACHINE], "winch_friction.discrepancy.workflow.find_gap", "model.yaml", "gap.json"),
    "gap, a law of one's own": (
        ["gap", RUN, *MACHINE], "winch_friction.discrepancy.workflow.find_gap", "proposal_1.py", "gap.json",
    ),
    "gap, a next experiment": (
        ["gap", RUN, *MACHINE], "winch_friction.discrepancy.workflow.find_gap", "experiment_loads.yaml", "gap.json",
    ),
    "gap, runs that supply what lacks": (
        ["gap", RUN, *MACHINE], "winch_friction.discrepancy.workflow.find_gap", "test_02.yaml", "gap.json",
    ),
    "gap, a swing that is not told": (
        ["gap", RUN, *MACHINE], "winch_friction.discrepancy.workflow.find_gap", "ahc_55t_215.yaml", "gap.json",
    ),
    "check": (
        ["check", RUN, *MACHINE], "winch_friction.commissioning.commissioning.check", "check.html", "check.json",
    ),
    "practice": (
        ["identify", "practice", "practice_150t"], "winch_friction.identification.practice.run_practice", "motor.yaml",
        "report.html",
    ),
    "fleet": (["fleet", "check", RUN, *MACHINE], "winch_friction.cli.fleet._done", "report.html", "fleet.jsonl"),
}  # fmt: skip


@pytest.mark.parametrize("verb", VERBS)
def test_what_somebody_else_wrote_is_not_replaced(verb, tmp_path, monkeypatch, capsys):
    words, work, name, _ = VERBS[verb]
    module, _, function = work.rpartition(".")

    def begun(*_, **__):
        raise AssertionError("the work has begun")

    monkeypatch.setattr(importlib.import_module(module), function, begun)
    (tmp_path / name).write_text("mine")
    assert run([*words, "--out", str(tmp_path)]) == 2
    assert f"--out {tmp_path}: holds {name}, no result of this verb" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "mine"


def test_an_earlier_result_and_a_folder_of_other_things_are_no_hindrance(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    refuse_foreign(tmp_path, ("model.yaml",), "gap.json", "winch_friction.gap/")
    (tmp_path / "model.yaml").write_text("of an earlier call")
    (tmp_path / "gap.json").write_text('{"schema": "other.gap/1"}')
    with pytest.raises(InputError, match=r"model\.yaml"):
        refuse_foreign(tmp_path, ("model.yaml",), "gap.json", "winch_friction.gap/")
    (tmp_path / "gap.json").write_text('{"schema": "winch_friction.gap/2"}')
    refuse_foreign(tmp_path, ("model.yaml",), "gap.json", "winch_friction.gap/")


EARLIER = {
    "gap": ("gap.json", '{"schema": "winch_friction.gap/2"}', ["model.yaml", "report.html"]),
    "practice": ("report.html", "<title>Friction practice: of last week</title>", ["motor.yaml", "seed.yaml"]),
}


@pytest.mark.parametrize("verb", EARLIER)
def test_an_earlier_result_is_replaced_only_when_told_so(verb, tmp_path, monkeypatch, capsys):
    """A search of an hour, or a seed, was gone after the next call without a word."""
    words, work, *_ = VERBS[verb]
    mark, text, others = EARLIER[verb]
    (tmp_path / mark).write_text(text)
    for name in others:
        (tmp_path / name).write_text("of last week")
    module, _, function = work.rpartition(".")

    def begun(*_, **__):
        raise InputError("the work has begun")

    monkeypatch.setattr(importlib.import_module(module), function, begun)
    assert run([*words, "--out", str(tmp_path)]) == 2
    assert f"--out {tmp_path}: holds an earlier result ({mark})" in capsys.readouterr().err
    assert (tmp_path / mark).read_text() == text
    assert run([*words, "--out", str(tmp_path), "--overwrite"]) == 2
    assert "the work has begun" in capsys.readouterr().err


def test_a_seal_that_was_opened_is_not_lost_to_the_next_trial(tmp_path, capsys):
    (tmp_path / "trial_02").mkdir()
    (tmp_path / "trial_02" / "gap.json").write_text("of last week")
    assert run(["gap", "--blind", "2", "--out", str(tmp_path)]) == 2
    assert "trial_02/gap.json: exists already" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["trial_02"]


DYING = """
import os, signal, sys
from winch_friction.cli import main


def dying(move):
    def moved(source, target, **options):
        move(source, target, **options)
        if os.path.dirname(target) == sys.argv[1]:
            os.kill(os.getpid(), signal.SIGKILL)

    return moved


os.replace, os.link = dying(os.replace), dying(os.link)
main.run(sys.argv[2:])
"""


def test_what_a_killed_search_has_left_is_its_own(tmp_path):
    """A model.yaml without its gap.json was refused by the next call as somebody else's."""
    words = ["gap", RUN, *MACHINE, "--out", str(tmp_path), "--no-report"]
    died = subprocess.run([sys.executable, "-c", DYING, str(tmp_path), *words], capture_output=True, check=False)
    assert died.returncode == -signal.SIGKILL
    assert [each.name for each in tmp_path.iterdir() if each.name[0] != "."] == ["gap.json"]
    for old in ("proposal_7.py", "proposal_7.yaml", "report.html", "addition.csv"):
        (tmp_path / old).write_text("of an earlier call")
    assert run([*words, "--overwrite"]) == 0
    found = json.loads((tmp_path / "gap.json").read_text())["next_experiment"]
    assert {each.name for each in tmp_path.iterdir()} == {"gap.json", "model.yaml", found["scenario"]}


@pytest.mark.parametrize("name", ["check.html", "gap.JSON", "model.yaml"])
def test_a_folder_is_not_made_under_the_name_of_a_file(tmp_path, name):
    with pytest.raises(InputError, match="writes a folder of files; give a name without"):
        refuse_foreign(tmp_path / name, ("check.html",), "check.json")
    refuse_foreign(tmp_path / "run.3", ("check.html",), "check.json")
    (tmp_path / name).mkdir()  # somebody's own
    refuse_foreign(tmp_path / name, ("check.html",), "check.json")
