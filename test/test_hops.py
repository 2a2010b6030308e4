"""How many files a reader opens who follows a path through the program.

Counted are the files of the package of which a function's body runs between the two ends of a path:

* `winch-friction gap`: from the command line with CSV files of two drives to the verdict, when `find_gap` returns. The
  report comes after it and does not count.
* the compensator node: from the moment at which a message of the motor's speed waits in its subscription to the torque
  that is published for it, in the middle of a run, with every other input there.

What runs while a module is imported does not count, and neither does what was built before the path begins. Files that
only hold data, or whose classes are built without a line of our own, are not seen. A file that is new on a path is no
defect: but who splits one asks whether its parts are ever read apart, and raises the number here if they are.
"""

import sys
import time
from pathlib import Path

import pytest

import winch_friction
from campaign.rig import make_dataset
from winch_friction.cli.main import run as winch_friction_command
from winch_friction.discrepancy import workflow
from winch_friction.physics.signals import GroupSample, Run, Sample
from winch_friction.records.runs import write_run

ROOT = str(Path(winch_friction.__file__).parent) + "/"
MOST_OF_A_GAP = 65
MOST_OF_A_MESSAGE = 14


class Visited:
    """The package's files whose functions run while it is switched on, without what runs at import."""

    def __init__(self):
        self._codes = {}

    def on(self):
        sys.settrace(self._see)  # calls alone, without lines: unlike a profile it passes over those of C

    def off(self):
        sys.settrace(None)

    def _see(self, frame, event, _):
        code = frame.f_code
        if event == "call" and not self._codes.get(code) and code.co_filename.startswith(ROOT):
            self._codes[code] = code.co_name != "<module>" and not self._imports(frame)

    def _imports(self, frame):
        """Whether a module is being imported further up."""
        while (frame := frame.f_back) is not None:
            if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
                return True
        return False

    @property
    def files(self):
        return sorted({code.co_filename.removeprefix(ROOT) for code, counts in self._codes.items() if counts})


class Verdict(BaseException):
    """The verdict is there; the rest of the command is not wanted."""


def test_from_a_csv_row_to_the_verdict(tmp_path, monkeypatch):
    paths = []
    for k, columns in enumerate(make_dataset(4010, "quiet", (("churning", 1.0),), length=0.3)[-6:]):
        paths.append(str(tmp_path / f"run_{k + 1:02d}.csv"))
        write_run(Run(f"run_{k + 1:02d}", columns), Path(paths[-1]))
    visited, find_gap = Visited(), workflow.find_gap

    def found(*arguments, **options):
        result = find_gap(*arguments, **options)
        visited.off()
        assert result.verdict in ("missing_effect", "ambiguous")
        raise Verdict

    monkeypatch.setattr(workflow, "find_gap", found)
    command = ["gap", *paths, "--crane", "crane_150t", "--model", "a6vm215_crane2", "--out", str(tmp_path / "out")]
    visited.on()
    try:
        with pytest.raises(Verdict):
            winch_friction_command(command)
    finally:
        visited.off()
    assert "discrepancy/engine/selection.py" in visited.files
    assert len(visited.files) <= MOST_OF_A_GAP, "\n".join(visited.files)


def instant(now, crane):
    """Heave compensation with 55 t, as the sensors say it."""
    groups = {
        "active": GroupSample(50e5, 25e5, crane.max_displacement),
        "passive": GroupSample(275e5, 25e5, crane.max_displacement / 3.0),
    }
    speed = 100.0 + 0.1 * (now % 10.0)  # rad/s
    return Sample(now, speed, speed, groups, hook_load=55e3, oil_temperature=40.0, wire_layer=1.0)


def test_from_a_message_to_the_torque(monkeypatch):
    rclpy = pytest.importorskip("rclpy")
    from winch_friction.nodes.compensator import CompensatorNode
    from winch_friction.nodes.inputs import ROS, message_type
    from winch_friction.nodes.loop import Loop
    from winch_friction.records.domain import unused_domain

    rclpy.init(args=[], domain_id=unused_domain())
    node, other = CompensatorNode(), rclpy.create_node("sensors")
    try:
        assert node.trigger_configure().name == "SUCCESS"
        assert node.trigger_activate().name == "SUCCESS"
        visited, published, topics = Visited(), [], node.service.inputs.topics
        monkeypatch.setattr(node._torque, "publish", published.append)
        senders = {
            topic: other.create_publisher(message_type(source.type_name), topic, 10)
            for topic, source in topics.inputs.items()
        }
        end = time.monotonic() + 20.0
        while not senders[topics.speed_topic].get_subscription_count() and time.monotonic() < end:
            time.sleep(0.02)
        loop = Loop(node)
        for k in range(60):
            said = len(published)
            for topic, message in topics.encode(instant(node.ros_now(), node.crane), ROS):
                senders[topic].publish(message)
            if k >= 50:
                visited.on()
            end = time.monotonic() + 5.0
            while len(published) == said and time.monotonic() < end:
                loop._wait(0.1)  # a turn without the timers and services that would run in between
            visited.off()
            time.sleep(0.01)
        loop.end()
    finally:
        visited.off()
        node.destroy_node(), other.destroy_node()
        rclpy.try_shutdown()
    assert len(published) >= 50
    assert published[-1].header.frame_id.startswith("valid")
    assert "compensation/safe_output.py" in visited.files
    assert len(visited.files) <= MOST_OF_A_MESSAGE, "\n".join(visited.files)
