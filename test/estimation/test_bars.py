"""The bars of the online estimator: a simulated crane after 20 wave periods, and the real EMPS drive in one pass."""

import numpy as np
import pytest

from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.estimation.parameters import ScaledParameters
from winch_friction.physics.channels import RPM
from winch_friction.physics.winch.crane import run_drum_torque
from winch_friction.physics.winch.operating_point import run_operating_points
from winch_friction.records.crane_file import load_crane
from winch_friction.records.emps import read_emps
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

SPEED_BINS = (10, 50, 100, 229, 500, 1000, 1500, 2100)  # rpm
# as config/nodes/emps.yaml: the residual of the benchmark's own fit, and no adaptation, for it is not white
EMPS = EstimatorConfig(
    speed_noise=1e-3, speed_step=0.0, torque_noise=1.0, disturbance_std=3.0, disturbance_time=0.05, load_noise=0.0,
    stick_speed=0.004, excitation_speed=0.02, adaptation_time=1e12,
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("drive", "load", "sea"),
    [
        ("primary", 55e3, {"kind": "regular", "amplitude": 1.5, "period": 10.0}),
        ("secondary", 100e3, {"kind": "jonswap", "significant_height": 1.0, "peak_period": 8.0}),
    ],
)
def test_after_20_wave_periods_the_friction_is_known_in_every_speed_bin(crane, seed, drive, load, sea):
    truth = seed.with_values({name: 1.3 * seed.value(name) for name in ("C1", "C3", "C5", "C6")})
    period = sea.get("period") or sea["peak_period"]
    case = load_scenario("ahc_55t_215").override({"drive": drive, "load": load, "sea": sea, "duration": 20 * period})
    run = simulate(case, crane, truth, seed=23).run
    each = FrictionEstimator(crane, seed)
    for sample in run.samples():
        each.step(sample)
    x = run_operating_points(run, crane, drum_torque=run_drum_torque(run, crane))
    true, found = (np.abs(np.asarray(model.torque(x), float)) for model in (truth, each.model()))
    speed = np.abs(run["motor_speed"]) / RPM
    visited = 0
    for low, high in zip(SPEED_BINS, SPEED_BINS[1:], strict=False):
        inside = (speed >= low) & (speed < high)
        if inside.sum() >= 50:
            visited += 1
            assert found[inside].mean() == pytest.approx(true[inside].mean(), rel=0.05)
    assert visited >= 4
    assert each.consistency.share_inside >= 0.9


@pytest.mark.slow
def test_a_seed_far_outside_its_own_sigma_does_not_lock_the_gate(crane, seed):
    truth = seed.with_values({name: 1.3 * seed.value(name) for name in seed.parameter_names if name != "C4"})
    sea = {"kind": "regular", "amplitude": 1.5, "period": 10.0}
    case = load_scenario("ahc_55t_215").override({"drive": "secondary", "load": 100e3, "sea": sea, "duration": 60.0})
    run = simulate(case, crane, truth, seed=201).run
    each = FrictionEstimator(crane, seed)
    for sample in run.samples():
        each.step(sample)
    late = run["motor_speed"] > 20.0  # rad/s, the direction that it would have shut out
    x = run_operating_points(run, crane, drum_torque=run_drum_torque(run, crane))
    true, found = (np.asarray(model.torque(x), float)[late].mean() for model in (truth, each.model()))
    assert found == pytest.approx(true, rel=0.05)
    assert each.counts["rejected"] < 0.01 * len(run)


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("factor", [0.7, 1.3])
def test_emps_in_one_pass(shared_data, factor):
    from scipy.signal import decimate

    crane, published = load_crane("emps"), load_model("emps_symmetric")
    seed = published.with_values({name: factor * published.value(name) for name in ("C2", "C5")})
    run = read_emps(shared_data / "emps" / "DATA_EMPS.mat")
    each = FrictionEstimator(crane, seed, EMPS)
    for sample in run.samples():
        each.step(sample)
    found = {p.name: p for p in each.parameters()}
    for name, value in (("C2", 20.39), ("C5", 203.5)):
        assert found[name].value == pytest.approx(value, rel=0.05)
        assert abs(found[name].value - value) < 2.0 * found[name].std
    # the benchmark's own check: differentiate offline, decimate, leave out the filter's ends
    speed, force = run["motor_speed"], run["motor_torque"]
    acceleration = np.gradient(speed, run.time)
    x = run_operating_points(run, crane, drum_torque=np.zeros(len(run)))
    explained = crane.inertia * acceleration + np.asarray(each.model().torque(x), float)
    residual, whole = (decimate(column, 10, zero_phase=True)[5:-5] for column in (force - explained, force))
    assert np.linalg.norm(residual) / np.linalg.norm(whole) < 0.045


@pytest.mark.parametrize("ranges", [1e4, 1e140])
def test_a_seed_whose_sigma_is_far_beyond_its_range_is_taken_as_one_that_nothing_is_known_of(crane, seed, ranges):
    """With these sigmas themselves the covariance was none after a minute, and the model could not be told."""
    width = np.array([np.diff(seed.bounds_of(name))[0] for name in seed.parameter_names])
    correlation = seed.covariance / np.outer(seed.std, seed.std)

    def of(times):
        return seed.with_covariance(correlation * np.outer(times * width, times * width))

    sea = {"kind": "regular", "amplitude": 1.5, "period": 10.0}
    case = load_scenario("ahc_55t_215").override({"drive": "secondary", "load": 100e3, "sea": sea, "duration": 60.0})
    run = simulate(case, crane, seed, seed=201).run
    far, ten = (FrictionEstimator(crane, of(times)) for times in (ranges, 10.0))
    for sample in run.samples():
        far.step(sample)
        ten.step(sample)
    assert far.model().values == pytest.approx(ten.model().values, rel=1e-6)
    assert far.model().std == pytest.approx(ten.model().std, rel=1e-3)


def test_a_sigma_of_ten_ranges_is_taken_as_it_is_and_of_more_as_much(seed):
    width = np.array([np.diff(seed.bounds_of(name))[0] for name in seed.parameter_names])
    for times, taken in ((9.9, 9.9), (10.1, 10.0)):
        parts = ScaledParameters(seed.with_covariance(np.diag((times * width) ** 2)), EstimatorConfig())
        assert parts.scale == pytest.approx(taken * width, rel=1e-12)
        assert parts.seed_prior == pytest.approx(np.eye(len(width)), abs=1e-12)
