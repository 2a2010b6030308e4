"""One scan of the PLC: what scale, offset, bend, delay and quantisation make of a value, each by itself."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.sensors.channels import CHANNEL
from winch_friction.simulation.sensors.plc import draw_scans, quantise, scan

PERIOD = 0.01
VALUE = 200.0


def scanned(slope=0.0, **setting):
    """What the scan from 0.5 s to 0.52 s shows of a channel of 200 that rises by so much per second."""
    time = np.arange(101) * PERIOD
    history = np.column_stack([time, VALUE + slope * time])
    settings = np.zeros(2, CHANNEL)
    settings["scale"], settings["source"] = 1.0, [0, 1]
    for name, value in setting.items():
        settings[name][1] = value
    row = np.zeros(3)
    scan(history, PERIOD, settings, np.array([0.5, 0.52]), np.zeros((2, 2)), 1, row)
    assert row[0] == pytest.approx(0.51)
    return row[2]


@pytest.mark.parametrize(
    ("setting", "shown"),
    [
        ({}, 200.0),
        ({"scale": 1.02}, 204.0),
        ({"offset": 3.0}, 203.0),
        ({"scale": 1.02, "offset": 3.0}, 207.0),
        ({"curvature": 1e-4}, 204.0),
        ({"bend": [0.1] + [0.0] * 7, "beyond": [150.0] + [0.0] * 7}, 205.0),
        ({"step": 7.0}, 203.0),
    ],
)
def test_a_channel_shows_its_errors_one_after_the_other(setting, shown):
    assert scanned(**setting) == pytest.approx(shown)


def test_a_channel_is_taken_in_the_middle_of_the_scan_less_its_delay():
    assert scanned(slope=100.0) == pytest.approx(VALUE + 51.0)
    assert scanned(slope=100.0, delay=0.1) == pytest.approx(VALUE + 41.0)


@pytest.mark.parametrize(
    ("value", "step", "shown"), [(2.6, 1.0, 3.0), (2.4, 1.0, 2.0), (-2.6, 1.0, -3.0), (2.6, 0.5, 2.5), (2.6, 0.0, 2.6)]
)
def test_quantising_takes_the_nearest_step(value, step, shown):
    assert quantise(value, step) == pytest.approx(shown)


@pytest.mark.parametrize(("jitter", "most"), [(0.005, 0.005), (1.0, 0.008), (0.0, 0.0)])
def test_a_scan_ends_at_most_its_jitter_early_and_in_order(jitter, most):
    """Of a jitter beyond the period the stamps would run backwards, which every reader refuses."""
    scenario = load_scenario("ahc_55t_215").override({"duration": 20.0, "sensors.jitter": jitter})
    scans = draw_scans(scenario, SimpleNamespace(names=("motor_speed",)), np.random.default_rng(3))
    early = np.arange(1001) / 50.0 - scans.ends
    assert early[0] == 0.0
    assert early.min() >= -1e-12
    assert early.max() == pytest.approx(most, rel=0.02)
    assert np.diff(scans.ends).min() > 0.0
    assert early[1:].mean() == pytest.approx(0.5 * most, rel=0.1)
