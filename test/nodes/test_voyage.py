"""A sea that is sailed again while the time goes on, and the answers that lockstep waits for."""

import weakref

import pytest

from winch_friction.nodes.voyage import Answers, Voyage, adjusted, hidden_effects
from winch_friction.physics.errors import InputError
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
