"""The estimator's parts, each against what it must be by itself."""

import math

import numpy as np
import pytest
from filterpy.kalman import ExtendedKalmanFilter
from scipy.linalg import expm

from winch_friction.estimation import EstimatorConfig, dynamics
from winch_friction.estimation.answers import ParameterStatus
from winch_friction.estimation.dynamics import Friction, wire_step
from winch_friction.estimation.filter import SpeedFilter
from winch_friction.estimation.interval import mean_direction
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.trust import Consistency, Excitation, VarianceFactor, nis_band
from winch_friction.physics.friction.seed_range import seed_range


def some_filter(size=9, seed=1):
    rng = np.random.default_rng(seed)
    each = SpeedFilter(dynamics.measurement(size))
    root = rng.normal(size=(size, size))
    each.P, each.x = root @ root.T, rng.normal(size=(size, 1))
    return each


def test_the_wire_steps_as_the_exact_solution_does(crane):
    mass, length, damping, dt = 55e3, 50.0, 1.5e5, 0.02
    r, k = crane.drum.radius(6) / crane.gear_ratio, crane.wire_stiffness / 50.0
    shaft = r / crane.inertia
    rates = np.array(
        [
            [-damping * r * shaft, -k * shaft, damping * shaft],
            [r, 0.0, -1.0],
            [damping * r / mass, k / mass, -damping / mass],
        ]
    )
    step = wire_step(crane, mass, 6, length, damping, dt)
    assert step.transition == pytest.approx(expm(rates * dt), abs=0.02 * np.abs(expm(rates * dt)).max())
    still = np.array([0.0, 0.0, 0.0])
    assert step.transition @ still + step.by_heave * 0.0 == pytest.approx(still)
    moving = np.array([-1.0 / r, 0.0, 0.0])  # heave compensated: the load hangs still
    assert step.transition @ moving + step.by_heave == pytest.approx(moving, abs=1e-9 / r)


def test_without_a_load_the_shaft_is_alone(crane):
    step = wire_step(crane, 0.0, 6, 50.0, 1e5, 0.02)
    assert step.by_torque[0] == pytest.approx(0.02 / crane.inertia)
    assert np.array_equal(step.transition, np.eye(3))


def test_the_jacobian_is_that_of_the_propagation(crane, seed):
    config = EstimatorConfig()
    parameters = ScaledParameters(seed, config)
    gradient = np.random.default_rng(3).normal(size=len(seed.values)) / parameters.scale
    wire = wire_step(crane, 55e3, 6, 50.0, 1.5e5, 0.02)
    size = dynamics.FIRST_PARAMETER + parameters.size

    def moved(x):
        theta = parameters.values(x[dynamics.FIRST_PARAMETER :, 0])
        torque = float(gradient @ (theta - np.array(seed.values)))
        step = dynamics.Step(100.0, 1.0, 0.5, 0.02, wire, Friction(torque, gradient, 500.0), False)
        return dynamics.propagate(x, step, config), step

    x = np.random.default_rng(2).normal(size=(size, 1)) * 0.1
    base, step = moved(x)
    matrix = dynamics.jacobian(size, step, config, parameters)
    for column in range(size):
        shifted = x.copy()
        shifted[column, 0] += 1e-4
        assert (moved(shifted)[0] - base)[:, 0] / 1e-4 == pytest.approx(matrix[:, column], rel=1e-6, abs=1e-9)


def test_an_ordinary_correction_is_filterpys():
    each, plain = some_filter(), ExtendedKalmanFilter(9, 1)
    row = dynamics.measurement(9)
    plain.x, plain.P = each.x.copy(), each.P.copy()
    plain.update(np.array([[0.7]]), lambda _: row, lambda x: row @ x, R=0.3)
    each.correct(0.7, 0.3, considered=0)
    assert np.allclose(each.x, plain.x, rtol=1e-12)
    assert np.allclose(each.P, plain.P, rtol=1e-12)


def test_considered_states_keep_value_and_variance_and_the_rest_is_no_surer_than_optimal():
    considered, optimal = some_filter(), some_filter()
    x, covariance = considered.x.copy(), considered.P.copy()
    considered.correct(0.7, 0.3, considered=2)
    optimal.correct(0.7, 0.3, considered=0)
    assert np.array_equal(considered.x[-2:], x[-2:])
    assert np.array_equal(considered.P[-2:, -2:], covariance[-2:, -2:])
    assert not np.array_equal(considered.P[:2, -2:], covariance[:2, -2:])
    assert np.all(np.diag(considered.P) >= np.diag(optimal.P) - 1e-12)
    assert np.linalg.eigvalsh(considered.P).min() > -1e-9


