"""From messages to samples: what a node does with its inputs, without the node."""

from collections import Counter
from collections.abc import Callable
from typing import Any

from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Sample
from winch_friction.records.topics import Input, TopicMap, stamp_time

BACKWARD_JUMP = 1.0  # s; stamps that fall behind by more are a new recording, not a late message


def _any(column: str, stamp: float, value: float) -> bool:
    return True


class SampleStream:
    """Holds every message's readings and makes one sample at each speed.

    `on_jump` is called when the speed's stamps fall back by more than `BACKWARD_JUMP`, before the sample is made;
    what is held is dropped first. A message without a stamp counts as measured at the next speed sent after it:
    clocks of different processes would place it differently, the order of sending does not. `admit` says of a column,
    its stamp and its value whether it may be held; `on_held` hears of every column whose value was.
    """

    def __init__(
        self,
        topics: TopicMap,
        hold: InputHold,
        on_jump: Callable[[], None] = lambda: None,
        admit: Callable[[str, float, float], bool] = _any,
        on_held: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.topics, self.hold = topics, hold
        self._on_jump, self._admit, self._on_held = on_jump, admit, on_held
        self.counts: Counter[str] = Counter()
        self.rejected: Counter[str] = Counter()
        self.last_stamp = float("-inf")
        self._unstamped: list[tuple[float, Input, Any]] = []

    def take(self, source: Input, message: Any, receipt: float, sent: float | None = None) -> Sample | None:
        """Hold what a message says; the sample, if it was a speed.

        `receipt` s stamps a speed without a header; `sent` orders messages of all topics (default: `receipt`).
        """
        sent = receipt if sent is None else sent
        if source.topic == self.topics.speed_topic:
            return self.take_speed(source, message, stamp_time(message) if source.stamped else receipt, sent)
        if source.stamped:
            self.put(source, stamp_time(message), message)
        else:
            self.put_off(source, message, sent)
        return None

    def put_off(self, source: Input, message: Any, sent: float) -> None:
        """Keep a message without a stamp until the next speed that was sent after it."""
        self._unstamped.append((sent, source, message))

    def take_speed(self, source: Input, message: Any, stamp: float, sent: float) -> Sample | None:
        """The sample at a speed's stamp in s; None where the message shows none."""
        if stamp < self.last_stamp - BACKWARD_JUMP:
            self.forget()
            self._on_jump()
        if not self.put(source, stamp, message):
            return None
        self._date_unstamped(stamp, sent)
        self.last_stamp = stamp
        return self.hold.sample(stamp)

    def _date_unstamped(self, stamp: float, sent: float) -> None:
        later = []
        for each in self._unstamped:
            if each[0] <= sent:
                self.put(each[1], stamp, each[2])
            else:
                later.append(each)
        self._unstamped = later

    def forget(self) -> None:
        """Drop what is held, after a jump of time."""
        self.hold.reset()
        self._unstamped = []
        self.last_stamp = float("-inf")

    def put(self, source: Input, stamp: float, message: Any) -> bool:
        """Hold what a message with this stamp in s says; whether its first channel was believed."""
        taken, first = False, True
        for channel, value in source.decode(message).items():
            accepted = self._admit(channel, stamp, value) and self.hold.put(channel, stamp, value)
            if accepted:
                self._on_held(channel)
            if first:
                taken, first = accepted, False
        self.counts[source.topic] += 1
        if not taken:
            self.rejected[source.topic] += 1
        return taken
