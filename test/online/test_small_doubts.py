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
from winch_friction.online.doubt import (
    LEAST_KNOWN,
    LONGEST_SPAN,
    MEMORY,
    PUSH_SAID,
    Doubt,
    LoadAgainstDrive,
    StandingReadings,
    Way,
    span,
)
from winch_friction.online.load_balance import LoadBalance
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
    way = Way()
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
    """What the motors lack of it may be a quarter, but not more: with the outer layer's radius it would be."""
    radii = CRANE.drum.layer_radii
    assert 0.75 * radii[0] < 0.6 * radii[-1]
    assert not hoisting_and_lowering([55e3], 0.75, layer=1.0)[-1]


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


# -- loads beside torques, by hand: tonnes of a crane rated for 150 that are shown and held, and how it turns
def compared(shown, held, way, seconds, own=None, wire=math.nan):
    """What is said at the end of so many seconds one way."""
    own, said = own or LoadAgainstDrive(CRANE, RANGES), ""
    motors = CRANE.motor_count("active") * CRANE.max_displacement
    drop = CRANE.drum_torque(1e3 * held) / CRANE.gear_ratio / motors
    groups = {"active": GroupSample(25e5 + drop, 25e5, CRANE.max_displacement)}
    for k in range(round(seconds / 0.1)):
        sample = Sample(0.1 * k, 50.0 * way, groups=groups, hook_load=1e3 * shown, wire_out=wire)
        said = own.contradiction(sample, 0.1)
    return said


AT_ONCE, IN_THE_MIDDLE = "hook_load contradicts the drive torque", ", hoisting and lowering"


@pytest.mark.parametrize(
    ("shown", "held", "way", "said"),
    [
        (55, 55, 1, ""), (12, 55, 1, ""),  # apart by less than four fifths of the larger one
        # friction hides what is apart: two fifths, of the smaller one where no layer is why, and a third of the larger
        (55, 15, 1, ""), (55, 14, 1, AT_ONCE), (30, 69, -1, AT_ONCE), (30, 66, -1, ""),
        (55, 10, 1, AT_ONCE), (10, 56, 1, AT_ONCE), (55, -60, -1, AT_ONCE),
        (50, 8, -1, ""), (50, 8, 1, AT_ONCE),  # friction takes up to 45 t of a lowered load, and none of a hoisted one
        (0, 40, 1, ""), (0, 40, -1, AT_ONCE), (0, -40, -1, ""), (0, -40, 1, AT_ONCE),
        (0, 46, 1, AT_ONCE), (0, -46, -1, AT_ONCE),
        (14, 0, 1, ""), (16, 0, 1, AT_ONCE), (0, -14, 1, ""), (0, -16, 1, AT_ONCE),
        (344, 344, 1, ""), (346, 346, 1, AT_ONCE + IN_THE_MIDDLE), (-346, -346, -1, AT_ONCE + IN_THE_MIDDLE),
    ],
)  # fmt: skip
def test_a_load_and_a_torque_one_way_contradict_each_other_beyond_what_friction_may_be(shown, held, way, said):
    own = LoadAgainstDrive(CRANE, RANGES)
    assert compared(shown, held, way, 0.9, own) == ""
    assert own.pending is bool(said)
    assert compared(shown, held, way, 0.2, own) == said


@pytest.mark.parametrize(
    ("shown", "held", "wire", "doubted"),
    [
        (50, 69, 0, False), (50, 71, 0, True), (80, 50, 0, False), (87, 50, 0, True),  # on which layer, nobody says
        (50, 74, 5, False), (50, 76, 5, True),  # of 5 t of wire a cell at the hook sees nothing
        (87, 50, 5, True), (50, 71, -5, True),
        (20, 6, 0, False), (20, 4.5, 0, True), (0, 14, 0, False),
    ],
)  # fmt: skip
def test_the_middle_of_both_ways_may_be_off_by_two_fifths_and_by_a_tenth_of_the_rated_load(shown, held, wire, doubted):
    own, metres = LoadAgainstDrive(CRANE, RANGES), 1e3 * wire / CRANE.wire_mass
    assert compared(shown, held, 1.0, 8.0, own, metres) == ""
    assert compared(shown, held, -1.0, LEAST_KNOWN, own, metres) == ""
    said = compared(shown, held, -1.0, 2.2, own, metres)  # of a memory of 20 s, 5 are known after 5.8
    assert said == (AT_ONCE + IN_THE_MIDDLE if doubted else "")
    assert own.pending is doubted


