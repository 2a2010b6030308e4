"""How a node spins: a speed is taken at once, everything else is left to rclpy's executor, and nothing that a
callback, a transition, a service or a parameter raises ends the process.

The executor builds its wait set twice for each message, from everything that could wake it, and wraps the call in a
task, which costs more than the message and its answer. The wait set here holds what may wake a node at all.
"""

import functools
import inspect
import math
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn

from winch_friction.nodes.inputs import Polled, Seldom
from winch_friction.physics.errors import InputError

# -- nothing that is raised ends the process
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


class Clocks:
    """The clocks of a node: ROS time, the steady one, and the one that its service goes by."""

    steady_clock: Any
    options: Any
    get_clock: Any

    def ros_now(self) -> float:
        """The node's clock in s."""
        return float(self.get_clock().now().nanoseconds * 1e-9)

    def steady_now(self) -> float:
        """The steady clock in s."""
        return float(self.steady_clock.now().nanoseconds * 1e-9)

    def service_now(self) -> float:
        """The clock that the service inside goes by, s."""
        return self.ros_now() if self.options.watchdog_clock == "ros" else self.steady_now()


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
            asked, state = request.transition, node._state_machine.current_state[1]
            known = {each[1 if asked.label else 0] for each in node._state_machine.available_transitions}
            if (asked.label or asked.id) not in known:
                node.get_logger().warning(
                    f"refused transition {asked.label or asked.id}: not one of state '{state}'",
                    throttle_duration_sec=LEAST_BETWEEN, throttle_time_source_type=node.steady_clock,
                )  # fmt: skip
                response.success = False
                return response
            try:
                return change(request, response)
            except Exception as error:
                node.get_logger().error(f"refused transition '{asked.label}': {error}")
                response.success = False
                return response

        service.callback = answer


# -- one turn of the spinning
HEARTBEAT = 0.1  # s; so often it is looked whether the node was told to end, and for what comes seldom
URGENT = ("change_state", "enable", "reset", "load_model", "save")  # services that are answered at once


class Loop:
    """Waits for a node and runs what it is woken by, all in one thread.

    The middleware's wait ends at a time of the system clock: set back by an hour, it lasts an hour, and nothing but a
    message ends it, whatever the node's timers go by. A second thread, by the steady clock, ends what lasts too long.
    """

    def __init__(self, node: Any) -> None:
        self._node, self._executor, self._seldom = node, SingleThreadedExecutor(), Seldom(URGENT)
        self._executor.add_node(node)
        self._next, self._until, self._ended = 0.0, math.inf, False  # _until: steady s at which a wait is to be over
        self._alarm = GuardCondition(callback=None, callback_group=None, context=node.context)
        self._waker = threading.Thread(target=self._wake, name="waker", daemon=True)
        self._waker.start()
        self._wait: Callable[[float], bool] = self._wait_for_few if _wait_sets_as_known(node) else self._wait_for_all

    def end(self) -> None:
        """Let the node go."""
        self._ended = True
        self._waker.join()
        self._alarm.destroy()
        self._executor.remove_node(self._node)
        self._executor.shutdown(timeout_sec=0.0)  # else whoever collects it later prints a traceback behind the end

    def once(self) -> None:
        """Wait, at most for a heartbeat, and run what is ready; raises what a callback raises."""
        left = self._next - time.monotonic()
        if left <= 0.0:
            self._next = time.monotonic() + HEARTBEAT
            self._seldom.open(self._node)
            self._run_ready()
        elif self._wait(left):
            self._run_ready()

    def _wake(self) -> None:
        while not self._ended:
            time.sleep(HEARTBEAT)
            if time.monotonic() > self._until:
                self._alarm.trigger()

    def _run_ready(self) -> None:
        """One look of the executor, and every callback that it finds ready."""
        try:
            while True:
                handler, _, _ = self._executor.wait_for_ready_callbacks(timeout_sec=0.0)
                handler()
                handler.result()
        except TimeoutException:
            return

    def _wait_for_all(self, seconds: float) -> bool:
        """By the executor itself, for an rclpy whose wait sets are others."""
        self._executor.spin_once(timeout_sec=seconds)
        return False

    def _wait_for_few(self, seconds: float) -> bool:
        """Whether anything besides a speed, which is worked through here, is ready."""
        node = self._node
        speed = _speed(node)
        others = [each for each in node.subscriptions if each is not speed and not _polled(each)]
        services = [each for each in node.services if each.callback_group is not self._seldom]
        timers, clients = list(node.timers), list(node.clients)
        count = len(others) + (speed is not None)
        if not (count or timers or clients or services):
            time.sleep(seconds)
            return False
        waiting = _wait_set(node, count, len(timers), len(clients), len(services))
        waiting.clear_entities()
        for add, entities in (
            (waiting.add_subscription, others), (waiting.add_timer, timers), (waiting.add_client, clients),
            (waiting.add_service, services),
        ):  # fmt: skip
            for each in entities:
                add(each.handle)
        waiting.add_guard_condition(self._alarm.handle)
        place = None if speed is None else waiting.add_subscription(speed.handle)
        self._until = time.monotonic() + seconds
        waiting.wait(int(seconds * 1e9))
        self._until = math.inf
        if place is not None and waiting.is_ready("subscription", place):
            _take(speed)
            return any(waiting.is_ready("subscription", k) for k in range(len(others))) or _ready(waiting)
        return bool(waiting.get_ready_entities("subscription")) or _ready(waiting)


def _ready(waiting: Any) -> bool:
    return any(waiting.get_ready_entities(kind) for kind in ("timer", "service", "client"))


def _speed(node: Any) -> Any:
    """The subscription that drives a node with inputs, whose callback takes message and info; None while closed."""
    inputs = getattr(node, "inputs", None)
    return None if inputs is None else inputs.speed


def _polled(entity: Any) -> bool:
    return isinstance(entity.callback_group, Polled)


def _take(subscription: Any) -> None:
    """The oldest message, with its info, to the subscription's callback."""
    with subscription.handle:
        taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is not None:
        subscription.callback(*taken)


def _wait_set(node: Any, subscriptions: int, timers: int, clients: int, services: int) -> Any:
    return rclpy_implementation.WaitSet(subscriptions, 1, timers, clients, services, 0, node.context.handle)


def _wait_sets_as_known(node: Any) -> bool:
    try:
        found = _wait_set(node, 1, 0, 0, 0)
    except (AttributeError, TypeError):
        return False
    return hasattr(found, "is_ready")
