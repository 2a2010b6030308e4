"""The gain of the drive's torque: a displacement that drifts moves friction and inertia alike, friction does not."""

import itertools
import math
import random
from collections.abc import Callable, Iterator
from dataclasses import replace

import pytest
from sea import CRANE, SEED, TOPICS

from winch_friction.online.estimator import EstimatorService
from winch_friction.online.inertia_balance import CHANGED, FIRST, InertiaBalance
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.crane import Drive, Drum

PERIOD, LOAD = 0.02, 55e3  # s, kg
DISPLACEMENT = 3e-5  # m^3/rad
CHANGE_AT, SECONDS = 100.0, 200.0  # s


def sailed(
    friction: Callable[[float], float], shown: Callable[[float], float],
    inertia: Callable[[float], float] = lambda _: 1.0, compensated: Callable[[float], float] = lambda _: 1.0,
    load: float = LOAD,
) -> Iterator[Sample]:  # fmt: skip
    """Heave compensation by plain formulas: `friction` and `inertia` scale theirs, `shown` is the displacement that is
    logged over the true one, `compensated` the share of the wire's motion that the crane tip makes up for, all over
    time.
    """
    lever = CRANE.drum.radius(math.nan) / CRANE.gear_ratio
    for k in range(int(SECONDS / PERIOD)):
        time = k * PERIOD
        phases = (2.0 * math.pi * time / 8.0, 2.0 * math.pi * time / 5.3 + 1.0)
        speed = 80.0 * math.sin(phases[0]) + 40.0 * math.sin(phases[1])
        rate = 80.0 * 0.7854 * math.cos(phases[0]) + 40.0 * 1.1855 * math.cos(phases[1])
        torque = inertia(time) * CRANE.inertia * rate + friction(time) * (300.0 * math.tanh(speed / 3.0) + 1.5 * speed)
        torque += load * lever**2 * rate * (1.0 - compensated(time))
        held = CRANE.drum_torque(load, math.nan) / CRANE.gear_ratio / (CRANE.motor_count("passive") * DISPLACEMENT)
        drop = torque / (CRANE.motor_count("active") * DISPLACEMENT)
        yield Sample(
            time=time, motor_speed=speed, hook_load=load, heave_velocity=-lever * speed * compensated(time),
            groups={
                "active": GroupSample(drop + 20e5, 20e5, DISPLACEMENT * shown(time)),
                "passive": GroupSample(held + 20e5, 20e5, DISPLACEMENT),
            },
        )  # fmt: skip


def said(samples: Iterator[Sample]) -> tuple[float, float, str]:
    """When it first spoke, s (NaN: never), the largest change of gain that it saw, and its words."""
    balance, first, words, largest = InertiaBalance(CRANE), math.nan, "", 0.0
    for sample in samples:
        told = balance.contradiction(sample)
        largest = max(largest, abs(balance.change)) if balance.change == balance.change else largest
        if told and not words:
            first, words = sample.time, told
    return first, largest, words


same = lambda _time: 1.0
stepped = lambda to: lambda time: to if time > CHANGE_AT else 1.0


def test_a_displacement_that_is_off_is_told_within_a_minute():
    first, largest, words = said(sailed(same, lambda time: 1.0 - 0.2 * (time > CHANGE_AT)))
    assert CHANGE_AT < first < CHANGE_AT + 60.0
    assert largest > CHANGED
    assert "displacement or pressures" in words


def test_it_sees_a_load_by_its_rope_as_well():
    """A crane that measures the rope's force and no hook load had no such check."""
    by_rope = (
        replace(each, hook_load=math.nan, rope_force=LOAD * GRAVITY)
        for each in sailed(same, lambda time: 1.0 - 0.2 * (time > CHANGE_AT))
    )
    assert CHANGE_AT < said(by_rope)[0] < CHANGE_AT + 60.0


