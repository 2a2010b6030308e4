"""The compensator node: inputs in, friction feedforward out."""

import math
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import String

from winch_friction.compensation import CompensatorConfig, Feedforward
from winch_friction.compensation.config import check_on_crane
from winch_friction.nodes.base import ERROR, OK, WARN, Health, WinchNode
from winch_friction.nodes.beside import Beside, read_terms
from winch_friction.nodes.inputs import ROS, Inputs, pressure_message
from winch_friction.nodes.options import NodeOptions
from winch_friction.nodes.parameters import OptionParameters
from winch_friction.nodes.qos import LATCHED, OUTPUT, fresh, overridable
from winch_friction.nodes.rates import InputHealth
from winch_friction.nodes.run import run
from winch_friction.online.compensator import CompensatorService, mark
from winch_friction.online.inputs import ServiceOptions
from winch_friction.online.intake import ModelIntake
from winch_friction.online.readiness import ANSWERING, make_ready
from winch_friction.physics.errors import InputError, check, option
from winch_friction.physics.friction import FrictionModel, registered_terms
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.model_file import load_model
from winch_friction.records.topics import joint_state, stamp_header

STANDS_STILL = 1.0  # s without a new time of the watchdog's clock; the slowest recording's clock goes at some Hz
LONGEST_WATCH = 0.1  # s between two looks of the watchdog where the time-out is long


@dataclass(frozen=True)
class CompensatorNodeOptions:
    """What only the compensator node can be told. Raises `InputError` for values out of range."""

    starts_enabled: bool = option(
        True, doc="feed forward from the process's start on; false: not before ~/enable, however often it is restarted"
    )
    follow_model_topic: bool = option(True, doc="take over the models that arrive on friction_model")
    model_delay: float = option(
        0.5, lower=0.0, upper=60.0, unit="s", doc="a learned model takes effect this long after its last measurement"
    )

    def __post_init__(self) -> None:
        check(self)


