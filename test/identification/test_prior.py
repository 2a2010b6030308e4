"""What is known before the crane is measured: the supplier's fit, and the spread between units on top."""

import numpy as np
import pytest

from winch_friction.identification.prior import UnitSpread, supplier_prior
from winch_friction.records.model_file import load_model

SPREAD = UnitSpread({"K1": 0.1, "K4": 0.2}, 0.01, 0.0025, 75e3, 0.01)


@pytest.fixture(scope="module")
def motor():
    return load_model("a6vm215")


def at(model, name):
    return model.parameter_names.index(name)


def test_the_spread_between_units_adds_to_the_fits_own_variance(motor):
    own = np.diag((0.05 * np.abs(motor.values)) ** 2)
    found = supplier_prior(motor.with_covariance(own), SPREAD)
    k = at(motor, "K4")
    assert found.std[k] == pytest.approx(np.hypot(0.05, 0.2) * abs(motor.value("K4")))
    k = at(motor, "K2")  # of which the file says nothing
    assert found.std[k] == pytest.approx(np.hypot(0.05, 1.0) * abs(motor.value("K2")))


def test_a_parameter_that_was_fitted_to_nothing_is_not_known_exactly(motor):
    typical = motor.parameters[at(motor, "K1")].typical
    zero = motor.with_values({"K1": 0.0}).with_covariance(None)
    assert SPREAD.std(zero)[at(motor, "K1")] == pytest.approx(0.1 * 0.1 * typical)
