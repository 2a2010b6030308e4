"""A load cell that drifts while the estimator learns: the torque balance shows it, and nothing is learned from it."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from sea import CRANE, SEED, TOPICS

from winch_friction.online.compensator import CompensatorService
from winch_friction.online.estimator import EstimatorService
from winch_friction.online.load_balance import BALANCE_SHARE, BALANCE_TIME
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import term_named
from winch_friction.physics.signals import Sample
from winch_friction.records.topics import crane_topics
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SECONDS = 100.0
DRIFT = 0.3 / 60.0  # of the load, per second


@pytest.fixture(scope="module")
def sea() -> tuple[Sample, ...]:
    run = simulate(load_scenario("ahc_irregular").override({"duration": SECONDS}), CRANE, SEED, seed=3).run
    return tuple(each for each in run.samples() if each.motor_speed == each.motor_speed)


def fed(sea: tuple[Sample, ...], error: float = 0.0, rate: float = 0.0) -> Iterator[tuple[float, Sample]]:
    """The sea with a load cell that is off by `error` and drifts by `rate` per second."""
    for each in sea:
        passed = each.time - sea[0].time
        yield passed, replace(each, hook_load=each.hook_load * (1.0 + error + rate * passed), groups=dict(each.groups))


def test_a_load_cell_that_drifts_stops_the_learning_and_brings_the_seed_back(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    said, learned, words = 0.0, 0, ""
    for passed, sample in fed(sea, rate=DRIFT):
        service.take_row(sample)
        if service.contradiction and not said:
            said, learned, words = passed, service.law.counts["learned_from"], service.contradiction
    assert 0.8 * BALANCE_SHARE / DRIFT <= said - BALANCE_TIME <= 2.0 * BALANCE_SHARE / DRIFT
    assert "hook_load contradicts the balance" in words
    assert service.contradiction  # of more than two fifths by now
    assert service.law.counts["learned_from"] == learned > 500
    assert service.status(sea[-1].time)["state"] == "contradicted"
    assert {each.status for each in service.parameters()} <= {"invalid", "seed"}
    assert any(each.status == "invalid" for each in service.parameters())
    published = service.model_due(sea[-1].time)
    assert published is not None
    assert published.values == SEED.values
    assert service.law.model().values != SEED.values  # kept: it may have been right


def test_after_the_contradiction_it_learns_again_from_where_it_was(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea, error=0.25):
        if passed < 40.0:
            service.take_row(sample)
    assert service.contradiction
    learned = service.law.counts["learned_from"]
    for passed, sample in fed(sea):
        if passed >= 40.0:
            service.take_row(sample)
    assert not service.contradiction
    assert service.law.counts["learned_from"] > learned + 500
    published = service.model_due(sea[-1].time)
    assert published is not None
    assert published.values == service.law.model().values


def test_reset_forgets_the_contradiction_but_not_that_learning_is_switched_off(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea, error=0.25):
        if passed < 30.0:
            service.take_row(sample)
    assert service.contradiction
    service.set_enabled(False)
    service.reset()
    assert not service.contradiction
    assert not service.law.status()["enabled"]
    service.set_enabled(True)
    assert service.law.status()["enabled"]


@pytest.mark.parametrize("begin", [0.0, 15.0])
@pytest.mark.parametrize("load", [10e3, 55e3])
def test_nothing_is_learned_from_a_load_cell_that_is_dead(load: float, begin: float) -> None:
    """It shows exactly 0. With 10 t on the hook one parameter after the other had gone to the edge of its range, and
    with 55 t every sample was rejected: nothing was said of either."""
    scenario = load_scenario("ahc_irregular").override({"duration": begin + 20.0, "load": load})
    service, before = EstimatorService(CRANE, SEED, TOPICS), 0
    for sample in simulate(scenario, CRANE, SEED, seed=3).run.samples():
        dead = sample.time >= begin
        before = before if dead else service.law.counts["learned_from"]
        service.take_row(replace(sample, hook_load=0.0) if dead else sample)
    assert "hook_load contradicts" in service.contradiction
    assert service.status(sample.time)["state"] == "contradicted"
    assert service.law.counts["learned_from"] - before < 50 * (BALANCE_TIME + 2.0)
    published = service.model_due(sample.time)
    assert published is not None
    assert published.values == SEED.values


@pytest.mark.parametrize("load", [100.0, 1e3, 4e3])
def test_a_hook_that_is_all_but_empty_is_no_dead_load_cell(load: float) -> None:
    scenario = load_scenario("ahc_irregular").override({"duration": 30.0, "load": load})
    service = EstimatorService(CRANE, SEED, TOPICS)
    for sample in simulate(scenario, CRANE, SEED, seed=3).run.samples():
        service.take_row(replace(sample, hook_load=sample.hook_load + 40.0))  # a zero error: no share of nothing
        assert not service.contradiction


def test_a_dead_load_cell_in_the_rope_is_found_as_one_at_the_hook(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea):
        if passed < 10.0:
            force = sample.hook_load * GRAVITY if passed < 5.0 else 0.0
            service.take_row(replace(sample, hook_load=float("nan"), rope_force=force))
            assert passed >= 5.0 or not service.contradiction
    assert service.contradiction == "rope_force contradicts the drive torque"


def test_one_way_alone_friction_that_the_seed_does_not_know_is_no_error_of_the_load_cell() -> None:
    """The hook alone, hoisted for half a minute against 1.3 times the seed's friction, and then lowered: nothing tells
    friction from load before it is. It was contradicted after ten seconds, so that nothing was learned, for good."""
    stiff = SEED.with_values({name: 1.3 * SEED.value(name) for name in SEED.parameter_names if name != "C4"})
    run = simulate(load_scenario("experiment_zero_check"), CRANE, stiff, seed=5).run
    service = EstimatorService(CRANE, SEED, crane_topics(CRANE, run.groups))
    for sample in run.samples():
        service.take_row(sample)
        assert not service.contradiction
    assert service.law.counts["learned_from"] > 3000


def test_an_empty_hook_whose_cell_shows_a_little_less_than_nothing_contradicts_nothing(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea):
        if passed < 10.0:
            service.take_row(sample)
    scenario = load_scenario("ahc_irregular").override({"duration": 40.0, "load": 60.0})
    for sample in simulate(scenario, CRANE, SEED, seed=3).run.samples():
        service.take_row(replace(sample, time=sample.time + sea[0].time + 20.0, hook_load=-40.0))
        assert not service.contradiction


def test_a_load_cell_that_was_lost_contradicts_no_load_that_came_after_it(sea: tuple[Sample, ...]) -> None:
    """Its last word had been held against whatever hung there, for good."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea):
        if passed < 20.0:
            service.take_row(sample)
    learned = service.law.counts["learned_from"]
    scenario = load_scenario("ahc_irregular").override({"duration": 40.0, "load": 25e3})
    for sample in simulate(scenario, CRANE, SEED, seed=3).run.samples():
        service.take_row(replace(sample, time=sample.time + sea[0].time + 30.0, hook_load=float("nan")))
        assert not service.contradiction
    assert service.law.counts["learned_from"] > learned + 1000
    assert service.law.drum_torque == pytest.approx(CRANE.drum_torque(25e3), rel=0.05)


