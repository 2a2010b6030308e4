"""Box's complex method against functions whose minimum is known."""

import numpy as np
import pytest

from winch_friction.identification.complex_method import POPULATION, REFLECTION, complex_method

LOWER, UPPER = np.full(3, -4.0), np.full(3, 6.0)


def bowl(x):
    return float(((x - [1.0, -2.0, 3.0]) ** 2 * [1.0, 10.0, 0.1]).sum())


def rosenbrock(x):
    return float(100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2)


def test_paper_settings():
    assert (POPULATION, REFLECTION) == (36, 1.3)


def test_finds_the_minimum_of_a_bowl():
    result = complex_method(bowl, LOWER, UPPER, seed=3)
    np.testing.assert_allclose(result.x, [1.0, -2.0, 3.0], atol=1e-3)
    assert result.converged == result.restarts == 3


def test_finds_the_minimum_of_a_curved_valley():
    result = complex_method(rosenbrock, np.array([-2.0, -1.0]), np.array([2.0, 3.0]), seed=5, restarts=4)
    assert result.cost < 1e-4


def test_minimum_on_the_boundary():
    result = complex_method(lambda x: float(x.sum()), LOWER, UPPER, seed=1)
    np.testing.assert_allclose(result.x, LOWER, atol=1e-3)


def test_counts_every_evaluation_of_the_cost():
    calls = []
    result = complex_method(lambda x: calls.append(1) or bowl(x), LOWER, UPPER, seed=2, restarts=2)
    assert result.evaluations == len(calls)


def test_seedable():
    first, again, other = (complex_method(bowl, LOWER, UPPER, seed=seed, max_evaluations=300) for seed in (7, 7, 8))
    np.testing.assert_array_equal(first.x, again.x)
    assert not np.array_equal(first.x, other.x)


@pytest.mark.parametrize("budget", [200, 500])
def test_budget_is_kept(budget):
    result = complex_method(rosenbrock, LOWER[:2], UPPER[:2], seed=1, restarts=1, max_evaluations=budget, tolerance=0)
    assert budget <= result.evaluations <= budget + 12


def test_a_cost_in_another_unit_is_minimised_by_the_same_designs():
    """The population has settled where its costs agree to a share of themselves, however large or small these are."""
    few = {"seed": 4, "restarts": 1, "population": 8, "tolerance": 1e-3}
    found = [complex_method(lambda x, s=s: s * (1.0 + bowl(x)), LOWER, UPPER, **few) for s in (1.0, 2.0**-50, 2.0**50)]
    for each in found[1:]:
        np.testing.assert_array_equal(each.x, found[0].x)
        assert (each.evaluations, each.converged) == (found[0].evaluations, 1)


@pytest.mark.parametrize("reflection", [1.0, 1.3, 1.7])
def test_the_worst_design_is_mirrored_and_retracts_to_the_others_centroid_and_then_to_the_best(reflection):
    """By hand, of a population of four whose mirrored one is always worse: half as far from the centroid each time, and
    after six times of the best."""
    seen = []

    def cost(x):
        seen.append(np.array(x))
        return float(len(seen)) if len(seen) <= 4 else 100.0

    wide = np.full(2, 50.0)
    complex_method(cost, -wide, wide, seed=6, population=4, reflection=reflection, restarts=1, max_evaluations=5)
    best, *others, worst = seen[:4]
    centroid = np.mean([best, *others], axis=0)
    trial = np.clip(centroid + reflection * (centroid - worst), -wide, wide)
    for attempt, design in enumerate(seen[4:16]):
        np.testing.assert_allclose(design, trial, rtol=1e-12)
        trial = 0.5 * (trial + (centroid if attempt < 6 else best))
    assert len(seen) == 16
