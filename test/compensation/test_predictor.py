"""The speed predictor and the load from the balance: small things that a sign or half a step would spoil."""

import math

import pytest

from winch_friction.compensation.parts import DrumTorque
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.crane import sample_drive_torque
from winch_friction.physics.winch.operating_point import SpeedPredictor


def test_acceleration_is_that_of_now_not_of_half_a_step_ago():
    """A parabola has a constant jerk: extrapolation is exact for it, half a step included."""
    dt, lead, acceleration, jerk = 0.02, 0.05, 3.0, 40.0
    predictor = SpeedPredictor(lead, 0.0, 0.0)
    for k in range(100):
        time = k * dt
        found = predictor.step(time, acceleration * time + 0.5 * jerk * time**2)
    ahead = time + lead
    assert found.acceleration == pytest.approx(acceleration + jerk * ahead, rel=1e-6)
    assert found.speed == pytest.approx(acceleration * ahead + 0.5 * jerk * ahead**2, rel=1e-6)


@pytest.mark.parametrize("acceleration", [12.0, -12.0])
def test_what_accelerates_the_winch_is_not_taken_for_load(crane_150t, acceleration):
    """Pressures that carry a load and speed the winch up mean that load, not more."""
    load, layer = 40e3, math.nan
    torque = crane_150t.drum_torque(load, layer) / crane_150t.gear_ratio + crane_150t.inertia * acceleration
    displacement, motors = 3e-5, crane_150t.motor_count("main")
    group = GroupSample(torque / (motors * displacement) + 2e6, 2e6, displacement)
    sample = Sample(0.0, 50.0, groups={"main": group})
    assert sample_drive_torque(sample, crane_150t) == pytest.approx(torque)
    estimate = DrumTorque(crane_150t, math.nan, 5.0)
    estimate.learn(sample, 0.0, acceleration, 0.02)
    assert estimate.value(sample) == pytest.approx(crane_150t.drum_torque(load, layer), rel=1e-9)


def test_a_stamp_that_does_not_advance_leaves_the_past_as_it_is():
    each = SpeedPredictor(0.0, 0.0, 0.1)
    for time, speed in ((0.0, 0.0), (0.02, 1.0), (0.04, 2.0), (0.04, 9.0), (0.03, -9.0)):
        each.step(time, speed)
    assert each.step(0.06, 3.0).acceleration == pytest.approx(50.0)
