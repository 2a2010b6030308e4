"""Nothing that a callback, a transition, a service or a parameter raises ends the process."""

import functools
import inspect
import time
import traceback
from collections.abc import Callable
from typing import Any

from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn

from winch_friction.physics.errors import InputError

LEAST_BETWEEN = 1.0  # s between two reports of what callbacks raise: a defect at 200 Hz must not fill the disk


def said_aloud(transition: Callable[..., TransitionCallbackReturn]) -> Callable[..., TransitionCallbackReturn]:
    """Log what a transition raises: rclpy would only answer ERROR and keep the reason to itself."""

    @functools.wraps(transition)
    def wrapped(node: Any, state: LifecycleState) -> TransitionCallbackReturn:
        try:
            return transition(node, state)
        except Exception:
            node.get_logger().error(f"{transition.__name__} failed:\n{traceback.format_exc()}")
            raise

    return wrapped


def answered(action: Callable[[], str], response: Any) -> Any:
    """A service's response: what `action` did, or why not."""
    try:
        response.message, response.success = action(), True
    except (InputError, OSError) as error:
        response.message, response.success = str(error), False
    except Exception as error:  # a defect of ours is answered too
        response.message, response.success = f"{type(error).__name__}: {error}", False
    return response


class Guarded:
    """For lifecycle nodes: callbacks that end nothing, and an answer to every transition that is asked for."""

    _raised, _raised_at = 0, float("-inf")

    def guarded(self, callback: Callable[..., None]) -> Callable[..., None]:
        """A callback whose exceptions are said and counted."""

        @functools.wraps(callback)
        def wrapped(*arguments: Any) -> None:
            try:
                callback(*arguments)
            except Exception:
                self.report_defect(callback.__name__)

        # rclpy counts the parameters to know whether a callback wants the message's info
        wrapped.__signature__ = inspect.signature(callback)  # type: ignore[attr-defined]
        return wrapped

    def report_defect(self, where: str) -> None:
        """Log the exception that is being handled, at most once in `LEAST_BETWEEN` s."""
        self._raised += 1
        now = time.monotonic()
        if now - self._raised_at >= LEAST_BETWEEN:
            self._raised_at = now
            node: Any = self
            node.get_logger().error(f"{where} failed ({self._raised} so far):\n{traceback.format_exc()}")

    def answer_every_transition(self) -> None:
        """rclpy raises on a transition that the state does not have; whoever asks gets an answer instead."""
        node: Any = self
        service = node._service_change_state
        change = service.callback

        def answer(request: Any, response: Any) -> Any:
            known = {each[0] for each in node._state_machine.available_transitions}
            state = node._state_machine.current_state[1]
            if not request.transition.label and request.transition.id not in known:
                node.get_logger().warning(f"refused transition {request.transition.id}: not one of state '{state}'")
                response.success = False
                return response
            try:
                return change(request, response)
            except Exception as error:
                node.get_logger().error(f"refused transition '{request.transition.label}': {error}")
                response.success = False
                return response

        service.callback = answer
