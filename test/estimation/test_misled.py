"""What an estimator makes of data that lie: it stays around its seed, says so, and finds back."""

import copy
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from driven_winch import rigid_samples

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.physics.channels import BAR
from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.seed_range import seed_range
from winch_friction.physics.signals import GroupSample
from winch_friction.physics.winch import sample_operating_point

CONFIG = EstimatorConfig(speed_step=0.0, speed_noise=0.1, wire_length=5.0)
DURATION = 40.0


def samples(crane, truth, start=0.0, duration=DURATION, noise=3):
    for sample in rigid_samples(crane, truth, amplitude=150.0, duration=duration, noise=noise, speed_noise=0.1):
        sample.time += start
        yield sample


def drifting(each):
    """A transducer that reads 1 bar more every second."""
    for sample in each:
        sample.groups["main"].pressure_a += 1.0 * BAR * sample.time
        yield sample


def stuck(each):
    """A swash plate that stays where it is reported not to be: a quarter of the displacement is missing."""
    for sample in each:
        sample.groups["main"].displacement *= 1.33
        yield sample


def frozen_pressure(each):
    """A gauge that has stopped, on the side that works."""
    first = None
    for sample in each:
        first = first or copy.copy(sample.groups["main"])
        sample.groups["main"] = GroupSample(
            first.pressure_a, sample.groups["main"].pressure_b, sample.groups["main"].displacement
        )
        yield sample


def twice(crane, seed):
    return samples(crane, seed.with_values({n: 2.0 * seed.value(n) for n in seed.parameter_names if n != "C4"}))


MISLED = {
    "another crane": twice,
    "drift": lambda crane, seed: drifting(samples(crane, seed)),
    "stuck valve": lambda crane, seed: stuck(samples(crane, seed)),
    "frozen pressure": lambda crane, seed: frozen_pressure(samples(crane, seed)),
}


def friction(model, crane, sample, speed):
    x = sample_operating_point(sample, crane, drum_torque=crane.drum_torque(55e3), speed=speed)
    return float(model.torque(x))


@pytest.mark.slow
@pytest.mark.parametrize("how", MISLED)
def test_the_published_model_stays_around_the_seed_and_the_seed_comes_back(crane, seed, how):
    each = FrictionEstimator(crane, seed, CONFIG)
    allowed = seed_range(seed, CONFIG.seed_range)
    for count, sample in enumerate(MISLED[how](crane, seed)):
        each.step(sample)
        if count % 50 == 0:
            for name, value in each.model().as_dict().items():
                assert allowed[name][0] <= value <= allowed[name][1]
    if how == "another crane":
        assert "invalid" in {p.status for p in each.parameters()}
        assert each.status()["seed"] == "refuted"
    last = sample.time
    for sample in samples(crane, seed, start=last + 0.02, duration=2.5 * DURATION, noise=5):
        each.step(sample)
    for speed in (40.0, 140.0, -140.0):
        wanted = friction(seed, crane, sample, speed)
        assert friction(each.model(), crane, sample, speed) == pytest.approx(wanted, rel=0.1)
    each.reset()
    assert each.model().values == seed.values
    assert {p.status for p in each.parameters()} == {"seed"}


@pytest.mark.parametrize("lost", ["pressure_a", "pressure_b", "displacement"])
def test_nothing_is_learned_while_an_input_is_missing(crane, seed, lost):
    each = FrictionEstimator(crane, seed, CONFIG)
    whole = list(samples(crane, seed, duration=20.0))
    for sample in whole[:500]:
        each.step(sample)
    before, learned_from = each.model(), each.counts["learned_from"]
    for sample in whole[500:800]:
        setattr(sample.groups["main"], lost, float("nan"))
        assert each.step(sample).state == "rejected"
    assert each.model().values == before.values
    assert np.array_equal(each.model().covariance, before.covariance)
    assert each.counts["learned_from"] == learned_from


@pytest.mark.slow
def test_the_covariance_stays_positive_definite_over_many_steps(crane, seed):
    each = FrictionEstimator(crane, seed, CONFIG)
    minute = list(samples(crane, seed, duration=60.0))
    for number, sample in zip(range(12_000), itertools.cycle(minute), strict=False):
        again = copy.copy(sample)
        again.time = number * 0.02
        each.step(again)
        if number % 2000 == 0:
            scale = np.sqrt(np.diag(each._filter.P))
            kept = scale > 0.0
            correlation = each._filter.P[np.ix_(kept, kept)] / np.outer(scale[kept], scale[kept])
            assert np.linalg.eigvalsh(correlation).min() > 0.0
    assert each.counts["accepted"] > 11_200


@pytest.mark.parametrize(
    ("term", "channel"), [("viscosity_temperature", "oil_temperature"), ("torque_ripple", "shaft_angle")]
)
def test_what_a_term_reads_is_not_made_up_where_it_is_lost(crane, seed, term, channel):
    """Oil of 20 degC taken for one of 40 would be learned as another friction."""
    more = term_named(term)
    values = (*seed.values, *(each.typical for each in more.parameters))
    reading = replace(seed, terms=(*seed.terms, more), values=values, covariance=np.diag(np.square(values)) * 0.01)
    each = FrictionEstimator(crane, reading, CONFIG)
    whole = list(samples(crane, seed, duration=8.0))
    for sample in whole[:200]:
        setattr(sample, channel, 20.0)
        assert each.step(sample).accepted
    learned_from = each.counts["learned_from"]
    assert learned_from > 100
    for sample in whole[200:]:
        assert each.step(sample).state == "rejected"
    assert each.counts["learned_from"] == learned_from


