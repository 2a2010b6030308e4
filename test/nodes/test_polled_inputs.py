"""The subscriptions of a node: who wakes the node, in which order the messages go to the service, and whose time."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import inputs as of_nodes
from winch_friction.nodes.inputs import LONGEST_WAY, ROS, Inputs, Polled, Seldom, drain, sent_at
from winch_friction.nodes.loop import URGENT
from winch_friction.nodes.qos import SENSOR
from winch_friction.records.topics import TopicMap, joint_state, stamp_header

TOPICS = TopicMap(groups=("active",))
SPEED, LOAD = TOPICS.speed_topic, "winch/hook_load"
ROS_NOW, STEADY_NOW = 5000.0, 70.0


class Sent:
    """A subscription with messages that wait in it."""

    def __init__(self, kind: Any, topic: str, callback: Any, qos: Any, **arguments: Any) -> None:
        self.topic, self.callback, self.qos, self.group = topic, callback, qos, arguments["callback_group"]
        self.waiting: list[Any] = []


class Node:
    """A node whose clocks stand at different times."""

    def __init__(self) -> None:
        self.made: dict[str, Sent] = {}
        self.gone: list[str] = []

    def ros_now(self) -> float:
        return ROS_NOW

    def service_now(self) -> float:
        return STEADY_NOW

    def guarded(self, callback: Any) -> Any:
        return callback

    def create_subscription(self, *arguments: Any, **more: Any) -> Sent:
        made = Sent(*arguments, **more)
        self.made[made.topic] = made
        return made

    def destroy_subscription(self, each: Sent) -> None:
        self.gone.append(each.topic)


class Service:
    """Notes what it is given; answers a speed by its number, every third by nothing."""

    def __init__(self) -> None:
        self.inputs = SimpleNamespace(topics=TOPICS)
        self.taken: list[tuple[str, Any, float, float, float | None]] = []

    def take(self, source: Any, message: Any, receipt: float, now: float, sent: float | None = None) -> Any:
        self.taken.append((source.topic, message, receipt, now, sent))
        speeds = [each for each in self.taken if each[0] == SPEED]
        number = len(speeds) - 1
        return number if source.topic == SPEED and number != 2 else None


def info(sent: float) -> dict[str, int]:
    return {"source_timestamp": round(sent * 1e9)}


def speed(time: float) -> Any:
    return joint_state(ROS, stamp_header(time, ROS), "winch_motor", velocity=1.0)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Any:
    def emptied(subscription: Sent) -> list[Any]:
        waiting, subscription.waiting = subscription.waiting, []
        return waiting

    monkeypatch.setattr(of_nodes, "drain", emptied)
    node, service, answers = Node(), Service(), []
    inputs = Inputs(node, service, answers.append, latest=0.1)
    inputs.open()
    return SimpleNamespace(node=node, service=service, answers=answers, inputs=inputs)


def test_only_the_speed_wakes_a_node(opened: Any) -> None:
    assert set(opened.node.made) == set(TOPICS.inputs)
    assert opened.inputs.subscriptions() == {topic: opened.node.made[topic] for topic in TOPICS.inputs}
    for topic, each in opened.node.made.items():
        assert isinstance(each.group, Polled) is (topic != SPEED)
        assert each.qos is not SENSOR  # rclpy writes an override into the object that it is given
        assert (each.qos.depth, each.qos.reliability) == (SENSOR.depth, SENSOR.reliability)
    opened.inputs.close()
    assert sorted(opened.node.gone) == sorted(TOPICS.inputs)
    assert opened.inputs.subscriptions() == {}


@pytest.mark.parametrize("by", ["callback", "work"])
def test_what_came_before_goes_first_then_the_speeds_in_their_order(opened: Any, by: str) -> None:
    made = opened.node.made
    made[LOAD].waiting = [("load 1", info(1.0)), ("load 2", info(2.0))]
    first, *rest = [(speed(10.0 + 0.01 * k), info(3.0 + k)) for k in range(4)]
    if by == "callback":
        made[SPEED].waiting = rest
        made[SPEED].callback(*first)
    else:
        made[SPEED].waiting = [first, *rest]
        opened.inputs.work()
    assert [each[0] for each in opened.service.taken] == [LOAD, LOAD, *[SPEED] * 4]
    assert [each[1] for each in opened.service.taken] == ["load 1", "load 2", *(each[0] for each in (first, *rest))]
    assert {each[2:4] for each in opened.service.taken} == {(ROS_NOW, STEADY_NOW)}
    assert [each[4] for each in opened.service.taken] == pytest.approx([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert opened.answers == [0, 1, 3]  # 0 is an answer, None is none
    opened.inputs.work()
    assert len(opened.service.taken) == 6


def test_speeds_that_come_too_late_are_counted_over_all_bursts(opened: Any) -> None:
    for burst in range(2):
        opened.inputs._take_in([(speed(10.0 * burst + late), info(1.0)) for late in (0.0, 0.35, 0.41, 0.45)])
    assert opened.inputs.late == 2
    assert len(opened.service.taken) == 6
    for one in (21.0, 20.0):  # one alone is the newest there is
        opened.inputs._take_in([(speed(one), info(1.0))])
    assert opened.inputs.late == 2


def test_a_closed_node_works_nothing_through(opened: Any) -> None:
    opened.node.made[SPEED].waiting = [(speed(1.0), info(1.0))]
    opened.inputs.close()
    opened.inputs.work()
    assert opened.service.taken == []


@pytest.mark.parametrize(
    ("received", "sent", "found"),
    [(10.0, 9.9, 9.9), (10.0, 10.0, 10.0), (10.0, 10.1, 10.0), (10.0, 9.51, 9.51), (10.0, 9.49, 10.0), (0.0, 9.9, 9.9),
     (-1e-9, 9.9, 9.9)],
)  # fmt: skip
def test_a_message_was_sent_when_its_sender_says_where_that_may_be_our_clock(
    received: float, sent: float, found: float
) -> None:
    told = {"source_timestamp": round(sent * 1e9), "received_timestamp": round(received * 1e9)}
    assert sent_at(told) == pytest.approx(found)
    assert LONGEST_WAY == 0.5


def test_a_subscription_is_emptied_from_the_oldest_on() -> None:
    left = [("first", 1), ("second", 2)]

    class Handle:
        def __enter__(self) -> None: ...
        def __exit__(self, *_: object) -> None: ...
        def take_message(self, kind: object, raw: bool) -> Any:
            return left.pop(0) if left else None

    waiting = SimpleNamespace(handle=Handle(), msg_type=None, raw=False)
    assert list(drain(waiting)) == [("first", 1), ("second", 2)]
    assert list(drain(waiting)) == []


# -- what may wait
def test_what_comes_seldom_is_looked_at_twice_after_each_opening_and_what_is_urgent_always() -> None:
    own, others = object(), object()
    names = ("enable", "reset", "load_model", "change_state", "save", "get_parameters", "get_state")
    services = [SimpleNamespace(service_name=f"/compensator/{name}", callback_group=own) for name in names]
    waitables = [SimpleNamespace(callback_group=each) for each in (own, others)]
    node = SimpleNamespace(services=services, waitables=waitables, default_callback_group=own)
    seldom = Seldom(URGENT)
    seldom.open(node)
    assert [each.service_name.rpartition("/")[2] for each in services if each.callback_group is seldom] == [
        "get_parameters", "get_state",
    ]  # fmt: skip
    assert [each.callback_group for each in waitables] == [seldom, others]
    for _ in range(2):
        for each in services[-2:]:  # each by itself
            assert [seldom.can_execute(each) for _ in range(4)] == [True, True, False, False]
        seldom.open(node)
    assert seldom.beginning_execution(services[-1])


def test_what_is_polled_never_wakes_the_executor() -> None:
    group = Polled()
    assert not group.can_execute(object())
    assert not group.beginning_execution(object())