class CompensatorNode(WinchNode):
    """Publishes `~/friction_torque` and `~/pressure_feedforward` at every speed message."""

    executable, told_by = "compensator", (NodeOptions, CompensatorNodeOptions, CompensatorConfig)

    def __init__(self, **node_arguments: Any) -> None:
        fixed = (
            "pressure_group",
            "min_displacement",
            "pressure_limit",
        )  # they change the pressure at once, which no ramp bounds
        self._config = OptionParameters(CompensatorConfig, fixed=fixed, keys=_a_gain_for_every_term)
        self._own = OptionParameters(CompensatorNodeOptions, fixed=("starts_enabled",))
        self._files: Beside[FrictionModel] = Beside()
        self._moved = math.nan, math.inf  # the watchdog's clock when it moved last, and the steady one then, s
        self._said = ""  # why a learned model was refused, by the log
        self._models: Any = None  # the subscription of learned models, while active
        super().__init__("compensator", self._config, self._own, **node_arguments)
        # whoever switched it off has to switch it on, whatever transitions come between
        self._wanted = self._own.read(self).starts_enabled

    def build(self, crane: Crane, model: FrictionModel) -> None:
        """The feedforward law on its seed, its outputs and its switches."""
        self.own, config = self._own.read(self), self._config.read(self)
        topics = self.options.topics(crane)
        _check_pressure_group(config.pressure_group, topics.groups)
        make_ready(model, crane, len(topics.groups), ANSWERING)  # now, not while the first sample waits
        self.service = CompensatorService(crane, model, topics, config, self._service_options(), since=self.ros_now())
        self.service.set_enabled(self._wanted)
        groups = f", groups {', '.join(topics.groups)}" if crane.drive.hydraulic else ""
        self.get_logger().info(f"crane '{crane.name}' ({crane.drive.kind}), model '{model.name}'{groups}")
        if past := self.service.law.status()["past_corrections"]:
            self.get_logger().warning(f"model '{model.name}': over, and not taken out: {past}")
        if withheld := self.service.law.status()["withheld"]:
            self.get_logger().warning(str(withheld))
        if hazard := self.service.options.hazard(bool(self.get_parameter("use_sim_time").value)):
            self.get_logger().warning(hazard)
        self.models = ModelIntake(self._make_ready, self.service.options.paced, self.steady_now)
        self.inputs = Inputs(self, self.service, self._answer, self._latest(config))
        patience = self.options.watchdog_timeout
        self._input_health = InputHealth(self.service.inputs, self.inputs, self._needed, self.service_now, patience)
        self._torque = self.publisher(JointState, "~/friction_torque", OUTPUT, qos_overriding_options=overridable())
        self._pressure = self.publisher(
            FluidPressure, "~/pressure_feedforward", OUTPUT, qos_overriding_options=overridable()
        )
        self.switch("enable", self._enable)
        self.trigger("reset", self._reset)
        self.trigger("load_model", self._load_model)

    def _service_options(self) -> ServiceOptions:
        return ServiceOptions(self.options.watchdog_timeout, self.options.stamp_window, self.own.model_delay)

    def _latest(self, config: CompensatorConfig) -> float:
        return config.max_age if self._service_options().paced else math.inf

    def start(self) -> None:
        """Let the inputs and the models in, watch over both."""
        self.inputs.open()
        self._models = self.create_subscription(
            String, "friction_model", self.guarded(self._on_model), fresh(LATCHED), qos_overriding_options=overridable()
        )
        self.while_active(self._models)
        share = 0.2 * self.options.watchdog_timeout
        self._watchdog = self.every(min(max(self.service.options.watch_period, share), LONGEST_WATCH), self._watch)

    def stop(self) -> None:
        """Shut the inputs out and publish the ramp to zero."""
        self.inputs.close()
        self._models = None
        began = time.monotonic()
        for after, feedforward in self.service.ending(self.service_now()):
            time.sleep(max(0.0, began + after - time.monotonic()))
            self._publish(feedforward)

    def forget(self) -> None:
        """Start anew: nothing held, nothing remembered, the model kept."""
        if hasattr(self, "service"):
            self.service.reset()

    # -- callbacks
    def _on_model(self, message: String) -> None:
        if self.own.follow_model_topic:
            self.models.offer(message.data)
            self._take_models()

    def _answer(self, feedforward: Feedforward) -> None:
        """To a believed speed; the watchdog's period begins anew, so that it wakes the node only where none comes."""
        self._publish(feedforward)
        self._watchdog.reset()
        if self.models.waiting or self.service.refused_models:
            self._take_models()

    def _watch(self) -> None:
        self._take_models()
        said = self.service.tick(self.service_now())
        if said is not None:
            self.inputs.poll()
            self._publish(said)

    def _take_models(self) -> None:
        taken = self.models.take()  # read before they were no longer wanted, perhaps
        for each in taken if self.own.follow_model_topic else ():
            if isinstance(each, InputError):
                self.service.refuse(str(each))
            else:
                self.service.offer(each)
        while self.service.refused_models:
            self._refused(self.service.refused_models.pop())

    # -- services
    def _enable(self, wanted: bool) -> str:
        self._wanted = wanted
        self.service.set_enabled(wanted)
        return f"feedforward {'enabled' if wanted else 'disabled'}"

    def _reset(self) -> str:
        self.forget()
        return "feedforward starts anew"

    def _load_model(self) -> str:
        """The files are read, and the terms made ready, beside the control; the inputs go on meanwhile."""
        model = self._files.get(self._read_model, self.guarded(self._go_on), self.told_to_end)
        self.load_terms()  # read by now: what can be set for them is declared
        apart = self.service.load_model(model)
        learned = self.own.follow_model_topic and self._models is not None and self._models.get_publisher_count()
        until = "; what an estimator learns of its terms replaces it (follow_model_topic)" if learned else ""
        return f"model '{model.name}' in use{apart and f'; {apart}'}{until}"

    def _read_model(self) -> FrictionModel:
        read_terms(self.options.terms_file)
        model = load_model(self.options.model_file)
        self._make_ready(model)
        return model

    def _make_ready(self, model: FrictionModel) -> None:
        make_ready(model, self.crane, len(self.service.inputs.topics.groups), ANSWERING)

    def _go_on(self) -> None:
        self.inputs.work()
        self._watch()

    # -- outputs
    def _refused(self, reason: str) -> None:
        """Said once: an estimator that goes on publishes it every few seconds, and the diagnostics hold it."""
        if reason == self._said:
            return
        self._said = reason
        self.get_logger().warning(f"model refused, '{self.service.law.model.name}' kept: {reason}")

    def _publish(self, feedforward: Feedforward) -> None:
        """Stamped as the measurement that it was computed from; validity and number in the frame's name."""
        header = stamp_header(feedforward.time, ROS, mark(feedforward.valid, feedforward.sequence))
        torque, speed = feedforward.friction_torque, feedforward.speed
        self._torque.publish(joint_state(ROS, header, "winch_motor", velocity=speed, effort=torque))
        if self.crane.drive.hydraulic and feedforward.pressure == feedforward.pressure:
            self._pressure.publish(pressure_message(feedforward.time, feedforward.pressure, header.frame_id))

    # -- settings and health
    def check_settings(self, changes: Mapping[str, Any]) -> None:
        """Refuse what the output could not follow as well, before the parameter says that it is so."""
        super().check_settings(changes)
        if hasattr(self, "service"):
            config = self._config.read(self, changes)
            check_on_crane(config, self.service.law.ranges.load)
            self.service.law.output.check_slew(config.slew_limit)

    def apply_settings(self) -> None:
        """Take over changed settings without a bump."""
        if hasattr(self, "service"):
            self.own, config = self._own.read(self), self._config.read(self)
            self.service.configure(config, self._service_options())
            self.inputs.latest = self._latest(config)
            if not self.own.follow_model_topic:
                self.service.schedule.clear()

    def _needed(self) -> set[str]:
        """The topics without which nothing is fed forward."""
        topics, config = self.service.inputs.topics, self.service.law.config
        channels = {"speed_reference"} if config.velocity_source == "reference" else set()
        if self.crane.drive.hydraulic:
            channels |= {f"{g}.{c}" for g in topics.groups for c in ("pressure_a", "pressure_b", "displacement")}
        own = {topic for topic, source in topics.inputs.items() if channels & set(source.channels)}
        return {topics.speed_topic, *own}

    def urgent(self) -> object:
        """Whether anything is fed forward, and what is not there for it."""
        status = self.service.status(self.service_now())
        at_work = status["state"] in ("active", "fading", "disabled")
        return at_work, status["contradictions"], self._input_health.silent(), self._clock_stands()

    def _clock_stands(self) -> bool:
        """Whether the watchdog's clock has stopped: then nothing falls silent, and the torque stays where it is."""
        now, steady = self.service_now(), self.steady_now()
        if now != self._moved[0]:
            self._moved = now, steady
        return steady - self._moved[1] > STANDS_STILL

    def health(self) -> Sequence[Health]:
        """The feedforward's state and the inputs' rates and ages."""
        now = self.service_now()
        status = self.service.status(now)
        state = str(status["state"])
        never = state == "waiting" and now - self._activated > self.options.diagnostics_period
        level = ERROR if state == "stale" or never else {"waiting": WARN}.get(state, OK)
        why = status["contradictions"] or (status["missing"] if state in ("stale", "waiting") else "")
        said = f"{state}: {why}" if why else state
        if refusal := status["learned_model_refused"]:
            level, said = max(level, WARN), f"{said}; learned model refused: {refusal}"
        for warning in self.service.warnings(now):
            level, said = max(level, WARN), f"{said}; {warning}"
        if self._clock_stands():
            level, said = (
                max(level, WARN),
                f"{said}; /clock stands still: until it goes on the torque stays (watchdog_clock: ros)",
            )
        feedforward = Health("feedforward", level, said, status)
        return [self.alone(feedforward, self._torque), self._input_health.report()]


def _a_gain_for_every_term() -> dict[str, dict[str, float]]:
    return {"gains": dict.fromkeys(sorted(registered_terms()), 1.0)}


def _check_pressure_group(name: str, groups: Sequence[str]) -> None:
    """One that is not there would carry 0 Pa for ever, and say that it is valid."""
    if len(groups) > 1 and name not in groups:
        raise InputError(f"compensator: parameter 'pressure_group' must be one of {', '.join(groups)}, found {name!r}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of the executable `compensator`."""
    return run(CompensatorNode, arguments)


if __name__ == "__main__":
    sys.exit(main())
