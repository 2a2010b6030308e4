"""Messages in and out of a node: the subscriptions, whose messages go to the service in the order that the stamps
decide, and rclpy's messages from plain values.

rclpy builds its wait set anew at every wake-up, from everything that could wake it, which costs more than the message.
A winch has some fifteen inputs and one of them drives: the others are read when it arrives, fifteen wake-ups become
one. A node has as many services and events that nobody uses for days: they are in the wait set ten times a second.
"""

from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Protocol

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.callback_groups import CallbackGroup
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState, Temperature
from std_msgs.msg import Float64, Header, String

from winch_friction.nodes.qos import SENSOR, fresh, overridable
from winch_friction.online.inputs import InputGate
from winch_friction.records.topics import Input, split_time, stamp_time

# -- messages from plain values
_TYPES = {
    "builtin_interfaces/msg/Time": Time,
    "diagnostic_msgs/msg/DiagnosticArray": DiagnosticArray,
    "sensor_msgs/msg/FluidPressure": FluidPressure,
    "sensor_msgs/msg/JointState": JointState,
    "sensor_msgs/msg/Temperature": Temperature,
    "std_msgs/msg/Float64": Float64,
    "std_msgs/msg/Header": Header,
    "std_msgs/msg/String": String,
}


class RosFactory:
    """Builds the messages of `records.topics` with rclpy's types."""

    def make(self, type_name: str, **fields: Any) -> Any:
        """A message of this type."""
        return _TYPES[type_name](**fields)

    def doubles(self, values: Sequence[float]) -> Any:
        """A `float64[]` field."""
        return array("d", values)


ROS = RosFactory()


def message_type(type_name: str) -> Any:
    """The class of an input's message type."""
    return _TYPES[type_name]


def ros_time(time: float) -> Time:
    """A stamp from s."""
    seconds, nanoseconds = split_time(time)
    return Time(sec=seconds, nanosec=nanoseconds)


def clock_message(time: float) -> Clock:
    """What `/clock` says at `time` s."""
    return Clock(clock=ros_time(time))


def pressure_message(time: float, pressure: float, frame_id: str = "") -> FluidPressure:
    """A pressure difference in Pa at `time` s; the variance is not known."""
    header = Header(stamp=ros_time(time), frame_id=frame_id)
    return FluidPressure(header=header, fluid_pressure=float(pressure), variance=0.0)


def diagnostic_status(name: str, hardware: str, level: int, summary: str, values: Mapping[str, Any]) -> Any:
    """One status with plain numbers as values, so that plot tools can draw them."""
    pairs = [KeyValue(key=key, value=plain_value(value)) for key, value in values.items()]
    return DiagnosticStatus(name=name, hardware_id=hardware, level=bytes([level]), message=summary, values=pairs)


def diagnostic_array(stamp: Any, statuses: Sequence[Any]) -> DiagnosticArray:
    """What goes out on `/diagnostics`."""
    return DiagnosticArray(header=Header(stamp=stamp), status=list(statuses))


def plain_value(value: Any) -> str:
    """A number as digits, a truth value as 0 or 1, everything else as it prints."""
    if isinstance(value, bool):
        return str(int(value))
    return f"{value:.9g}" if isinstance(value, float) else str(value)


# -- subscriptions that are emptied on demand
class Polled(CallbackGroup):
    """The executor passes over the subscriptions of this group."""

    def can_execute(self, entity: Any) -> bool:
        """Never by the executor."""
        return False

    def beginning_execution(self, entity: Any) -> bool:
        """Never by the executor."""
        return False

    def ending_execution(self, entity: Any) -> None:
        """Nothing was begun."""


class Seldom(CallbackGroup):
    """What comes here waits until `open` is called next; the executor then finds it in the wait set once.

    Parameters, descriptions and events of the middleware, not the services that switch what a node does.
    """

    LOOKS = 2  # of the executor after an opening: it builds the wait set, it runs what was ready

    def __init__(self, urgent: tuple[str, ...]) -> None:
        super().__init__()
        self._urgent, self._looks = urgent, dict[int, int]()

    def open(self, node: Any) -> None:
        """Let the executor look once more; takes in what the node has made since."""
        self._looks.clear()
        for each in node.services:
            if not each.service_name.endswith(self._urgent):
                each.callback_group = self
        for each in node.waitables:
            if each.callback_group is node.default_callback_group:
                each.callback_group = self

    def can_execute(self, entity: Any) -> bool:
        """Until it was looked at often enough since the last opening."""
        looks = self._looks.get(id(entity), 0)
        self._looks[id(entity)] = looks + 1
        return looks < self.LOOKS

    def beginning_execution(self, entity: Any) -> bool:
        """Whatever was ready is run."""
        return True

    def ending_execution(self, entity: Any) -> None:
        """Nothing is left to do."""


