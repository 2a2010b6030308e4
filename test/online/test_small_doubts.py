"""Each small doubt of an input by itself: stamps, voices, a command that jumps, loads beside torques, what is held."""

import math
from dataclasses import replace

import pytest
from sea import CRANE, TOPICS, swell

from winch_friction.compensation.safe_output import AGAINST_SPEED, LONGEST_LAG
from winch_friction.online.agreement import (
    CHATTER_TIME,
    CONFIRMED_AFTER,
    CONFIRMED_BY,
    DOUBTED,
    TOGETHER,
    Agreement,
    Stamp,
    StampWatch,
    Voices,
)
from winch_friction.online.consumer import HeldTorque
from winch_friction.online.doubt import LEAST_KNOWN, LONGEST_SPAN, MEMORY, Doubt, LoadAgainstDrive, _Way, span
from winch_friction.physics.signals import GroupSample, Sample
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.bag_write import MESSAGES
from winch_friction.records.crane_file import load_crane

PERIOD = 0.02  # s
RANGES = ChannelRanges(CRANE, TOPICS.groups)
SPEED = TOPICS.inputs["winch/joint_states"]


def watch():
    """A watch that has seen good stamps of 100 s and more by a clock from 0."""
    own = StampWatch()
    for k in range(50):
        own.judge(100.0 + k * PERIOD, k * PERIOD)
    return own, 100.0 + 49 * PERIOD, 49 * PERIOD


# -- stamps
def test_after_a_long_pause_a_stamp_need_not_have_advanced_by_a_tenth_of_it():
    """A sender that stood still for a minute goes on from where it was."""
    own, stamp, now = watch()
    assert own.judge(stamp + 0.2, now + 60.0) is Stamp.GOOD


def test_a_burst_of_old_messages_sets_no_clock():
    """They agree, but come all at once: whoever was silent for a while sends what waited."""
    own, stamp, now = watch()
    assert {own.judge(stamp - 5.0 + k * PERIOD, now + 1e-3 * k) for k in range(1, 20)} == {Stamp.BACK}


@pytest.mark.parametrize(
    "stray", [lambda k: 3600.0 * k, lambda k: 3600.0], ids=["each of another hour", "each the same"]
)
def test_stray_stamps_that_do_not_advance_together_set_no_clock(stray):
    own, stamp, now = watch()
    worths = {own.judge(stamp + 7200.0 + stray(k), now + k * PERIOD) for k in range(1, 4 * CONFIRMED_BY)}
    assert worths == {Stamp.AHEAD}


def test_a_stray_stamp_that_is_repeated_and_then_another_one_set_no_clock():
    """Of five messages four were one and the same: they show no clock that goes on."""
    own, stamp, now = watch()
    same = {own.judge(stamp + 7200.0, now + k * PERIOD) for k in range(1, CONFIRMED_BY)}
    assert same == {Stamp.AHEAD}
    assert own.judge(stamp + 7200.0 + CONFIRMED_AFTER + 0.01, now + CONFIRMED_BY * PERIOD) is Stamp.AHEAD


# -- voices
def message(speed, time=10.0):
    sample = swell(time)
    sample.motor_speed = speed
    return dict(TOPICS.encode(sample, MESSAGES))[SPEED.topic]


def test_a_sender_whose_stamps_stand_still_has_one_voice():
    voices = Voices(RANGES)
    assert not voices.contradict(SPEED, message(100.0), 100.0)
    assert not voices.contradict(SPEED, message(-100.0), 100.0 + 2.0 * TOGETHER)


def test_another_time_forgets_who_contradicted_himself():
    voices = Voices(RANGES)
    voices.contradict(SPEED, message(100.0), 100.0)
    assert voices.contradict(SPEED, message(-100.0), 100.001)
    voices.forget()
    assert not voices.contradict(SPEED, message(100.0, 11.0), 100.0 + 0.5 * DOUBTED)


# -- the command
def jumping(steps, period=0.05):
    """Whether a command that makes these steps, as shares of the largest speed, is doubted at the end."""
    own, command, found = Agreement(CRANE, RANGES), 0.0, ()
    for k, step in enumerate(steps):
        command += step * RANGES.speed
        found = own.contradictions(Sample(k * period, math.nan, speed_reference=command))
    return "speed_reference jumps to and fro: two publishers?" in found


def test_a_command_that_jumps_to_and_fro_comes_from_two():
    assert jumping([0.2, -0.2] * 4)
    assert not jumping([0.2, -0.01] * 4)  # a staircase with a ripple
    assert not jumping([0.2, -0.2] * 4, period=1.2 * CHATTER_TIME / 3.0)  # a joystick


@pytest.mark.parametrize(("lead", "stands"), [(0.0, True), (0.3, False)])
def test_a_command_may_be_ahead_of_the_speed_by_the_look_ahead(lead, stands):
    own = Agreement(CRANE, RANGES, lead)
    times = [PERIOD * k for k in range(round((LONGEST_LAG + 0.1) / PERIOD) + 2)]
    found = [own.contradictions(Sample(t, 40.0, speed_reference=-40.0)) for t in times]
    assert ("speed_reference turns against motor_speed" in found[-1]) is stands


