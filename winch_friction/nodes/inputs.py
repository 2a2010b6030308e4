"""The subscriptions of a node: every message goes to its service, in the order that the stamps decide."""

from collections.abc import Callable
from typing import Any, Protocol

from winch_friction.nodes.messages import message_type
from winch_friction.nodes.polling import Polled, drain
from winch_friction.nodes.qos import SENSOR, fresh, overridable
from winch_friction.online.inputs import InputGate
from winch_friction.records.topics import Input, stamp_time

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
                self._service.take(source, message, receipt, now, info["source_timestamp"])

    def _on_speed(self, message: Any, info: Any) -> None:
        """The others first, all that have come: stamps decide what belongs to which speed."""
        topics = self._service.inputs.topics
        source = topics.inputs[topics.speed_topic]
        waiting = [(message, info), *drain(self.speed)]
        self.poll()
        receipt, now = self.node.ros_now(), self.node.service_now()
        for each, sent in self._in_time(source, waiting):
            answer = self._service.take(source, each, receipt, now, sent["source_timestamp"])
            if answer is not None:
                self._answer(answer)

    def _in_time(self, source: Input, waiting: list[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
        if len(waiting) == 1 or not source.stamped:
            return waiting
        newest = max(stamp_time(message) for message, _ in waiting)
        kept = [each for each in waiting if newest - stamp_time(each[0]) <= self.latest]
        self.late += len(waiting) - len(kept)
        return kept


def _never(_: Any) -> None:
    """What a polled subscription calls."""
