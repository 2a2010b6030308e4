"""A few trials of the campaign over DDS, and proof that its relay is a bad network."""

import os
import signal
import subprocess
import sys
import time

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from campaign.faults.dds import KINDS, Probe, _one
from campaign.faults.watch import Row

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def probe(tmp_path_factory):
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    made = Probe(tmp_path_factory.mktemp("probe"), 5)
    yield made
    made.bench.close()


@pytest.mark.parametrize("kind", ["lossy relay", "quality of service mismatch", "silence"])
def test_a_trial_is_safe(probe, kind):
    row = Row()
    _one(probe, kind, row)
    assert dict(row.violations) == {}
    assert row.largest > 100.0  # it did feed forward


def test_a_trial_sees_what_is_wrong(probe):
    """A compensator that is stopped for good does not come back, and is not zero after a silence."""
    probe.bench.drive(1.0)
    probe.bench.processes["compensator"].send_signal(signal.SIGSTOP)
    try:
        row = Row()
        _one(probe, "silence", row)
        assert {"not zero in time", "did not come back"} <= set(row.violations)
    finally:
        probe.bench.processes["compensator"].send_signal(signal.SIGCONT)


def test_the_relay_loses_and_delays(probe):
    from sensor_msgs.msg import JointState

    from winch_friction.nodes.qos import OUTPUT

    bench, came = probe.bench, []
    bench.node.create_subscription(
        JointState, "winch/reference", lambda message: came.append((time.monotonic(), message.velocity[0])), OUTPUT
    )
    sends = bench.node.create_publisher(JointState, "raw/winch/reference", OUTPUT)
    command = [sys.executable, "-m", "campaign.faults.relay", "--loss", "0.5", "--delay", "0.1", "--jitter", "0.1"]
    relay = subprocess.Popen(command, env={**os.environ, "ROS_DOMAIN_ID": str(bench.domain)})
    try:
        assert bench.spin(30.0, lambda: sends.get_subscription_count() > 0)
        bench.spin(0.3)
        sent = []
        for k in range(200):
            sent.append(time.monotonic())
            sends.publish(JointState(name=["winch_motor"], velocity=[float(k)]))
            bench.spin(0.01)
        bench.spin(0.5)
    finally:
        relay.terminate()
        ended = relay.wait(10.0)
    assert ended == 0  # one time in three it was a traceback out of the executor
    numbers = [int(number) for _, number in came]
    assert 60 < len(numbers) < 140
    assert numbers != sorted(numbers)  # they overtake each other
    assert min(arrived - sent[int(number)] for arrived, number in came) >= 0.1


def test_every_kind_has_a_line_in_the_campaign():
    assert {"lossy relay", "quality of service mismatch", "SIGSTOP", "late joiner"} <= set(KINDS)
