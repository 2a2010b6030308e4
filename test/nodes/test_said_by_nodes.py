"""What compensator, estimator and their common base say and publish, each function on stand-ins for the rest."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from winch_friction.compensation import CompensatorConfig, Feedforward
from winch_friction.estimation import Estimate
from winch_friction.nodes import base as of_base
from winch_friction.nodes import compensator as of_compensator
from winch_friction.nodes import estimator as of_estimator
from winch_friction.nodes.base import ERROR, LAST_WORD, OK, WARN, Health, WinchNode
from winch_friction.nodes.compensator import CompensatorNode, CompensatorNodeOptions
from winch_friction.nodes.estimator import EstimatorNode
from winch_friction.nodes.options import NodeOptions
from winch_friction.physics.errors import InputError
from winch_friction.records.topics import TopicMap

Given = SimpleNamespace
TOPICS = TopicMap(groups=("active",))


def bare(kind: type, **attributes: Any) -> Any:
    """A node that is on no network; `out` is what it publishes, `log` what it logs."""
    node = kind.__new__(kind)
    node.out, node.log = [], []
    node.get_logger = lambda: Given(
        error=lambda text: node.log.append(("error", text)),
        warning=lambda text, **_: node.log.append(("warning", text)),
        info=lambda text, **_: node.log.append(("info", text)),
    )  # fmt: skip
    node.get_name, node.get_fully_qualified_name = (lambda: "compensator"), (lambda: "/port/compensator")
    node.ros_now, node.steady_now, node.service_now = (lambda: 5000.0), (lambda: 70.0), (lambda: 60.0)
    for name, value in attributes.items():
        setattr(node, name, value)
    return node


def to(node: Any, name: str) -> Any:
    return Given(publish=lambda message: node.out.append((name, message)))


def stamp(message: Any) -> float:
    return message.header.stamp.sec + message.header.stamp.nanosec * 1e-9


# -- what all nodes have in common
@pytest.mark.parametrize(("count", "level"), [(0, WARN), (1, WARN), (2, ERROR), (3, ERROR)])
def test_a_second_sender_of_an_output_is_an_error_of_its_part(count: int, level: int) -> None:
    node = bare(WinchNode, count_publishers=lambda topic: count)
    part = node.alone(Health("feedforward", WARN, "fading", {"n": 1}), Given(topic_name="/port/torque"))
    more = f"; /port/torque has {count} publishers: does another compensator run?" if level == ERROR else ""
    assert part == Health("feedforward", level, f"fading{more}", {"n": 1})


def test_a_report_names_node_and_part_and_the_crane() -> None:
    clock = Given(now=lambda: Given(to_msg=lambda: of_base.Clock().now().to_msg()))
    node = bare(WinchNode, crane=Given(name="crane 7"), get_clock=lambda: clock)
    node._diagnostics = to(node, "diagnostics")
    node._report([Health("inputs", WARN, "silent", {"age": 0.5}), Health("filter", OK, "learning", {})])
    statuses = node.out[0][1].status
    assert [(s.name, s.hardware_id, s.level, s.message) for s in statuses] == [
        ("port/compensator: inputs", "crane 7", b"\x01", "silent"),
        ("port/compensator: filter", "crane 7", b"\x00", "learning"),
    ]
    assert [(pair.key, pair.value) for pair in statuses[0].values] == [("age", "0.5")]


def test_what_is_urgent_is_reported_when_it_changes_and_not_again() -> None:
    reports, urgent = [], ["a"]
    node = bare(WinchNode, urgent=lambda: urgent[0], health=lambda: "parts", _report=reports.append, _reported=None)
    for said, count in (("a", 1), ("a", 1), ("b", 2), ("b", 2), ("a", 3)):
        urgent[0] = said
        node._publish_what_is_urgent()
        assert len(reports) == count
    node._publish_health()
    assert reports == ["parts"] * 4


@pytest.mark.parametrize(
    ("error", "reason", "logged"),
    [(None, "", 0), (InputError("too large"), "too large", 0), (KeyError("gone"), "KeyError: 'gone'", 1)],
)
def test_a_parameter_is_refused_with_its_reason_and_a_defect_is_logged(
    error: Exception | None, reason: str, logged: int
) -> None:
    given = []

    def check(changes: dict[str, Any]) -> None:
        given.append(changes)
        if error:
            raise error

    node = bare(WinchNode, check_settings=check)
    done = node._on_set([Given(name="scale", value=0.5), Given(name="lead", value=0.1)])
    assert (done.successful, done.reason) == (error is None, reason)
    assert given == [{"scale": 0.5, "lead": 0.1}]
    assert len(node.log) == logged


def test_an_end_that_is_no_transition_still_saves() -> None:
    def raises() -> None:
        raise RuntimeError("finalized")

    calls: list[str] = []
    node = bare(WinchNode, trigger_shutdown=raises, save=lambda: calls.append("saved"))
    node.end()
    assert (calls, node.log) == (["saved"], [("warning", "shut down without a transition: finalized")])
    node.trigger_shutdown = lambda: calls.append("shut down")
    node.end()
    assert calls == ["saved", "shut down"]


def test_what_runs_is_ended_from_the_last_on_and_what_was_learned_is_saved_last() -> None:
    calls: list[str] = []
    node = bare(
        WinchNode, stop=lambda: calls.append("stopped"), _report_the_end=lambda: calls.append("reported"),
        save=lambda: calls.append("saved"), _active_entities=[lambda: calls.append("a"), lambda: calls.append("b")],
    )  # fmt: skip
    node._halt()
    assert calls == ["stopped", "reported", "b", "a", "saved"]
    assert node._active_entities == []


@pytest.mark.parametrize(("state", "halted"), [("active", True), ("inactive", False), ("unconfigured", False)])
def test_a_shutdown_halts_what_is_active_and_takes_down_whatever_there_is(
    monkeypatch: pytest.MonkeyPatch, state: str, halted: bool
) -> None:
    calls, slept = [], []
    monkeypatch.setattr(of_base.time, "sleep", slept.append)
    monkeypatch.setattr(of_base.LifecycleNode, "on_deactivate", lambda self, state: calls.append("publishers silent"))
    node = bare(WinchNode, _halt=lambda: calls.append("halted"), _take_down=lambda: calls.append("down"))
    assert node.on_shutdown(Given(label=state)).name == "SUCCESS"
    assert calls == (["halted", "publishers silent", "down"] if halted else ["down"])
    assert slept == ([LAST_WORD] if halted else [])


def test_a_node_that_is_taken_down_leaves_no_service_and_no_publisher() -> None:
    gone: list[tuple[str, str]] = []
    node = bare(
        WinchNode, _switches=["enable", "reset"], _publishers_made=["torque"], _built=True,
        destroy_service=lambda each: gone.append(("service", each)),
        destroy_lifecycle_publisher=lambda each: gone.append(("publisher", each)),
    )  # fmt: skip
    node._take_down()
    assert sorted(gone) == [("publisher", "torque"), ("service", "enable"), ("service", "reset")]
    assert (node._built, node._switches, node._publishers_made) == (False, [], [])


def test_services_are_the_nodes_own_and_answer_what_was_done() -> None:
    made: dict[str, Any] = {}
    node = bare(WinchNode, _switches=[], create_service=lambda kind, name, answer: made.update({name: (kind, answer)}))
    node.switch("enable", lambda wanted: f"wanted {wanted}")
    node.trigger("reset", lambda: "anew")
    assert {name: kind for name, (kind, _) in made.items()} == {"~/enable": SetBool, "~/reset": Trigger}
    for wanted in (True, False):
        done = made["~/enable"][1](SetBool.Request(data=wanted), SetBool.Response())
        assert (done.success, done.message) == (True, f"wanted {wanted}")
    done = made["~/reset"][1](Trigger.Request(), Trigger.Response())
    assert (done.success, done.message, len(node._switches)) == (True, "anew", 2)


@pytest.mark.parametrize(("clock", "now"), [("ros", 5000.25), ("steady", 70.5)])
def test_a_service_goes_by_the_watchdogs_clock(clock: str, now: float) -> None:
    node = WinchNode.__new__(WinchNode)
    node.options = Given(watchdog_clock=clock)
    node.get_clock = lambda: Given(now=lambda: Given(nanoseconds=5_000_250_000_000))
    node.steady_clock = Given(now=lambda: Given(nanoseconds=70_500_000_000))
    assert node.service_now() == pytest.approx(now)


# -- the compensator
def fed(**changes: Any) -> Feedforward:
    given = {"time": 12.25, "friction_torque": 300.0, "pressure": 5e6, "speed": -40.0, "state": "active",
             "valid": True, "sequence": 7} | changes  # fmt: skip
    return Feedforward(**{name: given.get(name, 0.0) for name in Feedforward._fields})


@pytest.mark.parametrize(("hydraulic", "pressure", "out"), [(True, 5e6, 2), (True, math.nan, 1), (False, 0.0, 1)])
def test_a_torque_is_published_with_its_speed_and_a_pressure_where_there_is_one(
    hydraulic: bool, pressure: float, out: int
) -> None:
    node = bare(CompensatorNode, crane=Given(drive=Given(hydraulic=hydraulic)))
    node._torque, node._pressure = to(node, "torque"), to(node, "pressure")
    node._publish(fed(pressure=pressure))
    assert [name for name, _ in node.out] == ["torque", "pressure"][:out]
    message = node.out[0][1]
    assert (list(message.name), list(message.velocity), list(message.effort)) == (["winch_motor"], [-40.0], [300.0])
    assert {(stamp(each), each.header.frame_id) for _, each in node.out} == {(12.25, "valid 7")}
    if out > 1:
        assert node.out[1][1].fluid_pressure == 5e6
    node._publish(fed(valid=False, sequence=8))
    assert node.out[out][1].header.frame_id == "invalid 8"


def status(**changes: Any) -> dict[str, Any]:
    return {"state": "active", "contradictions": "", "missing": "the speed", "learned_model_refused": ""} | changes


def judged(now: float, stands: bool = False, warnings: tuple[str, ...] = (), **changes: Any) -> tuple[int, str]:
    """Level and summary of a compensator that has been active since 60 s."""
    service = Given(status=lambda now: status(**changes), warnings=lambda now: [*warnings])
    node = bare(
        CompensatorNode, service=service, service_now=lambda: now, _activated=60.0,
        options=NodeOptions(diagnostics_period=2.0), _clock_stands=lambda: stands, count_publishers=lambda _: 1,
        _torque=Given(topic_name="t"), _input_health=Given(report=lambda: "inputs"),
    )  # fmt: skip
    own, inputs = node.health()
    assert inputs == "inputs"
    assert own.part == "feedforward"
    return own.level, own.summary


@pytest.mark.parametrize(
    ("now", "changes", "found"),
    [
        (70.0, {}, (OK, "active")),
        (70.0, {"state": "fading"}, (OK, "fading")),
        (70.0, {"state": "disabled"}, (OK, "disabled")),
        (70.0, {"state": "stale"}, (ERROR, "stale: the speed")),
        (61.9, {"state": "waiting"}, (WARN, "waiting: the speed")),
        (62.1, {"state": "waiting"}, (ERROR, "waiting: the speed")),
        (62.1, {"state": "waiting", "missing": ""}, (ERROR, "waiting")),
        (70.0, {"state": "stale", "contradictions": "a load"}, (ERROR, "stale: a load")),
        (70.0, {"contradictions": "a load"}, (OK, "active: a load")),
        (70.0, {"learned_model_refused": "old"}, (WARN, "active; learned model refused: old")),
        (70.0, {"warnings": ("less", "more")}, (WARN, "active; less; more")),
        (70.0, {"warnings": ("less",), "state": "stale"}, (ERROR, "stale: the speed; less")),
        (70.0, {"state": "stale", "learned_model_refused": "old"},
         (ERROR, "stale: the speed; learned model refused: old")),
    ],
)  # fmt: skip
def test_a_feedforwards_state_has_its_level_and_its_reason(
    now: float, changes: dict[str, str], found: tuple[int, str]
) -> None:
    assert judged(now, **changes) == found
    level, said = judged(now, stands=True, **changes)
    assert level == max(found[0], WARN)
    assert said.startswith(f"{found[1]}; /clock stands still")


@pytest.mark.parametrize(("source", "more"), [("reference", {"winch/reference"}), ("measured", set())])
@pytest.mark.parametrize("hydraulic", [True, False])
def test_a_compensator_needs_what_its_torque_is_made_of(source: str, more: set[str], hydraulic: bool) -> None:
    config = CompensatorConfig(velocity_source=source)
    node = bare(CompensatorNode, crane=Given(drive=Given(hydraulic=hydraulic)))
    node.service = Given(inputs=Given(topics=TOPICS), law=Given(config=config))
    group = {f"winch/active/{each}" for each in ("pressure_a", "pressure_b", "displacement")}
    assert node._needed() == {"winch/joint_states", *more, *(group if hydraulic else ())}


def test_a_clock_stands_a_second_after_it_moved_last() -> None:
    node, at = bare(CompensatorNode, _moved=(math.nan, math.inf)), [0.0, 0.0]
    node.service_now, node.steady_now = (lambda: at[0]), (lambda: at[1])
    for clock, steady, stands in (
        (5.0, 70.0, False), (5.0, 70.9, False), (5.0, 71.1, True), (5.1, 71.2, False), (5.1, 72.1, False),
        (5.1, 72.3, True), (4.0, 72.4, False),
    ):  # fmt: skip
        at[:] = clock, steady
        assert node._clock_stands() is stands


@pytest.mark.parametrize(
    ("state", "at_work"),
    [("active", True), ("fading", True), ("disabled", True), ("stale", False), ("waiting", False), ("ending", False)],
)
def test_it_is_urgent_whether_anything_is_fed_forward_why_not_and_what_is_silent(state: str, at_work: bool) -> None:
    node = bare(CompensatorNode, _clock_stands=lambda: False, _input_health=Given(silent=lambda: {"speed"}))
    node.service = Given(status=lambda now: status(state=state, contradictions="a load"))
    assert node.urgent() == (at_work, "a load", {"speed"}, False)


@pytest.mark.parametrize(
    ("follow", "publishers", "until"),
    [(True, 1, "; what an estimator learns of its terms replaces it (follow_model_topic)"), (True, 0, ""),
     (False, 1, ""), (True, None, "")],
)  # fmt: skip
def test_a_loaded_model_is_named_with_whoever_will_replace_it(follow: bool, publishers: int | None, until: str) -> None:
    calls: list[Any] = []
    node = bare(CompensatorNode, own=CompensatorNodeOptions(follow_model_topic=follow))
    node._files = Given(get=lambda *given: calls.append(("read", given[0], given[2])) or Given(name="mine"))
    node.load_terms = lambda: calls.append("terms")
    apart = "beside 'theirs' it lacks stribeck" if follow else ""
    node.service = Given(load_model=lambda model: calls.append(("loaded", model.name)) or apart)
    node._models = None if publishers is None else Given(get_publisher_count=lambda: publishers)
    node.told_to_end = lambda: False
    assert node._load_model() == f"model 'mine' in use{apart and f'; {apart}'}{until}"
    assert calls == [("read", node._read_model, node.told_to_end), "terms", ("loaded", "mine")]


@pytest.mark.parametrize(("follow", "taken"), [(True, 1), (False, 0)])
def test_a_learned_model_is_read_where_it_is_followed(follow: bool, taken: int) -> None:
    node, calls = bare(CompensatorNode, own=CompensatorNodeOptions(follow_model_topic=follow)), []
    node.models, node._take_models = Given(offer=calls.append), lambda: calls.append("take")
    node._on_model(String(data="text"))
    assert calls == ["text", "take"][: 2 * taken]


@pytest.mark.parametrize(
    ("waiting", "refused", "looks"), [(False, [], 0), (True, [], 1), (False, ["old"], 1), (True, ["old"], 1)]
)
def test_an_answer_begins_the_watchdog_anew_and_takes_models_only_where_some_wait(
    waiting: bool, refused: list[str], looks: int
) -> None:
    node, calls = bare(CompensatorNode, models=Given(waiting=waiting), service=Given(refused_models=refused)), []
    node._publish, node._take_models = (lambda said: calls.append(said)), (lambda: calls.append("look"))
    node._watchdog = Given(reset=lambda: calls.append("reset"))
    node._answer("a torque")
    assert calls == ["a torque", "reset", *["look"] * looks]


def test_learned_models_are_offered_or_refused_in_words() -> None:
    node, offered = bare(CompensatorNode, own=CompensatorNodeOptions(), _said=""), []
    refused: list[str] = []
    node.models = Given(take=lambda: ["a model", InputError("other terms")])
    node.service = Given(offer=offered.append, refuse=refused.append, refused_models=refused,
                         law=Given(model=Given(name="seed")))  # fmt: skip
    node._take_models()
    assert (offered, refused) == (["a model"], [])
    assert node.log == [("warning", "model refused, 'seed' kept: other terms")]


def test_a_switch_is_remembered_and_said() -> None:
    for kind, what in ((CompensatorNode, "feedforward"), (EstimatorNode, "learning")):
        node, calls = bare(kind), []
        node.service = Given(set_enabled=calls.append, reset=lambda calls=calls: calls.append("reset"))
        for wanted, word in ((False, "disabled"), (True, "enabled")):
            assert node._enable(wanted) == f"{what} {word}"
            assert (node._wanted, calls[-1]) == (wanted, wanted)
        node._reset()
        assert calls[-1] == "reset"


@pytest.mark.parametrize(("name", "groups", "refused"), [
    ("active", ("active", "passive"), False), ("main", ("active", "passive"), True), ("main", ("active",), False),
    ("passive", ("active", "passive"), False), ("", ("a", "b", "c"), True),
])  # fmt: skip
def test_a_pressure_group_is_one_of_those_that_there_are(name: str, groups: tuple[str, ...], refused: bool) -> None:
    if not refused:
        return of_compensator._check_pressure_group(name, groups)
    with pytest.raises(InputError, match=f"must be one of {', '.join(groups)}, found '{name}'"):
        of_compensator._check_pressure_group(name, groups)
    return None


@pytest.mark.parametrize(("timeout", "latest"), [(0.1, 0.25), (5.0, math.inf)])
def test_what_comes_late_is_dropped_at_the_pace_of_a_machine_alone(timeout: float, latest: float) -> None:
    node = bare(CompensatorNode, options=NodeOptions(watchdog_timeout=timeout, stamp_window=0.75))
    node.own = CompensatorNodeOptions(model_delay=0.25)
    assert node._latest(CompensatorConfig(max_age=0.25)) == latest
    options = node._service_options()
    assert (options.watchdog_timeout, options.stamp_window, options.model_delay) == (timeout, 0.75, 0.25)


# -- the estimator
def learned(**changes: Any) -> Estimate:
    given = dict(zip(Estimate._fields, (10.0, True, "learning", 0.1, 0.2, 0.3, 50.0, 2.0, 300.0), strict=True))
    return Estimate(**(given | changes))


@pytest.mark.parametrize(
    ("changes", "doubted", "said", "speed", "torque"),
    [
        ({}, False, "valid 1", 50.0, 300.0),
        ({}, True, "invalid 1", 50.0, 300.0),
        ({"accepted": False}, False, "invalid 1", 50.0, 300.0),
        ({"friction_torque": math.nan}, False, "invalid 1", 50.0, 0.0),
        ({"speed": math.nan, "friction_torque": -3.0}, False, "valid 1", 0.0, -3.0),
    ],
)
def test_an_estimators_torque_is_that_of_the_sample_and_zero_where_it_shows_none(
    changes: dict[str, Any], doubted: bool, said: str, speed: float, torque: float
) -> None:
    node = bare(EstimatorNode, _answers=0)
    node.service = Given(valid=lambda estimate: estimate.valid and not doubted)
    node._torque = to(node, "torque")
    for number in (1, 2):
        node._publish(learned(**changes))
        assert node.out[-1][1].header.frame_id == said.replace("1", str(number))
    message = node.out[0][1]
    assert (stamp(message), list(message.name)) == (10.0, ["winch_motor"])
    assert (list(message.velocity), list(message.effort)) == ([speed], [torque])


def test_a_model_goes_out_when_it_is_due_and_after_the_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(of_estimator, "model_to_text", lambda model: f"text of {model}")
    node, due = bare(EstimatorNode), [None]
    node._model, node._publish = to(node, "model"), lambda estimate: node.out.append(("torque", estimate))
    node.service = Given(model_due=lambda now: due[0] if now == 60.0 else "of another clock")
    node._answer("estimate")
    assert node.out == [("torque", "estimate")]
    due[0] = "what was learned"
    node._answer("estimate")
    assert node.out[-1] == ("model", String(data="text of what was learned"))


@pytest.mark.parametrize(("silence", "polled"), [(0.09, 0), (0.11, 1)])
def test_the_other_inputs_are_counted_where_no_speed_comes(silence: float, polled: int) -> None:
    node, polls, said = bare(EstimatorNode, options=NodeOptions()), [], []
    node.service = Given(inputs=Given(silence=lambda now: silence), tick=lambda now: ("no torque", now))
    node.inputs, node._publish = Given(poll=lambda: polls.append(1)), said.append
    node._poll()
    assert (len(polls), said) == (polled, [("no torque", 60.0)])
    node.service.tick = lambda now: None
    node._poll()
    assert len(said) == 1


@pytest.mark.parametrize(
    ("changes", "unkept", "found"),
    [
        ({}, "", (OK, "learning")),
        ({"state": "stick"}, "", (OK, "stick")),
        ({"state": "waiting"}, "", (WARN, "waiting for the speed")),
        ({"state": "waiting", "missing": ""}, "", (WARN, "waiting")),
        ({"state": "rejected", "rejection": "a jump"}, "", (WARN, "rejected: a jump")),
        ({"state": "contradicted"}, "", (ERROR, "contradicted: a load")),
        ({"suspicion": "a gain"}, "", (WARN, "learning; a gain")),
        ({"state": "contradicted", "suspicion": "a gain"}, "full", (ERROR, "contradicted: a load; a gain; full")),
        ({}, "disk full", (WARN, "learning; disk full")),
    ],
)
def test_a_filters_state_has_its_level_and_its_reason(
    changes: dict[str, str], unkept: str, found: tuple[int, str]
) -> None:
    silent = {"suspicion": "", "rejection": ""}
    given = {"state": "learning", "missing": "the speed", "contradictions": "a load", **silent, **changes}
    node = bare(EstimatorNode, _unkept=unkept, service=Given(status=lambda now: dict(given), last=None))
    health = node._filter_health()
    assert (health.part, health.level, health.summary) == ("filter", *found)
    assert "nis" not in health.values
    node.service.last = learned()
    values = node._filter_health().values
    assert (values["innovation"], values["nis"], values["speed"]) == (0.1, 0.3, 50.0)


def test_parameters_are_reported_with_deviation_and_status_and_the_invalid_ones_named() -> None:
    known = [
        Given(name="C3", value=1.0, std=0.1, status="learned"),
        Given(name="C6", value=2.0, std=0.2, status="seed"),
    ]
    node = bare(EstimatorNode, service=Given(parameters=lambda: known))
    health = node._parameter_health()
    assert (health.part, health.level, health.summary) == ("parameters", OK, "within the range around the seed")
    assert health.values == {
        "C3": 1.0,
        "C3 std": 0.1,
        "C3 status": "learned",
        "C6": 2.0,
        "C6 std": 0.2,
        "C6 status": "seed",
    }
    known[1].status = known[0].status = "invalid"
    assert (node._parameter_health().level, node._parameter_health().summary) == (ERROR, "invalid: C3, C6")


def test_it_is_urgent_that_it_waits_or_is_contradicted_and_by_what() -> None:
    state, node = ["learning"], bare(EstimatorNode, _input_health=Given(silent=lambda: {"speed"}))
    node.service = Given(status=lambda now: {"state": state[0]}, contradiction="", missing=("a load",))
    assert node.urgent() == (False, False, ("a load",), {"speed"})
    state[0], node.service.contradiction = "waiting", "a gain"
    assert node.urgent() == (True, True, ("a load",), {"speed"})


def test_a_checkpoint_is_saved_on_request_where_one_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[Any] = []
    monkeypatch.setattr(of_estimator, "write_checkpoint", lambda *what: written.append(what))
    node = bare(
        EstimatorNode, own=Given(checkpoint=""), service=Given(snapshot=lambda: "content"), _unkept="full", _kept=None
    )
    with pytest.raises(InputError, match="parameter 'checkpoint' is empty"):
        node._save()
    node.save()  # nothing to keep
    assert written == []
    node.own = Given(checkpoint="here.json")
    assert node._save() == "saved to here.json"
    assert (written, node._unkept) == ([("here.json", "content")], "")


@pytest.mark.parametrize(
    ("found", "restored", "said"),
    [
        (None, [], []),
        ({"a": 1}, [{"a": 1}], [("info", "continues from here.json")]),
        (InputError("another crane"), [],
         [("warning", "starts from the seed: another crane; the file is kept as here.1.json")]),
    ],
)  # fmt: skip
def test_what_an_earlier_run_left_is_gone_on_from_or_kept_aside(
    monkeypatch: pytest.MonkeyPatch, found: Any, restored: list[Any], said: list[tuple[str, str]]
) -> None:
    def read(path: str) -> Any:
        if isinstance(found, Exception):
            raise found
        return found

    monkeypatch.setattr(of_estimator, "read_checkpoint", read)
    monkeypatch.setattr(of_estimator, "set_aside", lambda path: path.replace(".json", ".1.json"))
    taken: list[Any] = []
    node = bare(EstimatorNode, own=Given(checkpoint="here.json"), service=Given(restore=taken.append))
    node._restore()
    assert (taken, node.log) == (restored, said)


def test_the_last_torque_does_not_stand_and_timers_are_as_often_as_they_are_set() -> None:
    node, calls = bare(EstimatorNode), []
    node.inputs = Given(open=lambda: calls.append("open"), close=lambda: calls.append("close"))
    node.service, node._publish = Given(ending=lambda: "no torque"), calls.append
    node.save, node.every = (lambda: calls.append("save")), (lambda period, action: calls.append(period))
    node.own = Given(checkpoint="", checkpoint_period=45.0)
    node.start()
    assert calls == ["save", "open", 0.2]
    node.own.checkpoint = "here.json"
    node.start()
    assert calls[3:] == ["save", "open", 0.2, 45.0]
    node.stop()
    assert calls[7:] == ["close", "no torque"]


# -- what a node is made of
@pytest.mark.parametrize(
    ("raises", "logged"),
    [((), []), (("crane",), ["no crane"]), (("crane", "model"), ["no crane", "no model"]), (("build",), ["no build"])],
)
def test_all_files_that_are_bad_are_said_at_once_and_leave_nothing_built(
    monkeypatch: pytest.MonkeyPatch, raises: tuple[str, ...], logged: list[str]
) -> None:
    def load(what: str) -> Any:
        def loaded(*of: Any) -> str:
            if what in raises:
                raise InputError(f"no {what}")
            return f"{what} {of[0]}"

        return loaded

    calls: list[Any] = []
    for name in ("crane", "model"):
        monkeypatch.setattr(of_base, f"load_{name}", load(name))
    monkeypatch.setattr(of_base, "check_qualities", lambda node: None)
    monkeypatch.setattr(of_base, "unknown_parameters", lambda node, settings: ["what is x?"])
    node = bare(WinchNode, _built=False, _settings=(), load_terms=lambda: calls.append("terms"))
    node._node_parameters = Given(read=lambda node: NodeOptions(crane="c", model_file="m"))
    node.build = lambda *of: calls.append(of) or load("build")("")
    node._take_down = lambda: calls.append("down")
    node.publisher = lambda kind, topic, qos: topic
    assert node.on_configure(Given(label="unconfigured")).name == ("FAILURE" if raises else "SUCCESS")
    assert node.log == [("warning", "what is x?"), *(("error", each) for each in logged)]
    built = [("crane c", "model m")] if raises in ((), ("build",)) else []
    assert calls == ["terms", *built, *(["down"] if raises else [])]
    assert node._built is (not raises)


def test_publishers_timers_and_subscriptions_of_a_node_go_with_it() -> None:
    calls: list[Any] = []
    node = bare(
        WinchNode, _publishers_made=[], _active_entities=[], _unwatched="unwatched", steady_clock="steady",
        create_lifecycle_publisher=lambda *of, **more: calls.append((of, more)) or "a publisher",
        create_timer=lambda period, action, clock: calls.append((period, clock)) or "a timer",
        destroy_timer=lambda each: calls.append(("gone", each)), guarded=lambda action: action,
        destroy_subscription=lambda each: calls.append(("gone", each)),
    )  # fmt: skip
    assert node.publisher(String, "/topic", 10) == "a publisher"
    assert (calls.pop(), node._publishers_made) == (
        ((String, "/topic", 10), {"callback_group": "unwatched"}),
        ["a publisher"],
    )
    assert node.publisher(String, "/topic", of_compensator.OUTPUT) == "a publisher"
    (_, _, qos), _ = calls.pop()
    assert qos is not of_compensator.OUTPUT  # an override would change it for every topic
    assert qos.depth == of_compensator.OUTPUT.depth
    assert node.every(0.5, print) == "a timer"
    node.while_active("a subscription")
    for end in node._active_entities:
        end()
    assert calls == [(0.5, "steady"), ("gone", "a timer"), ("gone", "a subscription")]


def test_changed_parameters_are_taken_over_and_a_defect_in_that_ends_nothing() -> None:
    calls: list[Any] = []
    node = bare(
        WinchNode, _node_parameters=Given(read=lambda node: "the options"), apply_settings=lambda: calls.append(1)
    )
    node._on_post_set([])
    assert (node.options, calls, node.log) == ("the options", [1], [])

    def fails() -> None:
        raise ZeroDivisionError

    node.apply_settings = node.forget = fails
    node._on_post_set([])
    node.steady_clock, node._raised_at = Given(clock_type=None), -math.inf
    node._on_clock_jump(None)
    assert [each.partition(" failed")[0] for level, each in node.log if level == "error"] == [
        "parameter change", "jump of the clock",
    ]  # fmt: skip
