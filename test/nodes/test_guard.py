"""What a callback raises is said once and ends nothing; speeds that come too late are dropped."""

import inspect
import signal
from types import SimpleNamespace

import pytest

from winch_friction.nodes import run
from winch_friction.nodes.inputs import ROS, Inputs
from winch_friction.nodes.loop import Guarded, answered
from winch_friction.nodes.run import Ending
from winch_friction.physics.errors import InputError
from winch_friction.records.topics import TopicMap, joint_state, stamp_header


class Node(Guarded):
    def __init__(self) -> None:
        self.logged: list[str] = []

    def get_logger(self) -> SimpleNamespace:
        return SimpleNamespace(error=self.logged.append)


def test_an_exception_ends_nothing_and_does_not_fill_the_log() -> None:
    node, called = Node(), []

    def callback(message: int, info: int) -> None:
        called.append(message)
        raise ZeroDivisionError("a defect")

    guarded = node.guarded(callback)
    for k in range(100):
        guarded(k, 0)
    assert len(called) == 100
    assert len(node.logged) == 1
    assert "a defect" in node.logged[0]
    assert list(inspect.signature(guarded).parameters) == ["message", "info"]


@pytest.mark.parametrize("error", [InputError("no"), OSError("no"), KeyError("no")])
def test_a_service_answers_whatever_happens(error: Exception) -> None:
    def action() -> str:
        raise error

    response = answered(action, SimpleNamespace())
    assert not response.success
    assert "no" in response.message


def test_of_speeds_that_waited_only_the_latest_are_obeyed() -> None:
    topics = TopicMap(groups=())
    source = topics.inputs[topics.speed_topic]
    waiting = [
        (joint_state(ROS, stamp_header(10.0 + 0.02 * k, ROS), "winch_motor", velocity=1.0), {}) for k in range(75)
    ]
    latest, every = (Inputs(None, SimpleNamespace(), print, age) for age in (0.1, float("inf")))
    assert len(latest._in_time(source, waiting)) in (5, 6)
    assert latest.late >= 69
    assert len(every._in_time(source, waiting)) == 75


@pytest.mark.parametrize(("before", "asked"), [(signal.SIG_DFL, True), (signal.SIG_IGN, False)])
def test_a_terminal_that_is_closed_is_an_end_but_not_under_nohup(before: signal.Handlers, asked: bool) -> None:
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    kept = {each: signal.getsignal(each) for each in numbers}
    try:
        signal.signal(signal.SIGHUP, before)
        ending = Ending()
        signal.raise_signal(signal.SIGHUP)
        assert ending.asked is asked
    finally:
        for each, handler in kept.items():
            signal.signal(each, handler)


@pytest.mark.parametrize(("good", "status"), [(True, 0), (False, 1)])
def test_defects_end_a_node_only_in_a_row(monkeypatch: pytest.MonkeyPatch, good: bool, status: int) -> None:
    """One a day would have ended it after three years of sailing."""
    turns = iter(range(10_000))

    class Turning:
        def __init__(self, node: object) -> None:
            self.node = node

        def once(self) -> None:
            turn = next(turns)
            ending.asked = turn > 3 * run.MOST_DEFECTS
            if turn % 2 or not good:
                raise RuntimeError("a defect of the executor")

        def end(self) -> None:
            self.node = None

    ending = SimpleNamespace(asked=False)
    monkeypatch.setattr(run, "Loop", Turning)
    monkeypatch.setattr(run.rclpy, "ok", lambda: True)
    assert run._spin(SimpleNamespace(report_defect=lambda where: None), ending) == status
