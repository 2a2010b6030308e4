"""The compensator node over DDS beside a relay on the same subscriptions that only copies, at 50 to 500 Hz.

Both run as processes of their own; every input of the crane is sent at the rate, a few seconds to the one, then to the
other, in turn. A round trip lasts from the sending of a speed to the arrival of its answer.
"""

import importlib.util
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
from winch_friction.records.domain import unused_domain

RATES = (50, 100, 200, 500)  # Hz
TURNS, TURN = 3, 4.0  # turns of s for each
STARTING = 60.0  # s
SETTLING = 0.5  # s after the last speed, for its answer
NODES = {"compensator": "winch_friction.nodes.compensator", "relay": "bench.relay"}
NOTE = "sender and receiver are one Python process, and what it takes is in both round trips"


class Driver:
    """Sends samples into the namespace of a node and takes its answers."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.node import Node
        from rclpy.signals import SignalHandlerOptions
        from sensor_msgs.msg import JointState

        from winch_friction.nodes.inputs import Polled, message_type
        from winch_friction.nodes.qos import OUTPUT, SENSOR, fresh
        from winch_friction.records.crane_file import load_crane
        from winch_friction.records.topics import crane_topics

        rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        self._node, polled = Node("driver"), Polled()
        self.topics = crane_topics(load_crane("crane_150t"))
        self._out = {
            (name, topic): self._node.create_publisher(
                message_type(each.type_name), f"/{name}_bench/{topic}", fresh(OUTPUT)
            )
            for name in NODES
            for topic, each in self.topics.inputs.items()
        }
        self._in = {
            name: self._node.create_subscription(
                JointState, f"/{name}_bench/{name}/friction_torque", print, fresh(SENSOR), callback_group=polled
            )
            for name in NODES
        }

    def close(self) -> None:
        """Leave the graph."""
        import rclpy

        self._node.destroy_node()
        rclpy.try_shutdown()

    def wait(self) -> None:
        """Until both nodes hear every input and answer to us."""
        deadline = time.monotonic() + STARTING
        while not self._connected():
            if time.monotonic() > deadline:
                raise RuntimeError(f"after {STARTING:g} s not both of {', '.join(NODES)} had subscribed")
            time.sleep(0.2)

    def _connected(self) -> bool:
        heard = all(publisher.get_subscription_count() for publisher in self._out.values())
        return heard and all(self._node.count_publishers(each.topic_name) for each in self._in.values())

    def turn(self, name: str, samples: list[Any], rate: float, duration: float) -> tuple[list[float], int]:
        """Round trips in s of so many seconds, and how many speeds had no answer."""
        from winch_friction.nodes.inputs import ROS, drain

        sent: dict[tuple[int, int], int] = {}
        trips: list[float] = []

        def take() -> None:
            for message, info in drain(self._in[name]):
                began = sent.pop((message.header.stamp.sec, message.header.stamp.nanosec), None)
                if began is not None:
                    trips.append((info["received_timestamp"] - began) * 1e-9)

        pace = Pace(rate)
        for number in range(int(duration * rate)):
            due = pace.next()
            while (wait := due - time.time()) > 0.0:
                time.sleep(min(wait, 0.001))
                take()
            sample = samples[number % len(samples)]
            sample.time = due
            messages = dict(self.topics.encode(sample, ROS))
            speed = messages.pop(self.topics.speed_topic)
            for topic, message in messages.items():
                self._out[name, topic].publish(message)
            sent[speed.header.stamp.sec, speed.header.stamp.nanosec] = time.time_ns()
            self._out[name, self.topics.speed_topic].publish(speed)
        end = time.time() + SETTLING
        while sent and time.time() < end:
            time.sleep(0.005)
            take()
        return trips, len(sent)


def measure(smoke: bool = False) -> list[Row]:
    """Median and 99th percentile of the round trip, and processor time per speed, each with its ratio to the relay."""
    if importlib.util.find_spec("rclpy") is None:
        raise InputError("the benchmark dds needs rclpy, which is not installed: pip install '.[ros]'")
    os.environ |= {
        "ROS_DOMAIN_ID": str(unused_domain()), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1",
    }  # fmt: skip
    there = sea(20.0)[3]
    samples = [*there, *reversed(there)]  # over and over: a speed that jumps is refused
    root = Path(__file__).resolve().parents[1]
    processes = {
        name: subprocess.Popen(
            [sys.executable, "-m", module, "--ros-args", "-r", f"__ns:=/{name}_bench"], cwd=root,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )
        for name, module in NODES.items()
    }  # fmt: skip
    driver = Driver()
    try:
        driver.wait()
        driver.turn("compensator", samples, 50.0, 1.0), driver.turn("relay", samples, 50.0, 1.0)
        rates, turns, duration = ((50,), 1, 0.5) if smoke else (RATES, TURNS, TURN)
        return [row for rate in rates for row in _rows(driver, processes, samples, rate, turns, duration)]
    finally:
        driver.close()
        end(list(processes.values()))


def _rows(driver: Driver, processes: dict[str, Any], samples: list[Any], rate: int, turns: int, duration: float
) -> list[Row]:  # fmt: skip
    found: dict[str, list[tuple[float, float, float]]] = {name: [] for name in NODES}
    lost = dict.fromkeys(NODES, 0)
    for _ in range(turns):
        for name, process in processes.items():
            before = _cpu_seconds(process.pid)
            trips, missing = driver.turn(name, samples, rate, duration)
            cpu = (_cpu_seconds(process.pid) - before) / (len(trips) + missing)
            found[name].append((*(1e3 * q for q in np.percentile(trips, [50, 99])), 1e6 * cpu))
            lost[name] += missing
    rows = []
    for place, (what, unit, goal) in enumerate((("p50", "ms", 1.1), ("p99", "ms", 1.1), ("CPU per speed", "us", 1.2))):
        ours, theirs = ([each[place] for each in found[name]] for name in ("compensator", "relay"))
        ratios = sorted(a / max(b, 1e-9) for a, b in zip(ours, theirs, strict=True))
        against = f"a relay that only copies ({lost['compensator']} and {lost['relay']} without an answer)"
        rows.append(
            Row(
                f"DDS at {rate} Hz: {what}", median(ours), unit, against, median(theirs), median(ratios),
                (ratios[0], ratios[-1]), at_most=goal, note=NOTE if place == 0 and rate == RATES[0] else "",
            )
        )  # fmt: skip
    return rows


def _cpu_seconds(pid: int) -> float:
    """User and system time of a process, from the scheduler: /proc's ticks of 10 ms are too coarse."""
    return sum(float(task.read_text().split()[0]) for task in Path(f"/proc/{pid}/task").glob("*/schedstat")) * 1e-9