def test_a_wrong_load_cell_that_was_taken_out_is_not_held_against_anything(sea: tuple[Sample, ...]) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea, error=0.25):
        if passed == pytest.approx(40.0):
            assert service.contradiction.startswith("hook_load contradicts")
        lost = {"hook_load": float("nan")} if passed > 40.0 else {}
        service.take_row(replace(sample, **lost))
    assert not service.contradiction


def on_the_brake(sample: Sample, passed: float) -> Sample:
    """The load on the brake: the shaft stands still and the motors' lines are at boost pressure."""
    groups = {name: replace(each, pressure_a=25e5, pressure_b=25e5) for name, each in sample.groups.items()}
    return replace(sample, time=sample.time + passed, motor_speed=0.0, speed_reference=0.0, groups=groups)


def test_a_load_that_hangs_on_the_brake_is_no_dead_load_cell(sea: tuple[Sample, ...]) -> None:
    """The seed took the learned model's place at each stop, and nothing was fed forward for two seconds after it."""
    learning, feeding = EstimatorService(CRANE, SEED, TOPICS), CompensatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea):
        if passed < 15.0:
            learning.take_row(sample)
    for k in range(500):
        stopped = on_the_brake(sea[750], 0.02 * k)
        assert feeding.take_row(replace(stopped, groups=dict(stopped.groups))).valid
        learning.take_row(stopped)
        assert not learning.contradiction
    published = learning.model_due(stopped.time)
    assert published is not None
    assert published.values == learning.law.model().values != SEED.values


@pytest.mark.parametrize("error", [-0.05, 0.05])
def test_a_load_cell_a_few_per_cent_off_is_none(sea: tuple[Sample, ...], error: float) -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    for passed, sample in fed(sea, error=error):
        if passed < 50.0:
            service.take_row(sample)
            assert not service.contradiction


def test_an_estimator_says_which_input_of_its_model_is_missing(sea: tuple[Sample, ...]) -> None:
    term = term_named("viscosity_temperature")
    values = (*SEED.values, *(each.typical for each in term.parameters))
    service = EstimatorService(CRANE, replace(SEED, terms=(*SEED.terms, term), values=values, covariance=None), TOPICS)
    service.take_row(replace(sea[0], oil_temperature=float("nan")))
    assert service.missing == ("oil_temperature",)
    assert service.status(sea[0].time)["state"] == "waiting"


@pytest.mark.parametrize(("error", "said"), [(-0.083, "adds +9% to hook_load"), (0.0, "")])
def test_a_load_cell_that_is_off_by_less_than_stops_the_learning_is_said(
    sea: tuple[Sample, ...], error: float, said: str
) -> None:
    """Off by nine per cent it said nothing at all, and what depends on the load was fed forward by so much less."""
    service = EstimatorService(CRANE, SEED, TOPICS)
    for _, sample in fed(sea, error=error):
        service.take_row(sample)
    status = service.status(sea[-1].time)
    assert not service.contradiction
    assert said in status["suspicion"]
    assert bool(status["suspicion"]) is bool(said)
    assert status["load_apart"] == pytest.approx(-error, abs=0.02)
    learned = service.law.counts["learned_from"]
    assert learned > 1000, "it goes on learning"
