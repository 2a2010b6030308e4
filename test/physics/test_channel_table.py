"""The one table of channels, and what derives from it."""

import math
import re
from dataclasses import fields

import numpy as np
import pytest

from winch_friction.physics.channels import (
    CHANNELS,
    GROUP_CHANNELS,
    SAMPLE_SCALARS,
    SLOW_INPUTS,
    Topic,
    accepted_units,
    beside,
    channel_of,
    column_unit,
    display_unit,
    factor_to_si,
    limits_of,
    outside,
    plausible,
)
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.compiled import group_point, operating_point
from winch_friction.physics.friction.symbols import CONSTANTS, SIGNAL_OF_SYMBOL, WINCH_SIGNALS
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


# -- what a sensor can say at all, by hand: unit, what people read, least and largest value, and how long it holds
CAN = {
    "time": ("s", "s", -1e300, 1e300, None),
    "motor_speed": ("rad/s", "rpm", -3e3, 3e3, None),
    "drum_speed": ("rad/s", "rpm", -3e3, 3e3, None),
    "speed_reference": ("rad/s", "rpm", -3e3, 3e3, None),
    "motor_torque": ("N*m", "N*m", -1e6, 1e6, None),
    "hook_load": ("kg", "t", -1e5, 1e7, 2.0),
    "heave_velocity": ("m/s", "m/s", -50.0, 50.0, None),
    "oil_temperature": ("degC", "degC", -60.0, 250.0, 30.0),
    "wire_layer": ("1", "1", 0.0, 100.0, 30.0),
    "wire_out": ("m", "m", -1e3, 3e4, 2.0),
    "shaft_angle": ("rad", "rad", -1e300, 1e300, None),
    "load_torque": ("N*m", "N*m", -1e8, 1e8, None),
    "rope_force": ("N", "kN", -1e6, 1e8, None),
    "mechanical_power": ("W", "kW", -1e9, 1e9, None),
    "motor_current": ("A", "A", -1e5, 1e5, None),
    "motor_torque_simulated": ("N*m", "N*m", -1e6, 1e6, None),
    "rope_force_simulated": ("N", "kN", -1e6, 1e8, None),
    "pressure_a": ("Pa", "bar", -1e7, 2e8, None),
    "pressure_b": ("Pa", "bar", -1e7, 2e8, None),
    "displacement": ("m^3/rad", "cm^3/rev", -0.06, 0.06, None),
    "pressure_drop_simulated": ("Pa", "bar", -1e7, 2e8, None),
}
NOT_LIVE = {
    "time", "drum_speed", "motor_torque_simulated", "rope_force_simulated", "pressure_drop_simulated",
}  # fmt: skip
TOPICS = {
    Topic.MOTION: {"motor_speed", "motor_torque", "shaft_angle"}, Topic.REFERENCE: {"speed_reference"},
    Topic.PRESSURE: {"pressure_a", "pressure_b"}, Topic.SWASH: {"displacement"},
    Topic.TEMPERATURE: {"oil_temperature"},
    Topic.PLAIN: {"hook_load", "heave_velocity", "wire_layer", "wire_out", "rope_force"},
    Topic.OF_DRIVE: {"load_torque", "mechanical_power", "motor_current"}, Topic.NONE: NOT_LIVE,
}  # fmt: skip


def test_a_channel_has_its_unit_and_limits_and_way_through_ros():
    told = {c.name: (c.unit, c.display, *c.limits, c.max_age) for c in CHANNELS}
    assert told == CAN
    assert {c.name for c in CHANNELS if not c.live} == NOT_LIVE
    assert {topic: {c.name for c in CHANNELS if c.topic is topic} for topic in Topic} == TOPICS
    of_group = {"pressure_a", "pressure_b", "displacement", "pressure_drop_simulated"}
    assert {c.name for c in CHANNELS if c.of_group} == of_group