def test_the_noise_of_a_load_cell_under_a_light_load_is_no_other_load():
    """0.15 t of a cell for 300 t, with 2 t on the hook: each sample had begun everything anew."""
    balance, rng = InertiaBalance(CRANE), random.Random(1)
    light = itertools.takewhile(lambda each: each.time < FIRST + 5.0, sailed(same, same, load=2e3))
    for sample in light:
        balance.contradiction(replace(sample, hook_load=2e3 + rng.gauss(0.0, 150.0)))
    assert abs(balance.change) < CHANGED


def test_it_looks_at_a_log_of_5_hz_as_well():
    """Its step was as long as the longest that counted: every sample began the smoothing anew."""
    slow = slice(0, None, round(0.2 / PERIOD))
    drifting = list(sailed(same, lambda time: 1.0 - 0.2 * (time > CHANGE_AT)))[slow]
    assert CHANGE_AT < said(iter(drifting))[0] < CHANGE_AT + 60.0
    first, largest, _ = said(itertools.islice(sailed(stepped(1.3), same), 0, None, slow.step))
    assert math.isnan(first)
    assert largest > 0.0


@pytest.mark.parametrize("by", [-3600.0, pytest.param(3600.0, marks=pytest.mark.long)])
def test_a_clock_that_is_set_makes_no_gain_true_again(by):
    """The first minute after it had become the one to compare with, and the wrong displacement the right one."""
    service, set_at = EstimatorService(CRANE, SEED, TOPICS), 0.85 * SECONDS
    for sample in itertools.islice(sailed(same, lambda time: 1.0 - 0.2 * (time > CHANGE_AT)), 0, None, 2):
        if set_at < sample.time <= set_at + 2.0 * PERIOD:
            assert "displacement or pressures" in service.contradiction
            service.forget()
        sample.time += by * (sample.time > set_at)
        service.take_row(sample)
    assert "displacement or pressures" in service.contradiction


def test_the_service_declares_it_and_publishes_the_seed():
    """It looked at what the filter took in alone: the reversals lacked, and 20 % were 26 %, said after 47 s."""
    service, first = EstimatorService(CRANE, SEED, TOPICS), math.nan
    for sample in sailed(same, lambda time: 1.0 - 0.2 * (time > CHANGE_AT)):
        service.take_row(sample)
        if service.contradiction and math.isnan(first):
            first = sample.time
    assert first < CHANGE_AT + 35.0
    assert service.gain_change == pytest.approx(-0.2, abs=0.02)
    assert "changed its gain" in service.contradiction
    assert service.status(SECONDS)["state"] == "contradicted"
    published = service.model_due(SECONDS)
    assert published is not None
    assert published.values == SEED.values
    service.reset()
    assert not service.contradiction
    assert math.isnan(service.gain_change)  # what it is compared with is forgotten as well


@pytest.mark.parametrize("friction", [same, stepped(1.3), stepped(0.7), lambda time: 1.0 - 0.3 * time / SECONDS])
def test_friction_that_changes_is_no_gain(friction):
    first, largest, _ = said(sailed(friction, same))
    assert math.isnan(first)
    assert largest < CHANGED


def test_an_inertia_that_changes_alone_is_no_gain():
    """What is accelerated may be more than before; a gain would have moved the friction alike."""
    first, largest, _ = said(sailed(same, same, inertia=stepped(1.3)))
    assert largest > CHANGED
    assert math.isnan(first)


def test_a_load_that_is_accelerated_at_first_and_then_hangs_still_is_no_gain():
    """Lifted at first by a crane at rest, then held against a sea: the load's inertia is known, and taken out."""
    first, largest, _ = said(sailed(same, same, compensated=lambda time: float(time > CHANGE_AT)))
    assert math.isnan(first)
    assert largest < CHANGED


def test_another_load_begins_anew():
    balance = InertiaBalance(CRANE)
    for sample in sailed(same, same):
        if sample.time > FIRST + 5.0:
            break
        balance.contradiction(sample)
    assert balance.change == pytest.approx(0.0, abs=0.01)
    sample.hook_load = 1.2 * LOAD
    balance.contradiction(sample)
    assert math.isnan(balance.change)