def drain(subscription: Any) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Every waiting message with its info (`source_timestamp`, ns), oldest first."""
    with subscription.handle:
        while (taken := subscription.handle.take_message(subscription.msg_type, subscription.raw)) is not None:
            yield taken


# -- the subscriptions of a node
Answer = Callable[[Any], None]


class Service(Protocol):
    """What takes the messages: `online.CompensatorService` or `online.EstimatorService`."""

    inputs: InputGate

    def take(self, source: Input, message: Any, receipt: float, now: float, sent: float | None = None) -> Any:
        """One message; the answer, if it was a speed."""


class Inputs:
    """Subscribes while open; `answer` gets what the service says to each speed.

    `latest` s: of speeds that waited together, those older than the newest by more are dropped: they come too late to
    be obeyed. Infinity works all of them through.
    """

    def __init__(self, node: Any, service: Service, answer: Answer, latest: float = float("inf")) -> None:
        self.node, self._service, self._answer, self.latest = node, service, answer, latest
        self._held: list[tuple[Input, Any]] = []
        self.speed: Any = None  # its subscription, while open
        self.late = 0

    def open(self) -> None:
        """Subscribe to everything."""
        topics, held = self._service.inputs.topics, Polled()
        for source in topics.inputs.values():
            if source.topic != topics.speed_topic:
                self._held.append((source, self._subscribe(source, None, held)))
        self.speed = self._subscribe(topics.inputs[topics.speed_topic], self.node.guarded(self._on_speed))

    def close(self) -> None:
        """Unsubscribe."""
        for subscription in self.subscriptions().values():
            self.node.destroy_subscription(subscription)
        self.speed, self._held = None, []

    def subscriptions(self) -> dict[str, Any]:
        """The open subscriptions by contract topic."""
        speed = {self._service.inputs.topics.speed_topic: self.speed} if self.speed is not None else {}
        return {**speed, **{source.topic: subscription for source, subscription in self._held}}

    def _subscribe(self, source: Input, callback: Callable[..., None] | None, group: Any = None) -> Any:
        return self.node.create_subscription(
            message_type(source.type_name),
            source.topic,
            callback or _never,
            fresh(SENSOR),
            callback_group=group,
            qos_overriding_options=overridable(),
        )

    def poll(self) -> None:
        """Take in what waits while no speed comes, so that it is counted and does not pile up."""
        receipt, now = self.node.ros_now(), self.node.service_now()
        for source, subscription in self._held:
            for message, info in drain(subscription):
                self._service.take(source, message, receipt, now, sent_at(info))

    def work(self) -> None:
        """Take in the speeds that wait, and all else that has come: for whoever keeps the executor from it."""
        if self.speed is not None and (waiting := list(drain(self.speed))):
            self._take_in(waiting)

    def _on_speed(self, message: Any, info: Any) -> None:
        self._take_in([(message, info), *drain(self.speed)])

    def _take_in(self, waiting: list[tuple[Any, Any]]) -> None:
        """The others first, all that have come: stamps decide what belongs to which speed."""
        topics = self._service.inputs.topics
        source = topics.inputs[topics.speed_topic]
        self.poll()
        receipt, now = self.node.ros_now(), self.node.service_now()
        for each, sent in self._in_time(source, waiting):
            answer = self._service.take(source, each, receipt, now, sent_at(sent))
            if answer is not None:
                self._answer(answer)

    def _in_time(self, source: Input, waiting: list[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
        if len(waiting) == 1 or not source.stamped:
            return waiting
        newest = max(stamp_time(message) for message, _ in waiting)
        kept = [each for each in waiting if newest - stamp_time(each[0]) <= self.latest]
        self.late += len(waiting) - len(kept)
        return kept


# s; a message that seems to have been on its way for longer was sent by another clock than ours: an input that old
# would be lost anyway (`compensation.config.OLDEST_INPUT`)
LONGEST_WAY = 0.5


def sent_at(info: Mapping[str, Any]) -> float:
    """When a message was sent, s: by its sender's clock as long as that may be ours, else when it was received.

    Messages without a stamp wait for the speed that was sent after them. Of a clock that is ahead, or of a speed's that
    is behind, they would wait for as long, and count as measured then.
    """
    source, received = info["source_timestamp"], info.get("received_timestamp", 0)
    if received > 0 and not received - LONGEST_WAY * 1e9 <= source <= received:
        source = received
    return float(source * 1e-9)


def _never(_: Any) -> None:
    """What a polled subscription calls."""
