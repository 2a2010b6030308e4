"""Samples between which the friction, or the drive's torque, changes: at 10 Hz a winch turns by a tenth of its speed
from one to the next, and the pressure of a pump-controlled loop swings at 1.8 Hz."""

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.estimation.sample import Accepted
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SECONDS, VOYAGES = 300.0, 4
EVERY = 5  # of 50 Hz
CASE = load_scenario("ahc_irregular").override({"duration": SECONDS, "drive": "secondary"})
PUMP = load_scenario("ahc_irregular").override({"duration": SECONDS, "drive": "primary"})


def drawn(seed, rng):
    """A truth from the seed's own distribution."""
    values = {n: v + s * rng.normal() for n, v, s in zip(seed.parameter_names, seed.values, seed.std, strict=True)}
    return seed.with_values({n: max(v, 0.3 * seed.value(n)) for n, v in values.items()})


def distance(found, truth):
    """Squared distance of the truth in the stated covariance, per parameter: 1 where the sigmas are true."""
    std = found.std
    apart = (np.array(truth.values) - np.array(found.values)) / std
    return float(apart @ np.linalg.solve(found.covariance / np.outer(std, std), apart)) / len(apart)


def apart(case, crane, seed, first=100):
    """Mean distance of drawn truths after a voyage each, and the samples that were rejected."""
    distances, rejected = [], 0
    for k in range(VOYAGES):
        truth = drawn(seed, np.random.default_rng(first + k))
        each = FrictionEstimator(
            crane, seed, EstimatorConfig(max_gap=1.0, speed_delay_std=0.0)
        )  # no speed here is late
        for sample in list(simulate(case, crane, truth, seed=k).run.samples())[::EVERY]:
            each.step(sample)
        distances.append(distance(each.model(), truth))
        rejected += each.counts["rejected"]
    return np.mean(distances), rejected


@pytest.mark.slow
def test_at_10_hz_the_sigmas_are_not_half_of_what_they_should_be(crane, seed):
    """Friction taken at the middle of the step was 2.75 squared sigmas off, and 290 samples of 12 000 were rejected."""
    off, rejected = apart(CASE, crane, seed)
    assert off < 1.7
    assert rejected < 120


@pytest.mark.slow
@pytest.mark.long
def test_nor_on_a_pump_whose_pressure_swings_between_the_samples(crane, seed):
    """The mean of the drive's torque taken on a straight line was 2.0 squared sigmas off."""
    off, rejected = apart(PUMP, crane, seed)
    assert off < 1.7
    assert rejected < 240


def test_a_torque_bends_by_what_the_step_before_does_not_foretell():
    at = lambda time, drive: Accepted(time, drive, 10.0, 0.0, 6.0)
    first, second = at(0.0, 100.0), at(0.1, 130.0).after(at(0.0, 100.0))
    assert second.bend(at(0.2, 160.0)) == pytest.approx(0.0)
    assert second.bend(at(0.2, 150.0)) == pytest.approx(-10.0)
    assert second.bend(at(0.16, 150.0)) == pytest.approx(2.0)  # a shorter step, a shorter way
    assert first.bend(second) == 0.0  # nothing before it
    assert second.bend(at(0.4, 160.0)) == second.bend(at(0.13, 160.0)) == 0.0  # steps too unlike to tell
