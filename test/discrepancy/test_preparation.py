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