@pytest.mark.parametrize(
    ("hoisted", "lowered", "said"),
    [
        ((50, 46.5), (50, 53.5), ""), ((50, 46), (50, 54), PUSH_SAID), ((50, 54), (50, 46), ""),
        ((2, 0), (2, 5), ""), ((2, -1), (2, 7), PUSH_SAID),  # an empty hook
        ((50, 36), (10, 19), ""), ((50, 34), (10, 19), PUSH_SAID),  # of 40 t a cell may be off by 16
        ((10, 0), (50, 55), ""), ((10, -1), (50, 65), PUSH_SAID),
    ],
)  # fmt: skip
def test_friction_opposes_both_ways_or_the_speed_turns_the_wrong_way(hoisted, lowered, said):
    own = LoadAgainstDrive(CRANE, RANGES)
    assert compared(*hoisted, 1.0, 8.0, own) == ""
    assert compared(*lowered, -1.0, LEAST_KNOWN, own) == ""
    assert compared(*lowered, -1.0, 2.2, own) == said
    assert own.pending is bool(said)


@pytest.mark.parametrize(
    ("shown", "name"),
    [({"hook_load": 55e3}, "hook_load"), ({"rope_force": 5.4e5}, "rope_force"), ({}, "load (the parameter)")],
)
def test_what_contradicts_the_torque_is_named_as_it_was_shown(shown, name):
    own, said = LoadAgainstDrive(CRANE, RANGES, 55e3), ""
    groups = {"active": GroupSample(25e5, 25e5, CRANE.max_displacement)}
    for k in range(20):
        said = own.contradiction(Sample(0.1 * k, 50.0, groups=groups, **shown), 0.1)
    assert said == f"{name} contradicts the drive torque"


# -- the balance of torques
def balanced(apart, hoisting, lowering, slow=0.0, **shown):
    """A balance that is off by a share, after so many seconds of either way, and of creeping down."""
    own, said, time = LoadBalance(5.0), "", 0.0
    for seconds, speed in ((slow, -4.0), (hoisting, 50.0), (lowering, -50.0)):
        for _ in range(round(seconds / 0.1)):
            time += 0.1
            said = own.contradiction(apart, Sample(time, speed, **(shown or {"hook_load": 55e3})))
    return own, said


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_balance_is_suspect_from_a_twentieth_on_and_wrong_from_a_tenth_on_either_way(sign):
    own, said = balanced(sign * 0.04, 20.0, 16.0)
    assert (said, own.suspicion, own.pending) == ("", "", False)
    own, said = balanced(sign * 0.07, 20.0, 16.0)
    assert (said, own.pending) == ("", False)
    assert own.suspicion.startswith(f"the balance of torques adds {sign * 0.07:+.0%} to hook_load: ")
    own, said = balanced(sign * 0.12, 20.0, 16.0, rope_force=5e5)
    assert said.startswith("rope_force contradicts the balance of torques by 12%: ")
    assert (own.suspicion, own.pending) == ("", True)


@pytest.mark.parametrize(
    ("hoisting", "lowering", "slow", "told"),
    [(40.0, 0.0, 0.0, False), (40.0, 4.0, 30.0, False), (0.0, 40.0, 0.0, False), (40.0, 6.0, 0.0, True)],
)
def test_no_balance_is_wrong_before_the_winch_has_turned_both_ways(hoisting, lowering, slow, told):
    """One way, friction that the seed does not know looks like load."""
    own, said = balanced(0.2, hoisting, lowering, slow)
    assert bool(said) is told
    assert not own.suspicion


