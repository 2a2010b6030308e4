"""What one sample says: the noise of its torque, whether the drive is at a limit, the load, the sensors' errors."""

import math
from dataclasses import replace

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig
from winch_friction.estimation.sample import Accepted, HangingLoad, saturated, torque_variance
from winch_friction.estimation.sensor_errors import SensorErrors
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.crane_file import load_crane

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


# -- by hand
def test_the_noise_of_a_torque_is_that_of_every_pressure_and_every_displacement(crane):
    """Variances of independent errors add up: n D of both transducers, n D dp of the feedback."""
    shown = {"active": (200e5, 40e5, 3e-5, 3), "passive": (60e5, 220e5, 1e-5, 8)}
    groups = {name: GroupSample(a, b, d) for name, (a, b, d, _) in shown.items()}
    config = EstimatorConfig(pressure_noise=2e5, displacement_noise=0.01)
    expected = sum(2.0 * (n * d * 2e5) ** 2 + (n * d * (a - b) * 0.01) ** 2 for a, b, d, n in shown.values())
    assert torque_variance(Sample(0.0, 50.0, groups=groups), crane, config) == pytest.approx(expected)


@pytest.mark.parametrize("motors", [1, 4])
def test_the_noise_of_an_electric_torque_is_one_of_every_motor(motors):
    crane = replace(load_crane("emps"), groups={"main": motors})
    found = torque_variance(Sample(0.0, 1.0, motor_torque=5.0), crane, EstimatorConfig(torque_noise=3.0))
    assert found == pytest.approx((motors * 3.0) ** 2)


@pytest.mark.parametrize("delay", [0.0, 0.005, 0.01, 0.02, 0.05])
@pytest.mark.parametrize(("before", "last", "now"), [(300.0, 340.0, 500.0), (10.0, -40.0, 25.0), (1.0, 2.0, 3.0)])
def test_what_acted_before_a_late_speed_is_the_mean_along_straight_lines(delay, before, last, now):
    """Integrated here: from `delay` before the last sample to `delay` before this one, a step at most."""
    first = Accepted(0.0, before, 50.0, 0.1, 6.0)
    second = Accepted(0.02, last, 51.0, 0.3, 6.0).after(first)
    torque, heave = second.means(Accepted(0.04, now, 52.0, 0.5, 6.0), delay)
    times = 0.02 + 1e-5 * (np.arange(2000) + 0.5) - min(delay, 0.02)
    assert torque == pytest.approx(np.interp(times, [0.0, 0.02, 0.04], [before, last, now]).mean(), rel=1e-6)
    assert heave == pytest.approx(np.interp(times, [0.0, 0.02, 0.04], [0.1, 0.3, 0.5]).mean(), rel=1e-6)


@pytest.mark.parametrize("layer", [1.0, 3.0, math.nan])
def test_a_torque_at_the_shaft_is_a_mass_and_a_share_of_one_on_its_layer(crane, layer):
    load = HangingLoad(crane, 2.0)
    radius = crane.drum.layer_radii[-1] if math.isnan(layer) else crane.drum.layer_radii[int(layer) - 1]
    one = GRAVITY * radius / crane.gear_ratio  # N m per kg
    assert load.mass_by(20e3 * one, layer) == pytest.approx(20e3)
    assert load.mass_by(-20e3 * one, layer) == 0.0
    assert load.shaft_torque(layer) == 0.0
    assert math.isnan(load.share(one, layer))
    for mass, least in ((40e3, 40e3), (200.0, 1500.0), (0.0, 1500.0)):  # a hundredth of 150 t
        load.mass = mass
        assert load.shaft_torque(layer) == pytest.approx(mass * one)
        assert load.mass_by(20e3 * one, layer) == mass
        assert load.share(-3e3 * one, layer) == pytest.approx(-3e3 / least)


def test_where_no_rated_load_is_known_half_of_what_the_motors_hold_stands_for_it(crane):
    bare = replace(crane, rated_load=0.0)
    load = HangingLoad(bare, 2.0)
    load.mass = 0.0
    least = 0.01 * 0.5 * ChannelRanges(bare).load
    assert load.share(bare.drum_torque(least) / bare.gear_ratio, math.nan) == pytest.approx(1.0)


@pytest.mark.parametrize(("relative", "counts"), [(0.099, False), (0.101, True), (-0.099, False), (-0.101, True)])
def test_a_load_is_another_one_from_a_tenth_on_either_way(crane, relative, counts):
    load = HangingLoad(crane, 2.0)
    load.mass, load.doubted = 50e3, True
    shown = (1.0 + relative) * 50e3
    assert (load.following(sample(hook_load=shown), 0.02) == shown) is counts
    assert load.is_another(relative * load.shaft_torque(math.nan), sample(hook_load=50e3)) is counts