def test_stamps_that_creep_stretch_no_patience():
    """Ten seconds by the clock are one by the stamps."""
    own = Agreement(CRANE, RANGES)
    fast = 0.5 * RANGES.speed
    found = [
        own.contradictions(Sample(0.1 * PERIOD * k, fast, speed_reference=0.1 * fast), PERIOD * k) for k in range(60)
    ]
    assert "speed_reference contradicts motor_speed" in found[-1]


# -- doubts
def test_what_was_wrong_counts_until_it_was_right_for_as_long_as_is_forgiven():
    """Messages in batches: a command that is right in one sample of each is none."""
    batches, single = Doubt(0.1, forgiven=0.1), Doubt(0.1)
    for k in range(20):
        for each in (batches, single):
            each.step(k % 4 != 0, 0.03)
    assert batches.stands
    assert not single.stands


@pytest.mark.parametrize(
    ("last", "time", "counted"),
    [(1.0, 1.02, 0.02), (1.0, 61.0, LONGEST_SPAN), (1.0, -60.0, 0.0), (math.nan, 1.0, 0.0)],
)
def test_neither_a_gap_nor_a_jump_back_is_time_in_which_something_was_wrong(last, time, counted):
    assert span(last, time) == pytest.approx(counted)


# -- the load
def test_a_mean_of_one_way_forgets_what_was_long_ago():
    way = _Way()
    for drive in (100.0, 300.0):
        for _ in range(round(5.0 * MEMORY / 0.1)):
            way.step(50.0, drive, 0.1)
    assert way.load == pytest.approx(50.0)
    assert way.drive == pytest.approx(300.0, rel=0.02)
    assert way.known == pytest.approx(MEMORY, rel=0.02)


def hoisting_and_lowering(loads, share, layer=math.nan):
    """What is said of loads shown in kg, each for 8 s of either way, while the motors hold `share` of 55 t."""
    own, said, time = LoadAgainstDrive(CRANE, RANGES), [], 0.0
    for load in loads:
        for way in (1.0, -1.0):
            for _ in range(round(1.6 * LEAST_KNOWN / PERIOD)):
                time += PERIOD
                held = share * CRANE.drum_torque(55e3, layer) / CRANE.gear_ratio
                motors = CRANE.motor_count("active") * CRANE.max_displacement
                groups = {"active": GroupSample(held / motors, 0.0, CRANE.max_displacement)}
                sample = Sample(time, 100.0 * way, groups=groups, hook_load=load, wire_layer=layer)
                said.append(own.contradiction(sample, PERIOD))
    return said


@pytest.mark.parametrize(("shown", "doubted"), [(55e3, False), (15e3, True)])
def test_the_middle_of_both_ways_tells_a_load_cell_that_is_off(shown, doubted):
    said = hoisting_and_lowering([shown], 1.0)
    assert bool(said[-1]) is doubted
    assert not any(said[: round(1.6 * LEAST_KNOWN / PERIOD)]), "one way alone is no middle"


@pytest.mark.parametrize("wrong", [1e3, -1e3])
def test_a_torque_of_a_wrong_unit_is_doubted_as_long_as_it_is_wrong(wrong):
    """An electric motor's torque has no range of its own: its mean of four seconds outweighed the right ones for
    minutes, and nothing was fed forward meanwhile."""
    crane = replace(load_crane("worm_drive"), rated_load=0.2)
    own, held = LoadAgainstDrive(crane, ChannelRanges(crane, ())), crane.drum_torque(0.1) / crane.gear_ratio
    found = []
    for k in range(190):
        time = 0.1 * k
        factor = wrong if 12.0 <= time < 16.0 else 1.0
        sample = Sample(time, 100.0 * (-1.0) ** (k // 30), motor_torque=factor * held, hook_load=0.1)
        found.append(bool(own.contradiction(sample, 0.1)))
    assert not any(found[:125])
    assert all(found[135:160])
    assert not any(found[175:])


def test_on_an_inner_layer_the_load_is_compared_at_its_own_radius():
    """What the motors lack of it may be a third, but not more: with the outer layer's radius it would be."""
    radii = CRANE.drum.layer_radii
    assert 0.65 * radii[0] < 0.6 * radii[-1]
    assert not hoisting_and_lowering([55e3], 0.65, layer=1.0)[-1]


def test_a_cell_that_was_taken_out_and_put_back_begins_anew():
    said = hoisting_and_lowering([25e3, math.nan, 25e3], 1.0)
    part = len(said) // 3
    assert said[part - 1]
    assert not any(said[2 * part : 2 * part + round(0.9 * LEAST_KNOWN / PERIOD)])
    assert said[-1]


def test_near_standstill_a_command_turns_against_nothing():
    """Slower than that a speed has no direction; of a machine that turns half as fast at half of it."""
    own = Agreement(CRANE, RANGES)
    least = AGAINST_SPEED * CRANE.speed_scale
    found = [own.contradictions(Sample(PERIOD * k, 0.9 * least, speed_reference=-40.0)) for k in range(50)]
    assert not any("turns against" in name for names in found for name in names)
    found = [own.contradictions(Sample(1.0 + PERIOD * k, 1.1 * least, speed_reference=-40.0)) for k in range(50)]
    assert "speed_reference turns against motor_speed" in found[-1]


# -- who uses the torque
def test_a_torque_that_no_crane_says_is_ignored_either_way():
    held = HeldTorque(largest=500.0)
    assert held.take(400.0, 0.0)
    assert not held.take(-600.0, 0.01)
    assert not held.take(600.0, 0.02)
    assert held.torque == 400.0
