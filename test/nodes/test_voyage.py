"""A sea that is sailed again while the time goes on, and the answers that lockstep waits for."""

import weakref

import pytest

from winch_friction.nodes import voyage as of_nodes
from winch_friction.nodes.voyage import Answers, Voyage, adjusted, hidden_effects
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Sample
from winch_friction.simulation.scenario import load_scenario


def test_the_same_sea_again_with_later_stamps(crane_150t, crane2_model) -> None:
    scenario = adjusted(load_scenario("ahc_irregular"), 100.0, 1.0)
    voyage = Voyage(scenario, crane_150t, crane2_model, seed=4)
    voyage.begin(1000.0)
    first = [(voyage.sample.time, voyage.sample.motor_speed) for _ in range(80) if voyage.advance(0.0)]
    while voyage.advance(0.0):
        pass
    assert voyage.finished
    assert voyage.samples == 100
    voyage.begin(1000.0)
    second = [(voyage.sample.time, voyage.sample.motor_speed) for _ in range(80) if voyage.advance(0.0)]
    assert [speed for _, speed in first] == [speed for _, speed in second]
    assert [b[0] - a[0] for a, b in zip(first, second, strict=True)] == pytest.approx([3.0] * 80)


def test_legs_are_sailed_one_after_the_other_round_and_round(crane_150t, crane2_model) -> None:
    first = adjusted(load_scenario("ahc_irregular"), 50.0, 0.5)
    second = first.override({"load": 15e3, "name": "light"})
    voyage = Voyage(first, crane_150t, crane2_model, seed=4, legs=(second,))
    loads, starts = [], []
    for _ in range(4):
        voyage.begin(1000.0)
        loads.append(round(voyage.sample.hook_load, -3))
        starts.append(voyage.now)
        while voyage.advance(0.0):
            pass
        assert voyage.finished
    assert loads == [55e3, 15e3, 55e3, 15e3]
    assert starts == pytest.approx([1000.0, 1002.5, 1005.0, 1007.5])


def test_on_the_walls_clock_the_stamps_do_not_run_ahead(crane_150t, crane2_model) -> None:
    voyage = Voyage(adjusted(load_scenario("ahc_irregular"), 50.0, 0.5), crane_150t, crane2_model, seed=4)
    voyage.begin(5000.0, gap=0.0)
    while voyage.advance(0.0):
        pass
    voyage.begin(5007.0, gap=0.0)
    assert voyage.now == 5007.0


def test_a_dated_scenario_is_dated_by_the_clock(crane_150t, crane2_model) -> None:
    scenario = adjusted(load_scenario("ahc_irregular"), 50.0, 0.5).override({"start_time": 1.7e9})
    voyage = Voyage(scenario, crane_150t, crane2_model, seed=4)
    voyage.begin(1000.0)
    assert voyage.advance(0.0)
    assert voyage.sample.time == pytest.approx(voyage.now, abs=0.05)


def test_answers_are_waited_for_but_not_for_ever() -> None:
    answers = Answers(("compensator", "estimator"))
    answers.expect(10.0, now=100.0)
    answers.take("compensator", 10.0)
    assert not answers.complete
    assert not answers.overdue(100.5, patience=1.0)
    answers.take("estimator", 9.98)
    assert not answers.complete
    answers.take("estimator", 10.0)
    assert answers.complete
    assert answers.overdue(101.5, patience=1.0)
    assert answers.unanswered == 1


def test_hidden_effects_by_name_and_size() -> None:
    assert hidden_effects(["signal_delay", "wear_drift=0.5"]) == [("signal_delay", 1.0), ("wear_drift", 0.5)]
    with pytest.raises(InputError, match="must be a number"):
        hidden_effects(["wear_drift=much"])


def test_the_old_voyage_is_gone_before_the_next_is_drawn(crane_150t, crane2_model, monkeypatch) -> None:
    """Two of them at a time left holes in the heap: 21 MB in eight voyages of 300 s."""
    voyage = Voyage(adjusted(load_scenario("ahc_irregular"), 50.0, 0.5), crane_150t, crane2_model, seed=4)
    voyage.begin(1000.0)
    history, fresh, left = weakref.ref(voyage._simulator.history), Voyage._fresh, []
    monkeypatch.setattr(Voyage, "_fresh", lambda self: left.append(history()) or fresh(self))
    voyage.begin(1000.0)
    assert left == [None]


@pytest.mark.parametrize(("rate", "period"), [(100.0, 0.01), (50.0, 0.01), (500.0, 0.002), (10.0, 0.01), (40.0, 0.0125),
                                              (80.0, 0.0125), (30.0, 1.0 / 90.0)])  # fmt: skip
