"""The compensator node: inputs in, friction feedforward out."""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import String

from winch_friction.compensation import CompensatorConfig, Feedforward, FeedforwardCompensator
from winch_friction.compensation.model_schedule import ModelSchedule
from winch_friction.nodes.base import ERROR, OK, WARN, Health, WinchNode
from winch_friction.nodes.inputs import Inputs
from winch_friction.nodes.messages import ROS, pressure_message
from winch_friction.nodes.parameters import OptionParameters
from winch_friction.nodes.qos import LATCHED, OUTPUT, overridable
from winch_friction.nodes.rates import InputHealth
from winch_friction.nodes.run import run
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel, registered_terms
from winch_friction.physics.hold import InputHold
from winch_friction.physics.options import check, option
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.model_file import load_model, model_from_text
from winch_friction.records.topics import joint_state, stamp_header

WATCHDOG_SHARE, LONGEST_WATCH = 0.2, 0.5  # of the timeout, s


@dataclass(frozen=True)
class CompensatorNodeOptions:
    """What only the compensator node can be told. Raises `InputError` for values out of range."""

    follow_model_topic: bool = option(True, doc="take over the models that arrive on friction_model")
    model_delay: float = option(
        0.5, lower=0.0, upper=60.0, unit="s", doc="a learned model takes effect this long after its last measurement"
    )

    def __post_init__(self) -> None:
        check(self)


class CompensatorNode(WinchNode):
    """Publishes `~/friction_torque` and `~/pressure_feedforward` at every speed message."""

    def __init__(self, **node_arguments: Any) -> None:
        self._config = OptionParameters(CompensatorConfig, keys=_a_gain_for_every_term)
        self._own = OptionParameters(CompensatorNodeOptions)
        super().__init__("compensator", self._config, self._own, **node_arguments)

    def build(self, crane: Crane, model: FrictionModel) -> None:
        """The feedforward law on its seed, its outputs and its switches."""
        self.own, config = self._own.read(self), self._config.read(self)
        model.compile(len(self.options.topics(crane).groups))  # now, not while the first sample waits
        self.law = FeedforwardCompensator(crane, model, config)
        self.schedule = ModelSchedule(self.own.model_delay)
        hold = InputHold(self.options.topics(crane).groups, config.max_age, dict(config.max_ages))
        self.inputs = Inputs(self, self.options.topics(crane), hold, self._on_sample, self.forget)
        self._input_health = InputHealth(self.inputs, self.ros_now)
        self._torque = self.publisher(JointState, "~/friction_torque", OUTPUT, qos_overriding_options=overridable())
        self._pressure = self.publisher(FluidPressure, "~/pressure_feedforward", OUTPUT)
        self.switch("enable", self._enable)
        self.trigger("reset", self._reset)
        self.trigger("load_model", self._load_model)

    def start(self) -> None:
        """Let the inputs and the models in, watch over both."""
        self.inputs.open()
        models = self.create_subscription(
            String, "friction_model", self._on_model, LATCHED, qos_overriding_options=overridable()
        )
        self.while_active(models)
        self.every(min(WATCHDOG_SHARE * self.options.watchdog_timeout, LONGEST_WATCH), self._watch)

    def stop(self) -> None:
        """Shut the inputs out."""
        self.inputs.close()

    def forget(self) -> None:
        """Start anew: nothing held, nothing remembered, the model kept."""
        if hasattr(self, "law"):
            self.inputs.forget()
            self.schedule.clear()
            self.law.reset()

    # -- callbacks
    def _on_sample(self, sample: Sample) -> None:
        self._take_over(self.schedule.due(sample.time))
        self._publish(self.law.step(sample), sample.time)

    def _on_model(self, message: String) -> None:
        if not self.own.follow_model_topic:
            return
        try:
            self.schedule.offer(model_from_text(message.data, "friction_model"))
        except InputError as error:
            self._refused(error)

    def _watch(self) -> None:
        silence = self.inputs.silence() - self.options.watchdog_timeout
        if silence > 0.0 and self.inputs.last_stamp > float("-inf"):
            stamp = self.inputs.last_stamp
            remaining = self.law.expire(stamp + self.law.config.max_age + silence)
            if remaining is not None:
                self._publish(remaining, stamp)

    # -- services
    def _enable(self, wanted: bool) -> str:
        self.law.set_enabled(wanted)
        return f"feedforward {'enabled' if wanted else 'disabled'}"

    def _reset(self) -> str:
        self.forget()
        return "feedforward starts anew"

    def _load_model(self) -> str:
        self.load_terms()
        model = load_model(self.options.model_file)
        self.law.load_model(model)
        return f"model '{model.name}' in use"

    # -- models and outputs
    def _take_over(self, model: FrictionModel | None) -> None:
        if model is None:
            return
        try:
            self.law.load_model(model)
        except InputError as error:
            self._refused(error)

    def _refused(self, error: InputError) -> None:
        self.get_logger().warning(f"model refused, '{self.law.model.name}' kept: {error}")

    def _publish(self, feedforward: Feedforward, stamp: float) -> None:
        """Stamped as the measurement that it was computed from."""
        header = stamp_header(stamp, ROS)
        torque, speed = feedforward.friction_torque, feedforward.speed
        self._torque.publish(joint_state(ROS, header, "winch_motor", velocity=speed, effort=torque))
        if self.crane.drive.hydraulic and feedforward.pressure == feedforward.pressure:
            self._pressure.publish(pressure_message(stamp, feedforward.pressure))

    # -- settings and health
    def check_settings(self, changes: Mapping[str, Any]) -> None:
        """Also what only fits together, such as velocity source and drive."""
        super().check_settings(changes)

    def apply_settings(self) -> None:
        """Take over changed settings without a bump."""
        if hasattr(self, "law"):
            self.own = self._own.read(self)
            self.schedule.delay = self.own.model_delay
            self.law.configure(self._config.read(self))

    def health(self) -> Sequence[Health]:
        """The feedforward's state and the inputs' rates and ages."""
        status = dict(self.law.status())
        state = "stale" if self.inputs.silence() > self.options.watchdog_timeout else str(status["state"])
        status["state"] = state
        level = {"waiting": WARN, "stale": ERROR}.get(state, OK)
        return [Health("feedforward", level, state, status), self._input_health.report()]


def _a_gain_for_every_term() -> dict[str, dict[str, float]]:
    return {"gains": dict.fromkeys(sorted(registered_terms()), 1.0)}


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of the executable `compensator`."""
    return run(CompensatorNode, arguments)


if __name__ == "__main__":
    sys.exit(main())