# -- wrong from the beginning
PER_RADIAN = 1.0 / (2.0 * math.pi)  # a displacement in cm3/rad that is read as cm3/rev
SEED_FRICTION = 300.0  # N m, of `sailed` at its typical speed


def said_from_the_beginning(samples: Iterator[Sample], expected: float = SEED_FRICTION) -> str:
    balance = InertiaBalance(CRANE, lambda _sample, _speed: expected)
    return [balance.contradiction(each) for each in samples if each.time < FIRST + 20.0][-1]


@pytest.mark.parametrize("times", [PER_RADIAN, 2.0 * math.pi], ids=["per radian", "per turn"])
def test_a_displacement_in_another_unit_from_the_beginning_is_no_gain(times):
    """Its friction was learned as far as the seed's range lets it, and the compensator took that over."""
    assert "displacement or pressures in another unit" in said_from_the_beginning(sailed(same, lambda _: times))


def test_friction_or_inertia_alone_that_nobody_expects_is_a_winch_and_no_unit():
    third = lambda _time: 1.0 / 3.0
    assert not said_from_the_beginning(sailed(third, same))
    assert not said_from_the_beginning(sailed(same, same, inertia=third))
    assert not said_from_the_beginning(sailed(same, lambda _: PER_RADIAN), expected=0.0)  # a seed without friction
    assert not said_from_the_beginning(sailed(same, lambda _: 0.6))  # a spread, whatever is to blame


def test_what_was_learned_with_a_unit_that_is_none_is_taken_back_to_the_beginning():
    """It had stood in the checkpoint and in the model that the compensator takes over."""
    service, right_from = EstimatorService(CRANE, SEED, TOPICS), FIRST + 30.0
    began = service.law.model().values
    for sample in sailed(same, lambda time: PER_RADIAN if time < right_from else 1.0):
        if sample.time >= right_from and "another unit" in service.contradiction:
            assert service.law.model().values == pytest.approx(began, rel=1e-12)
            assert service.model_due(sample.time).values == SEED.values
            assert {each.status for each in service.parameters()} <= {"invalid", "seed"}
            break
        service.take_row(sample)
    else:
        pytest.fail("nothing was said")


# -- an electric drive
ELECTRIC = replace(
    CRANE, drive=Drive("electric"), groups={}, inertia=0.4, gear_ratio=40.0, drum=Drum((0.25,)), rated_load=5e3,
    max_displacement=0.0, rated_pressure=0.0,
)  # fmt: skip


def driven(shown: Callable[[float], float], friction: Callable[[float], float], load: float = 3e3) -> Iterator[Sample]:
    """A 5 t winch; `shown` is the torque that is read over the true one."""
    lever = ELECTRIC.drum.radius(math.nan) / ELECTRIC.gear_ratio
    for k in range(int(SECONDS / PERIOD)):
        time = k * PERIOD
        speed = 90.0 * math.sin(2.0 * math.pi * time / 7.0) + 30.0 * math.sin(2.0 * math.pi * time / 4.3)
        rate = 80.78 * math.cos(2.0 * math.pi * time / 7.0) + 43.84 * math.cos(2.0 * math.pi * time / 4.3)
        torque = (ELECTRIC.inertia + load * lever**2) * rate + friction(time) * (
            8.0 * math.tanh(speed / 3.0) + 0.05 * speed
        )
        torque += ELECTRIC.drum_torque(load) / ELECTRIC.gear_ratio
        yield Sample(time, speed, motor_torque=shown(time) * torque, hook_load=load)


def test_a_motor_torque_that_is_off_is_told_as_well():
    """A constant that is another after maintenance, an amplifier that is warm: hydraulic drives alone had it."""
    balance = InertiaBalance(ELECTRIC)
    told = [balance.contradiction(each) for each in driven(stepped(0.8), same)]
    assert "motor_torque" in told[-1]
    assert not any(told[: round(CHANGE_AT / PERIOD)])


def test_friction_that_changes_on_an_electric_drive_is_no_gain():
    balance = InertiaBalance(ELECTRIC)
    assert not any(balance.contradiction(each) for each in driven(same, stepped(1.4)))
