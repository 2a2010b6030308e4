"""When a learned model takes effect: the newest that is due, never before its time, and none across a jump of time."""

from dataclasses import replace

import pytest

from winch_friction.online.compensator import LEARNED_AT, MOST_WAITING, ModelSchedule
from winch_friction.records.model_file import load_model

SEED = load_model("a6vm215_crane1")


def learned(at: float):
    return replace(SEED, name=f"learned at {at:g}", provenance={LEARNED_AT: at})


def test_of_several_models_that_are_due_the_newest_takes_effect_and_the_older_ones_never():
    schedule = ModelSchedule(0.5)
    for at in (12.0, 10.0, 11.0):
        schedule.offer(learned(at))
    found = schedule.due(11.6)
    assert found is not None
    assert found.name == "learned at 11"
    assert schedule.due(11.6) is None
    found = schedule.due(12.5)
    assert found is not None
    assert found.name == "learned at 12"


@pytest.mark.parametrize(("time", "there"), [(10.49, False), (10.5, True)])
def test_a_model_waits_for_its_delay_and_no_longer(time, there):
    schedule = ModelSchedule(0.5)
    schedule.offer(learned(10.0))
    assert (schedule.due(time) is not None) is there


def test_a_model_without_a_date_takes_effect_at_once():
    schedule = ModelSchedule(0.5)
    schedule.offer(SEED)
    assert schedule.due(0.0) is SEED


def test_what_waits_is_forgotten_after_a_jump_of_time():
    schedule = ModelSchedule(0.5)
    schedule.offer(learned(10.0))
    schedule.clear()
    assert schedule.due(1e9) is None


def test_models_of_a_time_to_come_do_not_pile_up_nor_hold_up_those_of_today():
    schedule = ModelSchedule(0.5)
    for k in range(3 * MOST_WAITING):
        schedule.offer(learned(1e12 + k))
    schedule.offer(learned(10.0))
    assert len(schedule._waiting) == MOST_WAITING
    found = schedule.due(11.0)
    assert found is not None
    assert found.name == "learned at 10"
