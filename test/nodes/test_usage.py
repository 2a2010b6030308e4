"""What stands on a node's command line before ROS's arguments."""

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import run as of_run
from winch_friction.nodes.compensator import CompensatorNode
from winch_friction.nodes.estimator import EstimatorNode
from winch_friction.nodes.simulator import SimulatorNode
from winch_friction.nodes.usage import own_arguments


@pytest.fixture(autouse=True)
def _no_pipes(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("Ending", "Console"):
        monkeypatch.setattr(of_run, name, lambda: type("", (), {"end": lambda self: None, "asked": True})())


@pytest.mark.parametrize("kind", [CompensatorNode, EstimatorNode, SimulatorNode], ids=lambda kind: kind.executable)
@pytest.mark.parametrize("arguments", [["--help"], ["-h"], ["--ros-args", "-p", "scale:=0.5", "--help"]])
def test_help_is_shown_and_no_node_started(kind: Any, arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """`--help` began to publish a torque."""
    assert of_run.run(kind, ["program", *arguments]) == 0
    said = capsys.readouterr().out
    assert said.startswith(f"usage: {kind.executable} [--ros-args")
    assert "\n  watchdog_timeout (0.1 s): time without a speed after which the inputs count as lost\n" in said
    assert ("\n  scale (" in said) == (kind is CompensatorNode)
    # an option by name of which nothing is set says so, one of which something is names it
    assert ("\n  gains (one number for each {name}: none given): " in said) == (kind is CompensatorNode)
    assert ("\n  max_ages (one number for each {name}: hook_load 2.0, " in said) == (kind is CompensatorNode)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--params-file", "my.yaml"], "--params-file my.yaml: not understood; parameters, files and names stand"),
        (["--ros-args", "-p", "scale:=1.0", "--", "more"], "more: not understood; "),
        (["--ros-args", "--bogus"], "'--bogus': no argument of ROS; --help says which there are"),
        (["--ros-args", "-p"], "failed to initialize rcl: Couldn't parse trailing -p flag"),
    ],
)
def test_what_nobody_reads_is_refused_in_one_line(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parameter file before --ros-args was passed over: the node ran for the shipped crane."""
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    assert of_run.run(CompensatorNode, ["program", *arguments]) == of_run.BAD_INPUT
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: {said}")
    assert "/src/" not in line


def test_ros_own_arguments_are_left_to_ros() -> None:
    assert own_arguments(["--ros-args", "-p", "a:=1", "--", "--ros-args", "-r", "__ns:=/b"]) == []
