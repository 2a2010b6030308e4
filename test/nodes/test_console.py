"""What a process prints goes to its console as before, and waits for nobody."""

import os
import subprocess
import sys
import time
from contextlib import suppress

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

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
