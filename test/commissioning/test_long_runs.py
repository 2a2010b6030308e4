"""A recording of many minutes is thinned, and still shows which way the winch turns."""

import numpy as np
import pytest

from winch_friction.commissioning.view import MOST_BLOCKS, view_of
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane


@pytest.mark.parametrize("minutes", [4.0, 8.1, 24.0, 240.0])
@pytest.mark.parametrize("period", [5.0, 10.0])
def test_a_long_sea_moves_as_a_short_one_does(minutes: float, period: float) -> None:
    """Every thirteenth block of 24 minutes turned another way than its neighbours: none of them counted as moving."""
    time = np.arange(0.0, 60.0 * minutes, 0.1)
    run = Run("sea", {"time": time, "motor_speed": 100.0 * np.sin(2.0 * np.pi * time / period)})
    view = view_of(run, load_crane("crane_150t"))
    assert len(view.time) <= MOST_BLOCKS + 10
    assert view.moving.mean() > 0.3
