"""From messages to samples: what a node does with its inputs, without the node."""

from collections import Counter
from collections.abc import Callable
from typing import Any

from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Sample
from winch_friction.records.topics import Input, TopicMap, stamp_time

BACKWARD_JUMP = 1.0  # s; stamps that fall behind by more are a new recording, not a late message


class SampleStream:
    """Holds every message's readings and makes one sample at each speed.

    `on_jump` is called when the speed's stamps fall back by more than `BACKWARD_JUMP`, before the sample is made;
    what is held is dropped first.
    """

    def __init__(self, topics: TopicMap, hold: InputHold, on_jump: Callable[[], None] = lambda: None) -> None:
        self.topics, self.hold = topics, hold
        self._on_jump = on_jump
        self.counts: Counter[str] = Counter()
        self.rejected: Counter[str] = Counter()
        self.last_stamp = float("-inf")

    def take(self, source: Input, message: Any, receipt: float) -> Sample | None:
        """Hold what a message says (`receipt` s stamps it when it has no header); the sample, if it was a speed."""
        stamp = stamp_time(message) if source.stamped else receipt
        speed = source.topic == self.topics.speed_topic
        if speed and stamp < self.last_stamp - BACKWARD_JUMP:
            self.forget()
            self._on_jump()
        taken = self._put(source, stamp, message)
        if not (speed and taken):
            return None
        self.last_stamp = stamp
        return self.hold.sample(stamp)

    def forget(self) -> None:
        """Drop what is held, after a jump of time."""
        self.hold.reset()
        self.last_stamp = float("-inf")

    def _put(self, source: Input, stamp: float, message: Any) -> bool:
        readings = source.decode(message)
        accepted = [self.hold.put(channel, stamp, value) for channel, value in readings.items()]
        taken = bool(accepted) and accepted[0]
        self.counts[source.topic] += 1
        self.rejected[source.topic] += not taken
        return taken
