"""What the closed-loop study holds a squared error against: the mean of a filter whose stated covariance is true."""

import numpy as np
import pytest

from campaign.loop_cases import honest_nees

RNG = np.random.default_rng(3)
ROOT = RNG.normal(size=(4, 4))
PRIOR = ROOT @ ROOT.T
BY_DATA = RNG.normal(size=(6, 4))  # what six measurements of unit noise see of four parameters
GAIN = np.linalg.inv(np.linalg.inv(PRIOR) + BY_DATA.T @ BY_DATA) @ BY_DATA.T
OWN = np.linalg.inv(np.linalg.inv(PRIOR) + BY_DATA.T @ BY_DATA)  # without what is considered
SENSITIVITY = RNG.normal(size=(2, 4))  # one sigma of two errors
NOWHERE = np.zeros(4)


def test_drawn_errors_and_truths_leave_one_for_each_parameter():
    root = np.linalg.cholesky(PRIOR)
    drawn = [(RNG.normal(size=2), root @ RNG.normal(size=4)) for _ in range(4000)]
    found = [honest_nees(OWN, PRIOR, SENSITIVITY, errors, off) for errors, off in drawn]
    assert np.mean(found) == pytest.approx(4.0, rel=0.03)


@pytest.mark.parametrize("errors", [(0.0, 0.0), (1.0, -2.0)])
@pytest.mark.parametrize("off", [NOWHERE, np.array([1.0, -2.0, 0.5, 3.0])])
def test_of_one_truth_and_one_error_it_is_what_noise_alone_makes(errors, off):
    """Linear least squares under the prior, with noise drawn; the estimate is off by the errors besides."""
    seen = BY_DATA @ off + RNG.normal(size=(20_000, 6))
    missed = seen @ GAIN.T - np.array(errors) @ SENSITIVITY - off
    stated = OWN + SENSITIVITY.T @ SENSITIVITY
    expected = np.mean(np.einsum("ij,ij->i", missed @ np.linalg.inv(stated), missed))
    assert honest_nees(OWN, PRIOR, SENSITIVITY, errors, off) == pytest.approx(expected, rel=0.03)


def test_without_errors_and_at_the_seed_the_room_that_is_left_makes_it_less():
    found = honest_nees(OWN, PRIOR, SENSITIVITY, (0.0, 0.0), NOWHERE)
    assert 0.0 < found < honest_nees(OWN, PRIOR, np.zeros((2, 4)), (0.0, 0.0), NOWHERE) < 4.0


def test_an_error_of_many_sigmas_makes_it_more():
    one, three = (honest_nees(OWN, PRIOR, SENSITIVITY, (each, 0.0), NOWHERE) for each in (1.0, 3.0))
    assert three > one
