"""When a seed's claim is taken back: how far the estimate went along what was told, and how often in a row; and when a
speed is said to be late."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2

from winch_friction.estimation import EstimatorConfig, conflict
from winch_friction.estimation.conflict import LOOK_PERIOD, SeedConflict, Shift, shift_of
from winch_friction.estimation.considered import ConsideredErrors

TOLD = np.diag([0.9, 0.1])  # of the prior's variance a tenth is taken along the first direction, most along the second


@pytest.mark.parametrize(("by_sensors", "chi2"), [(0.0, 1.0 / 0.9), (0.6, 1.0 / 1.5)])
def test_a_shift_counts_along_what_the_data_told_and_beyond_what_sensors_make(by_sensors, chi2):
    found = shift_of(np.array([5.0, 1.0]), TOLD, TOLD + np.diag([0.0, by_sensors]), np.eye(2))
    assert found.directions == 1
    assert found.chi2 == pytest.approx(chi2)


@pytest.mark.parametrize(("looks", "widened"), [("rr", False), ("rrorr", False), ("orrr", True), ("rrr", True)])
def test_a_seed_is_refuted_by_three_looks_in_a_row(monkeypatch, looks, widened):
    """A seed far off is first blamed on the load; what is refuted once and not the next time was that."""
    said = iter(looks)
    monkeypatch.setattr(conflict, "shift_of", lambda *_: Shift(9.0, 1, 1e-9 if next(said) == "r" else 0.5))
    done = []
    parameters = SimpleNamespace(prior=None, widened=False, size=3, widened_names=(), widen=done.extend)
    state = SimpleNamespace(
        phi=None, phi_covariance=None, considered_covariance=None, change_prior=lambda change: change()
    )
    each = SeedConflict(EstimatorConfig(), parameters)
    for _ in looks:
        for _ in range(10):
            each.step(state, 0.1 * LOOK_PERIOD + 1e-9)
    assert done == ([0, 1, 2] if widened else [])


@pytest.mark.parametrize(("taken", "directions"), [(0.1, 0), (0.45, 0), (0.55, 1), (0.8, 1)])
def test_a_direction_counts_once_the_data_took_half_of_its_variance(taken, directions):
    covariance = np.diag([1.0, 1.0 - taken])
    found = shift_of(np.array([9.0, 2.0]), covariance, covariance, np.eye(2))
    assert found.directions == directions
    assert found.chi2 == pytest.approx(4.0 / taken if directions else 0.0)
    assert found.probability == pytest.approx(chi2.sf(4.0 / taken, 1) if directions else 1.0)


def test_a_shift_is_the_same_in_whatever_units_and_mixtures_the_parameters_are():
    rng = np.random.default_rng(3)
    mixed, phi = rng.normal(size=(3, 3)) + 2.0 * np.eye(3), np.array([1.0, -2.0, 0.5])
    covariance, sensors = np.diag([0.2, 0.3, 0.9]), np.diag([0.1, 0.0, 0.2])
    plain = shift_of(phi, covariance, covariance + sensors, np.eye(3))
    assert plain.chi2 == pytest.approx(1.0 / (0.8 + 0.1) + 4.0 / 0.7)
    other = shift_of(mixed @ phi, *(mixed @ each @ mixed.T for each in (covariance, covariance + sensors, np.eye(3))))
    assert (other.directions, other.chi2) == (2, pytest.approx(plain.chi2))


@pytest.mark.parametrize(("level", "looks"), [(0.01, 12), (0.0, 0)])
def test_every_five_seconds_of_learning_is_looked_at_the_prior_that_is_believed_then(monkeypatch, level, looks):
    asked = []
    monkeypatch.setattr(conflict, "shift_of", lambda *given: asked.append(given) or Shift(1.0, 1, 0.3))
    parameters = SimpleNamespace(prior="now", seed_prior="before", widened=(), size=1, widened_names=())
    state = SimpleNamespace(phi="phi", phi_covariance="P", considered_covariance="C")
    each = SeedConflict(EstimatorConfig(conflict_level=level), parameters)
    for _ in range(250):
        each.step(state, 0.25)
    assert asked == [("phi", "P", "C", "now")] * looks


@pytest.mark.parametrize("names", [(), ("K1", "C5")])
def test_a_status_tells_the_shift_and_whose_sigmas_were_taken_back(names):
    each = SeedConflict(EstimatorConfig(), SimpleNamespace(widened_names=names))
    each.shift = Shift(7.5, 3, 0.06)
    assert each.status() == {
        "seed": "refuted" if names else "holds", "seed_shift_chi2": 7.5, "seed_shift_directions": 3,
        "seed_shift_probability": 0.06, "seed_widened": ", ".join(names),
    }  # fmt: skip


# -- a lateness that is told
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_lateness_is_what_innovations_are_off_by_a_hundred_times_over(sign):
    """Each tells 2 of one error with a variance of 4: after a hundred the deviation is a tenth, and 0.5 is found."""
    each = ConsideredErrors((0.15,), late=True)
    assert all(np.isnan(each.lateness))
    for _ in range(100):
        each.step(np.array([2.0]), sign, 4.0)
    assert each.lateness == (pytest.approx(0.5 * sign), pytest.approx(0.1))
    status = each.status()
    assert (status["speed_late"], status["speed_late_std"]) == each.lateness
    assert "about 0.5 of the time between two samples" in status["lateness"]
    assert status["lateness"].startswith("motor_speed seems late" if sign > 0.0 else "pressures or torque seem late")
    fresh = each.anew()
    assert all(np.isnan(fresh.lateness))
    fresh.step(np.array([2.0]), sign, 4.0)
    assert fresh.lateness[1] == pytest.approx(1.0)
    assert each.lateness[1] == pytest.approx(0.1)


def test_an_error_that_is_no_lateness_is_not_told_as_one():
    each = ConsideredErrors((0.15,), late=False)
    for _ in range(100):
        each.step(np.array([2.0]), 1.0, 4.0)
    assert all(np.isnan(each.lateness))
    assert each.status()["lateness"] == ""
