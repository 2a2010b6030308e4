"""The estimator node: inputs in, the learned friction model out, latched."""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sensor_msgs.msg import JointState
from std_msgs.msg import String

from winch_friction.compensation.config import OLDEST_INPUT
from winch_friction.estimation import Estimate, EstimatorConfig
from winch_friction.nodes.base import ERROR, OK, URGENT_PERIOD, WARN, Health, WinchNode
from winch_friction.nodes.inputs import ROS, Inputs
from winch_friction.nodes.options import NodeOptions
from winch_friction.nodes.parameters import OptionParameters
from winch_friction.nodes.qos import LATCHED, OUTPUT, overridable
from winch_friction.nodes.rates import InputHealth
from winch_friction.nodes.run import run
from winch_friction.online.compensator import mark
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inputs import ServiceOptions
from winch_friction.online.readiness import LEARNING, make_ready
from winch_friction.physics.errors import InputError, check, option
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.checkpoint import file_there, read_checkpoint, set_aside, write_checkpoint
from winch_friction.records.model_file import model_to_text
from winch_friction.records.topics import joint_state, stamp_header


@dataclass(frozen=True)
class EstimatorNodeOptions:
    """What only the estimator node can be told. Raises `InputError` for values out of range."""

    model_period: float = option(
        5.0, lower=1.0, upper=3600.0, unit="s", doc="time between models on friction_model, in the inputs' time"
    )
    checkpoint: str = option("", doc="file that keeps what was learned; empty: nothing is kept")
    checkpoint_period: float = option(
        60.0, lower=1.0, upper=86400.0, unit="s", doc="time between checkpoints, besides the one at the end"
    )
    max_age: float = option(
        0.1, lower=0.001, upper=OLDEST_INPUT, unit="s", doc="age beyond which an input counts as lost"
    )

    def __post_init__(self) -> None:
        check(self)


