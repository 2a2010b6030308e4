"""A record that is cut out of a motion, and one with a hole: at their edges a slope of the speed is guessed."""

import numpy as np
import pytest

from winch_friction.discrepancy.preparation.grid import uniform
from winch_friction.discrepancy.preparation.seen import motion_of
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import Run

PERIOD, SPEED = 6.2, 150.0  # s, rad/s


def sea(rate, begin=0.9, seconds=40.0):
    time = np.arange(begin, begin + seconds, 1.0 / rate)
    return {"time": time, "motor_speed": SPEED * np.sin(2.0 * np.pi * time / PERIOD)}


def off(columns, crane):
    """The largest error of the acceleration in the samples that are used, share of its peak."""
    grid = uniform(Run("sea", columns))
    motion = motion_of(grid, crane, "sea", turning=False)
    peak = SPEED * 2.0 * np.pi / PERIOD
    true = peak * np.cos(2.0 * np.pi * (grid.time + columns["time"][0]) / PERIOD)
    return float(np.abs(motion.acceleration - true)[motion.used & grid.valid].max()) / peak, motion.used


@pytest.mark.parametrize("rate", [5.0, 10.0, 20.0, 50.0, 200.0])
@pytest.mark.parametrize("begin", [0.9, 2.4, 4.1])
def test_no_sample_is_used_whose_acceleration_is_guessed(crane_150t, rate, begin):
    columns = sea(rate, begin)
    error, used = off(columns, crane_150t)
    # a central difference and a parabola over the window flatten a sine by so much anywhere
    inside = 0.02 if rate > 5.0 else 0.08
    assert error < inside
    assert used.mean() > (0.25 if rate == 5.0 else 0.6)
    hole = (columns["time"] > begin + 20.0) & (columns["time"] < begin + 21.5)
    error, _ = off({name: values[~hole] for name, values in columns.items()}, crane_150t)
    assert error < inside


def test_a_record_of_two_years_is_to_be_split(crane_150t):
    """Two logs in one file: the grid of all the time between them took 600 GB."""
    columns = sea(50.0)
    columns["time"] = np.where(np.arange(len(columns["time"])) < 500, 0.0, 3.2e7) + columns["time"]
    with pytest.raises(InputError, match=r"leaps by 3\.2e\+07 s at .* split the file there"):
        uniform(Run("sea", columns))


def test_a_sample_that_is_missing_here_and_there_costs_none_of_its_neighbours(crane_150t):
    whole, few = sea(50.0), sea(50.0)
    few["motor_speed"] = few["motor_speed"].copy()
    few["motor_speed"][100::50] = np.nan
    used = [off(columns, crane_150t)[1] for columns in (whole, few)]
    assert used[1].sum() == pytest.approx(used[0].sum(), abs=5)  # reversals are found in other noise
