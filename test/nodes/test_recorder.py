"""What a recording holds: every message once, in the order of sending, dated by the simulated clock."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from rclpy.qos import QoSDurabilityPolicy, QoSReliabilityPolicy

from winch_friction.nodes import recorder as of_nodes
from winch_friction.nodes.inputs import clock_message
from winch_friction.nodes.recorder import Recorder, winch_topics
from winch_friction.records.topics import TopicMap

FIRST = 1_800_000_000_000_000_000  # ns; when the first message was sent, by the senders' clock
MS = 1_000_000
TYPES = {"load": "std_msgs/msg/Float64", "speed": "sensor_msgs/msg/JointState", "friction_model": "std_msgs/msg/String"}


class Sea:
    """A recorder on a node of names alone; `send` puts a message on a topic, `collect` and `finish` are its own."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.waiting: dict[str, list[Any]] = {}
        self.qualities: dict[str, Any] = {}
        self.publishers: dict[str, int] = {}
        self.written: list[tuple[str, str, bytes, int]] = []
        self.gone: list[str] = []
        node = SimpleNamespace(
            resolve_topic_name=lambda name: f"/winch/{name}", create_subscription=self._subscribe,
            destroy_subscription=lambda each: self.gone.append(each.topic),
        )  # fmt: skip
        monkeypatch.setattr(of_nodes, "drain", lambda each: self.waiting.pop(each.topic, []))
        writer = SimpleNamespace(write_raw=lambda *row: self.written.append(row))
        self.recorder = Recorder(node, writer, TYPES)

    def _subscribe(self, kind: Any, topic: str, callback: Any, qos: Any, **_: Any) -> Any:
        self.qualities[topic] = qos
        return SimpleNamespace(topic=topic, get_publisher_count=lambda: self.publishers.get(topic, 0))

    def send(self, topic: str, message: Any, at: float) -> None:
        """At `at` ms after the first."""
        self.waiting.setdefault(topic, []).append((message, {"source_timestamp": FIRST + round(at * MS)}))

    def clock(self, time: float, at: float) -> None:
        self.send("/clock", clock_message(time), at)


@pytest.fixture
def sea(monkeypatch: pytest.MonkeyPatch) -> Sea:
    return Sea(monkeypatch)


def test_messages_are_written_in_the_order_of_sending_and_dated_by_the_clock_before_them(sea: Sea) -> None:
    sea.send("/winch/load", b"before any clock", 0.0)
    sea.send("/winch/load", b"4", 40.0)
    sea.clock(1000.25, 1.0)
    sea.clock(1000.5, 30.0)
    sea.send("/winch/speed", b"3", 20.0)
    sea.send("/winch/load", b"2", 10.0)
    sea.recorder.finish()
    assert [(topic, message) for topic, _, message, _ in sea.written] == [
        ("/winch/load", b"2"), ("/winch/speed", b"3"), ("/winch/load", b"4"),
    ]  # fmt: skip
    assert [kind for _, kind, _, _ in sea.written] == [TYPES["load"], TYPES["speed"], TYPES["load"]]
    assert [at for *_, at in sea.written] == [1_000_250_000_000, 1_000_250_000_001, 1_000_500_000_000]


def test_receipts_only_grow_also_where_the_clock_steps_back(sea: Sea) -> None:
    for k, time in enumerate((1000.0, 1000.0, 999.0, 999.5, 1000.1)):
        sea.clock(time, 10.0 * k)
        sea.send("/winch/load", b"%d" % k, 10.0 * k + 1.0)
        sea.send("/winch/load", b"%d again" % k, 10.0 * k + 2.0)
    sea.recorder.finish()
    receipts = [at for *_, at in sea.written]
    assert receipts[:8] == [1_000_000_000_000 + k for k in range(8)]
    assert receipts[8:] == [1_000_100_000_000, 1_000_100_000_001]


def test_what_may_still_be_overtaken_waits_for_two_seconds(sea: Sea) -> None:
    """A message that was lost on the way is sent again, and comes after its successors."""
    sea.clock(1000.0, 0.0)
    sea.send("/winch/load", b"first", 500.0)
    sea.send("/winch/load", b"third", 2400.0)
    sea.recorder.collect()
    assert sea.written == []
    sea.send("/winch/load", b"second", 600.0)
    sea.send("/winch/load", b"fourth", 2600.0)
    sea.recorder.collect()
    assert [message for _, _, message, _ in sea.written] == [b"first", b"second"]
    assert (sea.recorder.taken["/winch/load"], sea.recorder.counts["/winch/load"]) == (4, 2)
    sea.recorder.collect()
    assert (sea.recorder.taken["/winch/load"], sea.recorder.counts["/winch/load"]) == (4, 2)
    sea.recorder.finish()
    assert [message for _, _, message, _ in sea.written][2:] == [b"third", b"fourth"]
    assert sea.recorder.counts == {"/winch/load": 4}
    assert sea.recorder.taken == {"/winch/load": 4, "/clock": 1}


def test_what_comes_two_seconds_before_the_latest_is_written_once(sea: Sea) -> None:
    sea.clock(1000.0, 0.0)
    sea.send("/winch/load", b"first", 500.0)
    sea.send("/winch/load", b"last", 2500.0)
    for _ in range(3):
        sea.recorder.collect()
    assert [message for _, _, message, _ in sea.written] == [b"first"]
    sea.recorder.finish()
    assert [message for _, _, message, _ in sea.written] == [b"first", b"last"]


def test_somebody_is_heard_where_every_topic_has_a_publisher(sea: Sea) -> None:
    sea.publishers["/winch/load"] = 1
    assert sea.recorder.hears("load")
    assert not sea.recorder.hears("load", "speed")
    sea.publishers["/winch/speed"] = 1
    assert sea.recorder.hears("load", "speed")
    sea.recorder.close()
    assert sorted(sea.gone) == ["/clock", "/winch/friction_model", "/winch/load", "/winch/speed"]


def test_a_recording_is_reliable_and_the_model_of_before_it_is_in_it(sea: Sea) -> None:
    for topic, qos in sea.qualities.items():
        assert qos.reliability == QoSReliabilityPolicy.RELIABLE
        latched = qos.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL
        assert latched == (topic == "/winch/friction_model")
        assert latched or qos.depth == 5000


def test_a_winch_is_recorded_with_all_that_goes_in_and_comes_out() -> None:
    topics = TopicMap(groups=("active",))
    joints, added = "sensor_msgs/msg/JointState", winch_topics(topics)
    assert {name: added.pop(name) for name in topics.inputs} == {k: v.type_name for k, v in topics.inputs.items()}
    assert added == {
        "compensator/friction_torque": joints, "estimator/friction_torque": joints, "simulator/truth": joints,
        "compensator/pressure_feedforward": "sensor_msgs/msg/FluidPressure", "friction_model": "std_msgs/msg/String",
        "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    }  # fmt: skip
