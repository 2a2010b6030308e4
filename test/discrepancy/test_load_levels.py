"""A load that is set down or picked up within a run, and what is none: a cell's noise, a swell, a winch that starts."""

import numpy as np
import pytest
from scipy.signal import lfilter

from winch_friction.discrepancy.preparation.grid import smooth, uniform
from winch_friction.discrepancy.preparation.load_levels import EVERY, LASTS, level_of
from winch_friction.discrepancy.preparation.seen import motion_of
from winch_friction.discrepancy.preparation.suspended_load import load_of
from winch_friction.physics.signals import Run

DT = 0.1  # s
TIME = np.arange(0.0, 180.0, DT)
NOISE = 0.001 * np.random.default_rng(4).standard_normal(len(TIME))  # of a ton


def levels(cell):
    return level_of(cell, smooth(cell, 25), DT)


def steps(*parts):
    """20 t, and by how much more from when on, in s."""
    return 20.0 + sum(size * (since <= TIME) for since, size in parts)


@pytest.mark.parametrize("parts", [
    [(60.0, -0.9)],
    [(17.0, -2.6), (63.0, 0.4)],  # 17 s of what was set down then: half a minute of a run is enough to see it
    [(50.0, 1.5), (90.0, -1.5)],  # picked up and set down: both halves are 20 t in the middle
])  # fmt: skip
def test_a_load_that_is_set_down_or_picked_up_is_followed(parts):
    true = steps(*parts)
    found = levels(true + 15.0 * NOISE)
    away = np.min([np.abs(TIME - since) for since, _ in parts], axis=0) > 3.0
    assert found[away] == pytest.approx(true[away], abs=0.02)


def test_where_one_level_becomes_another_the_cell_is_followed_and_no_further_than_these():
    cell = 20.0 - np.clip((TIME - 80.0) / 8.0, 0.0, 1.0)  # 8 s of setting down
    found = levels(cell + 15.0 * NOISE)
    over = (TIME > 80.0) & (TIME < 88.0)
    assert np.abs(found - cell)[over].max() < 0.15
    assert found.max() == pytest.approx(20.0, abs=0.01)
    assert found.min() == pytest.approx(19.0, abs=0.01)
    assert np.ptp(found[TIME < 80.0 - LASTS]) == 0.0


@pytest.mark.parametrize("period", [6.0, 12.0, 20.0, 25.0])
@pytest.mark.parametrize("phase", [0.0, 1.0, 2.0])
def test_a_cell_that_feels_a_swell_says_one_level(period, phase):
    cell = 20.0 + 0.5 * np.sin(2.0 * np.pi * TIME / period + phase)
    assert np.ptp(levels(cell + 15.0 * NOISE)) == 0.0


def test_a_cell_that_feels_the_winch_start_says_one_level():
    starts = sum(np.exp(-(((TIME - at) / 2.0) ** 2)) * way for at, way in ((30, 1), (55, -1), (90, 1), (140, -1)))
    assert np.ptp(levels(20.0 + 0.6 * starts + 15.0 * NOISE)) == 0.0


def test_what_may_be_the_cells_own_is_no_change_of_the_load():
    """Half a per cent, half of what pins in sheaves are stated with."""
    assert np.ptp(levels(steps((90.0, 0.09)) + 5.0 * NOISE)) == 0.0
    assert np.ptp(levels(steps((90.0, 0.11)) + 5.0 * NOISE)) > 0.0


def test_a_change_is_where_it_is():
    found = levels(steps((90.0, 0.8)) + 15.0 * NOISE)
    assert np.ptp(found[TIME < 90.0 - 0.5 * LASTS - EVERY]) == 0.0
    assert np.ptp(found[TIME > 90.0 + 0.5 * LASTS + EVERY]) == 0.0


def test_what_stays_for_less_than_a_swell_is_no_level():
    assert np.ptp(levels(steps((90.0, 1.0), (90.0 + 0.4 * LASTS, -1.0)) + 15.0 * NOISE)) == 0.0
    short = TIME < 2.0 * LASTS - EVERY
    assert np.ptp(level_of(steps((15.0, 1.0))[short], steps((15.0, 1.0))[short], DT)) == 0.0


@pytest.mark.parametrize("seed", range(20))
def test_noise_of_any_colour_says_one_level(seed):
    rng = np.random.default_rng(seed)
    held = np.exp(-DT / rng.uniform(0.05, 3.0))
    wander = lfilter([np.sqrt(1.0 - held**2)], [1.0, -held], rng.standard_normal(len(TIME)))
    assert np.ptp(levels(20.0 + rng.uniform(0.01, 0.4) * wander)) == 0.0


def test_a_run_hangs_what_its_cell_says_at_every_time(crane_150t):
    """By 3 t in 24, less than a twentieth of the deviation: a median of the run was 2 bar off before and after."""
    speed = 60.0 * np.sin(2.0 * np.pi * TIME / 40.0)
    mass = 1e3 * (24.0 - 3.0 * (TIME > 17.0) + 0.4 * (TIME > 63.0))
    columns = {"time": TIME, "motor_speed": speed, "hook_load": mass + 20e3 * NOISE}
    grid = uniform(Run("run", columns))
    found = load_of(grid, motion_of(grid, crane_150t, "run", turning=False), crane_150t, float("nan")).mass
    kept = np.minimum(np.abs(grid.time - 17.0), np.abs(grid.time - 63.0)) > 3.0
    assert found[kept] == pytest.approx(np.interp(grid.time, TIME, mass)[kept], abs=60.0)
