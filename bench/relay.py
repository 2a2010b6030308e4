"""The least that a node on the same topics can cost: it takes the same messages and copies one of them out.

    python -m bench.relay

Subscriptions, their polling and the two outputs are the compensator node's; nothing is read, decided or checked.
"""

from contextlib import suppress
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import FluidPressure, JointState

from winch_friction.nodes.inputs import Polled, drain, message_type
from winch_friction.nodes.qos import OUTPUT, SENSOR, fresh
from winch_friction.records.crane_file import load_crane
from winch_friction.records.topics import crane_topics


class Relay(Node):
    """Copies every speed message to `~/friction_torque` and the last pressure to `~/pressure_feedforward`."""

    def __init__(self) -> None:
        super().__init__("relay")
        topics, polled = crane_topics(load_crane("crane_150t")), Polled()
        self._held = [
            self.create_subscription(
                message_type(each.type_name), topic, self._copy, fresh(SENSOR), callback_group=polled
            )
            for topic, each in topics.inputs.items()
            if topic != topics.speed_topic
        ]
        self._pressure = FluidPressure()
        self._out = self.create_publisher(JointState, "~/friction_torque", fresh(OUTPUT))
        self._pressure_out = self.create_publisher(FluidPressure, "~/pressure_feedforward", fresh(OUTPUT))
        self._speed = self.create_subscription(JointState, topics.speed_topic, self._copy, fresh(SENSOR))

    def _copy(self, message: Any) -> None:
        for each in self._held:
            for held, _ in drain(each):
                if isinstance(held, FluidPressure):
                    self._pressure = held
        self._out.publish(message)
        self._pressure_out.publish(self._pressure)


def main() -> None:
    """Spin until told to end."""
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(Relay())


if __name__ == "__main__":
    main()
