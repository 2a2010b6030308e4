"""A kill at any moment leaves the old file or the new one; what else it leaves, the next start removes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from winch_friction.records.atomic import atomic_path, remove_stale, together, write_text
from winch_friction.records.checkpoint import read_checkpoint

WRITER = """
import sys
from winch_friction.records.checkpoint import write_checkpoint
print("ready", flush=True)
k = 0
while True:
    k += 1
    write_checkpoint(sys.argv[1], {"k": k, "x": [float(k)] * 2000})
"""


@pytest.mark.parametrize("delay", [0.01 * k for k in range(12)])
def test_a_killed_writer_leaves_a_whole_file_and_no_litter(tmp_path: Path, delay: float) -> None:
    path = tmp_path / "ck.json"
    process = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE)
    process.stdout.readline()
    time.sleep(0.1 + delay)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert len(read_checkpoint(path)["x"]) == 2000
    assert [each.name for each in tmp_path.iterdir()] == ["ck.json"]


def test_what_a_dead_process_left_is_removed_by_the_next_writer(tmp_path: Path) -> None:
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    (tmp_path / f".run.{dead.pid}-1.tmp.csv").write_text("half")
    (tmp_path / ".run.other").write_text("not ours")
    with atomic_path(tmp_path / "run.csv") as temporary:
        temporary.write_text("whole")
    assert sorted(each.name for each in tmp_path.iterdir()) == [".run.other", "run.csv"]


def test_files_that_belong_together_come_at_once(tmp_path: Path) -> None:
    killed = "import os, sys; from pathlib import Path; from winch_friction.records.atomic import together\n"
    killed += "with together(Path(sys.argv[1]), 'a.json') as place:\n"
    killed += "    (place / 'b.yaml').write_text('new'); os.kill(os.getpid(), 9)"
    subprocess.run([sys.executable, "-c", killed, str(tmp_path)], check=False)
    assert [each.name.split(".")[:2] for each in tmp_path.iterdir()] == [["", "a"]]  # hidden
    (tmp_path / "b.yaml").write_text("mine")

    def broken(place: Path) -> None:
        (place / "b.yaml").write_text("half")
        raise ValueError

    with pytest.raises(ValueError), together(tmp_path, "a.json") as place:
        broken(place)
    assert [(each.name, each.read_text()) for each in tmp_path.iterdir()] == [("b.yaml", "mine")]
    with together(tmp_path, "a.json") as place:
        for name in ("b.yaml", "a.json"):
            (place / name).write_text("new")
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == {"a.json": "new", "b.yaml": "new"}


def test_of_files_that_belong_together_the_mark_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A process that is killed between them has said whose the folder is."""
    moved, replaced = list[str](), os.replace
    monkeypatch.setattr(os, "replace", lambda one, two: (moved.append(Path(two).name), replaced(one, two)))
    with together(tmp_path, "gap.json") as place:
        for name in ("addition.csv", "gap.json", "model.yaml"):
            (place / name).write_text("new")
    assert moved == ["gap.json", "addition.csv", "model.yaml"]


def test_others_may_read_what_the_writer_s_mask_lets_them(tmp_path: Path) -> None:
    """A node of another user loads the model; its temporary file was nobody's but the writer's."""
    before = os.umask(0o027)
    try:
        with atomic_path(tmp_path / "run.parquet") as temporary:
            temporary.write_bytes(b"new")
        write_text(tmp_path / "model.yaml", "new")
    finally:
        os.umask(before)
    assert {each.stat().st_mode & 0o777 for each in tmp_path.iterdir()} == {0o640}


def test_an_error_leaves_the_old_file_alone(tmp_path: Path) -> None:
    path = write_text(tmp_path / "a.txt", "old")

    def broken() -> None:
        with atomic_path(path) as temporary:
            temporary.write_text("half")
            raise ValueError

    with pytest.raises(ValueError):
        broken()
    assert path.read_text() == "old"
    assert write_text(path, "new").read_text() == "new"
    assert len(list(tmp_path.iterdir())) == 1


def test_only_a_dead_process_leaves_something_to_remove(tmp_path: Path) -> None:
    living = tmp_path / f".run.{os.getpid()}-1.tmp.csv"
    nobodys = tmp_path / ".run.mine-1.tmp.csv"
    for each in (living, nobodys):
        each.write_text("half")
    remove_stale(tmp_path / "run.csv")
    assert living.exists()
    assert nobodys.exists()
