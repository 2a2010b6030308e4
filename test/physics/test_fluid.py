"""What leaks and what gives way: with the sign of the drop, whatever the oil, and below the atmosphere."""

import numpy as np
import pytest

from winch_friction.physics.fluid import (
    LEAKAGE_LAWS,
    air_compressed,
    kinematic_viscosity,
    leakage_per_coefficient,
    relative_viscosity,
    relaxed_compression,
)
from winch_friction.physics.friction import term_named
from winch_friction.physics.friction.symbols import oil_temperature, w
from winch_friction.physics.winch.operating_point import PredictedSpeed, time_to_reversal


def test_the_oil_is_as_thick_as_it_is_stated_and_terms_follow_it():
    np.testing.assert_allclose(kinematic_viscosity(np.array([20.0, 60.0])), [134.0, 21.0])
    term = term_named("viscosity_temperature")
    for celsius in (-10.0, 40.0, 80.0):
        values = {term.parameters[0].symbol: 1.0, w: 1.0, oil_temperature: celsius}
        assert float(term.equation.subs(values)) == pytest.approx(relative_viscosity(celsius) - 1.0, abs=1e-12)


@pytest.mark.parametrize("law", LEAKAGE_LAWS)
def test_every_leak_is_stated_at_150_bar_and_turns_with_the_drop(law):
    drop = 150e5 * np.array([1.0, -1.0, 0.0])
    np.testing.assert_allclose(leakage_per_coefficient(law, drop, 1.0), drop)


@pytest.mark.parametrize(
    ("law", "thin"),
    [("slip_leakage", 2.0), ("orifice_leakage", 1.0), ("opening_gap_leakage", 2.0), ("isoviscous_leakage", 1.0)],
)
def test_thin_oil_leaks_more_through_a_gap_and_as_much_through_an_orifice(law, thin):
    drop = np.array([80e5, -200e5])
    np.testing.assert_allclose(leakage_per_coefficient(law, drop, 2.0), thin * leakage_per_coefficient(law, drop, 1.0))


def test_air_is_as_large_as_it_gets_at_the_atmosphere():
    """A transducer's zero below it, and a line that cavitates, make no number that is none."""
    high = np.array([1e5, -2.0e5, 0.0, 1e5, 20.0 * 1e5])
    found = air_compressed(high, high - 1.0e5)
    np.testing.assert_allclose(found[:4], 0.0)
    assert found[4] == pytest.approx(1.0 - 20.0 ** (-1.0 / 1.4))


def test_a_lost_pressure_is_bridged_and_the_gas_follows_what_is_left():
    time, pressure = np.arange(0.0, 100.0, 0.1), np.full(1000, 300e5)
    pressure[500:] = 330e5
    whole = relaxed_compression(time, pressure, 10.0)
    lost = pressure.copy()
    lost[700:750] = np.nan
    np.testing.assert_allclose(relaxed_compression(time, lost, 10.0), whole)
    assert whole[499] == 0.0
    assert whole[600] == pytest.approx(np.log(1.1) * (1.0 - np.exp(-10.1 / 10.0)))


@pytest.mark.parametrize(
    ("speed", "acceleration", "seconds"),
    [(10.0, -5.0, 2.0), (-10.0, 5.0, 2.0), (10.0, 5.0, np.inf), (-10.0, -5.0, np.inf), (10.0, 0.0, np.inf)],
)
def test_a_motion_turns_only_where_it_is_braked(speed, acceleration, seconds):
    assert time_to_reversal(PredictedSpeed(speed, acceleration)) == seconds
