"""What acts between two samples: the sign of a speed that turns, a short or stiff wire, and a crane tip that heaves."""

import math

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.estimation.dynamics import LOAD_SPEED, fresh_motion, rounding_variance, wire_step
from winch_friction.estimation.interval import mean_direction
from winch_friction.estimation.sample import accepted
from winch_friction.estimation.trust import Consistency
from winch_friction.physics.signals import GroupSample, Sample


def sample(time, speed=50.0, **more):
    groups = {"main": GroupSample(150e5, 25e5, 3.4e-5)}
    return Sample(time, speed, groups=groups, hook_load=55e3, **more)


@pytest.mark.parametrize(
    ("before", "after", "mean"),
    [(3.0, -1.0, 0.5), (-1.0, 3.0, 0.5), (-3.0, 1.0, -0.5), (1.0, -3.0, -0.5), (2.0, 0.0, 1.0)],
)
def test_a_speed_that_turns_has_the_sign_of_its_longer_part(before, after, mean):
    assert mean_direction(before, after) == mean
    between = np.linspace(before, after, 4001)
    assert np.sign(between).mean() == pytest.approx(mean, abs=1e-3)


@pytest.mark.parametrize("mass", [10.0, 55e3])
def test_a_light_hook_on_a_stiff_wire_is_no_quicker_than_what_a_filter_can_follow(crane, mass):
    step = 1e-5
    stiffest = wire_step(crane, mass, 6.0, 1.0, 0.0, step)[2][1] / step  # of the load's speed per stretch: k / m
    own = crane.wire_stiffness / mass
    assert stiffest == pytest.approx(min(own, 40.0**2), rel=0.01)


def test_a_wire_that_is_all_on_the_drum_is_a_metre(crane, seed):
    each = FrictionEstimator(crane, seed)
    each.step(sample(0.0))
    none, metre, ten = (each._intervals._wire(sample(0.02, wire_out=length), 0.0, 0.02) for length in (0.0, 1.0, 10.0))
    assert none == metre != ten


def test_a_load_that_follows_its_wire_rises_with_the_crane_tip_as_well(crane):
    """Both as seen from the sea's mean: hoisting at 50 rad/s and a tip that rises at 0.4 m/s."""
    own = {
        state: value for state, value, _ in fresh_motion(sample(0.0, heave_velocity=0.4), crane, EstimatorConfig(), 0.0)
    }
    lever = crane.drum.radius(math.nan) / crane.gear_ratio
    assert own[LOAD_SPEED] == pytest.approx(0.4 + 50.0 * lever)


def test_the_heave_of_a_step_is_that_of_its_middle(crane, seed):
    each = FrictionEstimator(crane, seed)
    each.step(sample(0.0))
    last, now = (accepted(sample(time, heave_velocity=heave), crane) for time, heave in ((0.0, 0.2), (0.02, 0.6)))
    theta = each._parameters.theta(each._filter.phi)
    step, _ = each._intervals.between(last, now, sample(0.02, heave_velocity=0.6), theta, 0.0)
    assert step.heave == pytest.approx(0.4)
    assert step.duration == pytest.approx(0.02)


def test_the_drives_torque_of_a_step_is_that_of_its_middle(crane, seed):
    each = FrictionEstimator(crane, seed)
    each.step(sample(0.0))
    last, now = accepted(sample(0.0), crane), accepted(sample(0.02), crane)
    theta = each._parameters.theta(each._filter.phi)
    more = last._replace(drive=last.drive + 100.0), now._replace(drive=now.drive + 300.0)
    plain, changed = (each._intervals.between(*ends, sample(0.02), theta, 0.0)[0] for ends in ((last, now), more))
    assert changed.torque - plain.torque == pytest.approx(200.0)


def test_an_encoders_rounding_is_even_within_its_step():
    config = EstimatorConfig(speed_step=0.3)
    within = 0.3 * (np.arange(1000) + 0.5) / 1000.0
    assert rounding_variance(config) == pytest.approx(np.var(within), rel=1e-3)


def test_innovations_that_are_too_small_are_as_inconsistent_as_too_large_ones():
    small = Consistency(100)
    for _ in range(500):
        small.step(0.5)
    assert small.share_inside == 0.0