class EstimatorNode(WinchNode):
    """Learns at every speed message; publishes `friction_model` and `~/friction_torque`."""

    executable, told_by = "estimator", (NodeOptions, EstimatorNodeOptions, EstimatorConfig)

    def __init__(self, **node_arguments: Any) -> None:
        self._config = OptionParameters(EstimatorConfig, fixed=EstimatorConfig.__dataclass_fields__)
        self._own = OptionParameters(EstimatorNodeOptions, fixed=("checkpoint",))
        self._unkept = ""  # why the last checkpoint was not written
        self._kept: tuple[int, int] | None = None  # the file that this estimator has read or written
        self._wanted = True  # whoever switched it off has to switch it on, whatever transitions come between
        super().__init__("estimator", self._config, self._own, **node_arguments)

    def build(self, crane: Crane, model: FrictionModel) -> None:
        """The filter on its seed, what an earlier run left, and the outputs."""
        self.own = self._own.read(self)
        topics = self.options.topics(crane)
        make_ready(model, crane, len(topics.groups), LEARNING)  # now, not while the second sample waits
        options = ServiceOptions(self.options.watchdog_timeout, self.options.stamp_window)
        periods = {"model_period": self.own.model_period, "max_age": self.own.max_age, "since": self.ros_now()}
        self.service = EstimatorService(crane, model, topics, self._config.read(self), options, **periods)
        self.law = self.service.law
        self.get_logger().info(f"crane '{crane.name}' ({crane.drive.kind}), seed '{model.name}'")
        self._restore()
        self.service.set_enabled(self._wanted)
        self.inputs = Inputs(self, self.service, self._answer)
        patience = self.options.watchdog_timeout
        self._input_health = InputHealth(self.service.inputs, self.inputs, self._needed, self.service_now, patience)
        self._model = self.publisher(String, "friction_model", LATCHED, qos_overriding_options=overridable())
        self._torque = self.publisher(JointState, "~/friction_torque", OUTPUT, qos_overriding_options=overridable())
        self._answers = 0
        self.switch("enable", self._enable)
        self.trigger("reset", self._reset)
        self.trigger("save", self._save)

    def start(self) -> None:
        """Let the inputs in; whether anything can be kept is known before they have taught anything."""
        self.save()
        self.inputs.open()
        self.every(URGENT_PERIOD, self._poll)
        if self.own.checkpoint:
            self.every(self.own.checkpoint_period, self.save)

    def stop(self) -> None:
        """Shut the inputs out; the last torque does not stand."""
        self.inputs.close()
        self._say(self.service.ending())

    def forget(self) -> None:
        """After a jump of time: nothing held; the filter restarts its speed by itself and keeps what it learned."""
        if hasattr(self, "service"):
            self.service.forget()

    def save(self) -> None:
        """Write the checkpoint; a full disk is said, not fatal."""
        if not hasattr(self, "service") or not self.own.checkpoint:
            return
        try:
            self._keep()
        except (InputError, OSError) as error:
            before, self._unkept = self._unkept, _unkept(self.own.checkpoint, error)
            if self._unkept != before:  # each try would be one more line on a disk that may be full
                self.get_logger().error(self._unkept)

    def _keep(self) -> None:
        """Not over what somebody else keeps there: of two winches with one file each would begin as the other ended."""
        path = self.own.checkpoint
        if file_there(path) not in (None, self._kept):
            raise InputError(
                f"{path}: not what this estimator wrote there; does another one keep its own? Name a file for each"
            )
        write_checkpoint(path, self.service.snapshot())
        self._kept, self._unkept = file_there(path), ""

    # -- callbacks
    def _answer(self, estimate: Estimate) -> None:
        self._publish(estimate)
        learned = self.service.model_due(self.service_now())
        if learned is not None:
            self._model.publish(String(data=model_to_text(learned)))

    def _poll(self) -> None:
        """Count the inputs that come although no speed does, and say that no friction is known."""
        now = self.service_now()
        if self.service.inputs.silence(now) > self.options.watchdog_timeout:
            self.inputs.poll()
        self._say(self.service.tick(now))

    # -- services
    def _enable(self, wanted: bool) -> str:
        self._wanted = wanted
        self.service.set_enabled(wanted)
        return f"learning {'enabled' if wanted else 'disabled'}"

    def _reset(self) -> str:
        self.service.reset()
        return "everything learned is forgotten: the seed again"

    def _save(self) -> str:
        if not self.own.checkpoint:
            raise InputError("parameter 'checkpoint' is empty: name a file")
        self._keep()
        return f"saved to {self.own.checkpoint}"

    # -- outputs
    def _say(self, estimate: Estimate | None) -> None:
        if estimate is not None:
            self._publish(estimate)

    def _publish(self, estimate: Estimate) -> None:
        """One answer to each sample; of one that was not taken in, or whose inputs contradict each other, it is not
        valid, and of one that shows no friction it is zero: the torque before it would stand for as long as an input
        is lost."""
        self._answers += 1
        known = math.isfinite(estimate.friction_torque)
        header = stamp_header(estimate.time, ROS, mark(self.service.valid(estimate), self._answers))
        speed = estimate.speed if math.isfinite(estimate.speed) else 0.0
        torque = estimate.friction_torque if known else 0.0
        self._torque.publish(joint_state(ROS, header, "winch_motor", velocity=speed, effort=torque))

    # -- what an earlier run left, health
    def _restore(self) -> None:
        if not self.own.checkpoint:
            return
        try:
            snapshot = read_checkpoint(self.own.checkpoint)
            if snapshot is not None:
                self.service.restore(snapshot)
                self.get_logger().info(f"continues from {self.own.checkpoint}")
        except InputError as error:
            kept = set_aside(self.own.checkpoint)  # it may be another crane's, or no checkpoint at all
            self.get_logger().warning(f"starts from the seed: {error}; the file is kept as {kept}")
        self._kept = file_there(self.own.checkpoint)

    def apply_settings(self) -> None:
        """Take over the periods."""
        if hasattr(self, "service"):
            self.own = self._own.read(self)
            self.service.model_period, self.service.inputs.hold.max_age = self.own.model_period, self.own.max_age

    def urgent(self) -> object:
        """Whether it waits, and for what."""
        waiting = self.service.status(self.service_now())["state"] == "waiting"
        return waiting, bool(self.service.contradiction), self.service.missing, self._input_health.silent()

    def health(self) -> Sequence[Health]:
        """The filter, every parameter with deviation and status, and the inputs."""
        own = self.alone(self._filter_health(), self._model)
        return [own, self._parameter_health(), self._input_health.report()]

    def _needed(self) -> set[str]:
        """The topics without which nothing is learned."""
        topics = self.service.inputs.topics
        needed = {f"{g}.{c}" for g in topics.groups for c in ("pressure_a", "pressure_b", "displacement")}
        needed |= set(self.crane.drive.channels)
        return {topics.speed_topic} | {t for t, source in topics.inputs.items() if needed & set(source.channels)}

    def _filter_health(self) -> Health:
        status, last = self.service.status(self.service_now()), self.service.last
        if last:
            status |= {"innovation": last.innovation, "nis": last.nis, "speed": last.speed}
        state = str(status["state"])
        why = {
            "waiting": status["missing"] and f" for {status['missing']}",
            "contradicted": f": {status['contradictions']}",
            "rejected": f": {status['rejection']}",
        }
        level = {"waiting": WARN, "rejected": WARN, "contradicted": ERROR}.get(state, OK)
        said = f"{state}{why.get(state, '')}"
        if suspicion := str(status["suspicion"]):
            level, said = max(level, WARN), f"{said}; {suspicion}"
        if self._unkept:
            level, said = max(level, WARN), f"{said}; {self._unkept}"
        return Health("filter", level, said, status)

    def _parameter_health(self) -> Health:
        values: dict[str, Any] = {}
        invalid = []
        for each in self.service.parameters():
            values |= {each.name: each.value, f"{each.name} std": each.std, f"{each.name} status": each.status}
            invalid += [each.name] if each.status == "invalid" else []
        summary = f"invalid: {', '.join(invalid)}" if invalid else "within the range around the seed"
        return Health("parameters", ERROR if invalid else OK, summary, values)


def _unkept(path: str, error: Exception) -> str:
    why = (isinstance(error, OSError) and error.strerror) or str(error)
    return (
        f"checkpoint not written, {path}: {why.removeprefix(f'{path}: ')}; what is learned is lost when the node ends"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of the executable `estimator`."""
    return run(EstimatorNode, arguments)


if __name__ == "__main__":
    sys.exit(main())
