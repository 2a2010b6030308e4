"""The one table of channels, and what derives from it."""

from dataclasses import fields

import pytest

from winch_friction.physics.channels import (
    CHANNELS,
    GROUP_CHANNELS,
    SAMPLE_SCALARS,
    SLOW_INPUTS,
    channel_of,
    column_unit,
    display_unit,
    limits_of,
    plausible,
)
from winch_friction.physics.friction.compiled import operating_point
from winch_friction.physics.friction.symbols import WINCH_SIGNALS
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import CHANNEL_SIGNALS
from winch_friction.records.unit_names import conversion_to_si


def test_a_sample_has_the_fields_of_the_table():
    own = {each.name for each in fields(Sample)} - {"time", "groups"}
    assert own == set(SAMPLE_SCALARS), "a live channel is a field of Sample in physics/signals.py"
    assert tuple(each.name for each in fields(GroupSample)) == GROUP_CHANNELS, "so is a group's of GroupSample"


@pytest.mark.parametrize("channel", CHANNELS, ids=lambda each: each.name)
def test_every_channel_is_whole(channel):
    column = f"active.{channel.name}" if channel.of_group else channel.name
    assert channel_of(column) is channel
    assert column_unit(column) == channel.unit
    assert display_unit(column) == channel.display
    assert limits_of(column) == channel.limits
    assert channel.doc
    if channel.unit != "degC" and channel.display != channel.unit:
        scale, offset = conversion_to_si(channel.display, channel.unit, "a test")
        assert scale > 0.0
        assert offset == 0.0
    lower, upper = channel.limits
    assert lower < upper
    assert plausible(channel.name, 0.5 * (lower + upper))
    assert plausible(channel.name, upper)
    assert not plausible(channel.name, float("nan"))
    if upper < 1e299:
        assert not plausible(column, 1.001 * upper)
        assert not plausible(column, lower - 1e-3 * (upper - lower))


def test_units_of_contract_columns():
    assert display_unit("active.pressure_drop_simulated") == "bar"
    assert display_unit("rope_force") == "kN"
    assert display_unit("mechanical_power") == "kW"
    assert display_unit("motor_current") == "A"
    assert column_unit("load_torque") == "N*m"
    assert column_unit("pressure_a") is None, "a group's channel needs its group"
    assert column_unit("active.hook_load") is None
    assert limits_of("pressure_a") == limits_of("active.pressure_a")


def test_slow_inputs_are_those_with_an_age():
    assert SLOW_INPUTS == {"hook_load": 2.0, "oil_temperature": 30.0, "wire_layer": 30.0, "wire_out": 2.0}


def test_the_operating_point_takes_its_channels_by_name():
    assert set(CHANNEL_SIGNALS) == {"oil_temperature", "time", "shaft_angle", "wire_layer", "wire_out"}
    x = operating_point(direction=1.0, speed=-3.0, drum_torque=5.0, motor_total=4, wire_out=70.0)
    at = dict(zip([signal.name for signal in WINCH_SIGNALS], x, strict=True))
    assert (at["speed_magnitude"], at["wire_out"], at["oil_temperature"]) == (3.0, 70.0, 40.0)
    with pytest.raises(TypeError, match="wire_length"):
        operating_point(direction=1.0, speed=-3.0, drum_torque=5.0, motor_total=4, wire_length=70.0)