def test_a_suspicion_counts_from_when_both_ways_were_seen():
    assert not balanced(0.07, 40.0, 6.0)[0].suspicion
    assert balanced(0.07, 40.0, 16.0)[0].suspicion


# -- readings that stand still
MEASURED = ("motor_torque", "mechanical_power", "motor_current", "hook_load", "rope_force", "heave_velocity",
            "wire_out", "shaft_angle", "load_torque")  # fmt: skip


def standing(way=1.0, lives="", **shown):
    """Whether it is doubted after two seconds in which nothing moves but what `lives`."""
    own, said = StandingReadings(5.0), ""
    for k in range(100):
        group = GroupSample(150e5, 25e5, 3e-5)
        sample = Sample(PERIOD * k, 60.0 * way, groups={"active": group}, **{"hook_load": 55e3, **shown})
        owner = group if hasattr(group, lives) else sample
        if lives:
            setattr(owner, lives, 1e-6 * k)
        said = own.contradiction(sample, PERIOD)
    return "all readings" in said


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_readings_that_stand_still_are_doubted_whichever_way_it_turns_or_is_told_to(way):
    assert standing(way)
    assert standing(0.0, speed_reference=60.0 * way)
    assert not standing(0.0, speed_reference=4.0 * way)
    assert not standing(0.0)


@pytest.mark.parametrize("lives", [*MEASURED, "pressure_a", "pressure_b", "displacement"])
def test_one_reading_that_lives_shows_a_sender_that_does(lives):
    assert not standing(lives=lives)


@pytest.mark.parametrize(
    ("name", "told"),
    [("motor_torque", True), ("mechanical_power", True), ("motor_current", True), ("hook_load", False)],
)
def test_a_drive_of_any_kind_may_hang_and_one_without_a_torque_tells_nothing(name, told):
    own, said = StandingReadings(5.0), ""
    for k in range(100):
        said = own.contradiction(Sample(PERIOD * k, 60.0, **{name: 30.0}), PERIOD)
    assert ("all readings" in said) is told


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_speed_of_many_digits_hangs_lowering_as_well_as_hoisting(way):
    own, found = StandingReadings(5.0), []
    for k in range(200):
        speed = way * (50.0 + 10.0 * math.sin(0.01 * min(k, 60)))
        group = GroupSample(150e5 + k, 25e5, 3e-5)
        found.append(own.contradiction(Sample(PERIOD * k, speed, groups={"active": group}), PERIOD))
    assert not any(found[:100])
    assert found[-1].startswith("motor_speed stands still")


# -- how long a doubt counts
@pytest.mark.parametrize(
    ("looks", "stands"),
    [
        ([(True, 0.9)], False), ([(True, 1.0)], True), ([(True, 0.6), (None, 29.0), (True, 0.6)], True),
        ([(True, 0.6), (None, 31.0), (True, 0.6)], False), ([(True, 1.1), (None, 300.0)], True),
        ([(True, 0.6), (None, 20.0), (True, 0.3), (None, 20.0), (True, 0.2)], True),
        ([(True, 0.6), (False, 0.1), (True, 0.6)], False), ([(True, 1.1), (False, 0.9)], True),
        ([(True, 1.1), (False, 1.1)], False), ([(True, 1.1), (False, 0.9), (True, 0.1), (False, 0.9)], True),
        ([(True, 1.1), (None, 31.0), (False, 0.5), (True, 0.1), (False, 0.6)], True),
    ],
)  # fmt: skip
def test_a_doubt_counts_what_was_wrong_until_something_was_right_or_nothing_was_seen_for_long(looks, stands):
    own = Doubt(1.0)
    for wrong, seconds in looks:
        own.step(wrong, seconds)
    assert own.stands is stands
