"""The simulator node: a crane in a sea that publishes every input and is fed by the compensator."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from winch_friction.nodes.base import OK, WARN, Health, WinchNode
from winch_friction.nodes.inputs import ROS, clock_message, message_type
from winch_friction.nodes.options import NodeOptions
from winch_friction.nodes.parameters import OptionParameters
from winch_friction.nodes.qos import LATCHED, OUTPUT, fresh, overridable
from winch_friction.nodes.run import run
from winch_friction.nodes.voyage import Answers, Voyage, adjusted, hidden_effects
from winch_friction.online.consumer import HOLD_TIME, HeldTorque
from winch_friction.physics.errors import InputError, check, option
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.scaled import scaled_system
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.topics import stamp_header, stamp_time, whole_nanoseconds
from winch_friction.simulation.scenario import load_scenario

FEEDFORWARD = "compensator/friction_torque"
LONGEST_PAUSE = 0.05  # s; how often an answer that does not come is looked for
SHORTEST_PAUSE = 0.001  # s; two samples each: more than a plant with its messages manages, and no spinning in between
# scans between two messages of what changes slowly, as a PLC does it
SLOW_CHANNELS = {"hook_load": 5, "wire_out": 25, "wire_layer": 25, "oil_temperature": 50}
UNMEASURED = frozenset({"rope_force"})  # the simulated crane weighs its load at the hook
MOST_AT_ONCE = 2  # samples in a tick, to catch up
HELD_SCANS = 2.5  # scans that a torque is held at least: the answer to a scan comes during the next
SETTLE = 0.3  # s between the last subscriber's discovery and the first sample: both ends must know each other


@dataclass(frozen=True)
class SimulatorNodeOptions:
    """What only the simulator node can be told. Raises `InputError` for values out of range."""

    scenario: str = option("ahc_55t_215", doc="scenario file, or the name of a shipped scenario")
    legs: tuple[str, ...] = option((), doc="scenarios that follow it, one at each ~/reset, round and round")
    seed: int = option(1, lower=0, upper=2**31 - 1, doc="which sea, which sensor noise")
    friction_factor: float = option(
        1.3, lower=0.1, upper=3.0, doc="the plant's system friction as a multiple of the model file's"
    )
    hidden: tuple[str, ...] = option((), doc="hidden effects in the plant, as name or name=size")
    sensor_rate: float = option(0.0, lower=0.0, upper=500.0, unit="Hz", doc="rate of the inputs; 0: the scenario's")
    duration: float = option(0.0, lower=0.0, upper=36000.0, unit="s", doc="how long; 0: the scenario's")
    rate: float = option(1.0, lower=0.0, upper=1000.0, doc="simulated seconds per second; 0: as fast as answered")
    publish_clock: bool = option(True, doc="make the time: publish /clock")
    time_origin: float = option(1000.0, lower=0.0, upper=1e10, unit="s", doc="what /clock says at the start")
    lockstep: bool = option(False, doc="wait for the answers to each sample before the next")
    wait_for: tuple[str, ...] = option((FEEDFORWARD,), doc="topics whose answers are waited for")
    lockstep_timeout: float = option(1.0, lower=0.01, upper=60.0, unit="s", doc="longest wait for an answer")
    subscribers: int = option(0, lower=0, upper=100, doc="begin when every input has this many subscribers")
    repeat: bool = option(False, doc="begin the sea again when it is over")

    def __post_init__(self) -> None:
        check(self)
        if self.rate == 0.0 and not self.lockstep:
            raise InputError("rate 0 goes as fast as answers come: it needs lockstep; set lockstep, or a rate above 0")


class SimulatorNode(WinchNode):
    """Publishes a sample, takes the answer, advances the plant; begins when activated and again on `~/reset`.

    Sea, plant and lockstep are those of the parameters at the last `configure`: one process sails one scenario after
    the other.
    """

    executable, told_by = "simulator", (NodeOptions, SimulatorNodeOptions)

    def __init__(self, **node_arguments: Any) -> None:
        self._own = OptionParameters(SimulatorNodeOptions, fixed=("publish_clock",))
        super().__init__("simulator", self._own, **node_arguments)

    def build(self, crane: Crane, model: FrictionModel) -> None:
        """The crane at sea and what it publishes."""
        self.own = own = self._own.read(self)
        scenario = adjusted(load_scenario(own.scenario), own.sensor_rate, own.duration)
        truth = scaled_system(model, own.friction_factor)
        legs = [adjusted(load_scenario(each), own.sensor_rate, own.duration) for each in own.legs]
        self.voyage = Voyage(scenario, crane, truth, own.seed, hidden_effects(own.hidden), legs)
        self.topics = self.options.topics(crane)
        self.answers = Answers(own.wait_for if own.lockstep else ())
        self.held = HeldTorque(max(HOLD_TIME, HELD_SCANS / scenario.sensors.rate), largest=crane.absolute_torque_limit)
        self._inputs = {
            topic: self.publisher(message_type(each.type_name), topic, OUTPUT, qos_overriding_options=overridable())
            for topic, each in self.topics.inputs.items()
            if not UNMEASURED.issuperset(each.channels)
        }
        self._clock_out = self.publisher(Clock, "/clock", OUTPUT) if own.publish_clock else None
        self._truth = self.publisher(JointState, "~/truth", OUTPUT)
        self._progress = self.publisher(Float64, "~/progress", LATCHED)
        self.trigger("reset", self._begin)

    def start(self) -> None:
        """Listen to the answers and begin."""
        for topic in {FEEDFORWARD, *self.answers.topics}:
            self.while_active(self.create_subscription(JointState, topic, self._answer_taker(topic), fresh(OUTPUT)))
        scans = self.own.rate * self.voyage.scenario.sensors.rate  # per second; 0: the answers set the pace
        pause = max(SHORTEST_PAUSE, 1.0 / scans) if scans else LONGEST_PAUSE
        self._ticks = self.every(min(LONGEST_PAUSE, pause), self._tick)
        self._begin()

    def _begin(self) -> str:
        """The sea from its start; the time goes on."""
        if self.own.publish_clock:
            self.voyage.begin(self.own.time_origin)
        else:
            self.voyage.begin(self.ros_now(), gap=0.0)
        self.answers.clear()
        self.held.clear()
        self._said = 0.0
        self._running, self._ready_since = True, float("inf")
        self._started: float | None = None
        self._ticks.reset()
        return f"scenario '{self.voyage.scenario.name}' from its start"

    # -- pace
    def _tick(self) -> None:
        """Advance as far as pace and answers allow."""
        if not self._running or not self._all_there():
            return
        if self._started is None:
            self._set_pace()
            self._publish(self.voyage.sample)
        self._go_on()

    def _set_pace(self) -> None:
        """From here on by the rate as it is now."""
        self._started = self._steady() - self.voyage.elapsed / (self.own.rate or 1.0)

    def _go_on(self) -> None:
        """In lockstep one sample; else what is due, but no burst after a pause: sensors do not do that either."""
        for _ in range(1 if self.answers.topics else MOST_AT_ONCE):
            if not (self._running and self._due() and self._answered()):
                return
            self._advance()

    def _due(self) -> bool:
        if self._started is None:
            return False
        return self.own.rate == 0.0 or self.voyage.elapsed <= (self._steady() - self._started) * self.own.rate

    def _answered(self) -> bool:
        return self.answers.complete or self.answers.overdue(self._steady(), self.own.lockstep_timeout)

    def _all_there(self) -> bool:
        """Whether all subscribers have been there for a moment."""
        if self._started is not None:
            return True
        there = all(each.get_subscription_count() >= self.own.subscribers for each in self._inputs.values())
        self._ready_since = min(self._ready_since, self._steady()) if there else float("inf")
        return self._steady() - self._ready_since >= (SETTLE if self.own.subscribers else 0.0)

    def _advance(self) -> None:
        if self.voyage.finished:
            self._end()
            return
        if self.voyage.advance(self.held.value(self._age_clock())):
            self._publish(self.voyage.sample)

    def _end(self) -> None:
        self._running = False
        self._ticks.cancel()  # a simulator that has nothing to do costs nothing
        self._progress.publish(Float64(data=1.0))
        if self.own.repeat:
            self._begin()

    # -- messages
    def _answer_taker(self, topic: str) -> Any:
        def take(message: JointState) -> None:
            if topic == FEEDFORWARD and len(message.effort):
                self.held.take(float(message.effort[0]), self._age_clock(), message.header.frame_id)
            self.answers.take(topic, stamp_time(message))
            if self.answers.topics and self.answers.complete:
                self._go_on()

        return self.guarded(take)

    def _age_clock(self) -> float:
        """s by which the feedforward ages: in lockstep the sea waits for it, so the sea's own time counts."""
        return self.voyage.elapsed if self.answers.topics else self._steady()

    def _publish(self, sample: Sample) -> None:
        """The clock first, the truth, then the inputs with the speed last."""
        if self._clock_out:
            self._clock_out.publish(clock_message(self.voyage.now))
        self._publish_truth()
        for topic, message in self.topics.encode(self._due_channels(sample), ROS):
            if topic in self._inputs:
                self._inputs[topic].publish(message)
        if sample.motor_speed == sample.motor_speed:
            self.answers.expect(whole_nanoseconds(sample.time), self._steady())

    def _due_channels(self, sample: Sample) -> Sample:
        """The sample without the slow channels between their own, slower scans."""
        fresh = self.voyage.samples
        rested = {name: math.nan for name, every in SLOW_CHANNELS.items() if fresh % every}
        return replace(sample, **rested)  # type: ignore[arg-type]

    def _publish_truth(self) -> None:
        """Joint `winch_motor`: speed and friction torque; joint `load`: its position error and the heave's speed."""
        truth = self.voyage.truth()
        self._truth.publish(
            JointState(
                header=stamp_header(self.voyage.now, ROS),
                name=["winch_motor", "load"],
                position=[truth["shaft_angle"], truth["position_error"]],
                velocity=[truth["motor_speed"], truth["heave_velocity"]],
                effort=[truth["friction_torque"], truth["friction_feedforward"]],
            )
        )
        if self.voyage.progress >= self._said + 0.01 or self.voyage.progress < self._said:
            self._said = self.voyage.progress
            self._progress.publish(Float64(data=min(self._said, 0.999)))

    def _steady(self) -> float:
        return float(self.steady_clock.now().nanoseconds * 1e-9)

    # -- health
    def apply_settings(self) -> None:
        """Take over pace and patience."""
        if hasattr(self, "voyage"):
            self.own = self._own.read(self)
        if getattr(self, "_started", None) is not None:
            self._set_pace()

    def health(self) -> Sequence[Health]:
        """How far the voyage is and how often an answer did not come."""
        values = {"progress": self.voyage.progress, "time": self.voyage.now, "samples": self.voyage.samples}
        values["unanswered"] = self.answers.unanswered
        level = WARN if self.answers.unanswered else OK
        return [Health("sea", level, "at sea" if self._running else "over", values)]


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of the executable `simulator`."""
    return run(SimulatorNode, arguments)


if __name__ == "__main__":
    sys.exit(main())
