"""When a contradiction counts and when it is over; which ones are looked for, and where nothing can be told."""

import math

import pytest
from sea import CRANE

from winch_friction.online.agreement import Agreement
from winch_friction.online.doubt import Doubt
from winch_friction.online.load_balance import BALANCE_TIME, LoadBalance
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import ChannelRanges

GROUPS = ("active", "passive")


def test_a_doubt_ends_only_after_a_second_of_agreement():
    doubt = Doubt(0.5)
    for _ in range(6):
        doubt.step(True, 0.1)
    assert doubt.stands
    assert doubt.step(False, 0.9)
    assert not doubt.step(False, 0.2)


@pytest.mark.parametrize("shown", [None, False])
def test_where_nothing_is_to_be_seen_a_doubt_stays(shown):
    doubt = Doubt(0.5, 1.0)
    for _ in range(6):
        doubt.step(True, 0.1)
    for _ in range(20):
        doubt.step(shown, 0.1)
    assert doubt.stands is (shown is None)


def test_speeds_near_standstill_heal_no_doubt():
    each = Agreement(CRANE, ChannelRanges(CRANE, GROUPS))

    def doubted(time: float, command: float, speed: float) -> bool:
        found = each.contradictions(Sample(time, speed, speed_reference=command))
        return "speed_reference contradicts motor_speed" in found

    fast = 0.5 * ChannelRanges(CRANE, GROUPS).speed
    assert [doubted(0.05 * k, fast, 0.2 * fast) for k in range(20)][-1]
    assert all(doubted(1.0 + 0.05 * k, 0.0, 0.0) for k in range(60))
    assert not [doubted(4.0 + 0.05 * k, fast, fast) for k in range(30)][-1]


@pytest.mark.parametrize(("share", "heals"), [(1.0, True), (0.8, True), (9.55, False), (0.105, False), (-1.0, False)])
def test_a_sea_that_calms_lets_a_command_that_agrees_again_heal_its_doubt(share, heals):
    """Below a tenth of the largest speed nothing was to be seen: one hang in a high sea, or a wrong unit that was put
    right, and nothing was fed forward in a low one for good."""
    ranges = ChannelRanges(CRANE, GROUPS)
    each, slow = Agreement(CRANE, ranges), 0.009 * ranges.speed  # 9.55 times that is no contradiction by itself
    said = "speed_reference contradicts motor_speed"
    for k in range(20):
        each.contradictions(Sample(0.05 * k, 0.5 * ranges.speed, speed_reference=0.1 * ranges.speed))
    found = [
        each.contradictions(Sample(1.0 + 0.05 * k, speed, speed_reference=share * speed))
        for k in range(160)
        for speed in (slow * math.sin(2.0 * math.pi * 0.05 * k / 6.0),)
    ]
    assert said in found[4]
    assert (said in found[-1]) is not heals


@pytest.mark.parametrize("apart", [0.3, -0.3])
def test_a_load_cell_that_shows_too_much_is_doubted_as_one_that_shows_too_little(apart):
    balance = LoadBalance()
    both_ways = [Sample(0.1 * k, 100.0 * (-1.0) ** k, hook_load=55e3) for k in range(int(BALANCE_TIME / 0.1) + 5)]
    said = [balance.contradiction(apart, sample) for sample in both_ways]
    assert not said[1]
    assert "by 30%" in said[-1]


def test_small_torques_contradict_no_load():
    """An empty hook: what the motors hold and what the load cell shows are both of the size of their errors."""
    each = Agreement(CRANE, ChannelRanges(CRANE, GROUPS))
    groups = {
        "active": GroupSample(25e5, 25e5, CRANE.max_displacement),
        "passive": GroupSample(25e5, 25e5, CRANE.max_displacement),
    }
    # it hoists: less torque than the load asks for is no friction's doing; a winch at rest is not looked at
    samples = [Sample(0.05 * k, 100.0 + 0.01 * k, groups=groups, hook_load=1e3) for k in range(100)]
    assert not any(each.contradictions(sample, math.nan) for sample in samples)


@pytest.mark.parametrize(("shown", "said"), [({"hook_load": 0.0}, "hook_load"), ({"rope_force": 0.0}, "rope_force")])
def test_a_torque_at_the_motors_and_no_load_on_the_rope_contradict_each_other(shown, said):
    each = Agreement(CRANE, ChannelRanges(CRANE, GROUPS))
    groups = {
        "active": GroupSample(50e5, 25e5, CRANE.max_displacement),
        "passive": GroupSample(275e5, 25e5, CRANE.max_displacement / 3.0),
    }
    found = [each.contradictions(Sample(0.05 * k, 100.0 + 0.01 * k, groups=groups, **shown)) for k in range(30)]
    assert found[10] == ()
    assert found[-1] == (f"{said} contradicts the drive torque",)


# of the shipped crane the largest speed is 628 rad/s: 63 rad/s and 30 % of the larger one may lie between the two
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("one", "other", "differ"),
    [(200.0, 370.0, False), (200.0, 381.0, True), (200.0, 60.0, True), (200.0, 90.0, False), (200.0, -200.0, True),
     (62.0, 0.0, None), (64.0, 0.0, False), (100.0, 0.0, True), (85.0, 0.0, False), (50.0, -50.0, None)],
)  # fmt: skip
def test_command_and_speed_contradict_each_other_whichever_is_the_larger(way, one, other, differ):
    for speed, command in ((one, other), (other, one)):
        own = Agreement(CRANE, ChannelRanges(CRANE))
        assert own._speeds_differ(Sample(0.0, way * speed, speed_reference=way * command)) is differ


def test_a_load_that_is_set_is_compared_with_the_torque_of_the_drive():
    own = Agreement(CRANE, ChannelRanges(CRANE), load=55e3)
    groups = {"active": GroupSample(25e5, 25e5, CRANE.max_displacement)}
    found = [own.contradictions(Sample(0.1 * k, 50.0, speed_reference=50.0, groups=groups)) for k in range(20)]
    assert "load (the parameter) contradicts the drive torque" in found[-1]
