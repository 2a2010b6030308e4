"""Do the other channels agree with the speed: sign, size and time of each."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.commissioning.kinematics import LATE, MOST, agreements
from winch_friction.commissioning.mistakes import delayed

TIME = np.arange(300) * 0.2
SPEED = 100.0 * np.sin(0.8 * TIME) + 40.0 * np.sin(2.1 * TIME + 1.0)
LEVER = 0.004


def score(channel, rate, must_follow=()):
    view = SimpleNamespace(speed=SPEED, lever=LEVER, rates={channel: rate})
    found = agreements(view, must_follow)
    return (found[0].ratio, found[0].score) if found else None


def test_a_channel_that_tells_the_same_speed_costs_nothing():
    assert score("shaft_angle", SPEED) == pytest.approx((1.0, 0.0))
    assert score("wire_out", LEVER * SPEED) == pytest.approx((1.0, 0.0))


def test_the_opposite_sign_is_a_flat_contradiction():
    assert score("shaft_angle", -SPEED) == pytest.approx((-1.0, MOST))


def test_another_size_counts_in_ordinary_errors_of_the_channel():
    assert score("shaft_angle", 1.03 * SPEED)[1] == pytest.approx(1.0, rel=0.05)
    assert score("speed_reference", 1.12 * SPEED)[1] == pytest.approx(1.0, rel=0.15)
    assert score("shaft_angle", 60.0 * SPEED)[1] == MOST


@pytest.mark.parametrize("lag", [3, -3])
def test_a_channel_that_fits_only_when_it_is_shifted_is_late(lag):
    assert score("speed_reference", np.roll(SPEED, lag))[1] >= LATE


def test_a_channel_that_does_not_follow_is_left_out_unless_it_must():
    noise = np.random.default_rng(0).standard_normal(300)
    assert score("heave_velocity", noise) is None
    assert score("heave_velocity", noise, ("heave_velocity",))[1] == MOST


@pytest.mark.parametrize(("seconds", "said"), [(0.3, "motor_speed is late"), (-0.3, "the drive's torque is late")])
def test_a_drive_without_oil_has_no_pressures_that_are_late(seconds, said):
    assert delayed(seconds, hydraulic=False).words.startswith(said)
    assert "pressures" not in delayed(seconds, hydraulic=False).words
    assert "pressures" in delayed(seconds).words
