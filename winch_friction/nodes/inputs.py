"""The subscriptions of a node: every message goes into the stream, at each speed a sample comes out."""

from collections import Counter
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType

from winch_friction.nodes.messages import message_type
from winch_friction.nodes.polling import Polled, drain
from winch_friction.nodes.qos import SENSOR, overridable
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Sample
from winch_friction.records.sample_stream import SampleStream
from winch_friction.records.topics import Input, TopicMap

NANOSECOND = 1e-9


class Inputs:
    """Subscribes while open; `on_sample` gets the sample at each speed, `on_jump` hears of stamps that fall back."""

    def __init__(
        self,
        node: Any,
        topics: TopicMap,
        hold: InputHold,
        on_sample: Callable[[Sample], None],
        on_jump: Callable[[], None],
    ) -> None:
        self._node, self._on_sample = node, on_sample
        self._stream = SampleStream(topics, hold, on_jump)
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._held: list[tuple[Input, Any]] = []
        self._speed: Any = None
        self._last_seen = self.steady()

    def open(self) -> None:
        """Subscribe to everything."""
        self._last_seen = self.steady()
        topics = self._stream.topics
        held = Polled()
        for source in topics.inputs.values():
            if source.topic != topics.speed_topic:
                self._held.append((source, self._subscribe(source, None, held)))
        self._speed = self._subscribe(topics.inputs[topics.speed_topic], self._on_speed)

    def close(self) -> None:
        """Unsubscribe and forget what was held."""
        for subscription in (self._speed, *(each for _, each in self._held)):
            if subscription is not None:
                self._node.destroy_subscription(subscription)
        self._speed, self._held = None, []
        self.forget()

    def forget(self) -> None:
        """Drop what is held, after a jump of time."""
        self._stream.forget()

    @property
    def last_stamp(self) -> float:
        """Stamp of the last sample in s; -inf before the first."""
        return self._stream.last_stamp

    @property
    def counts(self) -> Counter[str]:
        """Messages by topic."""
        return self._stream.counts

    @property
    def rejected(self) -> Counter[str]:
        """Messages by topic that were not finite, late or of another joint."""
        return self._stream.rejected

    def steady(self) -> float:
        """Steady time in s."""
        return float(self._steady.now().nanoseconds * NANOSECOND)

    def silence(self) -> float:
        """Steady seconds since the last sample."""
        return self.steady() - self._last_seen

    def ages(self) -> dict[str, float]:
        """Age of every input at the last speed, s."""
        return self._stream.hold.ages(self.last_stamp)

    def _subscribe(self, source: Input, callback: Callable[..., None] | None, group: Any = None) -> Any:
        return self._node.create_subscription(
            message_type(source.type_name),
            source.topic,
            callback or _never,
            SENSOR,
            callback_group=group,
            qos_overriding_options=overridable(),
        )

    def _on_speed(self, message: Any, info: Any) -> None:
        """The others first, all that have come: stamps decide what belongs to which speed."""
        topics = self._stream.topics
        source, sent = topics.inputs[topics.speed_topic], info["source_timestamp"]
        receipt = self._receipt()
        for held, subscription in self._held:
            for other, other_info in drain(subscription):
                self._stream.take(held, other, receipt, other_info["source_timestamp"])
        sample = self._stream.take(source, message, receipt, sent)
        if sample is not None:
            self._last_seen = self.steady()
            self._on_sample(sample)

    def _receipt(self) -> float:
        return float(self._node.get_clock().now().nanoseconds * NANOSECOND)


def _never(_: Any) -> None:
    """What a polled subscription calls."""
