"""Listens to the nodes and prints JSON lines, for `watch`, `dashboard` and `foxglove`, which read from a process of
its own: frames, or with `--raw` every message of the winch's topics as it came."""

import argparse
import base64
import json
import os
import sys
from functools import partial
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

from winch_friction.nodes.inputs import message_type
from winch_friction.nodes.remote import looking_on
from winch_friction.physics.errors import InputError
from winch_friction.records.telemetry import TOPICS, Telemetry
from winch_friction.records.topics import FLOAT64, FLUID_PRESSURE, JOINT_STATE, TEMPERATURE

PERIOD = 0.2  # s between frames
LOOK_AROUND = 1.0  # s between looks at which topics there are
BATCH = 0.05  # s for which raw messages are gathered
SHOWN = {FLOAT64, FLUID_PRESSURE, JOINT_STATE, TEMPERATURE, TOPICS["/diagnostics"]}


def main() -> int:
    """Print until the reader goes away."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--namespace", default="")
    parser.add_argument("--joint", default="")
    parser.add_argument("--raw", action="store_true")
    # said by the reader itself: one that is killed while this process still starts is nobody's parent any more
    parser.add_argument("--reader", type=int, default=os.getppid())
    options = parser.parse_args()
    try:
        node = looking_on("winch_friction_telemetry", options.namespace)
    except InputError as error:
        print(json.dumps({"error": str(error)}), flush=True)
        return 2
    if options.raw:
        Raw(node)
    else:
        _frames(node, options.joint, options.namespace)
    node.create_timer(LOOK_AROUND, partial(_orphaned, options.reader))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        executor.spin()
    except (BrokenPipeError, KeyboardInterrupt, ExternalShutdownException):
        sys.stderr.close()  # the reader has gone: nothing is left to say
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


def _orphaned(reader: int) -> None:
    """End with the reader, even one that was killed and before there is anything to write to it."""
    if os.getppid() != reader:
        raise KeyboardInterrupt


def _frames(node: Node, joint: str, namespace: str) -> None:
    telemetry = Telemetry(joint, namespace)
    for topic, type_name in TOPICS.items():
        node.create_subscription(
            message_type(type_name), topic, partial(telemetry.take, topic), qos_profile_sensor_data
        )
    node.create_timer(PERIOD, lambda: print(json.dumps(telemetry.frame()), flush=True))


class Raw:
    """Every message of the topics below the winch's namespace, and /diagnostics, as JSON lines."""

    def __init__(self, node: Node) -> None:
        self._node, self._heard, self._lines = node, set[str](), list[str]()
        self._prefix = "/" if node.get_namespace() == "/" else f"{node.get_namespace()}/"
        self._look_around()
        node.create_timer(LOOK_AROUND, self._look_around)
        node.create_timer(BATCH, self._print)

    def _look_around(self) -> None:
        for topic, types in self._node.get_topic_names_and_types():
            ours = topic == "/diagnostics" or topic.startswith(self._prefix)
            if ours and topic not in self._heard and types[0] in SHOWN:
                self._heard.add(topic)
                take = partial(self._take, topic, types[0])
                kind = message_type(types[0])
                self._node.create_subscription(kind, topic, take, qos_profile_sensor_data, raw=True)

    def _take(self, topic: str, type_name: str, data: Any) -> None:
        receipt = self._node.get_clock().now().nanoseconds
        content = base64.b64encode(bytes(data)).decode()
        self._lines.append(json.dumps({"topic": topic, "type": type_name, "receipt": receipt, "data": content}))

    def _print(self) -> None:
        if self._lines:
            print("\n".join(self._lines), flush=True)
            self._lines.clear()


if __name__ == "__main__":
    raise SystemExit(main())
