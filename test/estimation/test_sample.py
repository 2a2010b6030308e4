"""What one sample says: the noise of its torque, whether the drive is at a limit, the load, the sensors' errors."""

import math
from dataclasses import replace

import pytest

from winch_friction.estimation import EstimatorConfig
from winch_friction.estimation.sample import HangingLoad, saturated, torque_variance
from winch_friction.estimation.sensor_errors import SensorErrors
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import GroupSample, Sample

CONFIG = EstimatorConfig(saturation_pressure=350e5)


def sample(pressure_a=150e5, pressure_b=25e5, **channels):
    return Sample(0.0, 50.0, groups={"main": GroupSample(pressure_a, pressure_b, 3e-5)}, **channels)


@pytest.mark.parametrize(
    ("pressure_a", "pressure_b", "limit"), [(351e5, 25e5, True), (25e5, 351e5, True), (349e5, 25e5, False)]
)
def test_one_port_at_its_limit_suffices_for_saturation(crane, pressure_a, pressure_b, limit):
    assert saturated(sample(pressure_a, pressure_b), crane, CONFIG) is limit


def test_both_transducers_of_a_group_are_noisy(crane):
    config = EstimatorConfig(pressure_noise=1e5, displacement_noise=0.0)
    full = crane.motor_count("main") * 3e-5
    assert torque_variance(sample(), crane, config) == pytest.approx(2.0 * (full * 1e5) ** 2)


def test_a_load_that_is_picked_up_counts_at_once_and_noise_by_and_by(crane):
    load = HangingLoad(crane, time_constant=5.0)
    load.mass = 20e3
    assert load.following(sample(hook_load=50e3), 0.02) == 50e3
    assert load.following(sample(hook_load=10e3), 0.02) == 10e3
    assert load.following(sample(hook_load=21e3), 0.02) == pytest.approx(20e3 + 1e3 * 0.02 / 5.02)
    assert load.following(sample(hook_load=math.nan), 0.02) == 20e3


@pytest.mark.parametrize("order", [1, -1])
def test_of_a_sensors_corrections_the_least_sure_says_how_sure_it_is(crane, seed, order):
    known = (Correction("pressure_offset", 1e5, 3e4, groups=("main",)), Correction("pressure_offset", 1e5, 1e4))
    errors = SensorErrors(crane, replace(seed, corrections=known[::order]), EstimatorConfig(displacement_scale_std=0.0))
    assert errors.std[1] == 3e4


def test_a_cell_that_shows_less_than_nothing_shows_an_empty_hook(crane):
    """Its zero is off by 0.2 t: when 55 t had been set down they hung there for good."""
    load = HangingLoad(crane, 2.0)
    for shown, mass in ((55e3, 55e3), (-200.0, 0.0), (-190.0, 0.0), (4e3, 4e3)):
        load.mass = load.following(sample(hook_load=shown), 0.02)
        assert load.mass == mass
