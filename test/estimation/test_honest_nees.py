"""What the closed-loop study holds a squared error against: the mean of a filter whose stated covariance is true."""

import numpy as np
import pytest

from campaign.loop_cases import honest_nees

RNG = np.random.default_rng(3)
ROOT = RNG.normal(size=(4, 4))
OWN = ROOT @ ROOT.T  # of four parameters, without what is considered
SENSITIVITY = RNG.normal(size=(2, 4))  # one sigma of two errors


def test_drawn_errors_leave_one_for_each_parameter():
    drawn = RNG.normal(size=(4000, 2))
    assert np.mean([honest_nees(OWN, SENSITIVITY, each) for each in drawn]) == pytest.approx(4.0, rel=0.02)


def test_without_errors_the_room_that_is_left_for_them_makes_it_less():
    found = honest_nees(OWN, SENSITIVITY, (0.0, 0.0))
    stated = OWN + SENSITIVITY.T @ SENSITIVITY
    off = RNG.multivariate_normal(np.zeros(4), OWN, size=20_000)
    assert found == pytest.approx(np.mean(np.einsum("ij,ij->i", off @ np.linalg.inv(stated), off)), rel=0.03)
    assert found < 4.0
    assert honest_nees(OWN, np.zeros((2, 4)), (0.0, 0.0)) == pytest.approx(4.0)


def test_an_error_of_many_sigmas_makes_it_more():
    assert honest_nees(OWN, SENSITIVITY, (3.0, 0.0)) > honest_nees(OWN, SENSITIVITY, (1.0, 0.0)) > 3.0
