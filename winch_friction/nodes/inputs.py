"""The subscriptions of a node: every message is decoded, held, and at each speed handed on as one sample."""

from collections import Counter
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType

from winch_friction.nodes.messages import message_type
from winch_friction.nodes.qos import SENSOR, overridable
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Sample
from winch_friction.records.topics import Input, TopicMap, stamp_time

NANOSECOND = 1e-9
BACKWARD_JUMP = 1.0  # s; stamps that fall behind by more are a new recording, not a late message


class Inputs:
    """Subscribes while open; the speed topic drives, all others are held.

    `on_sample` gets the held sample at each finite speed. `on_jump` is called when the speed's stamps fall back by
    more than `BACKWARD_JUMP`, before the sample is handed on.
    """

    def __init__(
        self,
        node: Any,
        topics: TopicMap,
        hold: InputHold,
        on_sample: Callable[[Sample], None],
        on_jump: Callable[[], None],
    ) -> None:
        self._node, self._topics, self._hold = node, topics, hold
        self._on_sample, self._on_jump = on_sample, on_jump
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._subscriptions: list[Any] = []
        self.counts: Counter[str] = Counter()
        self.rejected: Counter[str] = Counter()
        self.last_stamp = float("-inf")
        self._last_seen = self.steady()

    def open(self) -> None:
        """Subscribe, the speed last: the executor serves in this order, so a sample finds its own companions."""
        self._last_seen = self.steady()
        speed = self._topics.speed_topic
        for source in sorted(self._topics.inputs.values(), key=lambda each: each.topic == speed):
            self._subscriptions.append(self._subscribe(source, self._speed if source.topic == speed else self._take))

    def close(self) -> None:
        """Unsubscribe and forget what was held."""
        while self._subscriptions:
            self._node.destroy_subscription(self._subscriptions.pop())
        self.forget()

    def forget(self) -> None:
        """Drop what is held, after a jump of time."""
        self._hold.reset()
        self.last_stamp = float("-inf")

    def steady(self) -> float:
        """Steady time in s."""
        return float(self._steady.now().nanoseconds * NANOSECOND)

    def silence(self) -> float:
        """Steady seconds since the last sample."""
        return self.steady() - self._last_seen

    def ages(self) -> dict[str, float]:
        """Age of every input at the last speed, s."""
        return self._hold.ages(self.last_stamp)

    def _subscribe(self, source: Input, take: Callable[[Input, Any], Any]) -> Any:
        return self._node.create_subscription(
            message_type(source.type_name),
            source.topic,
            lambda message: take(source, message),
            SENSOR,
            qos_overriding_options=overridable(),
        )

    def _take(self, source: Input, message: Any) -> tuple[float, bool]:
        """Hold what a message says; its stamp in s and whether its first channel was taken."""
        stamp = stamp_time(message) if source.stamped else self._receipt()
        readings = source.decode(message)
        accepted = [self._hold.put(channel, stamp, value) for channel, value in readings.items()]
        taken = bool(accepted) and accepted[0]
        self.counts[source.topic] += 1
        self.rejected[source.topic] += not taken
        return stamp, taken

    def _speed(self, source: Input, message: Any) -> None:
        if (stamp_time(message) if source.stamped else self._receipt()) < self.last_stamp - BACKWARD_JUMP:
            self._on_jump()
        stamp, taken = self._take(source, message)
        if taken:
            self.last_stamp, self._last_seen = stamp, self.steady()
            self._on_sample(self._hold.sample(stamp))

    def _receipt(self) -> float:
        return float(self._node.get_clock().now().nanoseconds * NANOSECOND)
