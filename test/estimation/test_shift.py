"""When a seed's claim is taken back: how far the estimate went along what was told, and how often in a row."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig, conflict
from winch_friction.estimation.conflict import LOOK_PERIOD, SeedConflict, Shift, shift_of

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
