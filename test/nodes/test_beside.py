"""Files that are read while the control goes on."""

import threading
import time

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import beside as of_nodes
from winch_friction.nodes.beside import LONGEST, Beside, read_terms
from winch_friction.physics.errors import InputError


def slowly() -> str:
    time.sleep(0.1)
    return "read"


def test_whoever_waits_goes_on_meanwhile() -> None:
    looks = []
    assert Beside[str]().get(slowly, lambda: looks.append(threading.current_thread().name)) == "read"
    assert len(looks) >= 10
    assert set(looks) == {threading.current_thread().name}  # the one that serves the inputs, not the reader's


def test_what_the_work_raises_comes_to_whoever_asked() -> None:
    def fails() -> None:
        raise InputError("no model")

    with pytest.raises(InputError, match="no model"):
        Beside[None]().get(fails, lambda: None)


def test_what_does_not_end_is_left_to_itself_and_asked_for_once() -> None:
    hangs, each = threading.Event(), Beside[object](longest=0.05)
    with pytest.raises(InputError, match=r"not read within 0\.05 s"):
        each.get(hangs.wait, lambda: None)
    with pytest.raises(InputError, match="still being read"):
        each.get(slowly, lambda: None)
    hangs.set()
    each._worker.join(1.0)
    each.longest = 5.0
    assert each.get(slowly, lambda: None) == "read"


def test_whoever_is_told_to_end_waits_for_no_file() -> None:
    hangs, looks = threading.Event(), []
    began = time.monotonic()
    with pytest.raises(InputError, match="told to end"):
        Beside[object](longest=5.0).get(hangs.wait, lambda: looks.append(1), lambda: len(looks) > 2)
    assert time.monotonic() - began < 1.0
    hangs.set()


def test_the_last_ramp_is_published_before_whoever_ends_the_process_loses_patience() -> None:
    assert 3.0 < LONGEST < 5.0  # and a file has its time


def test_a_file_of_terms_that_ends_the_program_does_not(tmp_path) -> None:
    file = tmp_path / "mine.py"
    file.write_text("import sys\nsys.exit(3)\n")
    with pytest.raises(InputError, match="SystemExit"):
        read_terms(str(file))
    assert read_terms("") == []


class Strange(BaseException):
    """What an author may derive from the root of all exceptions."""


@pytest.mark.parametrize(
    ("error", "said"),
    [(SystemExit(3), "x.py: it wants to end the program (sys.exit)"),
     (KeyboardInterrupt(), "x.py: it wants to end the program (sys.exit)"),
     (GeneratorExit(), "x.py: it wants to end the program (sys.exit)"), (Strange("odd"), "x.py: Strange: odd"),
     (InputError("as it is"), "as it is")],
)  # fmt: skip
def test_whatever_reading_terms_raises_is_bad_input(monkeypatch, error, said) -> None:
    def fails(path: str) -> None:
        raise error

    monkeypatch.setattr(of_nodes, "load_file", fails)
    with pytest.raises(InputError) as refused:
        read_terms("x.py")
    assert str(refused.value) == said


@pytest.mark.parametrize("error", [KeyError("gone"), SystemExit(3), Strange("odd")])
def test_an_error_of_the_work_comes_as_it_is(error) -> None:
    def fails() -> None:
        raise error

    with pytest.raises(type(error)) as raised:
        Beside[None]().get(fails, lambda: None)
    assert raised.value is error
    assert Beside[None]().get(lambda: None, lambda: None) is None  # nothing is an answer too
