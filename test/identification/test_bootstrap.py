"""Spread over redrawn tests: a standard deviation, in which what only the prior knows takes part."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification import bootstrap as module
from winch_friction.identification.bootstrap import Bootstrap, bootstrap
from winch_friction.records.model_file import load_model

PRIOR = load_model("a6vm215_crane2")


def test_the_spread_of_a_normal_estimate_is_its_standard_deviation():
    draws = np.random.default_rng(0).normal(5.0, [0.5, 2.0], (20_000, 2))
    draws[:50] = 1e6  # resamples of tests that say nothing do not decide
    assert Bootstrap(("a", "b"), draws, np.ones(2)).std == pytest.approx([0.5, 2.0], rel=0.03)


def test_what_the_tests_do_not_tell_spreads_as_the_prior_does(monkeypatch, crane_150t, spread):
    """Tests that say nothing: each fit stays at its own prior's centre."""
    monkeypatch.setattr(module, "observations", lambda tests, crane: None)
    monkeypatch.setattr(module, "joint_fit", lambda data, prior, spread: SimpleNamespace(model=prior))
    fitted = SimpleNamespace(prior=PRIOR, model=PRIOR)
    found = bootstrap([[], []], crane_150t, fitted, spread, resamples=400)
    names = PRIOR.parameter_names
    for name in ("K1", "C5", "C6"):
        k = names.index(name)
        assert found.std[k] == pytest.approx(PRIOR.std[k], rel=0.2), name


def test_a_prior_of_parameters_of_all_sizes_is_drawn_as_it_is(monkeypatch, crane_150t, spread):
    """Variances of 1e16 beside 1e-31, in one covariance: the smaller ones spread by six times too much."""
    std = 0.01 * np.array(PRIOR.values)
    size = len(std)
    alike = np.full((size, size), 0.9) + 0.1 * np.eye(size)
    prior = PRIOR.with_covariance(alike * np.outer(std, std))
    monkeypatch.setattr(module, "observations", lambda tests, crane: None)
    monkeypatch.setattr(module, "joint_fit", lambda data, prior, spread: SimpleNamespace(model=prior))
    found = bootstrap([[]], crane_150t, SimpleNamespace(prior=prior, model=prior), spread, resamples=1000)
    assert found.std / std == pytest.approx(np.ones(size), rel=0.1)
    assert np.corrcoef(found.estimates.T) == pytest.approx(alike, abs=0.1)


def test_tests_are_drawn_with_replacement_and_a_prior_without_a_covariance_stays(monkeypatch, crane_150t, spread):
    """Of five tests a redraw has five again, some of them twice; what it is said beside is the fit's own sigma."""
    drawn, priors = [], []
    monkeypatch.setattr(module, "observations", lambda tests, crane: drawn.append(sorted(each[0] for each in tests)))

    def fit(data, prior, spread):
        priors.append(prior)
        return SimpleNamespace(model=prior)

    monkeypatch.setattr(module, "joint_fit", fit)
    prior, model = PRIOR.with_covariance(None), PRIOR
    found = bootstrap([[k] for k in range(5)], crane_150t, SimpleNamespace(prior=prior, model=model), spread)
    assert len(drawn) == len(found.estimates) == 40
    assert {len(each) for each in drawn} == {5}
    assert sum(len(set(each)) < 5 for each in drawn) > 30
    assert all(each is prior for each in priors)
    assert found.linearised_std == pytest.approx(model.std)
    assert found.names == model.parameter_names