def test_forgetting_goes_to_the_seed_and_never_beyond(seed):
    config = EstimatorConfig(forgetting_time=10.0)
    parameters = ScaledParameters(seed, config)
    size = dynamics.FIRST_PARAMETER + parameters.size
    covariance = np.eye(size)
    covariance[-1, -1] = 0.01  # learned; the others are as in the seed
    noise = dynamics.forgotten(covariance, 1.0, config, np.eye(parameters.size))
    assert noise[-1, -1] == pytest.approx(0.1 * 0.99)
    noise[-1, -1] = 0.0
    assert not noise.any()


def test_projection_moves_correlated_parameters_along(seed):
    config = EstimatorConfig(seed_range=0.5)
    parameters = ScaledParameters(seed, config)
    size = dynamics.FIRST_PARAMETER + parameters.size
    covariance = np.eye(size)
    covariance[-1, -2] = covariance[-2, -1] = 0.8
    x = np.zeros((size, 1))
    x[-1, 0] = parameters.upper[-1] + 1.0
    out = parameters.projected(x, covariance)
    assert out[-1, 0] == pytest.approx(parameters.upper[-1])
    assert out[-2, 0] == pytest.approx(-0.8)
    limits = seed_range(seed, 0.5)
    for name, value in zip(seed.parameter_names, parameters.values(out[dynamics.FIRST_PARAMETER :, 0]), strict=True):
        assert limits[name][0] <= value <= limits[name][1]


@pytest.mark.parametrize(
    ("before", "after", "mean"),
    [(1.0, 3.0, 1.0), (-2.0, -1.0, -1.0), (-1.0, 3.0, 0.5), (0.0, 0.0, 0.0), (2.0, -2.0, 0.0)],
)
def test_mean_direction_of_a_linear_speed(before, after, mean):
    assert mean_direction(before, after) == pytest.approx(mean)
    speeds = np.linspace(before, after, 100001)
    assert mean_direction(before, after) == pytest.approx(np.sign(speeds).mean(), abs=1e-4)


def test_excitation_is_forgotten():
    each = Excitation(10.0)
    for speed in (0.0, 40.0, -40.0):
        each.step(speed, 0.02)
    assert each.range == pytest.approx(80.0, rel=0.01)
    for _ in range(2000):
        each.step(0.0, 0.02)
    assert each.range < 80.0 * math.exp(-3.0)


def test_status_has_hysteresis_and_needs_time():
    each = ParameterStatus(EstimatorConfig(learning_below=0.9, learned_below=0.6, hysteresis=0.05, settle_time=1.0))
    said = []
    for share in (1.0, 0.92, 0.89, 0.92, 0.96, 0.55, 0.63, 0.66):
        each.step(share, frozen=False, at_limit=False, dt=0.1)
        said.append(each.text)
    assert said == ["seed", "seed", "learning", "learning", "seed", "learned", "learned", "learning"]
    for _ in range(5):
        each.step(0.7, frozen=True, at_limit=False, dt=0.1)
    assert each.text == "learning"
    for _ in range(6):
        each.step(0.7, frozen=True, at_limit=False, dt=0.1)
    assert each.text == "frozen"
    for _ in range(11):
        each.step(0.7, frozen=False, at_limit=True, dt=0.1)
    assert each.text == "invalid"


def test_white_innovations_are_consistent_and_twice_too_large_ones_are_not():
    rng = np.random.default_rng(7)
    good, bad, factor = Consistency(100), Consistency(100), VarianceFactor(5.0)
    for value in rng.normal(size=20000):
        good.step(value**2)
        bad.step(4.0 * value**2)
        factor.step(4.0 * value**2 / factor.value, 0.02)
    assert good.share_inside == pytest.approx(0.95, abs=0.03)
    assert bad.share_inside < 0.05
    assert factor.value == pytest.approx(4.0, rel=0.2)
    assert nis_band(100)[0] < 1.0 < nis_band(100)[1]
