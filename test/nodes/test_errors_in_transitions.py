"""A transition that raises leaves nothing running and a node that can be configured anew."""

from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from rclpy.context import Context

from winch_friction.nodes.compensator import CompensatorNode
from winch_friction.nodes.estimator import EstimatorNode

BOTH = pytest.mark.parametrize("kind", [CompensatorNode, EstimatorNode])


def state(node: Any) -> str:
    return str(node._state_machine.current_state[1])


def fails_once(node: Any, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first call of one of a node's methods raises."""
    own, calls = getattr(node, name), []

    def first(*arguments: Any) -> Any:
        calls.append(1)
        if len(calls) == 1:
            raise ZeroDivisionError("a defect")
        return own(*arguments)

    monkeypatch.setattr(node, name, first)


@BOTH
@pytest.mark.parametrize("name", ["build", "start", "stop"])
def test_a_node_whose_transition_raised_is_unconfigured_and_can_begin_again(
    context: Context, kind: type, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A first configuration that raised had nothing to halt, raised again over that, and finalized the node."""
    node = kind(context=context)
    fails_once(node, name, monkeypatch)
    node.trigger_configure()
    if name != "build":
        node.trigger_activate()
    if name == "stop":
        node.trigger_deactivate()
    assert state(node) == "unconfigured"
    assert not node._active_entities
    assert node._raised == 0  # what was never built is not halted
    node.trigger_configure()
    node.trigger_activate()
    assert state(node) == "active"
    node.end()
    node.destroy_node()


@BOTH
def test_what_cannot_be_stopped_runs_no_timer_any_more(
    context: Context, kind: type, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = kind(context=context)
    node.trigger_configure()
    node.trigger_activate()

    def fails() -> None:
        raise ZeroDivisionError("a defect")

    monkeypatch.setattr(node, "stop", fails)
    assert list(node.timers)
    node.trigger_deactivate()
    assert not list(node.timers)
    assert state(node) == "unconfigured"
    node.destroy_node()
