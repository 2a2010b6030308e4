"""Records topics into a bag as they come over the wire, without unpacking them."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile, QoSReliabilityPolicy
from rosgraph_msgs.msg import Clock

from winch_friction.nodes.inputs import Polled, drain, message_type
from winch_friction.nodes.qos import LATCHED
from winch_friction.records.topics import TopicMap

# reliable and deep: a recording with holes proves nothing
RECORDING = QoSProfile(depth=5000, reliability=QoSReliabilityPolicy.RELIABLE)
REORDERED = 2_000_000_000  # ns; a message that was lost on the way is sent again, and comes after its successors
LATCHED_TOPICS = ("friction_model",)
JOINT_STATE = "sensor_msgs/msg/JointState"


def winch_topics(topics: TopicMap) -> dict[str, str]:
    """Inputs, outputs, model, truth and diagnostics of one winch: topic -> type."""
    inputs = {each.topic: each.type_name for each in topics.inputs.values()}
    outputs = {f"{node}/friction_torque": JOINT_STATE for node in ("compensator", "estimator")}
    return {
        **inputs,
        **outputs,
        "compensator/pressure_feedforward": "sensor_msgs/msg/FluidPressure",
        "friction_model": "std_msgs/msg/String",
        "simulator/truth": JOINT_STATE,
        "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    }


class Recorder:
    """Writes what arrives on `topics` (topic -> type) to a `records.bag_write.BagWriter`.

    Messages are taken in by `collect`, written in the order in which they were sent, and dated by the simulated clock
    that was sent before them; what comes before its first word is not written. `finish` writes what is still waiting,
    `close` unsubscribes. `taken` and `counts` are the messages that came and that were written, by topic.
    """

    def __init__(self, node: Node, writer: Any, topics: Mapping[str, str]) -> None:
        self._node, self._writer = node, writer
        self._group = Polled()
        self._types = {node.resolve_topic_name(topic): type_name for topic, type_name in topics.items()}
        self._subscriptions = {topic: self._subscribe(topic, type_name) for topic, type_name in self._types.items()}
        self._subscriptions["/clock"] = node.create_subscription(
            Clock, "/clock", print, RECORDING, callback_group=self._group
        )
        self._waiting: list[tuple[int, str, Any]] = []
        self._now = self._last = 0  # ns: the simulated clock, the last receipt written
        self.taken: Counter[str] = Counter()
        self.counts: Counter[str] = Counter()

    def hears(self, *topics: str) -> bool:
        """Whether somebody is heard on each of these topics."""
        names = [self._node.resolve_topic_name(topic) for topic in topics]
        return all(self._subscriptions[name].get_publisher_count() > 0 for name in names)

    def collect(self) -> None:
        """Take in everything that has come and write what is old enough to be in order."""
        come = [
            (info["source_timestamp"], topic, message)
            for topic, subscription in self._subscriptions.items()
            for message, info in drain(subscription)
        ]
        self._waiting += come
        self.taken.update(topic for _, topic, _ in come)
        if self._waiting:
            self._write_until(max(each[0] for each in self._waiting) - REORDERED)

    def finish(self) -> None:
        """Write the rest."""
        self.collect()
        self._write_until(max((each[0] for each in self._waiting), default=0))

    def close(self) -> None:
        """Unsubscribe."""
        while self._subscriptions:
            self._node.destroy_subscription(self._subscriptions.popitem()[1])

    def _write_until(self, sent: int) -> None:
        ready = sorted((each for each in self._waiting if each[0] <= sent), key=lambda each: each[0])
        self._waiting = [each for each in self._waiting if each[0] > sent]
        for _, topic, message in ready:
            if topic == "/clock":
                self._now = message.clock.sec * 1_000_000_000 + message.clock.nanosec
            elif self._now:
                self._write(topic, message)

    def _write(self, topic: str, message: bytes) -> None:
        self._last = max(self._now, self._last + 1)  # one after the other, also within one tick
        self._writer.write_raw(topic, self._types[topic], message, self._last)
        self.counts[topic] += 1

    def _subscribe(self, topic: str, type_name: str) -> Any:
        latched = any(topic.endswith(each) for each in LATCHED_TOPICS)
        qos = LATCHED if latched else RECORDING
        kind = message_type(type_name)
        return self._node.create_subscription(kind, topic, print, qos, raw=True, callback_group=self._group)
