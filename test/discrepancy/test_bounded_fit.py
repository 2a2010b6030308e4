"""The small bounded fit is exact: compared with SciPy's, on well and badly conditioned problems."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from winch_friction.discrepancy.engine.problem import bounded_fit


@pytest.mark.parametrize("seed", range(30))
def test_equals_scipy_inside_the_box(seed):
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(60, 9)) @ np.diag(10.0 ** rng.uniform(-2, 2, 9))
    a[:, 3] = a[:, 4] + 1e-3 * a[:, 3]  # nearly tied columns are the ordinary case
    y = rng.normal(size=60) * 5.0
    lower, upper = -rng.uniform(0.1, 2.0, 9), rng.uniform(0.1, 2.0, 9)
    found = bounded_fit(a.T @ a, a.T @ y, lower, upper)
    expected = lsq_linear(a, y, (lower, upper), method="bvls", tol=1e-14).x
    assert ((found >= lower - 1e-12) & (found <= upper + 1e-12)).all()
    assert np.sum((y - a @ found) ** 2) == pytest.approx(np.sum((y - a @ expected) ** 2), rel=1e-9)


def test_a_box_that_excludes_zero_is_respected():
    found = bounded_fit(np.eye(2), np.array([5.0, 0.1]), np.array([1.0, 1.0]), np.array([2.0, 3.0]))
    np.testing.assert_allclose(found, [2.0, 1.0])
