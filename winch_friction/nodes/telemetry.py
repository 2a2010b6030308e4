"""Listens to the nodes and prints frames as JSON lines: what `watch` and `dashboard` read from a process of its own."""

import argparse
import json
import sys
from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data

from winch_friction.nodes.messages import message_type
from winch_friction.records.telemetry import TOPICS, Telemetry

PERIOD = 0.2  # s between frames


def main() -> int:
    """Print a frame every 0.2 s until the reader goes away."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--namespace", default="")
    options = parser.parse_args()
    rclpy.init(args=[])
    node = rclpy.create_node("winch_friction_telemetry", namespace=options.namespace, start_parameter_services=False)
    telemetry = Telemetry()
    for topic, type_name in TOPICS.items():
        node.create_subscription(
            message_type(type_name), topic, partial(telemetry.take, topic), qos_profile_sensor_data
        )
    node.create_timer(PERIOD, lambda: print(json.dumps(telemetry.frame()), flush=True))
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


if __name__ == "__main__":
    raise SystemExit(main())
