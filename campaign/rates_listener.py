"""Listens to the rate campaign's nodes from a process of its own, cheaply."""

import time
from types import TracebackType
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from winch_friction.nodes.inputs import Polled, drain, message_type
from winch_friction.nodes.qos import LATCHED, SENSOR
from winch_friction.nodes.recorder import RECORDING
from winch_friction.records.crane_file import load_crane
from winch_friction.records.topics import crane_topics

SPEED = "winch/joint_states"
GATHER = 0.1  # s
NANOSECOND = 1e-9


class Listener:
    """Subscribes to all inputs, so that the simulator waits for it, and reads stamps and counters."""

    def __enter__(self) -> "Listener":
        rclpy.init()
        self._node = Node("listener")
        self._group = Polled()
        self._progress = 0.0
        self._sent: dict[str, dict[tuple[int, int], int]] = {"speed": {}, "torque": {}}
        self._values: dict[str, dict[str, str]] = {}
        inputs = crane_topics(load_crane("crane_150t")).inputs
        self._ignored = [
            self._subscribe(message_type(each.type_name), topic, SENSOR)
            for topic, each in inputs.items()
            if topic != SPEED
        ]
        self._speed = self._subscribe(JointState, SPEED, RECORDING)
        self._torque = self._subscribe(JointState, "compensator/friction_torque", RECORDING)
        self._diagnostics = self._subscribe(DiagnosticArray, "/diagnostics", RECORDING)
        self._progress_in = self._subscribe(Float64, "simulator/progress", LATCHED)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._node.destroy_node()
        rclpy.shutdown()

    def _subscribe(self, kind: Any, topic: str, qos: Any) -> Any:
        return self._node.create_subscription(kind, topic, print, qos, callback_group=self._group)

    def wait_for_nodes(self, patience: float) -> None:
        """Until the first diagnostics of all three nodes."""
        self._until(lambda: len({name.split(":")[0] for name in self._values}) >= 3, patience)

    def listen(self, patience: float) -> None:
        """Until the simulator has reached the end."""
        self._until(lambda: self._progress >= 1.0, patience)

    def listen_on(self, duration: float) -> None:
        """For a while."""
        self._until(lambda: False, duration)

    def _until(self, reached: Any, patience: float) -> None:
        deadline = time.monotonic() + patience
        while not reached() and time.monotonic() < deadline:
            time.sleep(GATHER)
            self._take()

    def _take(self) -> None:
        for name, subscription in (("speed", self._speed), ("torque", self._torque)):
            for message, info in drain(subscription):
                key = (message.header.stamp.sec, message.header.stamp.nanosec)
                self._sent[name].setdefault(key, info["source_timestamp"])
        for message, _ in drain(self._diagnostics):
            for status in message.status:
                self._values[status.name] = {pair.key: pair.value for pair in status.values}
        for message, _ in drain(self._progress_in):
            self._progress = message.data

    @property
    def published(self) -> int:
        """Samples that the simulator published, the one at the start included."""
        return int(self._values["simulator: sea"]["samples"]) + 1

    def received(self, node: str) -> int:
        """Speeds that a node counted."""
        return int(self._values[f"{node}: inputs"][f"{SPEED} messages"])

    def delays(self) -> list[float]:
        """Seconds from the sending of a speed to the sending of its feedforward."""
        speeds, torques = self._sent["speed"], self._sent["torque"]
        return [(torques[key] - sent) * NANOSECOND for key, sent in speeds.items() if key in torques]
