"""A gear of which one flank alone carries more: a torque while hoisting, or while lowering, by a power of the load."""

import numpy as np
import pytest

from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.winch import operating_point


def lost(name, values, crane, torque, speed):
    model = FrictionModel("gear", (term_named(name),), values, constants={"gear_ratio": crane.gear_ratio})
    point = operating_point(direction=float(np.sign(speed)), speed=speed, drum_torque=torque, motor_total=11)
    return float(model.torque(point))


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_it_acts_one_way_alone_and_grows_by_its_power(way, crane_150t):
    whole = lost("gear_one_way", (0.01, 2.0, way), crane_150t, 5e5, 40.0 * way)
    assert whole == pytest.approx(2.0 * 0.01 * 5e5 / crane_150t.gear_ratio, rel=1e-3)
    assert lost("gear_one_way", (0.01, 2.0, way), crane_150t, 2.5e5, 40.0 * way) == pytest.approx(whole / 4.0, rel=1e-3)
    assert lost("gear_one_way", (0.01, 2.0, way), crane_150t, 5e5, -40.0 * way) == pytest.approx(0.0, abs=1e-2 * whole)


def test_in_proportion_to_the_load_it_is_the_catalogues(crane_150t):
    for speed in (-60.0, 60.0):
        catalogue = lost("gear_asymmetry", (0.02, 1.0), crane_150t, 3e5, speed)
        assert lost("gear_one_way", (0.01, 1.0, 1.0), crane_150t, 3e5, speed) == pytest.approx(
            catalogue, rel=1e-6, abs=1e-9
        )
