"""Friction curves as pages: the difference of two models and the shadow of one are what their labels say."""

import numpy as np
import pytest

from winch_friction.physics.winch.model_curve import model_curve
from winch_friction.records.model_file import load_model
from winch_friction.report.curves import SPEED, TORQUE, curve_plot, difference_plot, joint_std, pair_plot

FIRST, SECOND = load_model("a6vm215_crane1"), load_model("a6vm215_crane2")


@pytest.fixture(scope="module")
def pair(crane_150t):
    return [model_curve(each, crane_150t, load=55e3, speed=[20.0, 80.0, 150.0]) for each in (FIRST, SECOND)]


def test_deviations_of_independent_estimates_add_by_their_squares(pair):
    first, second = pair
    assert joint_std(first, second) == pytest.approx(np.hypot(first.std, second.std))


def test_the_difference_is_the_second_model_minus_the_first(pair):
    first, second = pair
    columns = pair_plot(first, second).frames[0].columns
    assert columns["difference [N·m]"] == pytest.approx(second.torque - first.torque)
    width = columns["plus 1 σ [N·m]"] - columns["difference [N·m]"]
    assert width == pytest.approx(np.hypot(first.std, second.std))
    assert columns["difference [N·m]"] - columns["less 1 σ [N·m]"] == pytest.approx(width)
    parts = difference_plot(first, second).frames[0].columns
    assert parts["viscous [N·m]"] == pytest.approx(second.parts["viscous"] - first.parts["viscous"])


def test_the_shadow_of_a_curve_is_one_standard_deviation(pair):
    columns = curve_plot(pair[:1]).frames[0].columns
    assert columns[SPEED] == pytest.approx(np.array([20.0, 80.0, 150.0]) * 30.0 / np.pi)
    assert columns["plus 1 σ [N·m]"] - columns[TORQUE] == pytest.approx(pair[0].std)
    assert columns[TORQUE] - columns["less 1 σ [N·m]"] == pytest.approx(pair[0].std)
