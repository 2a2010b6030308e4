"""The drum torque without a load cell: from the torque balance, with the signs of inertia and friction."""

import math
from dataclasses import replace

import pytest

from winch_friction.compensation.parts import DrumTorque, Needs
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.crane_file import load_crane

FULL = 3 * 3.4e-5 + 8 * 1.1e-5  # m^3/rad of both groups


def balanced(crane, load, acceleration, friction):
    """A sample whose motors carry a load at rest on the wire, the shaft's inertia and friction."""
    torque = crane.drum_torque(load) / crane.gear_ratio + crane.inertia * acceleration + friction
    drop = torque / FULL
    groups = {"active": GroupSample(drop + 25e5, 25e5, 3.4e-5), "passive": GroupSample(drop + 25e5, 25e5, 1.1e-5)}
    return Sample(0.0, 100.0, groups=groups)


@pytest.mark.parametrize("acceleration", [-130.0, 0.0, 130.0])
@pytest.mark.parametrize("friction", [-500.0, 0.0, 500.0])
def test_the_balance_gives_the_load_back(crane_150t, acceleration, friction):
    each = DrumTorque(crane_150t, math.nan, 5.0)
    each.learn(balanced(crane_150t, 55e3, acceleration, friction), friction, acceleration, 0.02)
    assert each.value(Sample(0.0, 0.0)) == pytest.approx(crane_150t.drum_torque(55e3), rel=1e-9)


def test_the_estimate_follows_slowly(crane_150t):
    each = DrumTorque(crane_150t, math.nan, 5.0)
    each.learn(balanced(crane_150t, 50e3, 0.0, 0.0), 0.0, 0.0, 0.02)
    for _ in range(250):  # one time constant
        each.learn(balanced(crane_150t, 60e3, 0.0, 0.0), 0.0, 0.0, 0.02)
    reached = each.value(Sample(0.0, 0.0)) / crane_150t.drum_torque(1e3)
    assert reached == pytest.approx(60.0 - 10.0 / math.e, abs=0.1)


def test_a_measured_rope_force_is_the_load_where_no_hook_load_is(crane_150t):
    each = DrumTorque(crane_150t, 40e3, 5.0)
    force = Sample(0.0, 0.0, rope_force=30e3 * GRAVITY, wire_layer=6.0)
    assert each.value(force) == pytest.approx(crane_150t.drum_torque(30e3, 6.0))
    both = Sample(0.0, 0.0, rope_force=30e3 * GRAVITY, hook_load=20e3, wire_layer=6.0)
    assert each.value(both) == pytest.approx(crane_150t.drum_torque(20e3, 6.0))


@pytest.mark.parametrize(("channel", "usual"), [("rope_force", 30e3 * GRAVITY), ("hook_load", 30e3)])
def test_a_load_that_this_crane_cannot_hold_is_no_input(crane_150t, channel, usual):
    needs = Needs(ChannelRanges(crane_150t), {"drum_torque"}, "measured", load_known=False)
    sample = balanced(crane_150t, 30e3, 0.0, 0.0)
    assert needs.missing(replace(sample, **{channel: usual})) == ()
    assert needs.missing(replace(sample, **{channel: 1e8})) == (channel,)


def test_a_load_cell_comes_first_then_the_setting(crane_150t):
    each = DrumTorque(crane_150t, 40e3, 5.0)
    each.learn(balanced(crane_150t, 55e3, 0.0, 0.0), 0.0, 0.0, 0.02)
    assert each.value(Sample(0.0, 0.0, hook_load=30e3)) == crane_150t.drum_torque(30e3)
    assert each.value(Sample(0.0, 0.0)) == crane_150t.drum_torque(40e3)


def test_motors_that_are_pulled_hold_no_load_rather_than_less_than_none(crane_150t):
    """An empty hook and an offset of the transducers: friction of a negative load would drive the winch."""
    each = DrumTorque(crane_150t, math.nan, 5.0)
    each.learn(balanced(crane_150t, -5e3, 0.0, 0.0), 0.0, 0.0, 0.02)
    assert each.value(Sample(0.0, 0.0)) == 0.0


def test_a_rope_force_acts_on_the_radius_of_the_layer_in_use(crane_150t):
    each = DrumTorque(crane_150t, math.nan, 5.0)
    inner, outer = (each.value(Sample(0.0, 0.0, rope_force=3e5, wire_layer=layer)) for layer in (1.0, math.nan))
    radii = crane_150t.drum.layer_radii
    assert inner == pytest.approx(3e5 * radii[0])
    assert outer == pytest.approx(3e5 * radii[-1])


@pytest.mark.parametrize("time_constant", [1.0, 5.0])
@pytest.mark.parametrize("dt", [0.02, 1.0, 60.0])
def test_a_step_moves_the_estimate_by_its_share_of_step_and_time_constant(crane_150t, time_constant, dt):
    """After a gap it is near what the balance says now, and never beyond it."""
    each = DrumTorque(crane_150t, math.nan, 17.0)
    each.learn(balanced(crane_150t, 50e3, 0.0, 0.0), 0.0, 0.0, 0.02)
    each.configure(math.nan, time_constant)
    each.learn(balanced(crane_150t, 60e3, 0.0, 0.0), 0.0, 0.0, dt)
    expected = 50.0 + 10.0 * dt / (dt + time_constant)
    assert each.value(Sample(0.0, 0.0)) / crane_150t.drum_torque(1e3) == pytest.approx(expected)


@pytest.mark.parametrize(("channel", "factor"), [("hook_load", 1.0), ("rope_force", GRAVITY)])
@pytest.mark.parametrize(("share", "believed"), [(-0.06, False), (-0.04, True), (0.99, True), (1.01, False)])
def test_each_way_to_show_the_load_has_its_own_range(crane_150t, channel, factor, share, believed):
    """A mass in kg and a force in N: what is too much of the one is little of the other."""
    ranges = ChannelRanges(crane_150t)
    needs = Needs(ranges, {"drum_torque"}, "measured", load_known=False)
    shown = replace(balanced(crane_150t, 30e3, 0.0, 0.0), **{channel: share * factor * 2.0 * crane_150t.rated_load})
    assert needs.missing(shown) == (() if believed else (channel,))


@pytest.mark.parametrize(
    ("shown", "load_known", "missing"),
    [({}, False, True), ({}, True, False), ({"hook_load": 100.0}, False, False), ({"rope_force": 1e3}, False, False)],
)
def test_an_electric_drive_needs_its_torque_only_where_nothing_else_tells_the_load(shown, load_known, missing):
    needs = Needs(ChannelRanges(load_crane("emps")), {"drum_torque"}, "measured", load_known=load_known)
    assert needs.missing(Sample(0.0, 0.1, **shown)) == (("motor_torque",) if missing else ())