@pytest.mark.parametrize("shown", [False, True], ids=["no load cell", "a load cell that has died since"])
def test_another_load_that_nobody_shows_does_not_lock_the_gate(crane, seed, shown):
    """What hangs there is changed while the winch is off; the first sample after that is of another balance."""
    each = FrictionEstimator(crane, seed, CONFIG)
    for start, load in ((0.0, 55e3), (100.0, 20e3), (200.0, 80e3)):
        rejected = each.counts["rejected"]
        for sample in rigid_samples(crane, seed, amplitude=150.0, duration=20.0, noise=3, speed_noise=0.1, load=load):
            sample.time += start
            if start or not shown:
                sample.hook_load = math.nan
            each.step(sample)
        assert each.counts["rejected"] - rejected < 50  # of a thousand
        assert each.drum_torque == pytest.approx(crane.drum_torque(load), rel=0.02)


def test_a_load_on_the_brake_is_not_learned_from_motors_that_carry_nothing(crane, seed):
    """After an hour the filter had lost half of the load; every sample was rejected after that, for good."""
    each = FrictionEstimator(crane, seed, CONFIG)
    sea = list(rigid_samples(crane, seed, amplitude=150.0, duration=20.0, noise=3, speed_noise=0.1))
    for sample in sea:
        each.step(sample)
    before, resting = each.drum_torque, copy.deepcopy(sea[-1])
    resting.motor_speed = resting.speed_reference = 0.0
    resting.groups["main"].pressure_a = resting.groups["main"].pressure_b
    for k in range(9000):
        resting.time = 20.0 + 0.4 * k
        each.step(resting)
    assert each.drum_torque == pytest.approx(before, rel=0.001)
    rejected = each.counts["rejected"]
    for sample in sea:
        sample.time += 3700.0
        each.step(sample)
    assert each.counts["rejected"] - rejected < 50


@pytest.mark.parametrize("shown", [0.5, 2.0])
def test_a_load_cell_that_steps_is_said_and_does_not_lock_the_gate(crane, seed, shown):
    """By so much less than a dead one that no check of one sample sees it; every sample was rejected, and nobody said
    why."""
    each, learned_from = FrictionEstimator(crane, seed, CONFIG), 0
    for sample in rigid_samples(crane, seed, amplitude=150.0, duration=40.0, noise=3, speed_noise=0.1):
        learned_from = learned_from if sample.time > 20.0 else each.counts["learned_from"]
        sample.hook_load *= shown if sample.time > 20.0 else 1.0
        each.step(sample)
    assert each.counts["rejected"] < 100  # of two thousand; some at each reversal, of the friction under the wrong load
    assert each.load_apart == pytest.approx(1.0 / shown - 1.0, abs=0.1)
    assert each.counts["learned_from"] - learned_from < 10  # nor does it teach anything
    for sample in rigid_samples(crane, seed, amplitude=150.0, duration=20.0, noise=4, speed_noise=0.1):
        sample.time += 40.0
        each.step(sample)
    assert each.counts["learned_from"] - learned_from > 500


def test_a_load_cell_that_follows_slowly_is_believed_as_soon_as_it_has(crane, seed):
    """55 t are set down at once, the cell lags by 2 s: what the filter had put in its place must go as it comes."""
    each, shown = FrictionEstimator(crane, seed, CONFIG), 55e3
    for sample in rigid_samples(crane, seed, amplitude=150.0, duration=20.0, noise=3, speed_noise=0.1):
        each.step(sample)
    for sample in rigid_samples(crane, seed, amplitude=150.0, duration=20.0, noise=5, speed_noise=0.1, load=10e3):
        sample.time += 20.0
        shown += (10e3 - shown) * 0.02 / 2.0
        sample.hook_load = shown
        each.step(sample)
        if sample.time > 32.0:
            assert abs(each.load_apart) < 0.1
            assert each.status()["state"] in ("learning", "stick")


def test_a_load_taken_anew_is_what_the_dead_cells_last_word_lacks(crane, seed):
    """The estimator knows of 55 t; where 20 t are balanced, what hangs there beyond the 55 is -35."""
    each = FrictionEstimator(crane, seed, CONFIG)
    for sample in rigid_samples(crane, seed, amplitude=150.0, duration=5.0):
        each.step(sample)
    lighter = list(rigid_samples(crane, seed, amplitude=150.0, duration=5.0, load=20e3))
    steady = max(lighter, key=lambda sample: sample.motor_speed)  # where nothing accelerates
    each._begin_load(replace(steady, hook_load=math.nan))
    # of one sample, its friction reckoned under 55 t
    assert each.drum_torque == pytest.approx(crane.drum_torque(20e3), rel=0.1)
