"""A crane as friction sees it: its drum's layers, its motors, and what a hanging load is at the motor shaft."""

import math

import pytest

from winch_friction.physics.errors import InputError
from winch_friction.physics.winch.crane import Crane, Drum

DRUM = Drum((0.8, 0.9, 1.0))
CRANE = Crane("c", 250.0, DRUM, {"active": 3, "passive": 8}, 1.5)


@pytest.mark.parametrize("layer", [0.0, 0.4, -1.0, 4.0, 3.6, math.inf])
def test_a_layer_beyond_the_drum_is_none_and_refused(layer):
    assert not DRUM.has(layer)
    with pytest.raises(InputError, match=r"the drum has layers 1 \.\.\. 3"):
        DRUM.radius(layer)


@pytest.mark.parametrize(("layer", "radius"), [(1.0, 0.8), (2.2, 0.9), (3.0, 1.0), (math.nan, 1.0)])
def test_a_layer_is_counted_from_one_and_without_one_the_outer_is_assumed(layer, radius):
    assert DRUM.has(layer)
    assert DRUM.radius(layer) == radius


def test_a_load_is_a_torque_at_the_drum_and_an_inertia_at_the_shaft():
    assert CRANE.drum_torque(1e4, 2.0) == pytest.approx(1e4 * 9.81 * 0.9, rel=1e-3)
    assert CRANE.load_inertia(1e4, 2.0) == pytest.approx(1e4 * (0.9 / 250.0) ** 2)
    assert (CRANE.motor_total(("active",)), CRANE.motor_total(())) == (3, 11)
