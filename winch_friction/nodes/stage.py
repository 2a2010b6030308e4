"""The demo's stage: sends the compensator through the phases of one sea, records everything, reports as JSON lines.

Started by `winch-friction demo`; reads a plan (JSON) and writes a bag. The plan: bag, crane, groups, and phases, each
with a name, the compensator's parameters and whether it is enabled.
"""

import json
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64

from winch_friction.nodes.qos import LATCHED
from winch_friction.nodes.recorder import Recorder, winch_topics
from winch_friction.nodes.remote import PATIENCE, RemoteNode
from winch_friction.physics.errors import InputError
from winch_friction.records.bag_write import BagWriter
from winch_friction.records.crane_file import load_crane
from winch_friction.records.topics import crane_topics

GATHER = 0.05  # s
SPEAKERS = ("compensator/friction_torque", "estimator/friction_torque", "friction_model", "simulator/truth")
LAST_MESSAGES = 1.0  # s that stragglers get after the last sample


class Stage:
    """Conducts the phases over services; every message goes into the bag."""

    def __init__(self, plan: Mapping[str, Any], writer: BagWriter) -> None:
        self._node = Node("stage")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self._node)
        topics = crane_topics(load_crane(plan["crane"]), plan["groups"])
        self.recorder = Recorder(self._node, writer, winch_topics(topics))
        self._progress = 0.0
        self._node.create_subscription(Float64, "simulator/progress", self._on_progress, LATCHED)
        names = ("compensator", "estimator", "simulator")
        self._compensator, self._estimator, self._simulator = (
            RemoteNode(self._node, self._executor, name) for name in names
        )
        self._phases = plan["phases"]

    def play(self) -> None:
        """All phases, one after the other, on the same sea."""
        say(event="waiting", nodes=["compensator", "estimator", "simulator"])
        self._simulator.change("configure")
        for number, phase in enumerate(self._phases):
            self._prepare(phase)
            self._wait_until_heard()
            self._progress = 0.0
            say(event="phase", name=phase["name"])
            if number == 0:
                self._simulator.change("activate")
            else:
                self._simulator.trigger("reset")
            self._watch(phase["name"])
        self._listen(LAST_MESSAGES)
        self.recorder.finish()
        self._estimator.change("deactivate")
        say(event="recorded", messages=dict(self.recorder.counts))

    def _prepare(self, phase: Mapping[str, Any]) -> None:
        """A fresh compensator with the phase's seed, settings and switch."""
        if self._compensator.state() == "active":
            self._compensator.change("deactivate")
        if self._compensator.state() == "inactive":
            self._compensator.change("cleanup")
        self._compensator.set(phase["parameters"])
        self._compensator.change("configure", "activate")
        self._compensator.switch("enable", bool(phase["enabled"]))

    def _wait_until_heard(self) -> None:
        """A recording begins when everyone who will speak is heard."""
        deadline = time.monotonic() + PATIENCE
        while not self.recorder.hears(*SPEAKERS):
            if time.monotonic() > deadline:
                raise InputError(f"not heard within {PATIENCE:g} s: one of {', '.join(SPEAKERS)}")
            self._turn()

    def _watch(self, name: str) -> None:
        said = 0.0
        while self._progress < 1.0:
            self._turn()
            if self._progress >= said + 0.01:
                said = self._progress
                say(event="progress", name=name, value=said)

    def _listen(self, duration: float) -> None:
        deadline = time.monotonic() + duration
        while time.monotonic() < deadline:
            self._turn()

    def _turn(self) -> None:
        """Let the messages gather, then take them all: waking at each would cost more than writing it."""
        time.sleep(GATHER)
        self.recorder.collect()
        self._executor.spin_once(timeout_sec=0.0)

    def _on_progress(self, message: Float64) -> None:
        self._progress = message.data


def say(**content: Any) -> None:
    """One line of JSON for whoever started the stage."""
    print(json.dumps(content), flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """`python -m winch_friction.nodes.stage PLAN.json`."""
    path = Path((arguments or sys.argv[1:])[0])
    plan = json.loads(path.read_text(encoding="utf-8"))
    rclpy.init(args=[])
    try:
        with BagWriter(plan["bag"], metadata={"demo": path.name, "phases": plan["phases"]}) as writer:
            Stage(plan, writer).play()
    except InputError as error:
        say(event="error", message=str(error))
        return 2
    except (KeyboardInterrupt, ExternalShutdownException):
        return 130
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
