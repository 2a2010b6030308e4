"""What a node does beside its samples: the pace of its last ramp and of its watchdog, what it says once, what it takes
over, when it begins anew."""

import time
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from rclpy.clock import ROSClock
from rclpy.context import Context
from rclpy.parameter import Parameter
from rclpy.time import Time
from std_msgs.msg import Float64

from winch_friction.estimation import Estimate
from winch_friction.nodes.base import ERROR, WARN
from winch_friction.nodes.compensator import CompensatorNode
from winch_friction.nodes.estimator import EstimatorNode
from winch_friction.nodes.remote import QUESTIONS, RemoteNode
from winch_friction.nodes.simulator import SimulatorNodeOptions
from winch_friction.online.compensator import LEARNED_AT
from winch_friction.physics.errors import InputError
from winch_friction.records.strict_yaml import config_directory


@pytest.fixture
def active(context: Context) -> Iterator[Any]:
    """Makes an active node of a kind with parameters."""
    made = []

    def make(kind: type, **values: object) -> Any:
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        node = kind(context=context, parameter_overrides=overrides)
        made.append(node)
        node.trigger_configure()
        node.trigger_activate()
        return node

    yield make
    for node in made:
        node.end()
        node.destroy_node()


def test_the_last_ramp_is_published_at_its_own_pace(active: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """A consumer holds what comes last: a ramp in one burst is a step."""
    node, came = active(CompensatorNode), []
    monkeypatch.setattr(node.service, "ending", lambda _: iter([(0.05, "first"), (0.1, "second"), (0.2, "last")]))
    monkeypatch.setattr(node, "_publish", lambda said: came.append((time.monotonic(), said)))
    began = time.monotonic()
    node.stop()
    assert [said for _, said in came] == ["first", "second", "last"]
    assert all(at - began >= due for (at, _), due in zip(came, (0.05, 0.1, 0.2), strict=True))


@pytest.mark.parametrize(("timeout", "period"), [(0.05, 0.01), (0.1, 0.02), (0.4, 0.08), (5.0, 0.1)])
def test_the_watchdog_looks_more_often_than_it_waits(active: Any, timeout: float, period: float) -> None:
    node = active(CompensatorNode, watchdog_timeout=timeout)
    assert node._watchdog.timer_period_ns * 1e-9 == pytest.approx(period)


def test_a_refusal_is_logged_once_however_often_it_comes(active: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    node, lines = active(CompensatorNode), []
    monkeypatch.setattr(node, "get_logger", lambda: SimpleNamespace(warning=lines.append))
    for reason in ("other terms", "other terms", "no model", "no model"):
        node.service.refuse(reason)
        node._take_models()
    assert len(lines) == 2


def test_a_feedforward_that_still_waits_after_a_report_is_an_error(
    active: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    node = active(CompensatorNode, diagnostics_period=1.0)
    now = node._activated
    for later, level in ((0.5, WARN), (5.0, ERROR)):
        monkeypatch.setattr(node, "service_now", lambda later=later: now + later)
        assert node.health()[0].level == level


def test_the_estimator_takes_its_periods_over(active: Any) -> None:
    node = active(EstimatorNode)
    (done,) = node.set_parameters([Parameter("model_period", value=2.5)])
    assert done.successful
    (done,) = node.set_parameters([Parameter("max_age", value=0.3)])
    assert done.successful
    assert (node.service.model_period, node.service.inputs.hold.max_age) == (2.5, 0.3)


@pytest.mark.parametrize(("to", "anew"), [(99.5, True), (100.5, False), (104.0, False), (106.0, True)])
def test_a_clock_that_steps_back_at_all_or_far_ahead_begins_anew(
    active: Any, monkeypatch: pytest.MonkeyPatch, to: float, anew: bool
) -> None:
    node, calls = active(CompensatorNode), []
    clock = node.get_clock()
    assert isinstance(clock, ROSClock)
    clock._set_ros_time_is_active(True)
    clock.set_ros_time_override(Time(seconds=100.0, clock_type=clock.clock_type))
    monkeypatch.setattr(node, "forget", lambda: calls.append(1))
    clock.set_ros_time_override(Time(seconds=to, clock_type=clock.clock_type))
    assert bool(calls) is anew


@pytest.mark.parametrize("kind", [CompensatorNode, EstimatorNode])
def test_a_node_that_is_not_active_holds_no_input_open(active: Any, kind: type) -> None:
    node = active(kind)
    open_ = set(node.inputs.subscriptions())
    assert len(open_) == len(node.service.inputs.topics.inputs)
    node.trigger_deactivate()
    assert node.inputs.subscriptions() == {}
    node.trigger_activate()
    assert set(node.inputs.subscriptions()) == open_
    node.inputs.poll()


@pytest.mark.parametrize(("service", "asked"), [("load_model", 1), ("get_state", QUESTIONS)])
def test_only_questions_are_asked_again(service: str, asked: int) -> None:
    """A model that was handed over twice would begin anew twice."""
    future, calls = SimpleNamespace(done=lambda: False), []
    client = SimpleNamespace(
        wait_for_service=lambda timeout_sec: True, remove_pending_request=lambda _: None,
        call_async=lambda _: calls.append(1) or future,
    )  # fmt: skip
    executor = SimpleNamespace(spin_until_future_complete=lambda _, timeout_sec: None)
    remote = RemoteNode(SimpleNamespace(create_client=lambda *_: client), executor, "compensator", 0.1)
    with pytest.raises(InputError, match="no answer"):
        remote._call(None, service, None)
    assert len(calls) == asked


@pytest.mark.parametrize("asked", [Transition(id=Transition.TRANSITION_ACTIVATE), Transition(label="activate")])
def test_a_manager_that_asks_for_the_same_again_and_again_fills_no_log(
    active: Any, capfd: pytest.CaptureFixture[str], asked: Transition
) -> None:
    """By name the library wrote a line as well, each time."""
    node = active(CompensatorNode)
    capfd.readouterr()
    for _ in range(50):
        response = node._service_change_state.callback(
            ChangeState.Request(transition=asked), ChangeState.Response(success=True)
        )
        assert not response.success
    said = capfd.readouterr().err
    assert said.count("refused transition") == 1
    assert "not one of state 'active'" in said
    assert len(said.splitlines()) == 1


def test_a_transition_may_be_asked_for_by_its_name(active: Any) -> None:
    node = active(CompensatorNode)
    request = ChangeState.Request(transition=Transition(label="deactivate"))
    assert node._service_change_state.callback(request, ChangeState.Response()).success
    assert node._state_machine.current_state[1] == "inactive"


def test_a_process_that_was_restarted_waits_where_it_is_told_to(active: Any) -> None:
    """Whoever had switched it off, and saw it die, had it feed forward again by respawn."""
    node = active(CompensatorNode, starts_enabled=False)
    assert not node.service.law.status()["enabled"]
    node._enable(True)
    node.trigger_deactivate()
    node.trigger_cleanup()
    node.trigger_configure()
    assert node.service.law.status()["enabled"]
    assert not node.set_parameters([Parameter("starts_enabled", value=True)])[0].successful


def test_a_compensator_feeds_forward_from_its_start_unless_told_otherwise(active: Any) -> None:
    assert active(CompensatorNode).service.law.status()["enabled"]


@pytest.mark.parametrize("kind", [CompensatorNode, EstimatorNode], ids=lambda kind: kind.executable)
def test_how_long_a_speed_may_be_silent_and_how_far_ahead_stamped_are_two_limits(active: Any, kind: type) -> None:
    """A late speed is lost after its own limit; a stamp from a clock that is ahead is refused by the other."""
    gate = active(kind, watchdog_timeout=0.3, stamp_window=2.0).service.inputs
    assert (gate.options.watchdog_timeout, gate.options.stamp_window) == (0.3, 2.0)


def test_a_simulated_plant_of_which_nothing_is_said_turns_harder_than_its_seed() -> None:
    """Else there were nothing to learn for whoever starts the simulation as the README does."""
    assert SimulatorNodeOptions().friction_factor == 1.3


def test_a_model_that_waits_is_dropped_with_the_topic_that_it_came_from(active: Any) -> None:
    """An hour ahead, by a clock that was set back, it took effect an hour after nobody was to be followed any more."""
    node = active(CompensatorNode)
    model = node.service.law.model
    later = replace(model, provenance={**model.provenance, LEARNED_AT: 5000.0})
    node.service.offer(later)
    node.set_parameters([Parameter("follow_model_topic", value=False)])
    assert node.service.schedule.due(1e9) is None
    node.models._done.append(later)  # it was being read meanwhile
    node._watch()
    assert node.service.schedule.due(1e9) is None
    node.set_parameters([Parameter("follow_model_topic", value=True)])
    node._watch()
    assert node.service.schedule.due(1e9) is None
    node.models._done.append(later)
    node._watch()
    assert node.service.schedule.due(1e9) is later


def test_the_last_report_warns(active: Any) -> None:
    """A report of level 0 stands for as long as somebody shows it."""
    for kind in (CompensatorNode, EstimatorNode):
        node, said = active(kind), []
        node._report = said.extend
        node.trigger_deactivate()
        assert {(each.level, each.summary) for each in said} == {(WARN, "not active")}


@pytest.mark.parametrize("crane", ["crane_150t", "current"])
def test_an_estimator_needs_what_its_drive_is_known_by(active: Any, crane: str, tmp_path: Any) -> None:
    if crane == "current":
        text = (config_directory() / "cranes" / "worm_drive.yaml").read_text()
        crane = str(tmp_path / "crane.yaml")
        (tmp_path / "crane.yaml").write_text(
            text.replace("drive: electric", "drive: {kind: current, torque_constant: 0.5}")
        )
        node = active(EstimatorNode, crane=crane, model_file="worm_viscous")
        assert node._needed() == {"winch/joint_states", "winch/motor_current"}
    else:
        assert len(active(EstimatorNode)._needed()) == 7


def test_an_activation_begins_anew(active: Any) -> None:
    """The senders' clock may have been set while nobody listened."""
    for kind in (CompensatorNode, EstimatorNode):
        node = active(kind)
        node.trigger_deactivate()
        node.service.inputs.last_stamp = 5000.0
        node.trigger_activate()
        assert node.service.inputs.last_stamp == float("-inf")


@pytest.mark.parametrize(("report", "look"), [(1.0, 0.2), (60.0, 0.2), (0.1, 0.1)])
def test_what_changes_is_looked_for_between_two_reports(active: Any, report: float, look: float) -> None:
    node = active(CompensatorNode, diagnostics_period=report)
    periods = sorted(timer.timer_period_ns * 1e-9 for timer in node.timers)
    assert [each for each in periods if each > 0.05] == pytest.approx(sorted((look, report)))


def test_a_silent_watch_counts_the_other_inputs(active: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    node, polled = active(CompensatorNode), []
    monkeypatch.setattr(node.inputs, "poll", lambda: polled.append(True))
    monkeypatch.setattr(node, "_publish", lambda said: None)
    for said, looked in ((None, 0), ("a ramp", 1)):
        monkeypatch.setattr(node.service, "tick", lambda _, said=said: said)
        node._watch()
        assert len(polled) == looked


def test_a_backlog_is_as_old_as_the_age_limit_that_was_set(active: Any) -> None:
    node = active(CompensatorNode)
    node.set_parameters([Parameter("max_age", value=0.3)])
    assert node.inputs.latest == 0.3
    slow = active(CompensatorNode, watchdog_timeout=5.0)  # simulated time: nothing comes late
    slow.set_parameters([Parameter("max_age", value=0.3)])
    assert slow.inputs.latest == float("inf")


def test_a_clock_that_stands_is_said_at_once(active: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    node, stands = active(CompensatorNode), [False]
    monkeypatch.setattr(node, "_clock_stands", lambda: stands[0])
    before = node.urgent()
    stands[0] = True
    assert node.urgent() != before


def test_whether_anything_is_kept_is_known_before_anything_is_learned(active: Any, tmp_path: Any) -> None:
    active(EstimatorNode, checkpoint=str(tmp_path / "learned.json"))
    assert (tmp_path / "learned.json").is_file()


@pytest.mark.parametrize(("accepted", "torque", "said"), [(True, 300.0, "valid"), (False, 300.0, "invalid")])
def test_a_torque_whose_sample_was_rejected_is_not_valid(
    active: Any, monkeypatch: pytest.MonkeyPatch, accepted: bool, torque: float, said: str
) -> None:
    node, came = active(EstimatorNode), []
    monkeypatch.setattr(node, "_torque", SimpleNamespace(publish=came.append))
    node._publish(Estimate(10.0, accepted, "steady", 0.0, 0.0, 0.0, 0.0, 50.0, torque))
    assert came[0].header.frame_id.split()[0] == said


def test_speeds_without_a_stamp_that_waited_together_are_all_taken(active: Any) -> None:
    """A plain bridge's have no header to be late by."""
    node = active(CompensatorNode, float64_inputs=["motor_speed"])
    source = node.service.inputs.topics.inputs["winch/joint_states"]
    waiting = [(Float64(data=float(k)), {}) for k in range(3)]
    assert node.inputs._in_time(source, waiting) == waiting