def test_a_scan_is_a_whole_number_of_the_controls_periods_of_about_ten_milliseconds(rate, period) -> None:
    scenario = adjusted(load_scenario("ahc_irregular"), rate, 0.0)
    assert (scenario.sensors.rate, scenario.duration) == (rate, load_scenario("ahc_irregular").duration)
    assert scenario.control_period == pytest.approx(period)
    assert (1.0 / rate / scenario.control_period) % 1.0 == pytest.approx(0.0, abs=1e-9)


def test_a_scenario_is_left_as_it_is_where_nothing_else_is_wanted() -> None:
    scenario = load_scenario("ahc_irregular")
    assert adjusted(scenario, 0.0, 0.0) == scenario
    longer = adjusted(scenario, 0.0, 7.5)
    assert (longer.duration, longer.sensors.rate, longer.control_period) == (
        7.5, scenario.sensors.rate, scenario.control_period,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("text", "pair"), [("a", ("a", 1.0)), ("a=", ("a", 1.0)), ("a=0.25", ("a", 0.25)), ("b=-2", ("b", -2.0))]
)
def test_a_hidden_effect_without_a_size_has_the_typical_one(text, pair) -> None:
    assert hidden_effects([text]) == [pair]


@pytest.mark.parametrize("text", ["a=b=2", "a=much"])
def test_a_size_is_all_that_stands_behind_the_first_equals_sign(text) -> None:
    with pytest.raises(InputError, match=f"^hidden effect '{text}': the size after = must be a number$"):
        hidden_effects([text])


def test_answers_are_each_topics_latest_and_the_late_ones_are_counted() -> None:
    answers = Answers(("a", "b"))
    assert answers.complete  # nothing is waited for yet
    assert not answers.overdue(1e9, 1.0)
    answers.expect(10.0, now=100.0)
    answers.take("a", 12.0)
    answers.take("a", 9.0)  # overtaken on its way
    answers.take("b", 10.0)
    assert answers.complete
    answers.expect(11.0, now=101.0)
    assert not answers.complete
    for now, late in ((101.9, False), (102.1, True), (103.0, True)):
        assert answers.overdue(now, 1.0) is late
    assert answers.unanswered == 2
    answers.clear()
    assert answers.complete
    answers.expect(5.0, now=1.0)  # of an earlier date: what was answered before counts no more
    assert not answers.complete
    assert Answers(()).complete


class Sailing:
    """A simulator that takes four steps to a scan and ends after eleven."""

    def __init__(self, scenario, crane, model, **given) -> None:
        self.given, self.time, self.torques, self.start_time = given, 0.0, [], scenario.start_time
        self.sailed = scenario

    @property
    def finished(self) -> bool:
        return len(self.torques) >= 11

    @property
    def fresh(self) -> bool:
        return len(self.torques) % 4 == 0

    def step(self, torque) -> None:
        self.torques.append(torque)
        self.time += 0.25

    @property
    def sample(self):
        return Sample(self.start_time + self.time, 5.0, 5.0)


def test_a_voyage_steps_with_the_torque_to_the_next_scan(monkeypatch) -> None:
    monkeypatch.setattr(of_nodes, "Simulator", Sailing)
    scenario = adjusted(load_scenario("ahc_irregular"), 0.0, 4.0).override({"start_time": 500.0})
    second = adjusted(scenario, 0.0, 8.0)
    voyage = Voyage(scenario, None, None, 7, [("wear_drift", 2.0)], [second])
    assert voyage._simulator.given == {"seed": 7, "hidden": [("wear_drift", 2.0)]}
    assert voyage.now == 0.25  # not begun: compiled by one step
    for legs, (leg, began) in enumerate(((scenario, 1000.0), (second, 1004.75), (scenario, 1009.5)), start=1):
        voyage.begin(1000.0)
        assert voyage.scenario == voyage._simulator.sailed == leg
        assert (voyage.now, voyage.elapsed, voyage.samples) == (pytest.approx(began), 0.0, 0)
        assert [voyage.advance(torque) for torque in (30.0, 40.0, 50.0)] == [True, True, False]
        assert voyage._simulator.torques == [30.0] * 4 + [40.0] * 4 + [50.0] * 3
        assert (voyage.samples, voyage.elapsed, voyage.finished) == (2, 2.75, True)
        assert voyage.progress == pytest.approx(2.75 / (8.0 if legs == 2 else 4.0))
        assert voyage.now == pytest.approx(began + 2.75)
        assert voyage.sample.time == pytest.approx(voyage.now)
