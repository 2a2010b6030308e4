"""Subscriptions that are emptied when somebody asks, and services that are looked at now and then.

rclpy builds its wait set anew at every wake-up, from everything that could wake it, which costs more than the message.
A winch has some fifteen inputs and one of them drives: the others are read when it arrives, fifteen wake-ups become
one. A node has as many services and events that nobody uses for days: they are in the wait set ten times a second.
"""

from collections.abc import Iterator
from typing import Any

from rclpy.callback_groups import CallbackGroup


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
