"""A disk that is full in the middle of a file: the file asked for is named, with what to do, and nothing stays."""

import errno
import os

import numpy as np
import pytest

from winch_friction.cli.main import run as command
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run
from winch_friction.records import atomic
from winch_friction.records.atomic import atomic_path, write_text
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import _turning, write_run
from winch_friction.report import check as report

FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
SAID = "cannot be written (No space left on device); make room there, or give another place"


def full(*_, **__):
    raise FULL


def small():
    time = np.arange(0.0, 4.0, 0.02)
    columns = {"time": time, "motor_speed": np.sin(time), "hook_load": np.full(len(time), 5e4)}
    groups = {"pressure_a": 2e7, "pressure_b": 2e6, "displacement": 3e-5}
    return Run("run", columns | {f"main.{name}": np.full(len(time), value) for name, value in groups.items()})


def test_a_text_names_its_file(tmp_path, monkeypatch):
    monkeypatch.setattr(atomic.os, "fsync", full)
    with pytest.raises(OSError, match="cannot be written") as caught:
        write_text(tmp_path / "seed.yaml", "x")
    assert (caught.value.filename, caught.value.strerror) == (str(tmp_path / "seed.yaml"), SAID)
    assert list(tmp_path.iterdir()) == []


def test_a_file_of_any_writer_names_the_one_that_was_asked_for(tmp_path):
    for named in (None, "temporary"):
        with (
            pytest.raises(OSError, match="cannot be written") as caught,
            atomic_path(tmp_path / "run.csv") as temporary,
        ):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), *([str(temporary)] if named else []))
        assert (caught.value.filename, caught.value.strerror) == (str(tmp_path / "run.csv"), SAID)
    assert list(tmp_path.iterdir()) == []


def test_what_is_said_of_another_file_stays(tmp_path):
    with pytest.raises(FileNotFoundError) as caught, atomic_path(tmp_path / "run.csv"):
        (tmp_path / "log.csv").open()
    assert caught.value.filename == str(tmp_path / "log.csv")


@pytest.mark.parametrize("name", ["bag", "run.mcap"])
@pytest.mark.parametrize("when", ["write", "__exit__"])
def test_a_bag_leaves_nothing(name, when, tmp_path, monkeypatch):
    """Its hidden folder stayed, for ever."""
    from rosbags.rosbag2 import Writer

    monkeypatch.setattr(Writer, when, full)
    with pytest.raises(OSError, match="cannot be written") as caught:
        write_run(small(), tmp_path / name)
    assert (caught.value.filename, caught.value.strerror) == (str(tmp_path / name), SAID)
    assert list(tmp_path.iterdir()) == []


def test_the_command_says_it_in_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(atomic.os, "fsync", full)
    assert command(["init", "map", "--out", "map.yaml"]) == 2
    assert capsys.readouterr().err == f"winch-friction: map.yaml: {SAID}\n"


def test_files_that_belong_together_name_the_one_that_did_not_fit(tmp_path, monkeypatch, capsys):
    """check.json stayed without its page, and the next call took the folder for a whole earlier result."""
    log = tmp_path / "run.csv"
    write_run(small(), log)
    arguments = ["check", str(log), "--crane", "crane_150t", "--out", str(tmp_path / "check"), "--json"]
    with monkeypatch.context() as patched:

        def page(path, *_):
            patched.setattr(atomic.os, "fsync", full)  # from here on
            write_text(path, "x")

        patched.setattr(report, "write_check_report", page)
        assert command(arguments) == 2
    assert capsys.readouterr().err == f"winch-friction: {tmp_path / 'check' / 'check.html'}: {SAID}\n"
    assert list((tmp_path / "check").iterdir()) == []
    command(arguments)
    assert sorted(each.name for each in (tmp_path / "check").iterdir()) == ["check.html", "check.json"]


def test_a_tab_in_a_file_of_keys_is_answered_with_what_to_use(tmp_path):
    (tmp_path / "crane.yaml").write_text("schema: winch_friction.crane/1\n\tname: x\n")
    with pytest.raises(InputError, match=r"line 2: not valid YAML .*; indent with spaces, not with tabs"):
        load_crane(str(tmp_path / "crane.yaml"))


@pytest.mark.filterwarnings("error")
def test_values_that_no_sensor_gives_do_not_overflow(tmp_path):
    """A speed of 1e308 was squared, and numpy's warning stood on the terminal."""
    speed = np.where(np.arange(200) == 100, 1e308, np.sin(np.arange(200)))
    assert _turning(speed).shape == speed.shape
    assert _turning(np.array([1e308, -1e308, -1.0, -1.0])).any()


def test_a_disk_that_may_only_be_read_says_what_to_do(tmp_path, monkeypatch):
    """Of a full one it was said; an estimator's checkpoint on a read-only disk was just `Read-only file system`."""

    def refused(*_, **__):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(atomic.Path, "touch", refused)
    with pytest.raises(OSError, match="cannot be written") as caught:
        write_text(tmp_path / "kept.yaml", "x")
    assert caught.value.strerror == "cannot be written (Read-only file system); give another place"
