"""A node's own loop runs what rclpy's executor would: speeds, timers, services, in one thread."""

import gc
import sys
import time

import pytest

rclpy = pytest.importorskip("rclpy")

from rclpy.clock import Clock  # noqa: E402
from rclpy.clock_type import ClockType  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.parameter_client import AsyncParameterClient  # noqa: E402
from sensor_msgs.msg import JointState  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from winch_friction.nodes import loop as loop_module  # noqa: E402
from winch_friction.nodes.loop import Loop  # noqa: E402
from winch_friction.records.domain import unused_domain  # noqa: E402


class Inputs:
    """The part of a node's inputs that the loop looks at."""

    speed = None


@pytest.fixture
def pair():
    context = Context()
    rclpy.init(context=context, domain_id=unused_domain())
    ours, other = Node("ours", context=context), Node("other", context=context)
    ours.inputs = Inputs()
    yield ours, other
    ours.destroy_node(), other.destroy_node()
    rclpy.shutdown(context=context)


@pytest.fixture(params=["wait sets as known", "by the executor"])
def made(request, monkeypatch):
    if request.param == "by the executor":
        monkeypatch.setattr(loop_module, "_wait_sets_as_known", lambda node: False)
    from rclpy import executors

    def for_node(node):
        monkeypatch.setattr(
            loop_module, "SingleThreadedExecutor", lambda: executors.SingleThreadedExecutor(context=node.context)
        )
        return Loop(node)

    return for_node


def turn(loop, seconds, until=lambda: False):
    end = time.monotonic() + seconds
    while time.monotonic() < end and not until():
        loop.once()
    return until()


def test_speeds_timers_and_services_are_all_run(pair, made):
    ours, other = pair
    heard, ticks, asked = [], [], []
    ours.inputs.speed = ours.create_subscription(
        JointState, "speed", lambda message, info: heard.append((message.name[0], info)), 50
    )
    plain = []
    ours.create_subscription(JointState, "plain", lambda message: plain.append(message), 50)
    ours.create_timer(0.02, lambda: ticks.append(time.monotonic()), clock=Clock(clock_type=ClockType.STEADY_TIME))

    def reset(_, response):
        asked.append(True)
        response.success = True
        return response

    ours.create_service(Trigger, "~/reset", reset)
    speed, more = other.create_publisher(JointState, "speed", 50), other.create_publisher(JointState, "plain", 50)
    client = other.create_client(Trigger, "/ours/reset")
    parameters = AsyncParameterClient(other, "ours")
    loop = made(ours)
    assert turn(
        loop,
        20.0,
        lambda: (
            speed.get_subscription_count()
            and more.get_subscription_count()
            and client.service_is_ready()
            and parameters.services_are_ready()
        ),
    )
    for number in range(20):
        speed.publish(JointState(name=[str(number)]))
        more.publish(JointState())
    assert turn(loop, 5.0, lambda: len(heard) == 20 and len(plain) == 20)
    assert [name for name, _ in heard] == [str(number) for number in range(20)]
    assert heard[0][1]["source_timestamp"] > 0
    before = len(ticks)
    assert turn(loop, 5.0, lambda: len(ticks) > before + 10)
    executor = SingleThreadedExecutor(context=other.context)
    executor.add_node(other)
    answers = [client.call_async(Trigger.Request()), parameters.list_parameters()]

    def answered():
        executor.spin_once(timeout_sec=0.0)
        return all(each.done() for each in answers)

    assert turn(loop, 10.0, answered)
    assert asked == [True]
    executor.remove_node(other)
    loop.end()


def test_what_a_callback_raises_comes_out_and_the_loop_goes_on(pair, made):
    ours, _ = pair
    ticks = []

    def failing():
        ticks.append(True)
        raise ValueError("of the callback")

    ours.create_timer(0.01, failing, clock=Clock(clock_type=ClockType.STEADY_TIME))
    loop = made(ours)
    for number in range(1, 4):
        with pytest.raises(ValueError, match="of the callback"):
            turn(loop, 5.0)
        assert len(ticks) == number
    loop.end()


def test_it_comes_back_within_a_heartbeat(pair, made):
    ours, _ = pair
    loop = made(ours)
    loop.once()
    begun = time.monotonic()
    loop.once()
    assert time.monotonic() - begun < 10.0 * loop_module.HEARTBEAT
    loop.end()


def test_nothing_is_said_behind_the_end(made, monkeypatch):
    """Its executor is part of a cycle, which may be collected after the context has gone."""
    context, unraisable = Context(), []
    monkeypatch.setattr(sys, "unraisablehook", unraisable.append)
    rclpy.init(context=context, domain_id=unused_domain())
    node = Node("ended", context=context)
    node.inputs = Inputs()
    loop = made(node)
    loop.once()
    loop.end()
    assert loop._executor._sigint_gc is None
    node.destroy_node()
    rclpy.shutdown(context=context)
    del loop
    gc.collect()
    assert not unraisable


def test_a_wait_that_lasts_too_long_is_ended(pair, made, monkeypatch):
    """The middleware waits for a time of the system clock: set back by an hour, no watchdog looked for an hour."""
    ours, _ = pair
    loop, looks = made(ours), []
    if loop._wait != loop._wait_for_few:
        pytest.skip("rclpy's own executor waits by itself")
    ours.create_timer(3600.0, lambda: None, clock=Clock(clock_type=ClockType.STEADY_TIME))
    turn(loop, 0.3)
    monkeypatch.setattr(loop_module, "int", lambda nanoseconds: int(nanoseconds + 20e9), raising=False)
    began = time.monotonic()
    for _ in range(3):
        loop.once()
        looks.append(time.monotonic() - began)
        began = time.monotonic()
    monkeypatch.undo()
    loop.end()
    assert max(looks) < 0.5
