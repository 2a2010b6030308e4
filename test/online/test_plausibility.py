"""What this crane cannot show is refused, named and faded; what contradicts itself too."""

import math
from collections.abc import Callable

import pytest
from sea import CRANE, PERIOD, SEED, TOPICS, Fed, check_invariants, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.signals import Sample
from winch_friction.records.bag_write import MESSAGES


def _set(sample: Sample, column: str, value: float) -> None:
    group, _, name = column.rpartition(".")
    setattr(sample.groups[group] if group else sample, name, value)


IMPLAUSIBLE = [
    ("active.displacement", 25.0 * CRANE.max_displacement),
    ("active.displacement", -25.0 * CRANE.max_displacement),
    ("passive.pressure_a", 1.9e8),
    ("hook_load", 9.9e6),
    ("speed_reference", 2999.0),
    ("motor_speed", 2999.0),
]


@pytest.mark.parametrize(("column", "value"), IMPLAUSIBLE)
def test_an_implausible_input_is_refused_named_and_not_obeyed(column: str, value: float) -> None:
    fed = Fed()
    fed.run(1.4)
    usual = max(abs(said.friction_torque) for _, said in fed.published)
    said = fed.run(3.0, lambda sample: _set(sample, column, value))
    assert max(abs(each.friction_torque) for each in said) < 1.2 * usual
    topic = next(t for t, source in TOPICS.inputs.items() if column in source.channels)
    arrivals = fed.service.inputs.arrivals[topic]
    assert arrivals.refused > 100
    assert column in arrivals.reason
    if column != "hook_load":  # without it the load comes from the pressures
        assert said[-1].friction_torque == 0.0
    fed.run(2.0)
    assert fed.service.law.status()["state"] == "active"
    check_invariants(fed)


def test_a_spike_within_the_range_is_too_fast_to_be_true() -> None:
    fed = Fed()
    fed.run(1.4)
    calm = fed.run(PERIOD)[-1].speed
    fed.run(PERIOD, lambda sample: _set(sample, "speed_reference", 590.0))
    assert abs(fed.published[-1][1].speed - calm) < 20.0
    check_invariants(fed)


def test_a_reference_of_the_opposite_sign_is_doubted() -> None:
    fed = Fed()
    fed.run(1.4)
    said = fed.run(8.0, lambda sample: _set(sample, "speed_reference", -sample.speed_reference))
    assert "contradicts motor_speed" in " ".join(fed.service.contradictions)
    assert {each.friction_torque for each in said[150:]} == {0.0}  # at the reversals too, where nothing is to be seen
    check_invariants(fed)


@pytest.mark.parametrize(
    ("size", "spoil"),
    [
        (0.3, lambda reference, _: -reference),  # below what the difference of the speeds would show
        (1.0, lambda reference, _: -reference),
        (0.3, lambda _, first: first),  # stuck
        (0.3, lambda _, first: 0.05 * first),
    ],
)
@pytest.mark.parametrize("lead", [0.0, 0.1])
def test_nothing_pushes_against_the_motion_for_long(
    size: float, spoil: Callable[[float, float], float], lead: float
) -> None:
    fed = Fed(config=CompensatorConfig(lead=lead))
    fed.run(1.4, lambda sample: _slower(sample, size))
    first: list[float] = []

    def change(sample: Sample) -> None:
        _slower(sample, size)
        first.append(sample.speed_reference)
        sample.speed_reference = spoil(sample.speed_reference, first[0])

    longest = wrong = 0.0
    for _ in range(400):
        (said, *_) = fed.run(PERIOD, change)
        speed = size * swell(fed.now).motor_speed
        wrong = wrong + PERIOD if said.friction_torque * speed < 0.0 and abs(speed) > 5.0 else 0.0
        longest = max(longest, wrong)
    assert "turns against motor_speed" in " ".join(fed.service.contradictions)
    assert longest <= lead + 0.25
    fed.run(5.0, lambda sample: _slower(sample, size))
    assert fed.service.law.status()["state"] == "active"
    check_invariants(fed)


@pytest.mark.parametrize("left", [0.04, 0.08, 0.1])
def test_what_is_left_against_the_motion_goes_at_once_when_the_speed_falls_silent(left: float) -> None:
    """A wrong command for a moment, then nothing any more: what it left had faded out over the whole ramp time."""
    fed = Fed(config=CompensatorConfig(ramp_time=1.0))
    fed.run(1.4)
    fed.run(left, lambda sample: setattr(sample, "speed_reference", -sample.speed_reference))
    assert fed.torque * swell(fed.now).motor_speed < 0.0
    began = fed.now
    while fed.torque * swell(fed.now).motor_speed < 0.0 and fed.now - began < 1.0:
        fed.wait(PERIOD)
    assert fed.now - began <= fed.options.watchdog_timeout + 0.1 + PERIOD
    check_invariants(fed)


def _slower(sample: Sample, size: float) -> None:
    sample.motor_speed *= size
    sample.speed_reference *= size


def test_two_references_that_take_turns_are_doubted() -> None:
    fed = Fed()
    fed.run(1.4)
    turn = iter(range(1000))

    def other(sample: Sample) -> None:
        _set(sample, "speed_reference", sample.speed_reference * (-1.0) ** next(turn))

    said = fed.run(1.6, other)
    assert "to and fro" in " ".join(fed.service.contradictions)
    assert min(abs(each.friction_torque) for each in said[-30:]) < 10.0
    check_invariants(fed)


def test_a_load_in_tonnes_is_doubted() -> None:
    fed = Fed()
    said = fed.run(4.0, lambda sample: _set(sample, "hook_load", 55.0))
    assert "hook_load contradicts" in " ".join(fed.service.contradictions)
    assert said[-1].friction_torque == 0.0


def test_the_estimator_does_not_learn_from_what_the_crane_cannot_show() -> None:
    service = EstimatorService(CRANE, SEED, TOPICS)
    now = 1000.0

    def feed(seconds: float, displacement: float = 1.0) -> None:
        nonlocal now
        for _ in range(round(seconds / PERIOD)):
            now += PERIOD
            sample = swell(now)
            sample.groups["active"].displacement *= displacement
            for topic, message in TOPICS.encode(sample, MESSAGES):
                service.take(TOPICS.inputs[topic], message, now, now)

    feed(10.0)
    feed(0.2, displacement=25.0)  # what was held before is still young
    before = service.law.model().values
    feed(3.0, displacement=25.0)
    assert service.law.model().values == before
    assert service.status(now)["state"] == "waiting"
    assert service.missing == ("active.displacement",)
    assert math.isnan(service.last.friction_torque)
