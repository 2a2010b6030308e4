"""Neither a disk that takes no log file nor a console that nobody reads keeps a node from its work."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from dds_bench import Bench, efforts
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState


def test_a_node_starts_where_no_log_file_can_be_written(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ROS refused to begin, and after a restart on a full disk nothing was fed forward."""
    file = tmp_path / "file"
    file.write_text("no folder")
    monkeypatch.setenv("ROS_LOG_DIR", str(file / "log"))
    bench.start("compensator", "-r", "__ns:=/crane_1", ramp_time=0.3)
    torque = bench.listen("crane_1/compensator/friction_torque")
    bench.announce("crane_1")
    bench.drive(1.0, namespace="crane_1")
    assert abs(efforts(torque)[-1]) > 50.0
    assert bench.says("compensator", "set ROS_LOG_DIR to a folder that can be written")
    assert bench.log("compensator").count("warning: no log file is kept") == 1
    assert bench.stop("compensator") == 0
    assert "Traceback" not in bench.log("compensator")


@pytest.fixture
def console() -> Iterator[tuple[int, int]]:
    """Where a console is read, and where it is written to."""
    made = os.pipe()
    yield made
    for each in made:
        os.close(each)


def test_a_console_that_nobody_reads_holds_up_no_torque(bench: Bench, console: tuple[int, int]) -> None:
    """Ctrl-S in the terminal and one line of the log: 375 N m stood, and the watchdog with it."""
    source, sink = console
    command = [sys.executable, "-m", "winch_friction.nodes.compensator", "--ros-args", "-p", "ramp_time:=0.3"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(bench.domain)}
    process = subprocess.Popen(command, env=environment, stdout=sink, stderr=sink, text=True)
    bench.processes["compensator"] = process
    torque = bench.listen("compensator/friction_torque")
    bench.announce()
    bench.drive(1.0)
    fill(sink)
    client = bench.node.create_client(ChangeState, "compensator/change_state")
    assert client.wait_for_service(5.0)
    for _ in range(3):
        client.call_async(ChangeState.Request(transition=Transition(id=Transition.TRANSITION_ACTIVATE)))
        before = len(torque)
        sent = bench.drive(0.6)
        assert len(torque) - before >= 0.6 * len(sent)
    process.send_signal(signal.SIGTERM)
    assert bench.spin(3.0, lambda: efforts(torque)[-1] == 0.0)
    assert process.wait(5.0) == 0


def fill(sink: int) -> None:
    """As much as it takes."""
    os.set_blocking(sink, False)
    for size in (4096, 1):
        try:
            while True:
                os.write(sink, b"x" * size)
        except BlockingIOError:
            pass
    os.set_blocking(sink, True)
