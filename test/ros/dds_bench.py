"""Real processes over DDS: every test has a domain of its own, on this machine alone."""

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402

from winch_friction.nodes.inputs import ROS, message_type  # noqa: E402
from winch_friction.nodes.qos import OUTPUT  # noqa: E402
from winch_friction.nodes.remote import RemoteNode  # noqa: E402
from winch_friction.physics.signals import GroupSample, Sample  # noqa: E402
from winch_friction.records.crane_file import load_crane  # noqa: E402
from winch_friction.records.domain import unused_domain  # noqa: E402
from winch_friction.records.topics import crane_topics, stamp_time  # noqa: E402

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
CRANE = load_crane("crane_150t")
SAMPLE_PERIOD = 0.02  # s
LATE = 0.06  # s that the stamps may fall behind the clock before samples are left out, as a busy source does


class Bench:
    """A domain with a probe node: starts nodes as processes, publishes inputs, keeps what comes back."""

    def __init__(self, logs: Path) -> None:
        self.domain = unused_domain()
        self._logs = logs
        self._context = Context()
        rclpy.init(context=self._context, domain_id=self.domain)
        self.node = Node("probe", context=self._context)
        self.executor = SingleThreadedExecutor(context=self._context)
        self.executor.add_node(self.node)
        self.processes: dict[str, subprocess.Popen[str]] = {}
        self._publishers: dict[str, object] = {}
        self.time = time.time()
        self._began = self.time  # every test meets the same swell, whenever it runs

    def start(self, executable: str, *arguments: str, name: str = "", **parameters: object) -> subprocess.Popen[str]:
        """A node of this package as a process; `arguments` go behind --ros-args."""
        command = [sys.executable, "-m", f"winch_friction.nodes.{executable}", "--ros-args", *arguments]
        for key, value in parameters.items():
            command += ["-p", f"{key}:={value if not isinstance(value, bool) else str(value).lower()}"]
        limits = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
        environment = {**os.environ, **limits, "ROS_DOMAIN_ID": str(self.domain)}
        log = (self._logs / f"{name or executable}.log").open("w")
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=subprocess.STDOUT, text=True)
        self.processes[name or executable] = process
        return process

    def log(self, name: str) -> str:
        """What a node has printed."""
        return (self._logs / f"{name}.log").read_text()

    def says(self, name: str, text: str, seconds: float = 10.0) -> bool:
        """Whether a node prints a text within a while: a thread of its own hands its lines to the console."""
        return self.spin(seconds, lambda: text in self.log(name))

    def remote(self, name: str) -> RemoteNode:
        """A node's services."""
        return RemoteNode(self.node, self.executor, name)

    def listen(self, topic: str, kind: type = JointState, qos: object = OUTPUT) -> list:
        """Messages of a topic, as they come while the bench spins."""
        heard: list = []
        self.node.create_subscription(kind, topic, heard.append, qos)
        return heard

    def spin(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Take messages in for a while; whether `until` came true."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline and not until():
            self.executor.spin_once(timeout_sec=0.02)
        return until()

    def publish(self, sample: Sample, namespace: str = "") -> None:
        """One sample as its messages."""
        for topic, message in crane_topics(CRANE).encode(sample, ROS):
            name = f"{namespace}/{topic}".lstrip("/")
            if name not in self._publishers:
                self._publishers[name] = self.node.create_publisher(type(message), name, OUTPUT)
            self._publishers[name].publish(message)

    def sample(self) -> Sample:
        """The swell now."""
        return replace(swell(self.time - self._began), time=self.time)

    def publisher(self, topic: str) -> Any:
        """The publisher of an input that was announced."""
        return self._publishers[topic]

    def announce(self, namespace: str = "", subscribers: int = 1) -> None:
        """Make the publishers and wait until the speed is subscribed to."""
        for source in crane_topics(CRANE).inputs.values():
            name = f"{namespace}/{source.topic}".lstrip("/")
            kind = message_type(source.type_name)
            self._publishers.setdefault(name, self.node.create_publisher(kind, name, OUTPUT))
        speed = self._publishers[f"{namespace}/winch/joint_states".lstrip("/")]
        assert self.spin(40.0, lambda: speed.get_subscription_count() >= subscribers), "nobody subscribes to the speed"
        self.spin(0.3)

    def drive(
        self, seconds: float, change: Callable[[Sample], None] = lambda _: None, namespace: str = ""
    ) -> list[float]:
        """Publish a steady swell in real time for a while, each sample changed by `change`; the stamps, s."""
        stamps, ahead, last = [], self.time - time.monotonic(), self.time + seconds - 0.5 * SAMPLE_PERIOD
        while self.time < last:
            began = time.monotonic()
            self.time = max(self.time + SAMPLE_PERIOD, began + ahead - LATE)
            stamps.append(self.time)
            sample = self.sample()
            change(sample)
            self.publish(sample, namespace)
            self.spin(max(0.0, SAMPLE_PERIOD - (time.monotonic() - began)))
        return stamps

    def stop(self, name: str, patience: float = 10.0) -> int:
        """End a process as Ctrl-C would; its exit status."""
        process = self.processes[name]
        process.send_signal(signal.SIGINT)
        return process.wait(patience)

    def close(self) -> None:
        """End everything."""
        for process in self.processes.values():
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in self.processes.values():
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)


def swell(now: float, period: float = 6.0, speed: float = 100.0) -> Sample:
    """A plausible instant of heave compensation with 55 t."""
    omega = speed * math.sin(2.0 * math.pi * now / period)
    groups = {
        "active": GroupSample(100e5, 25e5, CRANE.max_displacement),
        "passive": GroupSample(300e5, 25e5, CRANE.max_displacement / 3.0),
    }
    return Sample(time=now, motor_speed=omega, speed_reference=omega, hook_load=55e3, groups=groups)


def efforts(messages: list) -> list[float]:
    """The torques of JointState messages."""
    return [message.effort[0] for message in messages]


def stamps(messages: list) -> list[float]:
    """The stamps of messages, s."""
    return [stamp_time(message) for message in messages]


def diagnostics(messages: list[DiagnosticArray], part: str) -> dict[str, str]:
    """The latest values of a node's part, `compensator: feedforward`."""
    for message in reversed(messages):
        for status in message.status:
            if status.name.endswith(part):
                return {pair.key: pair.value for pair in status.values} | {"message": status.message}
    return {}
