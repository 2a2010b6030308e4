"""What the simulator publishes, in which order and how fast, on a clock and a sea of the test's own."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: pip install '.[ros]'")

from winch_friction.nodes import simulator as of_nodes
from winch_friction.nodes.base import OK, WARN
from winch_friction.nodes.inputs import ROS
from winch_friction.nodes.simulator import FEEDFORWARD, SETTLE, SimulatorNode, SimulatorNodeOptions
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.records.topics import TopicMap, joint_state, stamp_header

TOPICS = TopicMap(groups=("active",), max_displacement=3.4e-5)
TRUTH = {"shaft_angle": 1.0, "position_error": 2.0, "motor_speed": 3.0, "heave_velocity": 4.0, "friction_torque": 5.0,
         "friction_feedforward": 6.0}  # fmt: skip


class Sea:
    """A voyage of 100 s that goes on by `scan` s with each advance."""

    def __init__(self) -> None:
        self.elapsed, self.samples, self.scan, self.length = 0.0, 0, 0.02, 100.0
        self.torques: list[float] = []
        self.begun: list[tuple[float, float]] = []
        self.speed = 50.0
        self.scenario = SimpleNamespace(name="a sea", sensors=SimpleNamespace(rate=50.0))

    @property
    def now(self) -> float:
        return 1000.0 + self.elapsed

    @property
    def progress(self) -> float:
        return self.elapsed / self.length

    @property
    def finished(self) -> bool:
        return self.elapsed >= self.length

    @property
    def sample(self) -> Sample:
        groups = {"active": GroupSample(1e7, 2e6, 1e-5)}
        return Sample(self.now, self.speed, 50.0, groups=groups, hook_load=55e3, rope_force=5e5, oil_temperature=40.0,
                      wire_out=300.0, wire_layer=2.0)  # fmt: skip

    def advance(self, torque: float) -> bool:
        self.torques.append(torque)
        self.elapsed += self.scan
        self.samples += 1
        return True

    def begin(self, origin: float, gap: float = 2.0) -> None:
        self.begun.append((origin, gap))
        self.elapsed, self.samples = 0.0, 0

    def truth(self) -> dict[str, float]:
        return TRUTH


def made(**settings: Any) -> Any:
    """A simulator that has begun, at steady 70 s; `out` is what it publishes, in its order."""
    node = SimulatorNode.__new__(SimulatorNode)
    settings = {"lockstep": settings.get("rate") == 0.0} | settings
    node.own, node.voyage, node.topics, node.out, node.steady = (
        SimulatorNodeOptions(**settings),
        Sea(),
        TOPICS,
        [],
        70.0,
    )
    node.answers = of_nodes.Answers(node.own.wait_for if node.own.lockstep else ())
    node.held = SimpleNamespace(value=lambda age: ("held at", age), take=lambda *what: node.out.append(("took", *what)),
                                clear=lambda: node.out.append(("cleared", ())))  # fmt: skip

    def to(name: str) -> Any:
        return SimpleNamespace(
            publish=lambda message: node.out.append((name, message)), get_subscription_count=lambda: 1
        )

    node._inputs = {topic: to(topic) for topic in TOPICS.inputs if topic != "winch/rope_force"}
    node._clock_out, node._truth, node._progress = to("/clock"), to("truth"), to("progress")
    node.ticking: list[str] = []
    node._ticks = SimpleNamespace(
        reset=lambda: node.ticking.append("reset"), cancel=lambda: node.ticking.append("cancel")
    )
    node._steady, node.ros_now = (lambda: node.steady), (lambda: 8000.0)
    node._begin()
    node.out.clear(), node.ticking.clear(), node.voyage.begun.clear()
    return node


def topics(node: Any) -> list[str]:
    return [name for name, *_ in node.out]


def test_the_clock_goes_out_first_and_the_speed_last() -> None:
    node = made(lockstep=True)
    node._publish(node.voyage.sample)
    found = topics(node)
    assert found[:2] == ["/clock", "truth"]
    assert found[-1] == "winch/joint_states"
    assert "winch/rope_force" not in found  # the simulated crane weighs its load at the hook
    assert node.out[0][1].clock.sec == 1000
    assert (node.answers._awaited, node.answers._since) == (1000.0, 70.0)
    node.voyage.speed, node.steady = math.nan, 90.0
    node._publish(node.voyage.sample)
    assert node.answers._since == 70.0  # what shows no speed is not answered
    node._clock_out = None
    node.out.clear()
    node._publish(node.voyage.sample)
    assert "/clock" not in topics(node)


def test_the_truth_says_which_is_which() -> None:
    node = made()
    node._publish_truth()
    message = node.out[0][1]
    assert list(message.name) == ["winch_motor", "load"]
    assert [list(message.position), list(message.velocity), list(message.effort)] == [[1, 2], [3, 4], [5, 6]]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1000, 0)


def test_progress_is_said_at_each_percent_and_is_whole_at_the_end_alone() -> None:
    node, said = made(), []
    for elapsed in (0.5, 1.0, 1.4, 2.0, 50.0, 50.9, 99.95, 0.3, 0.9):
        node.out.clear()
        node.voyage.elapsed = elapsed
        node._publish_truth()
        said.append([message.data for name, message in node.out if name == "progress"])
    assert said == [[], [0.01], [], [0.02], [0.5], [], [0.999], [0.003], []]
    node.out.clear()
    node._end()
    assert [(name, message.data) for name, message in node.out] == [("progress", 1.0)]
    assert (node._running, node.ticking) == (False, ["cancel"])
    assert node.health()[0].summary == "over"


def test_a_sea_that_repeats_begins_again_at_its_end() -> None:
    node = made(repeat=True)
    node._end()
    assert node._running
    assert node.ticking == ["cancel", "reset"]
    assert node.voyage.begun == [(1000.0, 2.0)]


@pytest.mark.parametrize(("clock", "begun"), [(True, (1000.0, 2.0)), (False, (8000.0, 0.0))])
def test_a_sea_is_dated_by_its_origin_or_by_the_clock_that_there_is(clock: bool, begun: tuple[float, float]) -> None:
    node = made(publish_clock=clock)
    node._said, node._started = 0.7, 3.0
    node.answers.take(FEEDFORWARD, 1e9)
    assert node._begin() == "scenario 'a sea' from its start"
    assert node.voyage.begun == [begun]
    assert (node._said, node._started, node._running, node._ready_since) == (0.0, None, True, math.inf)
    assert topics(node) == ["cleared"]
    assert node.ticking == ["reset"]
    node.answers.topics = (FEEDFORWARD,)
    node.answers.expect(1.0, 70.0)
    assert not node.answers.complete  # what was answered before is no answer to this sea


@pytest.mark.parametrize(
    ("channel", "every"), [("hook_load", 5), ("wire_out", 25), ("wire_layer", 25), ("oil_temperature", 50)]
)
def test_what_changes_slowly_comes_in_scans_of_its_own(channel: str, every: int) -> None:
    node, came = made(), []
    for scan in range(101):
        node.voyage.samples = scan
        due = node._due_channels(node.voyage.sample)
        assert (due.motor_speed, due.groups["active"].pressure_a) == (50.0, 1e7)
        if not math.isnan(getattr(due, channel)):
            came.append(scan)
    assert came == list(range(0, 101, every))


# -- pace
@pytest.mark.parametrize("rate", [0.5, 1.0, 4.0])
def test_a_scan_is_due_when_the_rate_has_brought_it(rate: float) -> None:
    node = made(rate=rate)
    assert not node._due()  # not begun
    node.voyage.elapsed = 10.0
    node._set_pace()
    assert node._due()
    node.voyage.elapsed = 10.5
    assert not node._due()
    node.steady += 0.5 / rate - 1e-6
    assert not node._due()
    node.steady += 2e-6
    assert node._due()


def test_a_rate_of_nought_goes_as_fast_as_it_is_answered() -> None:
    node = made(rate=0.0)
    node.voyage.elapsed = 10.0
    node._set_pace()
    assert node._started == 60.0
    node.voyage.elapsed = 1e6
    assert node._due()


@pytest.mark.parametrize(("lockstep", "scans"), [(False, 2), (True, 1)])
def test_what_is_late_is_caught_up_by_two_scans_a_tick_and_in_lockstep_by_one(lockstep: bool, scans: int) -> None:
    node = made(lockstep=lockstep)
    node._tick()
    begun = node.voyage.samples
    assert topics(node).count("winch/joint_states") == 1 + begun  # the first sample without an advance
    node.steady += 50.0
    node._answer_taker(FEEDFORWARD)(joint_state(ROS, stamp_header(node.voyage.now, ROS), "winch_motor"))
    before = node.voyage.samples
    if lockstep:
        assert before == begun + 1  # the answer brings the next sample by itself
    else:
        node._tick()
        assert node.voyage.samples == before + scans


def test_lockstep_waits_for_every_answer_but_not_for_ever() -> None:
    node = made(lockstep=True, wait_for=(FEEDFORWARD, "estimator/friction_torque"), lockstep_timeout=1.0)
    node._tick()
    node.steady += 0.5
    samples = node.voyage.samples
    answer = joint_state(ROS, stamp_header(1000.0 + node.voyage.elapsed, ROS, "valid 7"), "winch_motor", effort=30.0)
    node._answer_taker(FEEDFORWARD)(answer)
    assert node.voyage.samples == samples
    node._tick()
    assert node.voyage.samples == samples
    assert ("took", 30.0, node.voyage.elapsed, "valid 7") in node.out
    node._answer_taker("estimator/friction_torque")(answer)
    assert node.voyage.samples == samples + 1
    assert topics(node).count("took") == 1  # of the compensator's alone
    assert node.health()[0].level == OK
    node.steady += 1.1
    node._tick()
    assert node.voyage.samples == samples + 2
    assert (node.health()[0].level, node.health()[0].values["unanswered"]) == (WARN, 1)
    assert node.voyage.torques[-1] == ("held at", node.voyage.elapsed - node.voyage.scan)


def test_without_lockstep_a_torque_ages_by_the_steady_clock_and_one_without_effort_is_none() -> None:
    node = made()
    take = node._answer_taker(FEEDFORWARD)
    take(joint_state(ROS, stamp_header(1000.0, ROS, "valid 3"), "winch_motor", effort=-12.5))
    assert node.out == [("took", -12.5, 70.0, "valid 3")]
    take(SimpleNamespace(effort=[], header=stamp_header(1000.0, ROS)))
    assert len(node.out) == 1
    assert node.voyage.samples == 0


def test_a_sea_begins_when_every_input_has_had_its_subscribers_for_a_moment() -> None:
    node, there = made(subscribers=2), dict.fromkeys(TOPICS.inputs, 2)
    for topic, each in node._inputs.items():
        each.get_subscription_count = lambda topic=topic: there[topic]
    assert not node._all_there()
    node.steady += 0.9 * SETTLE
    there["winch/hook_load"] = 1
    assert not node._all_there()
    node.steady += SETTLE
    there["winch/hook_load"] = 3
    assert not node._all_there()
    node.steady += 0.9 * SETTLE
    node._tick()
    assert node.out == []
    node.steady += 0.2 * SETTLE
    assert node._all_there()
    node._tick()
    there["winch/hook_load"] = 0
    assert node._all_there()  # begun is begun
    assert made()._all_there()


def test_an_ended_sea_says_so_and_advances_no_more() -> None:
    node = made()
    node._tick()
    node.voyage.elapsed, node.steady = 100.0, 1e6
    samples = node.voyage.samples
    node._tick()
    node._tick()
    assert node.voyage.samples == samples
    assert node.ticking == ["cancel"]


@pytest.mark.parametrize(
    ("rate", "scans", "pause"), [(1.0, 50.0, 0.02), (2.0, 100.0, 0.005), (1000.0, 500.0, 0.001), (0.0, 50.0, 0.05),
                                 (0.1, 50.0, 0.05)],
)  # fmt: skip
def test_it_ticks_once_a_scan_and_never_spins(rate: float, scans: float, pause: float) -> None:
    node, heard, periods = made(rate=rate), [], []
    node.voyage.scenario.sensors.rate = scans
    node.create_subscription = lambda kind, topic, callback, qos: topic
    node.while_active = heard.append
    node.every = lambda period, action: periods.append(period) or node._ticks
    node.start()
    assert periods == pytest.approx([pause])
    assert heard == [FEEDFORWARD]
    assert len(node.voyage.begun) == 1


def test_a_rate_that_is_changed_counts_from_here_on() -> None:
    node = made(rate=1.0)
    node._own = SimpleNamespace(read=lambda _: SimulatorNodeOptions(rate=2.0))
    node.apply_settings()
    assert node._started is None
    node._set_pace()
    node.voyage.elapsed, node.steady = 10.0, 80.0
    node.apply_settings()
    assert node._started == 75.0
    assert node._due()


def test_its_health_is_how_far_it_is() -> None:
    node = made()
    node.voyage.elapsed, node.voyage.samples = 25.0, 1250
    (sea,) = node.health()
    assert (sea.part, sea.level, sea.summary) == ("sea", OK, "at sea")
    assert sea.values == {"progress": 0.25, "time": 1025.0, "samples": 1250, "unanswered": 0}


@pytest.mark.parametrize(("lockstep", "complete", "goes_on"), [(True, True, 1), (True, False, 0), (False, True, 0)])
def test_an_answer_brings_the_next_sample_in_lockstep_where_none_is_missing(
    lockstep: bool, complete: bool, goes_on: int
) -> None:
    node, calls = made(lockstep=lockstep), []
    node._go_on = lambda: calls.append(1)
    node.answers.expect(1000.0 if complete else 2000.0, 70.0)
    node._answer_taker(FEEDFORWARD)(joint_state(ROS, stamp_header(1000.0, ROS), "winch_motor"))
    assert len(calls) == goes_on


def test_in_lockstep_one_tick_brings_one_sample_however_late_it_is() -> None:
    node = made(lockstep=True)
    node._tick()
    node.answers.expect(-math.inf, 70.0)  # answered
    node._publish = lambda sample: None  # nothing new is waited for
    node.steady, before = 1e6, node.voyage.samples
    node._tick()
    assert node.voyage.samples == before + 1


@pytest.mark.parametrize(("rate", "held"), [(200.0, 0.1), (50.0, 0.1), (10.0, 0.25)])
@pytest.mark.parametrize("lockstep", [False, True])
def test_what_it_is_built_of_is_what_was_set(
    monkeypatch: pytest.MonkeyPatch, rate: float, held: float, lockstep: bool
) -> None:
    """A torque is held for a tenth of a second, or two scans and a half where these are longer, and is none above what
    the crane's compensator may say; every leg has the rate that was set; a rope's force is not measured."""
    voyages, changed, topics = [], [], []
    node = SimulatorNode.__new__(SimulatorNode)
    settings = SimulatorNodeOptions(scenario="one", legs=("two",), sensor_rate=rate, duration=7.0, lockstep=lockstep,
                                    seed=5, friction_factor=1.2, hidden=("drag=2",))  # fmt: skip
    monkeypatch.setattr(of_nodes, "load_scenario", lambda name: name)
    monkeypatch.setattr(of_nodes, "scaled_system", lambda model, factor: (model, factor))
    monkeypatch.setattr(of_nodes, "Voyage", lambda *given: voyages.append(given))

    def adjusted(name: str, *change: float) -> Any:
        changed.append((name, *change))
        return SimpleNamespace(name=name, sensors=SimpleNamespace(rate=change[0]))

    monkeypatch.setattr(of_nodes, "adjusted", adjusted)
    node._own, node.options = SimpleNamespace(read=lambda _: settings), SimpleNamespace(topics=lambda crane: TOPICS)
    node.publisher = lambda kind, topic, *qos, **more: topics.append(topic)
    node.trigger = lambda name, action: topics.append(name)
    crane = SimpleNamespace(absolute_torque_limit=900.0)
    node.build(crane, "model")
    assert changed == [("one", rate, 7.0), ("two", rate, 7.0)]
    (sea, sailed, truth, seed, hidden, legs), *others = voyages
    assert (sea.name, sailed, truth, seed, hidden) == ("one", crane, ("model", 1.2), 5, [("drag", 2.0)])
    assert [each.name for each in legs] == ["two"]
    assert not others
    assert node.held.hold_time == pytest.approx(held)
    assert node.held.take(900.0, 0.0)
    assert not node.held.take(901.0, 0.0)
    assert node.answers.topics == ((FEEDFORWARD,) if lockstep else ())
    assert set(topics) == set(TOPICS.inputs) - {"winch/rope_force"} | {"/clock", "~/truth", "~/progress", "reset"}
