"""A crane file that does not say what the crane may lift still has a range for what hangs there."""

from dataclasses import replace

import pytest

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.compensation.parts import pressure_per_torque
from winch_friction.physics.channels import LIMITS
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import LOAD_MARGIN, ChannelRanges


def test_a_crane_without_motors_and_rated_load_takes_what_any_cell_may_say(crane_150t):
    bare = replace(crane_150t, rated_load=0.0, max_displacement=0.0)
    assert ChannelRanges(bare).load == LIMITS["hook_load"][1]
    assert ChannelRanges(replace(crane_150t, rated_load=100e3)).load == 100e3 * LOAD_MARGIN


def test_a_group_that_is_swung_out_carries_no_more_pressure_than_its_floor_does(crane_150t):
    config = CompensatorConfig(pressure_group="active", min_displacement=0.2)

    def asked(share):
        group = GroupSample(5e6, 2e6, share * crane_150t.max_displacement)
        return pressure_per_torque(Sample(0.0, 10.0, 10.0, {"active": group, "passive": group}), crane_150t, config)

    motors = crane_150t.motor_count("active")
    assert asked(1.0) == pytest.approx(1.0 / (motors * crane_150t.max_displacement))
    assert asked(0.01) == asked(0.2) == pytest.approx(asked(1.0) / 0.2)
    electric = Sample(0.0, 10.0, 10.0, {})
    assert pressure_per_torque(electric, crane_150t, config) == 0.0
