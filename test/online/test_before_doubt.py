"""What is learned while a load cell lies and nobody has noticed yet is neither published nor kept."""

import json
import math
from collections.abc import Iterator
from dataclasses import replace

import pytest
from sea import CRANE, SEED, TOPICS

from winch_friction.estimation import FrictionEstimator
from winch_friction.estimation.dynamics import LOAD
from winch_friction.online.before_doubt import WIRE_UNSEEN
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import Sample
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

TRUTH = SEED.with_values({name: 1.2 * SEED.value(name) for name in SEED.parameter_names if name != "C4"})
WRONG_FROM = 40.0  # s


@pytest.fixture(scope="module")
def sea() -> tuple[Sample, ...]:
    run = simulate(load_scenario("ahc_irregular").override({"duration": 80.0}), CRANE, TRUTH, seed=3).run
    return tuple(each for each in run.samples() if each.motor_speed == each.motor_speed)


def fed(sea: tuple[Sample, ...], begin: float, end: float, error: float) -> Iterator[Sample]:
    """The sea from `begin` to `end` s with a load cell that is off by `error`."""
    for each in sea:
        if begin <= each.time - sea[0].time < end:
            yield replace(each, hook_load=each.hook_load * (1.0 + error), groups=dict(each.groups))


def published(service: EstimatorService, samples: Iterator[Sample]) -> list[FrictionModel]:
    """The models that are published meanwhile, what is said first left out."""
    found = []
    for sample in samples:
        service.take_row(sample)
        if (model := service.model_due(sample.time)) is not None:
            found.append(model)
    return found


@pytest.mark.parametrize("error", [-0.5, -0.15, 0.15, 0.5])
def test_a_load_cell_that_was_wrong_from_the_first_sample_has_taught_nothing(
    sea: tuple[Sample, ...], error: float
) -> None:
    """After five seconds models with a friction wrong by up to a fifth were published, until it was contradicted after
    fourteen; they were kept, twelve of their sigmas off, and published again once the cell was right."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    said = published(service, fed(sea, 0.0, 30.0, error))
    assert service.contradiction
    assert len(said) == 6
    assert all(model.values == SEED.values for model in said)
    assert service.law.model().values == SEED.values
    assert service.law.model().std == pytest.approx(SEED.std)
    for sample in fed(sea, 30.0, 80.0, 0.0):
        service.take_row(sample)
    assert not service.contradiction
    apart = [abs(p.value - TRUTH.value(p.name)) / p.std for p in service.parameters()]
    assert max(apart) < 4.0


def test_what_was_learned_before_the_load_cell_failed_is_published_until_it_is_said_and_kept(
    sea: tuple[Sample, ...],
) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    before = published(service, fed(sea, 0.0, WRONG_FROM, 0.0))[-2:]
    assert before[-1].values != SEED.values
    meanwhile = published(service, fed(sea, WRONG_FROM, WRONG_FROM + 8.0, -0.3))
    assert not service.contradiction
    assert meanwhile[-1].values in [model.values for model in before]
    kept = json.loads(json.dumps(service.snapshot()))
    published(service, fed(sea, WRONG_FROM + 8.0, WRONG_FROM + 20.0, -0.3))
    assert service.contradiction
    assert service.law.model().values == pytest.approx(meanwhile[-1].values)

    again = EstimatorService(CRANE, SEED, TOPICS)
    again.restore(kept)
    assert again.law.model().values == pytest.approx(meanwhile[-1].values)
    said = published(again, fed(sea, WRONG_FROM + 20.0, WRONG_FROM + 40.0, -0.3))
    assert again.contradiction
    assert said[1].values == pytest.approx(meanwhile[-1].values)
    assert said[-1].values == SEED.values
    assert again.law.model().values == pytest.approx(meanwhile[-1].values)


def test_reset_forgets_what_was_believed(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    published(service, fed(sea, 0.0, WRONG_FROM, 0.0))
    service.reset()
    said = published(service, fed(sea, WRONG_FROM, WRONG_FROM + 20.0, -0.4))
    assert service.contradiction
    assert all(model.values == SEED.values for model in said)


def test_taking_back_keeps_shaft_wire_and_load_and_the_seeds_sigma_again(sea: tuple[Sample, ...]) -> None:
    law = FrictionEstimator(CRANE, SEED)
    samples = list(fed(sea, 0.0, 30.0, 0.0))
    law.step(samples[0])
    kept = law.snapshot()
    for sample in samples[1:-1]:
        law.step(sample)
    assert law.status()["seed"] == "refuted"
    load, counts = law.drum_torque, dict(law.counts)
    law.take_back(kept)
    assert law.model().values == SEED.values
    assert law.model().std == pytest.approx(SEED.std)
    assert {each.status for each in law.parameters()} == {"seed"}
    assert law.status()["seed"] == "holds"
    assert law.drum_torque == load
    assert law.counts == counts
    # what friction that is not believed made of the load is as uncertain as a load that begins
    assert law._filter.P[LOAD, LOAD] == pytest.approx((law.config.load_std * load / CRANE.gear_ratio) ** 2)
    assert law.step(samples[-1]).accepted
    assert law.drum_torque == pytest.approx(load, rel=law.config.load_std)


def of_both_speeds(sea: tuple[Sample, ...], begin: float, end: float, times: float) -> Iterator[Sample]:
    """The sea from `begin` to `end` s with a speed and a command that are both `times` what they are."""
    for each in fed(sea, begin, end, 0.0):
        yield replace(each, motor_speed=times * each.motor_speed, speed_reference=times * each.speed_reference)


def test_what_a_speed_that_the_wire_contradicts_has_taught_is_taken_back(sea: tuple[Sample, ...]) -> None:
    """It takes two waves and more to show, and only the last five seconds of them were taken back: with a speed of 1.6
    times what it is a parameter stood 8 of its sigmas off, and was learned on from there and published, `converged`."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    published(service, fed(sea, 0.0, WRONG_FROM, 0.0))
    published(service, of_both_speeds(sea, WRONG_FROM, 80.0, 1.6))
    assert service.contradiction.startswith("motor_speed contradicts wire_out")
    assert service.law.model().values == SEED.values  # within a minute there is nothing else to go back to


