"""What of a record is used: nothing where the direction of motion, and with it that of friction, is uncertain."""

import numpy as np
import pytest

from winch_friction.discrepancy.preparation.grid import uniform
from winch_friction.discrepancy.preparation.motion import motion_of
from winch_friction.physics.signals import Run


@pytest.mark.parametrize("rate", [5.0, 9.8, 50.0, 200.0])
def test_samples_beside_a_reversal_are_left_out_even_where_none_is_at_zero(crane_150t, rate):
    """Heave compensation in a short sea, logged so slowly that no sample is near zero speed."""
    time = np.arange(0.0, 120.0, 1.0 / rate)
    speed = 120.0 * np.cos(2.0 * np.pi * (time + 0.013) / 5.1)
    motion = motion_of(uniform(Run("sea", {"time": time, "motor_speed": speed})), crane_150t, "sea", turning=False)
    crossings = np.flatnonzero(np.diff(np.sign(speed)) != 0.0)
    assert len(crossings) > 40
    for k in crossings[2:-2]:
        assert not motion.used[k : k + 2].any()
    assert motion.used.mean() > (0.2 if rate < 20.0 else 0.6)


def test_a_shaft_that_waits_for_its_start_has_not_just_reversed(crane_150t):
    """A smoothed speed swings below zero before a quick start; the shaft, under a load that has not let go, rests."""
    time = np.arange(0.0, 40.0, 0.05)
    back, start = (time > 18.0) & (time < 18.5), time > 20.0
    speed = np.where(back, -2.0 * np.sin(2.0 * np.pi * (time - 18.0)), 0.0)
    speed = np.where(start, 150.0 * np.minimum(time - 20.0, 0.5), speed)
    motion = motion_of(uniform(Run("start", {"time": time, "motor_speed": speed})), crane_150t, "start", turning=True)
    rests = (time > 18.8) & (time <= 20.0)
    assert motion.speed[rests].min() < -0.5, "the swing is there"
    assert not motion.used[rests].any()
    assert motion.used[start].any()
