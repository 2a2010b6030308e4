"""A speed that is late: a PLC takes the difference of two encoder angles and stamps it, like all else, at the end."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.estimation.considered import ConsideredErrors
from winch_friction.estimation.sample import Accepted
from winch_friction.physics.signals import GroupSample
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

RATE, VOYAGES = 50.0, 2  # Hz
CASE = load_scenario("ahc_irregular").override({"duration": 200.0})
TURNING = ("pressure_a", "pressure_b", "displacement")


def late(samples, rate=RATE):
    """The same voyage with the speed of the scan that has just ended: all else is of its end, half way to the next."""
    for now, then in zip(samples, samples[1:], strict=False):
        for name, group in now.groups.items():
            for channel in TURNING:
                setattr(group, channel, 0.5 * (getattr(group, channel) + getattr(then.groups[name], channel)))
        now.heave_velocity = 0.5 * (now.heave_velocity + then.heave_velocity)
        now.time += 0.5 / rate
        yield now


def squared_error(crane, seed, **settings):
    """Of what is learned of truths drawn from the seed, in the stated covariance and per parameter: 1 where it is
    true."""
    found = []
    for k in range(VOYAGES):
        off = np.random.default_rng(100 + k).normal(size=len(seed.values)) * seed.std
        values = np.maximum(np.array(seed.values) + off, 0.3 * np.array(seed.values))
        truth = seed.with_values(dict(zip(seed.parameter_names, values.tolist(), strict=True)))
        each = FrictionEstimator(crane, seed, EstimatorConfig(**settings))
        for sample in late(list(simulate(CASE, crane, truth, seed=k).run.samples())):
            each.step(sample)
        model = each.model()
        apart = (values - np.array(model.values)) / model.std
        found.append(apart @ np.linalg.solve(model.covariance / np.outer(model.std, model.std), apart) / len(apart))
    return np.mean(found)


@pytest.mark.slow
def test_a_lateness_that_is_told_biases_nothing(crane, seed):
    """Half a scan of 20 ms: the squared error was 5 to 10 times what the covariance said."""
    assert squared_error(crane, seed, speed_delay=0.5 / RATE, speed_delay_std=0.0) < 1.7


@pytest.mark.slow
@pytest.mark.long
def test_a_lateness_that_nobody_told_is_part_of_the_sigmas(crane, seed):
    assert squared_error(crane, seed) < 3.0
    assert squared_error(crane, seed, speed_delay_std=0.0, wire_damping_std=0.0) > 4.0  # what it is about


def test_what_acted_while_a_late_speed_changed_is_that_much_earlier():
    at = lambda time, drive, heave: Accepted(time, drive, 10.0, heave, 6.0)
    first, second, third = at(0.0, 100.0, 1.0), at(0.1, 130.0, 2.0), at(0.2, 150.0, 4.0)
    second = second.after(first)
    assert second.means(third, 0.0) == (140.0, 3.0)
    assert second.means(third, 0.05) == pytest.approx((128.75, 2.0))  # (115 to 130 and 130 to 140) / 2
    assert second.means(third, 0.1) == pytest.approx((115.0, 1.0))
    assert second.means(third, 0.4) == pytest.approx((115.0, 1.0))  # further back it would be guessed
    assert first.means(second, 0.05)[0] == pytest.approx(100.0)  # nothing before: straight on


# -- what the innovations say of it
def told(crane, seed, drive, samples_of, rate=10.0, **settings):
    """The status of an estimator after a voyage at a slow rate."""
    case = load_scenario("ahc_irregular").override({"duration": 60.0, "drive": drive, "sensors.rate": rate})
    each = FrictionEstimator(crane, seed, EstimatorConfig(**settings))
    for sample in samples_of(list(simulate(case, crane, seed, seed=7).run.samples())):
        each.step(sample)
    return each.status()


@pytest.mark.parametrize("drive", ["primary", "secondary"])
def test_a_late_speed_that_nobody_told_is_said_with_what_to_set(crane, seed, drive):
    """At 10 Hz its squared error was 37 times what the covariance said, and nothing told."""
    said = told(crane, seed, drive, lambda samples: late(samples, 10.0))
    assert said["speed_late"] == pytest.approx(0.5, abs=0.15)
    assert "motor_speed seems late by about 0." in said["lateness"]
    assert "set speed_delay" in said["lateness"]
    right = told(crane, seed, drive, lambda samples: late(samples, 10.0), speed_delay=0.05)
    assert right["lateness"] == ""


@pytest.mark.parametrize("drive", ["primary", "secondary"])
def test_of_a_speed_that_is_right_nothing_is_said(crane, seed, drive):
    said = told(crane, seed, drive, lambda samples: samples)
    assert abs(said["speed_late"]) < 0.15
    assert said["lateness"] == ""
    assert np.isnan(told(crane, seed, drive, lambda samples: samples[:2])["speed_late"])  # nothing was seen yet


def test_pressures_that_are_late_are_no_late_speed(crane, seed):
    def skewed(samples):
        for before, now in zip(samples, samples[1:], strict=False):
            kept = {name: [getattr(group, c) for c in TURNING] for name, group in before.groups.items()}
            yield replace(now, groups={name: GroupSample(*kept[name]) for name in now.groups})

    said = told(crane, seed, "primary", skewed)
    assert said["speed_late"] < -0.3
    assert "pressures or torque seem late" in said["lateness"]


def test_nothing_is_said_where_no_lateness_is_considered(crane, seed):
    said = told(crane, seed, "primary", lambda samples: late(samples, 10.0), speed_delay_std=0.0)
    assert np.isnan(said["speed_late"])
    assert said["lateness"] == ""


def test_a_bias_is_found_by_weighted_least_squares_beside_what_else_is_considered():
    rng, errors = np.random.default_rng(4), np.array([0.4, 0.01])
    each, rows, right = ConsideredErrors((0.15, 0.01), late=True), np.diag([0.0, 1e4]), np.zeros(2)
    for _ in range(200):
        shown, variance = rng.normal(size=2), rng.uniform(0.5, 2.0)
        innovation = shown @ errors + np.sqrt(variance) * rng.normal()
        each.step(shown, innovation, variance)
        rows += np.outer(shown, shown) / variance
        right += shown * innovation / variance
    assert each.lateness[0] == pytest.approx(np.linalg.solve(rows, right)[0])
    assert each.lateness[1] == pytest.approx(np.sqrt(np.linalg.inv(rows)[0, 0]))


@pytest.mark.parametrize(
    ("share", "std", "said"),
    [(0.3, 0.04, True), (0.3, 0.06, False), (0.14, 0.001, False), (2.5, 0.14, True), (7.7, 1.5, False)],
)
def test_only_what_is_surely_more_than_what_is_considered_is_said(share, std, said):
    """The last is of a filter's first 0.18 s: the pressures were told to be late by 7.7 samples that were in time."""
    assert bool(ConsideredErrors((0.15,), late=True)._words(share, std)) is said
    assert bool(ConsideredErrors((0.15,), late=True)._words(-share, std)) is said


def test_what_inputs_in_doubt_have_told_is_forgotten_with_what_was_learned_of_them(crane, seed):
    case = load_scenario("ahc_irregular").override({"duration": 30.0, "sensors.rate": 10.0})
    each = FrictionEstimator(crane, seed)
    before = each.snapshot()
    for sample in late(list(simulate(case, crane, seed, seed=7).run.samples()), 10.0):
        each.step(sample)
    assert np.isfinite(each.status()["speed_late"])
    each.take_back(before)
    assert np.isnan(each.status()["speed_late"])
