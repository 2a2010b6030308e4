"""A disk that is full or read-only keeps no node from its work."""

from pathlib import Path

import pytest
from dds_bench import Bench, efforts


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
    log = bench.log("compensator")
    assert log.count("warning: no log file is kept") == 1
    assert "set ROS_LOG_DIR to a folder that can be written" in log
    assert bench.stop("compensator") == 0
    assert "Traceback" not in bench.log("compensator")
