"""What the nodes have in common: parameters, lifecycle, time jumps, diagnostics, services."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock, JumpThreshold
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile
from std_srvs.srv import SetBool, Trigger

from winch_friction.nodes.beside import read_terms
from winch_friction.nodes.inputs import Polled, diagnostic_array, diagnostic_status
from winch_friction.nodes.loop import Clocks, Guarded, answered, said_aloud
from winch_friction.nodes.options import FIXED, NodeOptions, refuse_crane_meanwhile
from winch_friction.nodes.parameters import OptionParameters, check_qualities, declare_all, unknown_parameters
from winch_friction.nodes.qos import fresh
from winch_friction.physics.errors import InputError, Problems
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

FORWARD_JUMP = 5.0  # s; a simulated clock that leaps further was restarted or skipped a piece of the recording
OK, WARN, ERROR = 0, 1, 2
URGENT_PERIOD = 0.2  # s; how often it is looked whether something must be said before the next report is due
SELDOM_SAID = 1.0  # s between two lines of the log that say the same
LAST_WORD = 0.05  # s that the last message gets before its publisher goes


@dataclass(frozen=True)
class Health:
    """What a node says about one of its parts: level (0 ok, 1 warn, 2 error), one line, and numbers."""

    part: str
    level: int
    summary: str
    values: Mapping[str, Any]


class WinchNode(Clocks, Guarded, LifecycleNode):
    """A lifecycle node around one object that steps through samples.

    A node says what it is made of in `build` (after the files are read), what it does while active in `start` and
    `stop`, and how it fares in `health`.
    """

    def __init__(self, name: str, *settings: OptionParameters[Any], **node_arguments: Any) -> None:
        super().__init__(name, **node_arguments)
        self._node_parameters = OptionParameters(NodeOptions, fixed=FIXED)
        self._settings = (self._node_parameters, *settings)
        declare_all(self, self._settings)
        self._built = False  # there is something to halt
        self.options: NodeOptions = self._node_parameters.read(self)
        self.check_settings({})
        self.crane: Crane
        self._activated = float("inf")
        self._reported: object = None
        self._active_entities: list[Callable[[], Any]] = []
        self._switches: list[Any] = []
        self._publishers_made: list[Any] = []
        self.told_to_end: Callable[[], bool] = lambda: False  # by whoever runs it: nothing may wait for a file then
        self._unwatched = Polled()  # every publisher's events would be waited for at every wake-up
        self.steady_clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.add_on_set_parameters_callback(self._on_set)
        self.add_post_set_parameters_callback(self._on_post_set)
        self.answer_every_transition()
        self._jump_handle = self.get_clock().create_jump_callback(_threshold(), post_callback=self._on_clock_jump)

    # -- what a node fills in
    def build(self, crane: Crane, model: FrictionModel) -> None:
        """Make the object inside and its publishers; `InputError` refuses to configure."""
        raise NotImplementedError

    def start(self) -> None:
        """Subscribe and begin."""

    def stop(self) -> None:
        """End and unsubscribe."""

    def save(self) -> None:
        """Write what should outlive the node."""

    def forget(self) -> None:
        """Start anew after a jump of time or on request."""

    def health(self) -> Sequence[Health]:
        """The node's parts, for diagnostics."""
        return ()

    def urgent(self) -> object:
        """What is reported at once when it changes."""
        return None

    def check_settings(self, changes: Mapping[str, Any]) -> None:
        """Raise `InputError` when the settings with these changes do not fit; changes nothing."""
        for each in self._settings:
            each.read(self, changes)
        refuse_crane_meanwhile(changes, self.options.crane if self._built else None)

    def apply_settings(self) -> None:
        """Take over changed parameters."""

    def load_terms(self) -> None:
        """Register the terms of `terms_file` and declare what can be set for them; `InputError` when there are none."""
        if read_terms(self.options.terms_file):
            declare_all(self, self._settings)

    # -- lifecycle
    @said_aloud
    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the files, build; a bad file is one line and leaves the node unconfigured."""
        try:
            self.options = self._node_parameters.read(self)
            self.load_terms()
            check_qualities(self)
            for each in unknown_parameters(self, self._settings):
                self.get_logger().warning(each)
            problems = Problems()
            with problems:
                self.crane = load_crane(self.options.crane)
            with problems:
                model = load_model(self.options.model_file)
            problems.say()
            self.build(self.crane, model)
            self._built = True
        except (InputError, OSError) as error:
            for each in getattr(error, "problems", (str(error),)):
                self.get_logger().error(each)
            self._take_down()
            return TransitionCallbackReturn.FAILURE
        self._diagnostics = self.publisher(DiagnosticArray, "/diagnostics", 10)
        return TransitionCallbackReturn.SUCCESS

    @said_aloud
    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Enable the publishers, then let the inputs in."""
        super().on_activate(state)
        self._activated = self.service_now()
        self.forget()
        self.start()
        self.every(self.options.diagnostics_period, self._publish_health)
        self.every(min(URGENT_PERIOD, self.options.diagnostics_period), self._publish_what_is_urgent)
        return TransitionCallbackReturn.SUCCESS

    @said_aloud
    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Shut the inputs out, keep what was learned."""
        self._halt()
        return super().on_deactivate(state)

    @said_aloud
    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take down what `build` made."""
        self._take_down()
        return TransitionCallbackReturn.SUCCESS

    @said_aloud
    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """From any state: end what runs, keep what was learned, then take down."""
        if state.label == "active":
            self._halt()
            super().on_deactivate(state)
            time.sleep(LAST_WORD)
        self._take_down()
        return TransitionCallbackReturn.SUCCESS

    @said_aloud
    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """A transition that raised leaves nothing running and the node unconfigured, to be configured anew."""
        try:
            if self._built:
                self._halt()
        except Exception:
            self.report_defect("the end after an error")
        self._take_down()
        return TransitionCallbackReturn.SUCCESS

    def end(self) -> None:
        """Shut down from whatever state: what is published ends at zero, what was learned is kept."""
        try:
            self.trigger_shutdown()
        except Exception as error:  # finalized already, or a transition that cannot be left: save what can be saved
            self.get_logger().warning(f"shut down without a transition: {error}")
            self.save()

    def _halt(self) -> None:
        try:
            self.stop()
        finally:
            self._report_the_end()
            while self._active_entities:
                self._active_entities.pop()()
        self.save()

    def _take_down(self) -> None:
        self._built = False
        while self._switches:
            self.destroy_service(self._switches.pop())
        while self._publishers_made:
            self.destroy_lifecycle_publisher(self._publishers_made.pop())

    # -- building blocks
    def publisher(self, message_type: Any, topic: str, qos: Any, **arguments: Any) -> Any:
        """A publisher that is silent unless the node is active, gone after cleanup."""
        qos = fresh(qos) if isinstance(qos, QoSProfile) else qos
        made = self.create_lifecycle_publisher(message_type, topic, qos, callback_group=self._unwatched, **arguments)
        self._publishers_made.append(made)
        return made

    def alone(self, part: Health, publisher: Any) -> Health:
        """The part's health, in error where somebody else publishes this output: who listens hears both in turn."""
        topic = publisher.topic_name
        if (count := self.count_publishers(topic)) < 2:
            return part
        said = f"{topic} has {count} publishers: does another {self.get_name()} run?"
        return replace(part, level=ERROR, summary=f"{part.summary}; {said}")

    def every(self, period: float, action: Callable[[], None]) -> Any:
        """A timer on the steady clock while active: those on ROS time freeze when it steps back (rclpy#1490)."""
        timer = self.create_timer(period, self.guarded(action), clock=self.steady_clock)
        self._active_entities.append(lambda: self.destroy_timer(timer))
        return timer

    def while_active(self, subscription: Any) -> None:
        """Drop a subscription when the node stops being active."""
        self._active_entities.append(lambda: self.destroy_subscription(subscription))

    def trigger(self, name: str, action: Callable[[], str]) -> None:
        """A Trigger service; `action` says what it did, `InputError` is its refusal."""
        self._switches.append(self.create_service(Trigger, f"~/{name}", lambda _, response: answered(action, response)))

    def switch(self, name: str, action: Callable[[bool], str]) -> None:
        """A SetBool service."""

        def answer(request: Any, response: Any) -> Any:
            return answered(lambda: action(request.data), response)

        self._switches.append(self.create_service(SetBool, f"~/{name}", answer))

    # -- parameters
    def _on_set(self, changes: Sequence[Any]) -> SetParametersResult:
        try:
            self.check_settings({each.name: each.value for each in changes})
        except InputError as error:
            return SetParametersResult(successful=False, reason=str(error))
        except Exception as error:
            self.report_defect("parameter check")
            return SetParametersResult(successful=False, reason=f"{type(error).__name__}: {error}")
        return SetParametersResult(successful=True)

    def _on_post_set(self, changes: Sequence[Any]) -> None:
        try:
            self.options = self._node_parameters.read(self)
            self.apply_settings()
        except Exception:
            self.report_defect("parameter change")

    # -- time and diagnostics
    def _on_clock_jump(self, jump: Any) -> None:
        try:
            # two senders of /clock make fifty jumps a second, and must not fill the disk
            self.get_logger().info(
                "time jumped: starting anew", throttle_duration_sec=SELDOM_SAID,
                throttle_time_source_type=self.steady_clock,
            )  # fmt: skip
            self.forget()
        except Exception:
            self.report_defect("jump of the clock")

    def _publish_what_is_urgent(self) -> None:
        if self.urgent() != self._reported:
            self._publish_health()

    def _report_the_end(self) -> None:
        """The last report does not say that all is well."""
        try:
            if getattr(self, "_diagnostics", None) in self._publishers_made:
                self._report([replace(each, level=WARN, summary="not active") for each in self.health()])
        except Exception:
            self.report_defect("last report")

    def _publish_health(self) -> None:
        self._reported = self.urgent()
        self._report(self.health())

    def _report(self, parts: Sequence[Health]) -> None:
        name = self.get_fully_qualified_name().lstrip("/")
        told = [diagnostic_status(f"{name}: {p.part}", self.crane.name, p.level, p.summary, p.values) for p in parts]
        self._diagnostics.publish(diagnostic_array(self.get_clock().now().to_msg(), told))


def _threshold() -> JumpThreshold:
    forward = Duration(nanoseconds=int(FORWARD_JUMP * 1e9))
    return JumpThreshold(min_forward=forward, min_backward=Duration(nanoseconds=-1), on_clock_change=True)
