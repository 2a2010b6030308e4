"""Two commands that make the same new file, or folder, at the same time: what the first made stands."""

import os
import subprocess
import sys

import numpy as np
import pytest

import winch_friction as wf
from winch_friction.cli import import_, init, simulate
from winch_friction.cli.inputs import refuse_existing, refuse_foreign
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records import atomic
from winch_friction.records.atomic import atomic_path, taken, together, write_text
from winch_friction.records.bag_write import BagWriter
from winch_friction.records.runs import write_run

RUN = Run("a", {"time": np.arange(3.0), "motor_speed": np.ones(3), "motor_torque": np.ones(3)})


def _text(path):
    write_text(path, "mine")


def _atomic(path):
    with atomic_path(path) as temporary:
        temporary.write_text("mine")


@pytest.mark.parametrize("write", [_text, _atomic, lambda path: write_run(RUN, path)])
@pytest.mark.parametrize("links", [True, False])
def test_a_file_that_another_made_meanwhile_is_not_replaced(write, links, tmp_path, monkeypatch):
    """Both had found nothing there, both said `rc 0`, and the later one's file stood."""
    if not links:  # a file system without hard links
        monkeypatch.setattr(atomic.os, "link", _no_links)
    path = tmp_path / "a.csv"
    refuse_existing(False, path)
    path.write_text("his")
    with pytest.raises(OSError, match="made meanwhile") as said:
        write(path)
    assert said.value.filename == str(path)
    assert path.read_text() == "his"
    assert os.listdir(tmp_path) == ["a.csv"]


def _no_links(*_, **__):
    raise PermissionError(1, "no hard links here")


@pytest.mark.parametrize("links", [True, False])
def test_what_nobody_else_made_is_written_and_written_again(links, tmp_path, monkeypatch):
    if not links:
        monkeypatch.setattr(atomic.os, "link", _no_links)
    path = tmp_path / "a.csv"
    refuse_existing(False, path)
    _text(path)
    _atomic(path)  # by the same command, which may
    assert path.read_text() == "mine"
    assert os.listdir(tmp_path) == ["a.csv"]


def test_with_overwrite_it_is_replaced_whoever_made_it(tmp_path):
    path = tmp_path / "a.csv"
    refuse_existing(False, path)
    refuse_existing(True, path)
    path.write_text("his")
    _text(path)
    assert path.read_text() == "mine"


def _folder(out):
    with together(out, "gap.json") as place:
        for name in ("gap.json", "model.yaml"):
            (place / name).write_text("mine")


def test_a_folder_of_results_that_another_filled_meanwhile_stays_his(tmp_path):
    out = tmp_path / "gap"
    refuse_foreign(out, ("gap.json", "model.yaml"), "gap.json", overwrite=False)
    out.mkdir()
    for name in ("gap.json", "model.yaml"):
        (out / name).write_text("his")
    with pytest.raises(OSError, match="made meanwhile"):
        _folder(out)
    assert {each.name: each.read_text() for each in out.iterdir()} == {"gap.json": "his", "model.yaml": "his"}


@pytest.mark.parametrize("name", ["a.mcap", "a.db3", "a"])
def test_a_bag_that_another_made_meanwhile_is_not_replaced(name, tmp_path):
    path = tmp_path / name
    with pytest.raises(OSError, match="made meanwhile"), BagWriter(path):
        path.write_text("his")
    assert path.read_text() == "his"
    assert os.listdir(tmp_path) == [name]


@pytest.mark.parametrize("ask", [lambda path: refuse_existing(False, path), lambda path: wf.write_run(RUN, path)])
def test_a_link_to_nothing_is_there_as_well(ask, tmp_path):
    """It was replaced, and what it had named was not written."""
    path = tmp_path / "a.csv"
    path.symlink_to("elsewhere.csv")
    with pytest.raises(InputError, match="exists already"):
        ask(path)
    assert path.is_symlink()


def test_a_program_may_go_on_after_a_refusal(tmp_path):
    path = tmp_path / "a.csv"
    assert not taken(path)
    path.write_text("his")
    with pytest.raises(OSError, match="made meanwhile"):
        _text(path)
    wf.write_run(RUN, path, overwrite=True)
    assert path.read_text().startswith("time")


def test_the_verbs_ask_so(tmp_path, monkeypatch):
    """Simulate, import and init, which look by themselves."""
    seen = []
    monkeypatch.setattr(atomic, "taken", lambda path, overwrite=False: bool(seen.append((path.name, overwrite))))
    simulate._refuse_overwriting([tmp_path / "a.csv"], False)
    import_._refuse_existing([], [tmp_path / "b.csv"], False)
    init._write(tmp_path / "c.yaml", "x", True, True)
    assert seen == [("a.csv", False), ("b.csv", False), ("c.yaml", True)]


KILLED = """
import os, signal, sys
from winch_friction.records.bag_write import BagWriter

with BagWriter(sys.argv[1]):
    os.kill(os.getpid(), signal.SIGTERM)
    signal.pause()
"""


@pytest.mark.parametrize("name", ["a.mcap", "a"])
def test_what_a_killed_bag_has_left_goes_with_the_next_one(name, tmp_path):
    """A recorder or replay that was ended by SIGTERM or SIGKILL left a hidden folder, as large as the bag, for good."""
    path = tmp_path / name
    subprocess.run([sys.executable, "-c", KILLED, str(path)], check=False)
    assert len(os.listdir(tmp_path)) == 1
    with BagWriter(path):
        assert len(os.listdir(tmp_path)) == 1  # its own
    assert os.listdir(tmp_path) == [name]


def test_what_another_bag_is_made_in_is_left_alone(tmp_path):
    with BagWriter(tmp_path / "a.mcap"), BagWriter(tmp_path / "b.mcap"):
        pass
    assert sorted(os.listdir(tmp_path)) == ["a.mcap", "b.mcap"]
