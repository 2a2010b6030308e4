"""A speed that is late: a PLC takes the difference of two encoder angles and stamps it, like all else, at the end."""

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.estimation.sample import Accepted
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

RATE, VOYAGES = 50.0, 2  # Hz
CASE = load_scenario("ahc_irregular").override({"duration": 200.0})
TURNING = ("pressure_a", "pressure_b", "displacement")


def late(samples):
    """The same voyage with the speed of the scan that has just ended: all else is of its end, half way to the next."""
    for now, then in zip(samples, samples[1:], strict=False):
        for name, group in now.groups.items():
            for channel in TURNING:
                setattr(group, channel, 0.5 * (getattr(group, channel) + getattr(then.groups[name], channel)))
        now.heave_velocity = 0.5 * (now.heave_velocity + then.heave_velocity)
        now.time += 0.5 / RATE
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
def test_a_lateness_that_nobody_told_is_part_of_the_sigmas(crane, seed):
    assert squared_error(crane, seed) < 3.0
    assert squared_error(crane, seed, speed_delay_std=0.0) > 4.0  # what it is about


def test_what_acted_while_a_late_speed_changed_is_that_much_earlier():
    at = lambda time, drive, heave: Accepted(time, drive, 10.0, heave, 6.0)
    first, second, third = at(0.0, 100.0, 1.0), at(0.1, 130.0, 2.0), at(0.2, 150.0, 4.0)
    second = second.after(first)
    assert second.means(third, 0.0) == (140.0, 3.0)
    assert second.means(third, 0.05) == pytest.approx((128.75, 2.0))  # (115 to 130 and 130 to 140) / 2
    assert second.means(third, 0.1) == pytest.approx((115.0, 1.0))
    assert second.means(third, 0.4) == pytest.approx((115.0, 1.0))  # further back it would be guessed
    assert first.means(second, 0.05)[0] == pytest.approx(100.0)  # nothing before: straight on
