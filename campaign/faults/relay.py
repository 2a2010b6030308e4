"""A bad network as a process: takes messages from `raw/...`, loses some, holds others back, lets them overtake.

    python -m campaign.faults.relay --seed 1 --loss 0.2 --delay 0.05 --jitter 0.1

Each message is lost with probability `loss`, or comes `delay` s later, and up to `jitter` s more, each by itself.
"""

import argparse
import heapq
import itertools
import random
import sys
import time
from functools import partial
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from winch_friction.nodes.inputs import message_type
from winch_friction.nodes.qos import OUTPUT, fresh
from winch_friction.nodes.run import Ending
from winch_friction.records.crane_file import load_crane
from winch_friction.records.topics import crane_topics

PERIOD = 0.002  # s between two looks at what is due
LONGEST_WAIT = 0.1  # s after which it is looked whether it is to end


class Relay:
    """Passes the inputs of the 150 t crane on, badly."""

    def __init__(self, node: Any, options: argparse.Namespace) -> None:
        self._options, self._random, self._count = options, random.Random(options.seed), itertools.count()
        self._waiting: list[tuple[float, int, Any, bytes]] = []
        for source in crane_topics(load_crane("crane_150t")).inputs.values():
            kind = message_type(source.type_name)
            onwards = node.create_publisher(kind, source.topic, fresh(OUTPUT))
            node.create_subscription(kind, f"raw/{source.topic}", partial(self._take, onwards), fresh(OUTPUT), raw=True)
        node.create_timer(PERIOD, self._pass_on)

    def _take(self, onwards: Any, message: bytes) -> None:
        if self._random.random() < self._options.loss:
            return
        due = time.monotonic() + self._options.delay + self._random.uniform(0.0, self._options.jitter)
        heapq.heappush(self._waiting, (due, next(self._count), onwards, message))

    def _pass_on(self) -> None:
        while self._waiting and self._waiting[0][0] <= time.monotonic():
            *_, onwards, message = heapq.heappop(self._waiting)
            onwards.publish(message)


def main() -> int:
    """Relay until ended."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0)
    for name in ("loss", "delay", "jitter"):
        parser.add_argument(f"--{name}", type=float, default=0.0)
    options = parser.parse_args()
    # rclpy's own handlers take the context away from under the executor, which then ends in a traceback
    ending = Ending()
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("relay", start_parameter_services=False)
    _relay, executor = Relay(node, options), SingleThreadedExecutor()
    executor.add_node(node)
    while not ending.asked:
        executor.spin_once(timeout_sec=LONGEST_WAIT)
    executor.shutdown()
    node.destroy_node()
    rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
