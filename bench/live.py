"""Both nodes as processes: how long until they answer beside an empty node, and whether anything is lost at 200 Hz.

The inputs are a simulated sea at 200 Hz, forwards and backwards in turn, so that nothing ever jumps.
"""

import importlib.util
import math
import os
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from bench.measuring import Pace, Row, end, sea
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run, Sample
from winch_friction.records.domain import unused_domain

RATE = 200.0  # Hz
SLOW = 50.0  # Hz, while nodes start: the sender must not take the processor from them
SOAK = 300.0  # s
STARTING, SETTLING = 60.0, 2.0  # s for a process to answer; after the last speed for its answer
NODES = {"compensator": "winch_friction.nodes.compensator", "estimator": "winch_friction.nodes.estimator"}
REPEATS = 3
EMPTY = """
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
rclpy.init()
node = Node("empty")
out = node.create_publisher(JointState, "~/friction_torque", 10)
node.create_timer(0.005, lambda: out.publish(JointState()))
rclpy.spin(node)
"""


class Driver:
    """Sends one sea to both nodes in one namespace and counts their answers by stamp."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.node import Node
        from rclpy.signals import SignalHandlerOptions
        from sensor_msgs.msg import JointState

        from winch_friction.nodes.inputs import Polled, message_type
        from winch_friction.nodes.qos import OUTPUT, fresh
        from winch_friction.records.crane_file import load_crane
        from winch_friction.records.topics import crane_topics

        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        self._node, polled = Node("driver"), Polled()
        self._topics = crane_topics(load_crane("crane_150t"))
        self._out = {
            topic: self._node.create_publisher(message_type(each.type_name), f"/live/{topic}", fresh(OUTPUT))
            for topic, each in self._topics.inputs.items()
        }
        self._in = {  # reliable: an answer that is lost on its way would be counted as the node's
            name: self._node.create_subscription(
                JointState, f"/live/{name}/friction_torque", print, fresh(OUTPUT), callback_group=polled
            )
            for name in (*NODES, "empty")
        }

    def close(self) -> None:
        """Leave the graph."""
        import rclpy

        self._node.destroy_node()
        rclpy.try_shutdown()

    def send(self, sample: Sample, stamp: float) -> tuple[int, int]:
        """All messages of one sample, the speed last; returns its stamp."""
        from winch_friction.nodes.inputs import ROS

        sample.time = stamp
        message: Any = None
        for topic, message in self._topics.encode(sample, ROS):
            self._out[topic].publish(message)
        return message.header.stamp.sec, message.header.stamp.nanosec

    def taken(self, name: str) -> set[tuple[int, int]]:
        """Stamps of the answers that came since."""
        from winch_friction.nodes.inputs import drain

        return {(each.header.stamp.sec, each.header.stamp.nanosec) for each, _ in drain(self._in[name])}

    def first_answer(self, name: str, samples: list[Sample]) -> float:
        """Seconds from the start of a node's process to its first message, with inputs from the start.

        A node's is the first answer to a speed of ours: what the one before said last may still be on its way.
        """
        command = [sys.executable, "-m", NODES[name]] if name in NODES else [sys.executable, "-c", EMPTY]
        process, begin, sent = _started(command), time.time(), set()
        try:
            for number in range(int(STARTING * SLOW)):
                sent.add(self.send(samples[number % len(samples)], time.time()))
                time.sleep(1.0 / SLOW)
                taken = self.taken(name)
                if taken & sent or (taken and name not in NODES):
                    return time.time() - begin
            raise RuntimeError(f"{name}: no answer within {STARTING:g} s")
        finally:
            end([process])

    def soak(self, samples: list[Sample], duration: float) -> tuple[int, dict[str, int], int]:
        """Speeds sent at 200 Hz, how many of them each node answered, and how often the sender was kept waiting; both
        answer before it counts."""
        processes = [_started([sys.executable, "-m", module]) for module in NODES.values()]
        try:
            number, waiting = 0, set(NODES)
            deadline = time.time() + STARTING
            both = math.inf  # when both answered; what waited for the later one is worked off after that
            while time.time() < min(deadline, both + SETTLING):
                self.send(samples[number % len(samples)], time.time())
                time.sleep(1.0 / RATE)
                waiting -= {name for name in waiting if self.taken(name)}
                both = min(both, time.time()) if not waiting else math.inf
                number += 1
            sent: set[tuple[int, int]] = set()
            answered: dict[str, set[tuple[int, int]]] = {name: set() for name in NODES}
            pace = Pace(RATE)
            for step in range(int(max(duration, STARTING) * RATE)):
                # a machine that is busy answers later: what is measured over seconds waits for one answer of each
                if step >= int(duration * RATE) and all(answered.values()):
                    break
                due = pace.next()
                if (wait := due - time.time()) > 0.0:
                    time.sleep(wait)
                sent.add(self.send(samples[(number + step) % len(samples)], due))
                for name, stamps in answered.items():
                    stamps |= self.taken(name)
            time.sleep(SETTLING)
            found = {name: len(sent & (stamps | self.taken(name))) for name, stamps in answered.items()}
            return len(sent), found, pace.pauses
        finally:
            end(processes)


def measure(smoke: bool = False) -> list[Row]:
    """Wall time to the first output, less an empty node's; the share of speeds answered over five minutes."""
    if importlib.util.find_spec("rclpy") is None:
        raise InputError("the benchmark live needs rclpy, which is not installed: pip install '.[ros]'")
    os.environ |= {
        "ROS_DOMAIN_ID": str(unused_domain()), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    samples, driver = there_and_back(sea(20.0)[2]), Driver()
    try:
        driver.first_answer("empty", samples)  # what only the first process on a machine waits for
        times = {
            name: [driver.first_answer(name, samples) for _ in range(1 if smoke else REPEATS)]
            for name in ("empty", *NODES)
        }
        # an empty node that waited for its discovery would make any node quick: the quickest of them counts
        first = {name: min(each) if name == "empty" else median(each) for name, each in times.items()}
        sent, answered, pauses = driver.soak(samples, 2.0 if smoke else SOAK)
    finally:
        driver.close()
    against = f"beyond an empty rclpy node's {first['empty']:.2f} s"
    rows = [
        Row(f"start: {name} node to its first output", max(first[name] - first["empty"], 1e-3), "s", against,
            at_most=1.0)
        for name in NODES
    ]  # fmt: skip
    return rows + [
        Row(f"live: share of speeds that the {name} answered", answered[name] / sent, "1",
            f"{sent} at {RATE:g} Hz, {sent - answered[name]} without an answer; {pauses} pauses of the sender",
            at_least=1.0)
        for name in NODES
    ]  # fmt: skip


def there_and_back(run: Run) -> list[Sample]:
    """A run's samples at 200 Hz, to its end and back."""
    time = np.arange(run.time[0], run.time[-1], 1.0 / RATE)
    finer = Run(run.name, {name: np.interp(time, run.time, values) for name, values in run.columns.items()})
    return [*finer.samples(), *reversed(list(finer.samples()))]


def _started(command: list[str]) -> Any:
    return subprocess.Popen(
        [*command, "--ros-args", "-r", "__ns:=/live"], cwd=Path(__file__).resolve().parents[1],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
