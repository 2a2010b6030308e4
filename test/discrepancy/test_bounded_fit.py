"""The small bounded fit is exact: compared with SciPy's, on well and badly conditioned problems."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from winch_friction.discrepancy.engine import problem
from winch_friction.discrepancy.engine.problem import bounded_fit, bounded_fits


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


def decays(count: int) -> np.ndarray:
    """Exponentials of slowly growing rates, whose Gram matrix is singular to rounding."""
    return np.exp(-np.linspace(0.0, 1.0, count + 30)[:, None] * np.linspace(0.1, 5.0, count))


@pytest.mark.parametrize("count", [9, 20, 41])
@pytest.mark.parametrize("pinned", [False, True])
def test_columns_that_are_all_but_tied_end_at_the_optimum_too(count, pinned):
    """Exchanging all at once goes in circles there, by rounding alone."""
    rng = np.random.default_rng(count)
    a, y = decays(count), rng.normal(size=count + 30)
    h = a.T @ a
    h[np.diag_indices(count)] *= 1.0 + 1e-6
    lower, upper = np.zeros(count), rng.uniform(0.0, 1.0, count)
    if pinned:
        lower[::4] = upper[::4]
    found = bounded_fit(h, a.T @ y, lower, upper)
    assert ((found >= lower - 1e-12) & (found <= upper + 1e-12)).all()
    root, wide = np.linalg.cholesky(h).T, upper > lower
    left = np.linalg.solve(root.T, a.T @ y) - root[:, ~wide] @ lower[~wide]
    best = lsq_linear(root[:, wide], left, (lower[wide], upper[wide]), method="bvls", tol=1e-14).cost
    cost = 0.5 * np.sum((left - root[:, wide] @ found[wide]) ** 2)
    assert cost == pytest.approx(best, rel=1e-9)


@pytest.mark.parametrize("seed", range(10))
def test_a_guess_changes_nothing_but_the_steps(seed):
    rng = np.random.default_rng(seed)
    a, y = rng.normal(size=(40, 12)), rng.normal(size=40)
    lower, upper = np.zeros(12), np.where(rng.random(12) < 0.5, 0.05, 10.0)
    guess = np.clip(rng.normal(size=12), lower, upper)
    found = bounded_fit(a.T @ a, a.T @ y, lower, upper)
    np.testing.assert_allclose(bounded_fit(a.T @ a, a.T @ y, lower, upper, guess), found, atol=1e-9)


def test_a_coefficient_without_room_stays_where_it_is_held():
    h, g, held = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([9.0, 1.0]), np.array([0.5, -5.0])
    for start in (None, held.copy()):
        found = bounded_fit(h, g, held, np.array([0.5, 5.0]), start)
        np.testing.assert_allclose(found, [0.5, 0.25])


@pytest.mark.parametrize("seed", [108, 234, 651, 877])
def test_what_goes_in_circles_by_exchanging_all_ends_by_exchanging_one(seed, monkeypatch):
    """Of 3000 such problems, none of them badly conditioned, 12 would go on for ever."""
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(30, 3)) @ rng.normal(size=(3, 12)) + 0.3 * rng.normal(size=(30, 12))
    y, lower, upper = rng.normal(size=30) * 5.0, np.zeros(12), np.full(12, 10.0)
    monkeypatch.setattr(problem, "_slowly", lambda *_: pytest.fail("went in circles"))
    expected = lsq_linear(a, y, (lower, upper), method="bvls", tol=1e-14).x
    np.testing.assert_allclose(bounded_fit(a.T @ a, a.T @ y, lower, upper), expected, atol=1e-8)


@pytest.mark.parametrize("started", [False, True])
def test_many_problems_at_once_end_where_each_ends_by_itself(started):
    """Whatever rounds each of them takes, those that go in circles and that have no room among them."""
    rng = np.random.default_rng(3)
    size, count = 12, 60
    parts = []
    for k in range(count):
        a = rng.normal(size=(30, 3)) @ rng.normal(size=(3, size)) + 0.3 * rng.normal(size=(30, size))
        parts.append((a.T @ a * 10.0 ** (k % 5), a.T @ (5.0 * rng.normal(size=30))))
    circling = np.random.default_rng(108)
    a = circling.normal(size=(30, 3)) @ circling.normal(size=(3, size)) + 0.3 * circling.normal(size=(30, size))
    parts[7] = (a.T @ a, a.T @ (circling.normal(size=30) * 5.0))
    h, g = np.array([one for one, _ in parts]), np.array([two for _, two in parts])
    lower, upper = np.zeros((count, size)), np.full((count, size), 10.0)
    lower[::2], upper[::3] = -0.05, 0.02
    upper[11] = lower[11]
    start = np.clip(rng.normal(size=(count, size)), lower, upper) if started else None
    kept = h.copy(), g.copy()
    found = bounded_fits(h, g, lower, upper, start)
    for k in range(count):
        np.testing.assert_allclose(found[k], bounded_fit(h[k], g[k], lower[k], upper[k]), rtol=1e-7, atol=1e-9)
    assert (found[11] == lower[11]).all()
    np.testing.assert_array_equal(h, kept[0])
    np.testing.assert_array_equal(g, kept[1])


def test_one_set_of_bounds_and_one_guess_serve_all():
    rng = np.random.default_rng(9)
    h = np.array([np.eye(4) + 0.1 * np.diag(rng.random(4)) for _ in range(5)])
    g, lower, upper = rng.normal(size=(5, 4)), np.zeros(4), np.full(4, 0.7)
    found = bounded_fits(h, g, lower, upper, np.full(4, 0.7))
    np.testing.assert_allclose(found, np.clip(g / np.diagonal(h, axis1=1, axis2=2), 0.0, 0.7), atol=1e-12)
    assert bounded_fits(h[:0], g[:0], lower, upper).shape == (0, 4)
