"""Which motor model: parameters are paid for, and a simpler one is as good within the best's own uncertainty."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification.selection import ModelScore, bic, choose


def score(name, parameters, squares):
    fitted = SimpleNamespace(parameter_count=parameters)
    by_group = np.sqrt(np.array(squares))
    return ModelScore(name, fitted, float(np.sqrt(np.mean(squares))), by_group, 0.0)


def test_the_criterion_pays_for_a_parameter_by_the_logarithm_of_the_observations():
    result = SimpleNamespace(observations=100, cost=50.0, parameter_count=4)
    assert bic(result) == pytest.approx(100.0 * np.log(0.5) + 4.0 * np.log(100.0))


@pytest.mark.parametrize(("more", "chosen"), [(0.8, "simple"), (1.5, "rich")])
def test_a_simpler_model_is_as_good_within_one_standard_error_of_its_excess(more, chosen):
    """Nine displacements, on which the simple one is worse by so many standard errors on average."""
    scatter = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 1.0, -1.0, 1.0, -1.0])
    excess = more * np.std(scatter, ddof=1) / np.sqrt(9.0) + scatter
    rich, simple = score("rich", 6, np.full(9, 4.0)), score("simple", 3, 4.0 + excess)
    assert choose([rich, simple]).name == chosen


def test_errors_count_by_their_squares_where_they_are_of_different_sizes():
    """As they do in the fit and in the held-out error: a little worse where all is small is outweighed."""
    rich, simple = score("rich", 6, np.repeat([0.0, 16.0], 4)), score("simple", 3, np.repeat([1.0, 3.9**2], 4))
    assert choose([rich, simple]).name == "simple"
