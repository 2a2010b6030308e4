"""The estimator's parts, each against what it must be by itself."""

import math
import sys
from dataclasses import replace

import numpy as np
import pytest
from filterpy.kalman import ExtendedKalmanFilter
from scipy.linalg import expm
from scipy.stats import chi2

from winch_friction.estimation import EstimatorConfig, chi_squared
from winch_friction.estimation.answers import ParameterStatus
from winch_friction.estimation.compiled_filter import CompiledFilter
from winch_friction.estimation.dynamics import (
    ACTING,
    DAMPING,
    DISTURBANCE,
    ENCODER,
    ENCODER_CHANGE,
    FIRST_PARAMETER,
    LOAD,
    LOAD_SPEED,
    SPEED,
    STRETCH,
    Propagation,
    Step,
    fresh_motion,
    noise_variances,
    wire_step,
)
from winch_friction.estimation.estimator import filter_class
from winch_friction.estimation.filter import StateFilter
from winch_friction.estimation.interval import mean_direction
from winch_friction.estimation.kernels import kernels
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.estimation.reference import ReferenceFilter
from winch_friction.estimation.sample import HangingLoad
from winch_friction.estimation.trust import Consistency, Excitation, VarianceFactor, nis_band
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction.seed_range import seed_range
from winch_friction.physics.signals import Sample

SENSORS = (0.01, 1e5)


@pytest.fixture(params=[StateFilter, CompiledFilter])
def kind(request):
    """The filter in NumPy and as compiled loops: what holds for one holds for the other."""
    return request.param


def unbounded(each):
    """The range of the parameters has tests of its own."""
    each.parameters.contains = lambda phi: True
    each.parameters.lower[:], each.parameters.upper[:] = -np.inf, np.inf


def some_filter(model, config=None, seed=1, kind=StateFilter):
    """A filter in some state, and a step from there."""
    config = config or EstimatorConfig()
    rng = np.random.default_rng(seed)
    each = kind(config, ScaledParameters(model, config), SENSORS)
    root = rng.normal(size=(each.size, each.size)) * 0.1
    each.state = 0.1 * rng.normal(size=(each.size, 1)), root @ root.T
    gradient = (rng.normal(size=len(model.values)) / model.std).tolist()
    wire = rng.normal(size=(3, 6)) * 0.1 + np.eye(3, 6)
    return each, Step(100.0, 4.0, 0.0, 30.0, gradient, (-600.0, -1e-3), wire, 0.5, 0.02, False)


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
    step = np.array(wire_step(crane, mass, 6, length, damping, dt))
    assert step[:, :3] == pytest.approx(expm(rates * dt), abs=0.02 * np.abs(expm(rates * dt)).max())
    tustin = np.linalg.inv(np.eye(3) - 0.5 * dt * rates)
    assert step[:, :3] == pytest.approx(tustin @ (np.eye(3) + 0.5 * dt * rates), rel=1e-9, abs=1e-12)
    assert step[:, 3] == pytest.approx(dt * tustin @ [1.0 / crane.inertia, 0.0, 0.0], rel=1e-9)
    assert step[:, 4] == pytest.approx(dt * tustin @ [-damping * shaft, 1.0, damping / mass], rel=1e-9)
    moving = np.array([-1.0 / r, 0.0, 0.0])  # heave compensated: the load hangs still
    assert step[:, :3] @ moving + step[:, 4] == pytest.approx(moving, abs=1e-9 / r)


def test_without_a_load_the_shaft_is_alone(crane):
    step = np.array(wire_step(crane, 0.0, 6, 50.0, 1e5, 0.02))
    assert step[0, 3] == pytest.approx(0.02 / crane.inertia)
    assert np.array_equal(step[:, :3], np.eye(3))
    assert not step[:, 4:].any()


@pytest.mark.parametrize("mass", [4e3, 55e3])
def test_what_a_wires_damping_may_be_off_by_moves_shaft_and_load_as_another_damping_would(crane, mass):
    motion, more = np.array([40.0, 3e-3, 0.2, 500.0, -0.3]), 1e-6
    one, other = (np.array(wire_step(crane, mass, 6, 50.0, 1.5e5 * each, 0.02)) for each in (1.0, 1.0 + more))
    opened = (one[:, :5] @ motion)[STRETCH] - motion[STRETCH]
    assert one[:, DAMPING] * opened == pytest.approx((other - one)[:, :5] @ motion / more, rel=1e-4)


