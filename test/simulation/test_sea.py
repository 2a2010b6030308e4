"""Seas and profiles."""

import numpy as np
import pytest

from winch_friction.simulation.motion.profile import plateau_points, profile_reference
from winch_friction.simulation.motion.sea import fade, jonswap_sea, regular_wave

TIME = np.arange(0.0, 3600.0, 0.05)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_jonswap_has_its_height_and_period(seed):
    height = jonswap_sea(2.0, 9.0, 3.3, seed).motion(TIME)[:, 0]
    assert 4.0 * height.std() == pytest.approx(2.0, rel=0.12)
    spectrum = np.abs(np.fft.rfft(height)) ** 2
    frequency = np.fft.rfftfreq(len(height), 0.05)
    band = (frequency > 0.04) & (frequency < 0.5)
    smooth = np.convolve(spectrum, np.ones(40), "same")
    assert frequency[band][smooth[band].argmax()] == pytest.approx(1 / 9.0, rel=0.12)


@pytest.mark.parametrize("waves", [regular_wave(1.5, 10.0), jonswap_sea(2.0, 8.0, 3.3, 5)])
@pytest.mark.parametrize("out", [False, True])
def test_speed_and_acceleration_belong_to_the_height(waves, out):
    time = np.arange(0.0, 60.0, 0.001)
    motion = fade(waves.motion(time), time, 5.0, 20.0, out)
    for k in (0, 1):
        slope = np.gradient(motion[:, k], time)
        assert np.abs(slope - motion[:, k + 1])[2:-2].max() < 1e-5


def test_regular_wave_of_the_domain():
    speed = regular_wave(1.5, 10.0).motion(TIME)[:, 1]
    assert speed.max() == pytest.approx(0.942, abs=1e-3)


def test_plateaus_visit_both_directions():
    points = plateau_points((10.0, 100.0), hold=5.0, ramp=1.0, rest=2.0)
    time = np.arange(0.0, points[-1][0], 0.01)
    reference = profile_reference(points, time)
    assert reference[:, 1].max() == 100.0
    assert reference[:, 1].min() == -100.0
    moving = np.sign(reference[reference[:, 1] != 0.0, 1])
    assert moving[np.flatnonzero(np.diff(moving, prepend=0.0))].tolist() == [1.0, -1.0, 1.0, -1.0]  # hoisted first
    for speed in (10.0, -10.0, 100.0, -100.0):
        assert (reference[:, 1] == speed).sum() == pytest.approx(500, abs=3)
    assert np.allclose(np.gradient(reference[:, 0], time)[1:-1], reference[1:-1, 1], atol=0.6)
