"""A candidate's column is the torque that the error of its transducers adds, port by port."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.signals import ALL, curved_columns, scale_columns
from winch_friction.discrepancy.preparation.prepared_run import GroupSignals
from winch_friction.physics.corrections import straight

A, B, SWASH, MOTORS = np.array([2.2e7, 1.1e7, 3.0e6]), np.array([2.5e6, 4.0e6, 9.0e6]), 2.4e-5, 3


def run():
    drop, zero = A - B, np.zeros(3)
    group = GroupSignals("active", MOTORS, drop, A + B, zero, np.full(3, SWASH), True, drop)
    return SimpleNamespace(groups=[group], time=zero)


@pytest.mark.parametrize("port_a", [0.0, 1.0])
@pytest.mark.parametrize(("columns", "power", "error"), [(scale_columns, 1, 1e-3), (curved_columns, 2, 5e-11)])
def test_a_column_is_the_torque_that_the_error_adds(columns, power, error, port_a):
    logged_b = B if port_a else B + error * B**power
    added = MOTORS * SWASH * ((A + error * A**power - logged_b) - (A - B))
    column = columns(run(), {"groups": ALL, "port_a": port_a})
    np.testing.assert_allclose(error * column[:, 0], added, rtol=1e-6)


@pytest.mark.parametrize("error", [5e-10, -5e-10, 1e-20, 0.0])
def test_a_gain_that_grows_is_taken_out_exactly(error):
    np.testing.assert_allclose(straight(A * (1.0 + error * A), error), A, rtol=1e-12)