def test_the_matrix_is_the_jacobian_of_the_propagation(seed):
    config = EstimatorConfig()
    parameters = ScaledParameters(seed, config)
    motion = Propagation(config, parameters.free, parameters.scale)
    _, step = some_filter(seed)
    gradient = np.array(step.by_parameters)

    def following(x):
        friction = float(gradient @ (parameters.scale * x[FIRST_PARAMETER:]))
        return moved(x, step._replace(friction=friction), config)

    x = 0.1 * np.random.default_rng(2).normal(size=motion.size)
    base = following(x)
    motion.take(step, x[FIRST_PARAMETER:])
    for column in range(motion.size):
        shifted = x.copy()
        shifted[column] += 1e-4
        assert (following(shifted) - base) / 1e-4 == pytest.approx(motion.matrix[:, column], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("learning", [True, False])
def test_the_states_move_as_the_equations_say(kind, seed, learning):
    each, step = some_filter(seed, kind=kind)
    x = each.x[:, 0].copy()
    each.predict_step(step, learning, False)
    assert each._ahead_carried[-1] == pytest.approx(moved(x, step, EstimatorConfig()), rel=1e-12, abs=1e-12)


def moved(x, step, config):
    """The states one step on: load torque and parameters stay, the disturbance fades, the rounding becomes a change."""
    out = x.copy()
    torque = step.torque - x[LOAD] - x[DISTURBANCE] - step.friction
    out[:3] = np.array(step.wire)[:, :DAMPING] @ [*x[:3], torque, step.heave]
    out[DISTURBANCE] *= math.exp(-step.duration / config.disturbance_time)
    out[ENCODER], out[ENCODER_CHANGE] = 0.0, -x[ENCODER]
    return out


def test_a_step_is_filterpys_predict_and_update(kind, seed):
    """filterpy's extended Kalman filter with the same F, Q, H and R, over a hundred steps."""
    config = EstimatorConfig(forgetting_time=1e12)  # the fading of the parameters' covariance has a test of its own
    each, step = some_filter(seed, config, kind=kind)
    plain, rng = ReferenceFilter(each), np.random.default_rng(5)
    assert isinstance(plain, ExtendedKalmanFilter)
    for _ in range(100):
        step = step._replace(torque=float(rng.normal(scale=100.0)), heave=float(rng.normal()))
        measured = float(plain.x[SPEED, 0] + rng.normal())
        following = moved(plain.x[:, 0], step, config)
        plain.take(step, measured)
        assert plain.x_prior[:, 0] == pytest.approx(following, rel=1e-9, abs=1e-9)
        each.predict_step(step, True, False)
        innovation, variance = each.innovation(measured)
        unbounded(each)
        each.correct(innovation, variance, True)
        scale = np.sqrt(np.outer(np.diag(plain.P), np.diag(plain.P))) + 1e-12
        assert np.abs((each.P - plain.P) / scale).max() < 1e-9
        assert each.x == pytest.approx(plain.x, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("count", [1, 2, 3, 7, 10, 50, 51, 1000])
def test_chi_squared_is_scipys(count):
    for tail in (1e-9, 1e-3, 0.025, 0.5, 0.975, 1.0 - 1e-6):
        squares = chi2.ppf(tail, count)
        assert chi_squared.survival(squares, count) == pytest.approx(chi2.sf(squares, count), rel=1e-9)
        assert chi_squared.quantile(tail, count) == pytest.approx(squares, rel=1e-6 if tail < 1e-6 else 1e-9)
    assert chi_squared.survival(0.0, count) == 1.0
    assert chi_squared.survival(2000.0 + 10.0 * count, count) == pytest.approx(chi2.sf(2000.0 + 10.0 * count, count))


@pytest.mark.parametrize(("learning", "stick"), [(True, False), (False, False), (False, True)])
def test_what_is_considered_keeps_value_and_variance_and_the_rest_is_josephs(kind, seed, learning, stick):
    each, step = some_filter(seed, kind=kind)
    each.predict_step(step, learning, False)
    ahead, x = each._ahead_P.copy(), each._ahead_carried[-1].copy()
    innovation, variance = each.innovation(0.7)
    row = np.zeros(each.size)
    row[[SPEED, ENCODER_CHANGE]] = 1.0
    considered = np.arange(each.size if learning else FIRST_PARAMETER, each.size)
    considered = np.append(considered, LOAD) if stick else considered
    gain = ahead @ row / variance
    gain[considered] = 0.0
    left = np.eye(each.size) - np.outer(gain, row)
    joseph = left @ ahead @ left.T + each.speed_variance * np.outer(gain, gain)
    unbounded(each)
    each.correct(innovation, variance, learning, stick)
    assert np.allclose(each.P, joseph, rtol=1e-9, atol=1e-12 * np.abs(joseph).max())
    assert np.array_equal(each.x[considered, 0], x[considered])
    among = np.ix_(considered, considered)
    assert np.array_equal(each.P[among], ahead[among])
    assert np.linalg.eigvalsh(each.P).min() > -1e-9


def test_the_sensitivity_is_what_a_sensor_error_does_to_the_state(kind, seed):
    config = EstimatorConfig(forgetting_time=1e12, wire_damping_std=0.0)
    wrong, right = some_filter(seed, config, kind=kind)[0], some_filter(seed, config, kind=kind)[0]
    error = np.array([0.004, 3e4])
    rng = np.random.default_rng(4)
    for each in (wrong, right):
        unbounded(each)
    _, step = some_filter(seed, kind=kind)
    for k in range(200):
        by_sensors = (-600.0 * rng.normal(), -1e-3)
        step = step._replace(torque=float(rng.normal(scale=50.0)), by_sensors=by_sensors)
        true = step._replace(torque=step.torque + float(np.dot(by_sensors, error)))
        for each, acting in ((wrong, step), (right, true)):
            friction = float(np.dot(step.by_parameters, seed.std * each.phi))
            each.predict_step(acting._replace(friction=friction), k % 3 > 0, False)
            innovation, variance = each.innovation(0.1 * k)
            each.correct(innovation, variance, k % 3 > 0)
    assert (right.x - wrong.x)[:, 0] == pytest.approx(error @ wrong.sensitivity, rel=1e-6, abs=1e-9)
    root = wrong.sensitivity[:, FIRST_PARAMETER:] * np.array(SENSORS)[:, None]
    assert wrong.considered_covariance - wrong.phi_covariance == pytest.approx(root.T @ root, rel=1e-6, abs=1e-12)


def test_the_sensitivity_is_what_another_damping_of_the_wire_does_to_the_state(seed):
    """The compiled filter is held to this one below."""
    wrong, right = some_filter(seed)[0], some_filter(seed)[0]
    more, rng = 1e-6, np.random.default_rng(4)
    for each in (wrong, right):
        unbounded(each)
    _, step = some_filter(seed)
    for k in range(30):
        wire = rng.normal(size=(3, ACTING)) * 0.1 + np.eye(3, ACTING)
        opening = wire[STRETCH, :DAMPING] - np.eye(1, DAMPING, STRETCH)[0]
        other = wire.copy()
        other[:, :DAMPING] += more * np.outer(wire[:, DAMPING], opening)
        for each, acting in ((wrong, wire), (right, other)):
            friction = float(np.dot(step.by_parameters, seed.std * each.phi))
            own = step._replace(wire=acting, friction=friction, by_sensors=(0.0, 0.0))
            own = own._replace(torque=float(np.sin(k)))
            each.predict_step(own, True, False)
            if each is wrong:
                gain = each._ahead_P.copy()
            each._ahead_P[:] = gain  # that of a filter that does not know
            innovation, variance = each.innovation(0.1 * k)
            each.correct(innovation, variance, True)
    found = (right.x - wrong.x)[:, 0] / more
    assert wrong.sensitivity[-1] == pytest.approx(found, rel=1e-3, abs=1e-4 * np.abs(found).max())


def from_the_prior(filters, seed):
    """Both at rest, and of the parameters no more certain than their prior."""
    start = np.diag([1e-2, 1e-6, 1e-2, 100.0, 100.0, 1e-2, 1e-2] + [0.0] * len(seed.values))
    for each in filters:
        covariance = start.copy()
        covariance[FIRST_PARAMETER:, FIRST_PARAMETER:] = each.parameters.prior
        each.state = np.zeros((each.size, 1)), covariance


def taught(filters, seed, step, count):
    """The same samples for all of them, of which each sees its own friction; yields after every one."""
    rng = np.random.default_rng(6)
    for k in range(count):
        gradient = rng.normal(size=len(seed.values)) * 0.1 / seed.std
        step = step._replace(by_parameters=gradient.tolist(), by_sensors=(rng.normal(), 1e-5))
        for each in filters:
            each.predict_step(step._replace(friction=float(np.dot(gradient, seed.std * each.phi))), True, False)
            innovation, variance = each.innovation(0.01 * k)
            each.correct(innovation, variance, True)
        yield k


def test_another_prior_is_as_if_it_had_been_there_from_the_start(kind, seed):
    """Two filters on the same data: one begins with the wide prior, the other takes it later."""
    config = EstimatorConfig(forgetting_time=1e12, wire_damping_std=0.0)
    early, late = some_filter(seed, config, kind=kind)[0], some_filter(seed, config, kind=kind)[0]
    _, step = some_filter(seed, kind=kind)
    for each in (early, late):
        unbounded(each)
    from_the_prior((early, late), seed)
    early.change_prior(lambda: early.parameters.widen([1, 2, 8]))
    assert early.phi_covariance == pytest.approx(early.parameters.prior, rel=1e-9, abs=1e-12)
    for _ in taught((early, late), seed, step, 300):
        pass
    late.change_prior(lambda: late.parameters.widen([1, 2, 8]))
    assert late.parameters.widened_names == tuple(seed.parameter_names[k] for k in (1, 2, 8))
    assert late.phi == pytest.approx(early.phi, rel=1e-6, abs=1e-8)
    assert late.phi_covariance == pytest.approx(early.phi_covariance, rel=1e-6, abs=1e-10)
    assert late.sensitivity == pytest.approx(early.sensitivity, rel=1e-6, abs=1e-8)


def test_another_prior_takes_back_what_the_range_had_moved(kind, seed):
    """Held at the edge of the range by the narrow prior, sample by sample, the wide one took the pull for told by the
    data: a parameter that had been held at its upper edge was found at the lower one."""
    config = EstimatorConfig(forgetting_time=1e12)
    free, held = some_filter(seed, config, kind=kind)[0], some_filter(seed, config, kind=kind)[0]
    _, step = some_filter(seed, kind=kind)
    from_the_prior((free, held), seed)
    unbounded(free)
    held.parameters.lower[:], held.parameters.upper[:] = -0.02, 0.02
    held.parameters.contains = lambda phi: bool(np.all(np.abs(phi) <= 0.02))
    at_edge = sum(np.any(np.abs(held.phi) >= 0.02) for _ in taught((free, held), seed, step, 200))
    assert at_edge > 10
    assert np.abs(held.phi - free.phi).max() > 0.01
    unbounded(held)
    for each in (free, held):
        each.change_prior(lambda each=each: each.parameters.widen(range(each.parameters.size)))
    assert held.x == pytest.approx(free.x, rel=1e-6, abs=1e-8)
    held.change_prior(lambda: None)
    assert held.x == pytest.approx(free.x, rel=1e-6, abs=1e-8)  # and once is enough


def test_what_is_taken_anew_was_moved_by_no_range(kind, seed):
    each, _ = some_filter(seed, kind=kind)
    each._moved[:] = 1.0
    each.take_anew([(SPEED, 3.0, 0.5)])
    x, covariance = each.state
    each.take_parameters(x[:, 0], covariance, each.sensitivity.copy())
    assert not each._moved[[SPEED, *range(FIRST_PARAMETER, each.size)]].any()
    assert each._moved[LOAD] == 1.0


@pytest.mark.parametrize("widths", [0.3, np.inf])
def test_the_compiled_step_is_numpys(seed, widths):
    """Through learning and rest, fading, and the edge of the range."""
    each, step = some_filter(seed, EstimatorConfig(forgetting_time=50.0))
    other, _ = some_filter(seed, EstimatorConfig(forgetting_time=50.0), kind=CompiledFilter)
    for one in (each, other):
        parameters = one.parameters
        parameters.lower[:], parameters.upper[:] = -widths, widths
        parameters._lows, parameters._highs = parameters.lower.tolist(), parameters.upper.tolist()
    rng, at_edge = np.random.default_rng(8), 0
    for k in range(400):
        gradient = (rng.normal(size=len(seed.values)) / seed.std).tolist()
        step = step._replace(torque=float(rng.normal(scale=100.0)), heave=float(rng.normal()), by_parameters=gradient)
        said = []
        for one in (each, other):
            one.predict_step(step, k % 5 > 0, k % 7 == 0)
            said.append(one.innovation(0.1 * k))
            one.correct(*said[-1], k % 5 > 0, k % 5 == 0 and k % 3 == 0)
            one.adapt(1.3, 0.02)
        assert said[1] == pytest.approx(said[0], rel=1e-9)
        at_edge += np.any(np.abs(each.phi) >= widths)
    scale = np.sqrt(np.outer(np.diag(each.P), np.diag(each.P))) + 1e-12
    assert np.abs((each.P - other.P) / scale).max() < 1e-9
    assert other.x == pytest.approx(each.x, rel=1e-9, abs=1e-9)
    assert other.sensitivity == pytest.approx(each.sensitivity, rel=1e-9, abs=1e-9)
    assert (at_edge > 0) == np.isfinite(widths)


def test_without_numba_the_filter_is_numpys(monkeypatch):
    filter_class.cache_clear()
    kernels.cache_clear()
    monkeypatch.setitem(sys.modules, "numba", None)
    assert filter_class() is StateFilter
    monkeypatch.undo()
    filter_class.cache_clear()
    kernels.cache_clear()
    assert filter_class() is CompiledFilter


def test_a_prediction_that_is_not_taken_in_changes_nothing(kind, seed):
    each, step = some_filter(seed, kind=kind)
    before = [part.tobytes() for part in each.state]
    each.predict_step(step, True, False)
    each.innovation(3.0)
    assert [part.tobytes() for part in each.state] == before


def test_noise_of_a_step(seed):
    config = EstimatorConfig()
    step = some_filter(seed)[1]._replace(unknown=7.0)
    torque, heave, load_speed, load, disturbance, rounding = noise_variances(step, config, 2.0, False)
    assert torque == pytest.approx(2.0 * step.variance + 7.0)  # what stick leaves unknown is no noise to be scaled
    assert heave == pytest.approx(2.0 * config.heave_noise**2)
    assert load_speed == pytest.approx(2.0 * config.payload_noise**2 * 0.02)
    assert load == pytest.approx(2.0 * config.load_noise**2 * 0.02)
    assert rounding == pytest.approx(2.0 * config.speed_step**2 / 12.0)
    assert noise_variances(step, config, 2.0, True)[3] == 0.0
    # over many steps the disturbance keeps its own variance, whatever their length
    for duration in (0.005, 0.02, 0.5):
        kept = math.exp(-2.0 * duration / config.disturbance_time)
        added = noise_variances(step._replace(duration=duration), config, 1.0, False)[4]
        assert added / (1.0 - kept) == pytest.approx(config.disturbance_std**2)


def test_forgetting_goes_to_the_seed_and_never_beyond(seed):
    parameters = ScaledParameters(seed.with_covariance(None), EstimatorConfig(forgetting_time=10.0))
    covariance = np.eye(parameters.size)
    covariance[-1, -1] = 0.01  # learned; the others are as in the seed
    noise = parameters.faded(covariance, 1.0)
    assert noise[-1, -1] == pytest.approx(0.1 * 0.99)
    noise[-1, -1] = 0.0
    assert not noise.any()


def test_forgetting_for_longer_than_its_time_ends_at_the_seed(seed):
    parameters = ScaledParameters(seed, EstimatorConfig(forgetting_time=10.0))
    covariance = 0.01 * np.eye(parameters.size)
    assert covariance + parameters.faded(covariance, 35.0) == pytest.approx(parameters.prior)


def test_the_halves_of_the_covariance_stay_alike_over_many_steps(kind, seed):
    each, step = some_filter(seed, kind=kind)
    each.P[0, -1] *= 1.0 + 1e-6  # as rounding leaves it, only more
    unbounded(each)
    for _ in range(60):
        each.predict_step(step, True, False)
        _, variance = each.innovation(0.0)
        each.correct(0.0, variance, True)
    scale = np.sqrt(np.outer(np.diag(each.P), np.diag(each.P)))
    assert np.abs((each.P - each.P.T) / scale).max() < 1e-12


def test_what_is_taken_anew_owes_nothing_to_sensor_errors_of_before(kind, seed):
    each, _ = some_filter(seed, kind=kind)
    each.sensitivity[:] = 1.0
    each.take_anew([(SPEED, 3.0, 0.5), (ENCODER, 0.0, 0.1)])
    assert each.speed == 3.0
    assert not each.sensitivity[:, [SPEED, ENCODER]].any()
    assert each.sensitivity[:, [LOAD, DISTURBANCE]].all()
    assert not np.delete(each.P[SPEED], SPEED).any()
    assert not np.delete(each.P[:, SPEED], SPEED).any()
    assert each.P[SPEED, SPEED] == 0.5


def test_another_load_owes_nothing_to_the_one_before(kind, seed):
    each, _ = some_filter(seed, kind=kind)
    each.begin_load(100.0, 7.0)
    assert each.load_torque == 7.0
    assert each.P[LOAD, LOAD] == 100.0
    assert not np.delete(each.P[LOAD], LOAD).any()


def test_a_parameter_that_steps_away_from_its_edge_for_a_moment_stays_invalid():
    each = ParameterStatus(EstimatorConfig(settle_time=1.0))
    for _ in range(20):
        each.step(1.0, frozen=False, at_limit=True, dt=0.1)
    each.step(1.0, frozen=False, at_limit=False, dt=0.1)
    assert each.text == "invalid"
    for _ in range(10):
        each.step(1.0, frozen=False, at_limit=False, dt=0.1)
    assert each.text == "seed"


def test_both_edges_of_a_range_are_limits(seed):
    parameters = ScaledParameters(seed, EstimatorConfig())
    phi = np.zeros(parameters.size)
    phi[0], phi[-1] = parameters.lower[0], parameters.upper[-1]
    assert np.flatnonzero(parameters.at_limit(phi)).tolist() == [0, parameters.size - 1]


def test_equal_belief_within_the_range_has_the_sigma_of_an_even_distribution(seed):
    parameters = ScaledParameters(seed, EstimatorConfig())
    even = (parameters.upper - parameters.lower) * parameters.scale / math.sqrt(12.0)
    parameters.widen(range(parameters.size))
    assert parameters.std(parameters.prior) == pytest.approx(np.maximum(even, seed.std).tolist())


def test_forgetting_acts_while_learning_and_only_then(kind, seed):
    each, step = some_filter(seed, EstimatorConfig(forgetting_time=100.0), kind=kind)
    each.state = np.zeros((each.size, 1)), np.eye(each.size) * 1e-12
    seen = step._replace(by_parameters=[0.0] * len(seed.values), by_sensors=(0.0, 0.0))
    for learning, expected in ((False, 0.0), (True, 1.0 - math.exp(-0.1))):
        for _ in range(500):
            each.predict_step(seen, learning, True)
            _, variance = each.innovation(0.0)
            each.correct(0.0, variance, learning)
        assert np.diag(each.phi_covariance) == pytest.approx(expected, rel=0.02, abs=1e-9)


def test_projection_moves_correlated_parameters_along(seed):
    parameters = ScaledParameters(seed, EstimatorConfig(seed_range=0.5))
    size = FIRST_PARAMETER + parameters.size
    covariance = np.eye(size)
    covariance[-1, -2] = covariance[-2, -1] = 0.8
    x = np.zeros(size)
    x[-1] = parameters.upper[-1] + 1.0
    assert not parameters.contains(x[FIRST_PARAMETER:])
    out = parameters.projected(x, covariance, FIRST_PARAMETER)
    assert parameters.contains(out[FIRST_PARAMETER:])
    assert out[-1] == pytest.approx(parameters.upper[-1])
    assert out[-2] == pytest.approx(-0.8)
    limits = seed_range(seed, 0.5)
    for name, value in zip(seed.parameter_names, parameters.values(out[FIRST_PARAMETER:]), strict=True):
        assert limits[name][0] <= value <= limits[name][1]
    assert parameters.theta(out[FIRST_PARAMETER:]) == pytest.approx(parameters.values(out[FIRST_PARAMETER:]))


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


def test_the_rope_force_says_the_hanging_mass_where_no_hook_load_is(crane_150t):
    load = HangingLoad(crane_150t, time_constant=5.0)
    assert load.following(Sample(0.0, 0.0, rope_force=30e3 * GRAVITY), 0.02) == pytest.approx(30e3)
    assert load.following(Sample(0.0, 0.0, rope_force=30e3 * GRAVITY, hook_load=20e3), 0.02) == 20e3
    assert math.isnan(load.following(Sample(0.0, 0.0), 0.02))


# -- what a filter tells and what it takes from outside
def test_a_state_that_was_asked_for_stays_as_it_was(kind, seed):
    each, step = some_filter(seed, kind=kind)
    x, covariance = each.state
    kept = x.copy(), covariance.copy()
    each.predict_step(step, True, False)
    each.correct(*each.innovation(3.0), True)
    assert (x == kept[0]).all()
    assert (covariance == kept[1]).all()
    assert (each.state[0] != x).any()


def test_what_sensors_may_add_is_their_variance_through_their_sensitivity(kind, seed):
    """The deviations of two errors, 0.01 and 1e5, squared: 1e-4 and 1e10."""
    each, _ = some_filter(seed, kind=kind)
    each.sensitivity[0], each.sensitivity[1] = 30.0, 1e-5
    each.sensitivity[1, -1] = -2e-5
    added = np.full((len(each.phi), len(each.phi)), 0.09 + 1.0)
    added[-1, :] = added[:, -1] = 0.09 - 2.0
    added[-1, -1] = 0.09 + 4.0
    assert each.considered_covariance - each.phi_covariance == pytest.approx(added)
    assert each.considered_variances == pytest.approx(each.phi_covariance.diagonal() + added.diagonal())
    bare = kind(each.config, each.parameters)
    assert bare.considered_covariance == pytest.approx(bare.phi_covariance)
    assert bare.considered_variances == pytest.approx(bare.phi_covariance.diagonal())


def test_a_measured_speed_is_as_unsure_as_all_noises_are_scaled(kind, seed):
    each, step = some_filter(seed, EstimatorConfig(speed_noise=0.3), kind=kind)
    each.adapt(3.0, each.config.adaptation_time)
    assert each.noise_factor == pytest.approx(3.0)
    assert each.speed_variance == pytest.approx(3.0 * 0.09)
    each.predict_step(step, True, False)
    _, variance = each.innovation(0.0)
    seen = each._ahead_P[SPEED] + each._ahead_P[ENCODER_CHANGE]
    assert variance == pytest.approx(seen[SPEED] + seen[ENCODER_CHANGE] + 0.27)


@pytest.mark.parametrize(
    ("learning", "stick", "told"), [(True, False, True), (True, True, False), (False, False, False)]
)
def test_of_a_sensors_error_only_what_is_learned_tells(kind, seed, learning, stick, told):
    each, step = some_filter(seed, kind=kind)
    each.predict_step(step, learning, False)
    each.correct(*each.innovation(1.0), learning, stick)
    assert np.isfinite(each.considered.lateness[0]) == told


@pytest.mark.parametrize(("late", "damped", "place"), [(0.15, 0.3, 1), (0.0, 0.3, 1), (0.15, 0.0, -1)])
def test_which_error_is_a_lateness_and_which_the_wires_damping(kind, seed, late, damped, place):
    config = EstimatorConfig(speed_delay_std=late, wire_damping_std=damped)
    each = kind(config, ScaledParameters(seed, config), SENSORS)
    assert each._damping == place
    assert each.considered._late == (late > 0.0)
    assert kind(config, ScaledParameters(seed, config))._damping == -1


def test_parameters_fade_once_a_second_by_all_of_the_learning_since(kind, seed):
    """Steps of 0.02 s that show nothing: fifty of them at a time, those of rest not counted."""
    each, step = some_filter(seed, EstimatorConfig(forgetting_time=100.0), kind=kind)
    each.state = np.zeros((each.size, 1)), np.eye(each.size) * 1e-9
    seen = step._replace(by_parameters=[0.0] * len(seed.values), by_sensors=(0.0, 0.0))
    grown, before = [], 0.0
    for k in range(160):
        learning = k >= 5
        each.predict_step(seen, learning, True)
        each.correct(0.0, each.innovation(0.0)[1], learning)
        now = each.phi_covariance[0, 0]
        if now > before + 1e-6:
            grown.append((k, now - before))
        before = now
    assert [k for k, _ in grown] in ([54, 104, 154], [55, 105, 155])  # the fiftieth, or that after rounding
    first = each.parameters.prior[0, 0] * each.config.forgetting_time**-1
    assert grown[0][1] == pytest.approx(first, rel=0.03)


def test_parameters_that_are_taken_from_elsewhere_owe_nothing_to_what_moves(kind, seed):
    """... and stand inside their range, where what the range had moved and what innovations told is forgotten."""
    each, step = some_filter(seed, kind=kind)
    each.predict_step(step, True, False)
    each.correct(*each.innovation(1.0), True)
    size, rng = each.size, np.random.default_rng(5)
    x, root, sensitivity = np.zeros(size), 0.1 * rng.normal(size=(size, size)), rng.normal(size=(2, size))
    covariance, before = root @ root.T, [part.copy() for part in (*each.state, each.sensitivity)]
    x[-1] = each.parameters.upper[-1] + 1.0
    each._moved[:] = 1.0
    each.take_parameters(x, covariance, sensitivity)
    phi = slice(FIRST_PARAMETER, size)
    expected = each.parameters.projected(x, covariance, FIRST_PARAMETER)
    assert each.phi == pytest.approx(expected[phi])
    assert each.phi[-1] == pytest.approx(each.parameters.upper[-1])
    assert (each.x[:FIRST_PARAMETER] == before[0][:FIRST_PARAMETER]).all()
    assert each.P[phi, phi] == pytest.approx(covariance[phi, phi])
    assert not each.P[phi, :FIRST_PARAMETER].any()
    assert not each.P[:FIRST_PARAMETER, phi].any()
    assert (each.P[:FIRST_PARAMETER, :FIRST_PARAMETER] == before[1][:FIRST_PARAMETER, :FIRST_PARAMETER]).all()
    assert (each.sensitivity[:, phi] == sensitivity[:, phi]).all()
    assert (each.sensitivity[:, :FIRST_PARAMETER] == before[2][:, :FIRST_PARAMETER]).all()
    assert not each._moved[phi].any()
    assert each._moved[:FIRST_PARAMETER].all()
    assert np.isnan(each.considered.lateness[0])


@pytest.mark.parametrize("doubted", [False, True])
def test_a_load_in_doubt_walks_twenty_times_as_far(seed, doubted):
    config, step = EstimatorConfig(load_noise=3.0), some_filter(seed)[1]._replace(doubted=doubted)
    walk = 20.0 * 3.0 if doubted else 3.0
    assert noise_variances(step, config, 2.0, False)[3] == pytest.approx(2.0 * walk**2 * step.duration)


def test_what_moves_begins_with_the_speed_as_measured_and_the_load_along_with_its_wire(crane):
    config, layer = EstimatorConfig(speed_step=0.6), 2.0
    fresh = {state: rest for state, *rest in fresh_motion(Sample(0.0, 50.0, wire_layer=layer), crane, config, 0.25)}
    lever = crane.drum.radius(layer) / crane.gear_ratio
    assert fresh[SPEED] == [50.0, pytest.approx(0.25 + 2.0 * 0.03)]
    assert fresh[STRETCH] == [0.0, pytest.approx(1e-6)]
    assert fresh[LOAD_SPEED] == [pytest.approx(50.0 * lever), pytest.approx(lever**2 * 0.31 + 4e-4)]
    assert fresh[DISTURBANCE] == [0.0, config.disturbance_std**2]
    assert fresh[ENCODER] == [0.0, pytest.approx(0.03)]
    assert fresh[ENCODER_CHANGE] == [0.0, 0.0]
    moved = fresh_motion(Sample(0.0, 50.0, heave_velocity=-0.4, wire_layer=layer), crane, config, 0.25)
    assert {state: value for state, value, _ in moved}[LOAD_SPEED] == pytest.approx(50.0 * lever - 0.4)


@pytest.mark.parametrize("stiffness", [math.inf, 3.0e8])
def test_a_wire_of_unknown_stiffness_rings_at_forty_rad_per_second_at_most(crane, stiffness):
    """Of a load held still, a stretch comes back by the cosine of w dt."""
    mass, dt = 2e3, 1e-4
    stiff = replace(crane, wire_stiffness=stiffness, inertia=1e12)
    step = np.array(wire_step(stiff, mass, 6.0, 50.0, 0.0, dt))
    assert 3.0e8 / 50.0 / mass > 1600.0
    assert step[2, 1] / dt == pytest.approx(1600.0, rel=1e-3)  # m/s^2 per m
