"""A crane file that does not say what the crane may lift still has a range for what hangs there."""

import math
from dataclasses import replace

import pytest

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.compensation.parts import carried
from winch_friction.physics.channels import GRAVITY, LIMITS
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import LOAD_MARGIN, ChannelRanges, fastest_command


def test_a_crane_without_motors_and_rated_load_takes_what_any_cell_may_say(crane_150t):
    bare = replace(crane_150t, rated_load=0.0, max_displacement=0.0)
    assert ChannelRanges(bare).load == LIMITS["hook_load"][1]
    assert ChannelRanges(replace(crane_150t, rated_load=100e3)).load == 100e3 * LOAD_MARGIN
    for turning in ("motor_speed", "speed_reference"):  # and of no rated speed: whatever may be a speed
        fastest = LIMITS["motor_speed"][1]
        assert ChannelRanges(replace(bare, rated_speed=0.0)).range(turning) == (-fastest, fastest)


def test_a_group_that_is_swung_out_carries_no_more_pressure_than_its_floor_does(crane_150t):
    config = CompensatorConfig(pressure_group="active", min_displacement=0.2)

    def asked(share):
        group = GroupSample(5e6, 2e6, share * crane_150t.max_displacement)
        return carried(Sample(0.0, 10.0, 10.0, {"active": group, "passive": group}), crane_150t, config)[0]

    motors = crane_150t.motor_count("active")
    assert asked(1.0) == pytest.approx(1.0 / (motors * crane_150t.max_displacement))
    assert asked(0.2) == pytest.approx(asked(1.0) / 0.2)
    assert asked(0.01) == pytest.approx(0.05 * asked(0.2))
    electric = Sample(0.0, 10.0, 10.0, {})
    assert carried(electric, crane_150t, config)[0] == 0.0


# of the shipped crane, by hand: 450 bar, 4800 rpm, 150 t, 11 motors of 215 cm^3/rev, six layers
FASTEST, HEAVIEST = 4800.0 * 2.0 * math.pi / 60.0 * 1.25, 300e3  # rad/s, kg
FULL = 215e-6 / (2.0 * math.pi)  # m^3/rad
SHOWN = {
    "motor_speed": (-FASTEST, FASTEST), "speed_reference": (-FASTEST, FASTEST), "hook_load": (-15e3, HEAVIEST),
    "rope_force": (-15e3 * GRAVITY, HEAVIEST * GRAVITY), "heave_velocity": (-10.0, 10.0), "wire_layer": (0.5, 6.5),
    "pressure_a": (-100e5, 600e5), "active.pressure_b": (-100e5, 600e5),
    "main.displacement": (-0.05 * FULL, 1.05 * FULL), "oil_temperature": LIMITS["oil_temperature"],
}  # fmt: skip
CHANGES = {
    "motor_speed": (4.0 * FASTEST, 0.05 * FASTEST), "speed_reference": (20.0 * FASTEST, 0.2 * FASTEST),
    "hook_load": (10.0 * HEAVIEST, 0.1 * HEAVIEST), "heave_velocity": (30.0, 1.0), "oil_temperature": (5.0, 5.0),
    "passive.pressure_a": (1e9, 60e5), "pressure_b": (1e9, 60e5), "active.displacement": (10.0 * FULL, 0.1 * FULL),
    "rope_force": None, "wire_layer": None,
}  # fmt: skip


@pytest.mark.parametrize("channel", SHOWN)
def test_what_a_channel_may_show_is_in_proportion_to_what_the_crane_is_rated_for(crane_150t, channel):
    ranges, (lower, upper) = ChannelRanges(crane_150t), SHOWN[channel]
    assert ranges.range(channel) == pytest.approx((lower, upper), rel=1e-6)
    width = upper - lower
    judged = [ranges.plausible(channel, value) for value in (
        lower - 1e-3 * width, lower + 1e-3 * width, upper - 1e-3 * width, upper + 1e-3 * width, math.nan)]  # fmt: skip
    assert judged == [False, True, True, False, False]


@pytest.mark.parametrize("channel", CHANGES)
def test_how_fast_a_channel_may_change_is_too(crane_150t, channel):
    found = ChannelRanges(crane_150t).change(channel)
    most = None if found is None else (found.per_second, found.at_once)
    assert most == (CHANGES[channel] and pytest.approx(CHANGES[channel], rel=1e-6))


@pytest.mark.parametrize(("groups", "motors"), [((), 22), (("active",), 3), (("active", "passive"), 11)])
def test_without_a_rated_load_the_motors_on_the_shaft_hold_it_on_the_innermost_layer(crane_150t, groups, motors):
    ranges = ChannelRanges(replace(crane_150t, rated_load=0.0), groups)
    assert ranges.load == pytest.approx(motors * FULL * 450e5 * 250.0 / (GRAVITY * 0.8), rel=1e-6)


@pytest.mark.parametrize(("size", "faster"), [(1.0, 1.0), (1.0 / 8.0, 2.0), (8.0, 0.5)])
def test_without_a_rated_speed_small_motors_turn_faster(crane_150t, size, faster):
    """As the pistons of a series have the same velocity, the speed goes with the third root of the size."""
    bare = replace(crane_150t, rated_speed=0.0, max_displacement=size * FULL)
    assert ChannelRanges(bare).speed == pytest.approx(FASTEST * faster, rel=1e-6)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_fastest_command_is_the_one_at_which_command_and_speed_begin_to_contradict(way):
    """They do where they are apart by 30 % of the larger one and a tenth of the largest speed."""
    fastest = fastest_command(way * 60.0, 600.0)
    assert fastest - 60.0 == pytest.approx(0.3 * fastest + 0.1 * 600.0)
