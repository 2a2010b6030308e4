"""What must stay true whatever the sensors do (docs/physics.md §4), over real step objects on a simulated sea."""

import math

import numpy as np
import pytest
from broken_sensors import CHANNELS, END, SENSOR_FAULTS, START, STREAM_FAULTS, dropout, everything_nan, lost, spike

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.estimation import EstimatorConfig, FrictionEstimator
from winch_friction.records.sample_stream import InputHold
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate

RAMP = 0.5  # s
CONFIG = CompensatorConfig(ramp_time=RAMP)
SETTLED = 3.0  # s after the fault


@pytest.fixture(scope="module")
def run(crane_150t, crane2_model):
    return simulate(load_scenario("ahc_irregular").override({"duration": 12.0}), crane_150t, crane2_model, seed=21).run


@pytest.fixture(scope="module")
def samples(run):
    return list(InputHold(run.groups).samples(run))


@pytest.fixture(scope="module")
def good(samples, crane_150t, crane2_model):
    compensator = FeedforwardCompensator(crane_150t, crane2_model, CONFIG)
    return [compensator.step(sample) for sample in samples]


def _faults():
    for fault in SENSOR_FAULTS:
        for channel in CHANNELS:
            yield pytest.param(lambda s, f=fault, c=channel: f(s, c), id=f"{fault.__name__}-{channel}")
    for fault in STREAM_FAULTS:
        yield pytest.param(fault, id=fault.__name__)


FAULTS = list(_faults())


@pytest.mark.parametrize("fault", FAULTS)
def test_the_feedforward_stays_finite_bounded_and_smooth(samples, good, crane_150t, crane2_model, fault):
    compensator = FeedforwardCompensator(crane_150t, crane2_model, CONFIG)
    before = None
    for sample in fault(samples):
        out = compensator.step(sample)
        assert math.isfinite(out.friction_torque)
        assert math.isfinite(out.pressure)
        assert abs(out.friction_torque) <= crane_150t.absolute_torque_limit
        if before is not None:
            dt = out.time - before.time
            allowed = CONFIG.slew_limit * min(max(dt, 0.0), 0.5) + 1e-6 if dt < CONFIG.max_age else math.inf
            assert abs(out.friction_torque - before.friction_torque) <= allowed
        before = out
    late = [out for out in good if out.time > END + SETTLED]
    assert before.friction_torque == pytest.approx(late[-1].friction_torque, rel=0.05, abs=5.0)


@pytest.mark.parametrize("fault", FAULTS)
def test_the_estimate_stays_finite_and_near_its_seed(samples, crane_150t, crane2_model, fault):
    estimator = FrictionEstimator(crane_150t, crane2_model, EstimatorConfig())
    seed = np.array(crane2_model.values)
    for sample in fault(samples):
        before = estimator.model().values if not math.isfinite(sample.motor_speed) else None
        estimate = estimator.step(sample)
        assert math.isfinite(estimate.drum_torque)
        assert math.isfinite(estimate.speed)
        if before is not None:
            assert not estimate.accepted
            assert estimator.model().values == before
    model = estimator.model()
    assert (np.abs(np.array(model.values) - seed) <= 0.5 * np.abs(seed) * (1.0 + 1e-9)).all()
    assert np.isfinite(model.covariance).all()
    assert (np.diag(model.covariance) >= 0.0).all()


@pytest.mark.parametrize("channel", ["speed_reference", "active.pressure_a", "active.displacement"])
def test_a_lost_input_that_is_needed_ramps_to_zero_and_back_without_a_bump(samples, crane_150t, crane2_model, channel):
    compensator = FeedforwardCompensator(crane_150t, crane2_model, CONFIG)
    outs = [compensator.step(sample) for sample in dropout(samples, channel)]
    gone = [out for out in outs if START + RAMP + 0.05 < out.time < END]
    assert all(out.state == "stale" for out in gone)
    assert all(abs(out.friction_torque) < 1e-6 for out in gone)
    back = [out for out in outs if END <= out.time < END + 0.1]
    assert abs(back[0].friction_torque) < 0.1 * max(abs(out.friction_torque) for out in outs)


def test_silence_is_answered_by_a_ramp_to_zero(samples, crane_150t, crane2_model):
    compensator = FeedforwardCompensator(crane_150t, crane2_model, CONFIG)
    for sample in samples[:300]:
        last = compensator.step(sample)
    after = [compensator.decay(last.time + CONFIG.max_age + t) for t in (0.0, 0.25 * RAMP, 0.5 * RAMP, RAMP, 10.0)]
    sizes = [abs(out.friction_torque) for out in after]
    assert sizes == sorted(sizes, reverse=True)
    assert max(sizes[-2:]) < 1e-9


def test_a_sample_without_numbers_teaches_nothing(samples, crane_150t, crane2_model):
    good_one, bad_one = (FrictionEstimator(crane_150t, crane2_model, EstimatorConfig()) for _ in range(2))
    for whole, broken in zip(samples, everything_nan(samples), strict=True):
        good_one.step(whole)
        bad_one.step(broken)
    missed = [bad_one.step(sample) for sample in everything_nan(samples) if START <= sample.time < END]
    assert not any(estimate.accepted for estimate in missed)
    assert bad_one.model().values == pytest.approx(good_one.model().values, rel=0.2)


def test_a_spike_in_one_pressure_does_not_throw_the_learning(samples, crane_150t, crane2_model):
    clean, spiked = (FrictionEstimator(crane_150t, crane2_model, EstimatorConfig()) for _ in range(2))
    for whole, broken in zip(samples, spike(samples, "active.pressure_a"), strict=True):
        clean.step(whole)
        spiked.step(broken)
    distance = np.abs(np.array(spiked.model().values) - np.array(clean.model().values))
    assert (distance <= 1.0 * clean.model().std).all()


def test_a_gap_in_the_samples_does_not_move_the_parameters_at_once(samples, crane_150t, crane2_model):
    estimator = FrictionEstimator(crane_150t, crane2_model, EstimatorConfig())
    cut = lost(samples)
    for sample in cut:
        before = np.array(estimator.model().values) if sample.time >= END else None
        estimator.step(sample)
        if before is not None:
            assert (np.abs(np.array(estimator.model().values) - before) <= 0.5 * crane2_model.std + 1e-30).all()
            break
