"""What a process prints goes to its console as before, and waits for nobody."""

import os
import subprocess
import sys
import time
from contextlib import suppress
from types import SimpleNamespace

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import console as of_nodes
from winch_friction.nodes.console import Console


def printed(source: int) -> str:
    os.set_blocking(source, False)
    try:
        return os.read(source, 1 << 20).decode()
    except BlockingIOError:
        return ""


@pytest.fixture
def pipe():
    """A descriptor that a process prints to, and where it is read."""
    source, sink = os.pipe()
    yield source, sink
    for each in (source, sink):
        os.close(each)


def test_lines_arrive_in_their_order_and_after_the_end(pipe) -> None:
    source, sink = pipe
    console = Console((sink,))
    for k in range(100):
        os.write(sink, f"line {k}\n".encode())
    console.end()
    os.write(sink, b"afterwards\n")
    assert printed(source).split("\n") == [*(f"line {k}" for k in range(100)), "afterwards", ""]


def test_a_console_that_nobody_reads_is_not_waited_for(pipe) -> None:
    source, sink = pipe
    console, began, lost = Console((sink,)), time.monotonic(), 0
    assert not os.get_blocking(sink)  # else what follows would wait for ever
    for _ in range(300):
        try:
            os.write(sink, b"x" * 1024)
        except BlockingIOError:
            lost += 1
    assert lost > 100
    console.end()
    assert time.monotonic() - began < 2.0
    while printed(source):  # and whoever reads again sees what was kept
        time.sleep(0.01)


def test_a_console_that_is_gone_ends_nothing() -> None:
    source, sink = os.pipe()
    console = Console((sink,))
    os.close(source)
    for _ in range(3):
        with suppress(BrokenPipeError):
            os.write(sink, b"nobody hears it\n")
        time.sleep(0.02)
    console.end()
    os.close(sink)


def test_a_process_without_a_console_has_none_to_lead() -> None:
    code = "import os; os.close(1); os.close(2)\nfrom winch_friction.nodes.console import Console\nConsole().end()"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_traceback_of_the_end_is_printed() -> None:
    code = (
        "from winch_friction.nodes.console import Console\nc = Console()\nprint('said')\n"
        "try:\n    1 / 0\nfinally:\n    c.end()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout == "said\n"
    assert "ZeroDivisionError" in done.stderr


def test_a_console_that_takes_a_line_in_pieces_gets_all_of_it(monkeypatch) -> None:
    given, taken, waits = [b"a line", b"and more\n", b""], [], []
    full = iter([False, True, False, False, True, True])

    def write(console: int, text: bytes) -> int:
        assert console == 11
        if next(full, False):
            raise BlockingIOError
        taken.append(text[:4])
        return 4 if len(text) > 4 else len(text)

    monkeypatch.setattr(of_nodes.os, "read", lambda source, most: given.pop(0))
    monkeypatch.setattr(of_nodes.os, "write", write)
    monkeypatch.setattr(of_nodes.os, "close", lambda source: taken.append(source))
    monkeypatch.setattr(of_nodes.time, "sleep", waits.append)
    of_nodes._pump(10, 11)
    assert taken == [b"a li", b"ne", b"and ", b"more", b"\n", 10]
    assert waits == [of_nodes.AGAIN] * 3


@pytest.mark.parametrize(("descriptor", "terminal", "before", "after"), [
    (2, True, None, "1"), (2, True, "0", "0"), (2, False, None, None), (1, True, None, None),
])  # fmt: skip
def test_colours_are_kept_where_the_errors_go_to_a_terminal_and_nobody_chose_otherwise(
    monkeypatch, descriptor: int, terminal: bool, before: str | None, after: str | None
) -> None:
    name = "RCUTILS_COLORIZED_OUTPUT"
    monkeypatch.setenv(name, before) if before else monkeypatch.delenv(name, raising=False)
    calls = []
    stand_in = SimpleNamespace(
        dup=lambda d: d + 40, isatty=lambda d: terminal, pipe=lambda: (50, 51), close=calls.append, environ=os.environ,
        set_blocking=lambda *of: calls.append(of), dup2=lambda *of: calls.append(of),
    )  # fmt: skip
    monkeypatch.setattr(of_nodes, "os", stand_in)
    started = []
    monkeypatch.setattr(of_nodes.threading, "Thread", lambda **of: SimpleNamespace(start=lambda: started.append(of)))
    console = Console((descriptor,))
    assert os.environ.get(name) == after
    assert calls == [(51, False), (51, descriptor), 51]
    assert (started[0]["args"], started[0]["daemon"]) == ((50, descriptor + 40), True)
    monkeypatch.delenv(name, raising=False)
    calls.clear()
    console._led = [(d, c, SimpleNamespace(join=calls.append, is_alive=lambda hangs=hangs: hangs))
                    for d, c, hangs in ((1, 41, False), (2, 42, True))]  # fmt: skip
    console.end()
    assert calls == [(41, 1), (42, 2), 0.5, 41, 0.5]  # one that still hangs is left open
    assert console._led == []
