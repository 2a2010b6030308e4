"""The recursive filters are scipy's, whose import costs more than they do."""

import numpy as np
from scipy.signal import lfilter, lfilter_zi

from winch_friction.discrepancy.preparation.grid import lagged, recursive


def test_filter_is_scipys_lfilter():
    x = np.cumsum(np.random.default_rng(1).normal(size=5000))
    numerator, denominator = np.array([0.1, 0.05, 0.02]), np.array([1.0, -1.7, 0.8])
    driven = lfilter(numerator, [1.0], x)
    np.testing.assert_allclose(recursive(denominator[1:], driven), lfilter(numerator, denominator, x), atol=1e-10)


def test_lag_is_settled_before_the_first_sample():
    x = 5.0 + np.cumsum(np.random.default_rng(2).normal(size=3000))
    keep = np.exp(-0.02 / 3.0)
    weights = [1.0 - keep], [1.0, -keep]
    expected = lfilter(*weights, x, zi=lfilter_zi(*weights) * x[0])[0]
    np.testing.assert_allclose(lagged(x, 0.02, 3.0), expected, atol=1e-10)
    assert lagged(np.full(4, 7.0), 0.02, 3.0).tolist() == [7.0] * 4


def test_a_weight_may_be_another_at_every_sample():
    """y_k = x_k - a_k y_(k-1) - b_k y_(k-2), by hand from rest."""
    a, b, x = np.array([9.0, -0.5, 0.25, -2.0]), np.array([9.0, 9.0, 0.5, -1.0]), np.array([2.0, 1.0, 0.0, 3.0])
    # 2, 1 + 1 = 2, 0 - 0.5 - 1 = -1.5, 3 - 3 + 2 = 2
    assert recursive((a, b), x.copy()).tolist() == [2.0, 2.0, -1.5, 2.0]
