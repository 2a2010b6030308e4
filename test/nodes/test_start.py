"""What a node's start spares itself, and what it takes up again before it controls."""

import gc
import subprocess
import sys

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import run as of_run
from winch_friction.nodes.compensator import CompensatorNode


@pytest.mark.parametrize(("program", "looks"), [("/opt/lib/compensator", "False"), ("/opt/bin/recorder", "True")])
def test_garbage_is_not_looked_for_while_a_nodes_modules_are_loaded(program: str, looks: str) -> None:
    """In a node's process alone: whoever else imports the package keeps what was set."""
    code = f"import gc, sys; sys.argv = [{program!r}]; import winch_friction.nodes; print(gc.isenabled())"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == looks


def test_what_was_imported_is_looked_through_no_more(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A look through all that SymPy and rclpy hold stands in the way of the torque for 0.04 to 0.1 s."""
    for name in ("Ending", "Console"):
        monkeypatch.setattr(of_run, name, lambda: type("", (), {"end": lambda self: None})())
    kept = [[] for _ in range(1000)]
    frozen = gc.get_freeze_count()
    gc.disable()
    try:
        assert of_run.run(CompensatorNode, ["program", "--help"]) == 0
        assert gc.isenabled()
    finally:
        gc.enable()
    assert gc.get_freeze_count() >= frozen + len(kept)
    assert "usage: compensator" in capsys.readouterr().out
