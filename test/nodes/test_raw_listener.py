"""Which topics the listener shows as they come, and what a line of it says."""

import base64
import json
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import telemetry
from winch_friction.nodes.telemetry import Raw

FLOAT, ARRAY = "std_msgs/msg/Float64", "diagnostic_msgs/msg/DiagnosticArray"


def listening(namespace: str) -> tuple[Raw, Any, dict[str, Any]]:
    """A listener in a namespace, its node with `topics` to be found, and its subscriptions."""
    heard: dict[str, Any] = {}
    node = SimpleNamespace(topics=[], timers=[])
    node.get_namespace = lambda: namespace
    node.get_topic_names_and_types = lambda: node.topics
    node.create_timer = lambda period, action: node.timers.append((period, action))
    node.get_clock = lambda: SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=12_345_678_901))

    def subscribe(kind: Any, topic: str, take: Any, qos: Any, raw: bool) -> None:
        assert raw
        assert topic not in heard, "twice"
        heard[topic] = (kind, take)

    node.create_subscription = subscribe
    return Raw(node), node, heard


@pytest.mark.parametrize(
    ("namespace", "ours"),
    [("/", {"/winch/load", "/winch2/load", "/diagnostics"}), ("/winch", {"/winch/load", "/diagnostics"})],
)
def test_every_topic_of_the_winch_that_can_be_shown_is_heard_once(namespace: str, ours: set[str]) -> None:
    listener, node, heard = listening(namespace)
    assert [period for period, _ in node.timers] == [1.0, 0.05]
    node.topics = [
        ("/winch/load", [FLOAT]), ("/winch2/load", [FLOAT]), ("/diagnostics", [ARRAY]), ("/winch/odd", ["own/msg/Odd"]),
    ]  # fmt: skip
    for _ in range(3):
        listener._look_around()
    assert set(heard) == ours
    assert heard["/winch/load"][0].__name__ == "Float64"


def test_a_line_says_topic_type_receipt_and_content_and_is_printed_once(capsys: pytest.CaptureFixture[str]) -> None:
    listener, node, heard = listening("/winch")
    node.topics = [("/winch/load", [FLOAT]), ("/diagnostics", [ARRAY])]
    listener._look_around()
    heard["/winch/load"][1](b"\x00\x01")
    heard["/diagnostics"][1](bytearray(b"\x02"))
    listener._print()
    listener._print()
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(each["topic"], each["type"], each["receipt"]) for each in lines] == [
        ("/winch/load", FLOAT, 12_345_678_901), ("/diagnostics", ARRAY, 12_345_678_901),
    ]  # fmt: skip
    assert [base64.b64decode(each["data"]) for each in lines] == [b"\x00\x01", b"\x02"]


def test_a_listener_ends_with_its_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(telemetry.os, "getppid", lambda: 42)
    telemetry._orphaned(42)
    with pytest.raises(KeyboardInterrupt):
        telemetry._orphaned(41)
