"""Subscriptions that are emptied when somebody asks, instead of waking the executor at every message.

rclpy builds its wait set anew at every wake-up, which costs more than the message. A winch has some fifteen inputs and
one of them drives: the others are read when it arrives, fifteen wake-ups become one.
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


def drain(subscription: Any) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Every waiting message with its info (`source_timestamp`, ns), oldest first."""
    with subscription.handle:
        while (taken := subscription.handle.take_message(subscription.msg_type, subscription.raw)) is not None:
            yield taken