def test_more_is_taken_back_where_a_doubt_joins_that_takes_longer_to_show(monkeypatch: pytest.MonkeyPatch) -> None:
    service, told = EstimatorService(CRANE, SEED, TOPICS), list[float]()
    monkeypatch.setattr(service._before, "go_back", told.append)
    for said, seconds in (("cell", 0.0), ("cell", 0.0), ("cell", WIRE_UNSEEN), ("wire", 0.0), ("gain", math.inf)):
        service.contradiction = said
        service._take_back(seconds)
    assert told == [0.0, WIRE_UNSEEN, math.inf]
    service.contradiction = ""
    service._take_back(0.0)
    service.contradiction = "cell"
    service._take_back(0.0)
    assert told[3:] == [0.0]
    service.reset()
    service.contradiction = "cell"
    service._take_back(0.0)
    assert told[4:] == [0.0]


def of_the_speed(sea: tuple[Sample, ...], begin: float, end: float, times: float) -> Iterator[Sample]:
    """The sea from `begin` to `end` s, without wire and load cell, with a speed that is `times` what it is."""
    for each in fed(sea, begin, end, 0.0):
        yield replace(each, motor_speed=times * each.motor_speed, hook_load=math.nan, wire_out=math.nan)


@pytest.mark.parametrize(("times", "said"), [(0.1, "contradicts"), (-1.0, "turns against")])
def test_what_a_speed_that_its_command_contradicts_has_taught_is_taken_back(
    sea: tuple[Sample, ...], times: float, said: str
) -> None:
    """The compensator let such a speed go; the estimator learned from it, and K2 stood 13.7 of its sigmas off."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    published(service, of_the_speed(sea, 0.0, WRONG_FROM, 1.0))
    assert not service.contradiction
    published(service, of_the_speed(sea, WRONG_FROM, 60.0, times))
    assert service.contradiction == f"speed_reference {said} motor_speed"
    assert service.law.model().values == SEED.values  # within a minute there is nothing else to go back to
    published(service, of_the_speed(sea, 60.0, 80.0, 1.0))
    assert service.contradiction  # a part of each wave agrees, whatever is wrong


def test_a_command_that_is_half_a_second_ahead_or_absent_stops_no_learning(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    samples = list(of_the_speed(sea, 0.0, WRONG_FROM, 1.0))
    for sample, ahead in zip(samples, samples[20:], strict=False):  # 0.4 s
        service.take_row(replace(sample, speed_reference=ahead.speed_reference, groups=dict(sample.groups)))
        assert not service.contradiction
    for sample in of_the_speed(sea, WRONG_FROM, 60.0, 1.0):
        service.take_row(replace(sample, speed_reference=math.nan))
        assert not service.contradiction


def test_once_a_doubt_is_over_the_load_is_as_uncertain_as_one_that_begins(sea: tuple[Sample, ...]) -> None:
    """What was found of it meanwhile is of what was wrong: a tenth of a load was blamed on the friction, 6.5 sigmas."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    published(service, of_the_speed(sea, 0.0, 30.0, 1.0))
    service.contradiction = "a doubt"
    service._take_back(0.0)
    published(service, iter(()))
    law = service.law
    law._filter.P[LOAD, LOAD] = 0.0
    service.contradiction = ""
    service._take_back(0.0)
    assert law._filter.P[LOAD, LOAD] == pytest.approx((law.config.load_std * law.drum_torque / CRANE.gear_ratio) ** 2)
    law._filter.P[LOAD, LOAD] = 0.0
    service._take_back(0.0)
    assert law._filter.P[LOAD, LOAD] == 0.0
