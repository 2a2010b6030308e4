"""What the PLC does to the signals, by its statistics."""

import numpy as np
import pytest
from clean_sensors import CLEAN

from winch_friction.physics.channels import BAR
from winch_friction.physics.errors import InputError
from winch_friction.simulation import Simulator, simulate

STILL = {"sea": {"kind": "still"}, "duration": 60.0}


def test_pressure_noise_and_step(ahc, crane, model):
    run = simulate(ahc.override({**STILL, "sensors.pressure_noise": 0.4 * BAR}), crane, model).run
    pressure = run["passive.pressure_b"]
    step = 600 * BAR / 4096
    assert np.std(pressure) == pytest.approx(np.hypot(0.4 * BAR, step / np.sqrt(12)), rel=0.06)
    assert np.abs(pressure / step - np.round(pressure / step)).max() < 1e-6


def test_encoder_step_is_2_9_rpm_at_50_hz(ahc, crane, model):
    run = simulate(ahc.override({"sensors.jitter": 0.0}), crane, model).run
    steps = run["motor_speed"] / (2 * np.pi / 1024 * 50)
    assert np.abs(steps - np.round(steps)).max() < 1e-6
    assert 2 * np.pi / 1024 * 50 * 30 / np.pi == pytest.approx(2.93, abs=0.01)


def test_clean_sensors_show_the_plant(ahc, crane, model):
    result = simulate(ahc.override(CLEAN), crane, model)
    run, truth = result.run, result.truth
    for measured, true in (("active.pressure_a", "pressure_a"), ("passive.pressure_a", "passive_pressure_a")):
        expected = np.interp(run.time, truth.time, truth[true])
        assert np.abs(run[measured] - expected).max() < 1.0
    expected = np.interp(run.time, truth.time, truth["motor_speed"])
    assert np.abs(run["motor_speed"] - expected)[1:].std() < 0.15


def test_rate_and_jitter(ahc, crane, model):
    run = simulate(ahc.override({"sensors.rate": 20.0, "sensors.jitter": 0.01}), crane, model).run
    intervals = np.diff(run.time[1:])
    assert len(run) == 60 * 20 + 1
    assert intervals.mean() == pytest.approx(0.05, rel=1e-3)
    assert 0.001 < intervals.std() < 0.01
    assert intervals.min() > 0.0


def test_skew_shifts_one_channel(ahc, crane, model):
    plain = simulate(ahc.override(CLEAN), crane, model).run
    skewed = simulate(ahc.override({**CLEAN, "sensors.skew": {"active.pressure_a": 0.04}}), crane, model).run
    assert np.allclose(skewed["active.pressure_a"][102:], plain["active.pressure_a"][100:-2], rtol=1e-9)
    assert np.array_equal(skewed["active.pressure_b"], plain["active.pressure_b"])


def test_offset_scale_and_displacement_error(ahc, crane, model):
    changes = {
        "sensors.pressure_offset": {"active.pressure_a": 1.5 * BAR},
        "sensors.pressure_scale": {"active.pressure_b": 1.01},
        "sensors.displacement_scale": {"active.displacement": 1.02},
    }
    plain = simulate(ahc.override(CLEAN), crane, model).run
    run = simulate(ahc.override({**CLEAN, **changes}), crane, model).run
    assert np.allclose(run["active.pressure_a"] - plain["active.pressure_a"], 1.5 * BAR)
    assert np.allclose(run["active.pressure_b"], 1.01 * plain["active.pressure_b"])
    assert np.allclose(run["active.displacement"], 1.02 * plain["active.displacement"])


def test_delay_holds_samples_back(ahc, crane, model):
    prompt, late = (
        Simulator(ahc.override({"sensors.delay": delay, "duration": 2.0}), crane, model) for delay in (0.0, 0.1)
    )
    for _ in range(150):
        prompt.step(0.0)
        late.step(0.0)
    assert prompt.sample.time - late.sample.time == pytest.approx(0.1, abs=0.002)


def test_dropouts_are_rows_of_nan_or_missing(ahc, crane, model):
    lossy = {"sensors.dropout_rate": 0.2, "sensors.dropout_length": 0.2, "duration": 120.0}
    with_nan = simulate(ahc.override(lossy), crane, model).run
    missing = simulate(ahc.override({**lossy, "sensors.dropout": "missing"}), crane, model).run
    lost = np.isnan(with_nan["motor_speed"])
    assert 0.01 < lost.mean() < 0.12
    assert len(missing) == len(with_nan) - lost.sum()
    assert np.isfinite(missing["motor_speed"]).all()
    assert np.isfinite(with_nan.time).all()


def test_a_setting_for_a_channel_that_is_not_there(cycle, crane, model):
    with pytest.raises(InputError, match="sensors.skew names 'active.pressure_a', the run has motor_speed"):
        Simulator(cycle.override({"sensors.skew": {"active.pressure_a": 0.1}}), crane, model)


def test_absent_channels_are_absent_live_and_logged(ahc, crane, model):
    absent = ["hook_load", "wire_layer", "heave_velocity"]
    simulator = Simulator(ahc.override({"sensors.absent": absent, "duration": 1.0}), crane, model)
    sample = simulator.step(0.0)
    assert all(np.isnan(getattr(sample, name)) for name in absent)
    assert not set(absent) & set(simulator.result().run.columns)
    with pytest.raises(InputError, match="'tension', which is not an optional channel"):
        Simulator(ahc.override({"sensors.absent": ["tension"]}), crane, model)