@pytest.mark.parametrize(
    ("unit", "si", "factor"),
    [("rpm", "rad/s", 2.0 * math.pi / 60.0), ("bar", "Pa", 1e5), ("cm^3/rev", "m^3/rad", 1e-6 / (2.0 * math.pi)),
     ("t", "kg", 1e3), ("kN*m", "N*m", 1e3), ("kN", "N", 1e3), ("kW", "W", 1e3), ("mm", "m", 1e-3), ("ms", "s", 1e-3),
     ("h", "s", 3600.0), ("deg", "rad", math.pi / 180.0), ("-", "1", 1.0), ("N*m*s", "N*m*s/rad", 1.0),
     ("bananas", "bananas", 1.0)],
)  # fmt: skip
def test_a_unit_that_people_write_has_its_factor(unit, si, factor):
    assert factor_to_si(unit, si) == pytest.approx(factor, rel=1e-12)
    assert unit in accepted_units(si)
    with pytest.raises(InputError, match=f"^wind: unit '{re.escape(unit)}' cannot be used, expected lumen$"):
        factor_to_si(unit, "lumen", "wind")


@pytest.mark.parametrize(
    ("column", "value", "lower", "upper", "said"),
    [
        ("main.pressure_a", 210.0, 1e5, 600e5, "210 Pa is outside 1e+05 ... 6e+07 Pa: sent in bar? Inputs are in Pa"),
        ("main.pressure_a", 7e7, 0.0, 6e7, "7e+07 Pa is outside 0 ... 6e+07 Pa"),
        ("motor_speed", 1480.0, -300.0, 300.0,
         "1480 rad/s is outside -300 ... 300 rad/s: sent in rpm? Inputs are in rad/s"),
        ("motor_speed", 3000.0, -300.0, 300.0, "3000 rad/s is outside -300 ... 300 rad/s"),
        ("wire_layer", 9.0, 0.5, 6.5, "9 is outside 0.5 ... 6.5"),
        ("own_signal", 9.0, 0.5, 6.5, "9 is outside 0.5 ... 6.5"),
    ],
)  # fmt: skip
def test_a_value_outside_is_asked_for_its_unit_where_that_explains_it(column, value, lower, upper, said):
    assert outside(column, value, lower, upper) == said


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [(0.0049, 1.0, 0.0), (0.0051, 1.0, 0.0051), (-0.0049, 1.0, 0.0), (-3.0, 1.0, -3.0), (1e-9, 0.0, 1e-9)],
)  # fmt: skip
def test_a_value_is_nothing_below_half_of_the_second_digit_of_its_sigma(value, std, shown):
    assert beside(value, std) == shown


# -- what an equation reads where nobody says
def test_a_signal_that_is_not_given_has_its_usual_value():
    known = {each.name: each.default for each in SIGNAL_OF_SYMBOL.values() if each.default is not None}
    assert known == {
        "acceleration": 0.0, "oil_temperature": 40.0, "time": 0.0, "shaft_angle": 0.0, "wire_layer": 1.0,
        "wire_out": 0.0, "pressure_sum": 0.0, "higher_port": 1.0, "role": 0.0, "max_displacement": 0.0,
        "density": 870.0, "viscosity": 0.04, "gear_ratio": 1.0,
    }  # fmt: skip
    within = {each.name: each.limits for each in CONSTANTS}
    assert within == {
        "max_displacement": (0.0, 0.06), "density": (400.0, 3000.0), "viscosity": (1e-4, 100.0),
        "gear_ratio": (1e-3, 1e5),
    }  # fmt: skip


@pytest.mark.parametrize(("drop", "size", "port"), [(3e6, 3e6, 1.0), (-2e6, 2e6, -1.0), (0.0, 0.0, 1.0)])
def test_a_groups_point_has_the_size_of_its_drop_and_the_port_that_is_higher(drop, size, port):
    for given in (drop, np.full(2, drop)):
        told = group_point(3, given, 2e-5)
        assert [float(np.ravel(each)[0]) for each in told] == [3.0, size, size, 2e-5, port, 0.0]
        assert np.all(group_point(3, given, 2e-5, role=-1.0)[5] == -1.0)
        assert float(np.ravel(group_point(3, given, 2e-5, 9e6)[2])[0]) == 9e6
