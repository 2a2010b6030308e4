"""The wire that is paid out tells whether command and speed together have a wrong unit or turn the wrong way."""

import math
from dataclasses import replace

import pytest
from sea import CRANE, SEED, TOPICS

from winch_friction.online.agreement import Agreement
from winch_friction.online.doubt import WireAgainstSpeed
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.operating_point import ChannelRanges

LEVER = CRANE.drum.radius(1.0) / CRANE.gear_ratio  # m of wire per radian of a motor
RPM = 60.0 / (2.0 * math.pi)
PERIOD = 0.02  # s


def sea(
    share=1.0, speed=60.0, period=7.0, seconds=40.0, step=0.001, hold=1, late=0.0, drift=0.0, still=False,
    zeroed=math.inf, layer=1.0, lies=None,
):  # fmt: skip
    """Samples whose speed is `share` of the true one, rad/s; a wire counted in steps of `step` m, every `hold` samples,
    `late` s late; `drift` m/s of it are nobody's; counted from 0 on after `zeroed` s. The layer is said to be `layer`,
    and is `lies`."""
    lever = LEVER if lies is None else CRANE.drum.radius(lies) / CRANE.gear_ratio
    omega, shown = 2.0 * math.pi / period, math.nan
    for k in range(int(seconds / PERIOD)):
        time = k * PERIOD
        if k % hold == 0:
            turned = speed / omega * (1.0 - math.cos(omega * (time - late)))
            wire = 300.0 - lever * turned + drift * time
            wire -= 300.0 if time > zeroed else 0.0
            shown = 300.0 if still else step * round(wire / step)
        now = share * speed * math.sin(omega * time)
        yield Sample(time, now, speed_reference=now, wire_out=shown, wire_layer=layer)


def said(samples):
    """When it was said first, s, and whether it is at the end."""
    own, found = WireAgainstSpeed(CRANE, ChannelRanges(CRANE)), []
    for k, sample in enumerate(samples):
        if own.contradiction(sample, PERIOD if k else 0.0):
            found.append(sample.time)
    return (found[0] if found else math.inf), bool(found and found[-1] == sample.time)


@pytest.mark.parametrize(
    "way",
    [
        {},
        {"hold": 25},
        {"step": 0.1, "speed": 200.0},
        {"late": 0.5},
        {"speed": 200.0},
        {"period": 15.0},
        {"zeroed": 6.2},
    ],
)
@pytest.mark.parametrize(
    ("share", "wrong"), [(1.0, False), (1.2, False), (0.85, False), (RPM, True), (-1.0, True), (1 / RPM, True)]
)
def test_a_wrong_unit_and_a_wrong_way_are_seen_however_the_wire_is_counted(share, wrong, way):
    first, last = said(sea(share, **way))
    assert last is wrong
    assert (first < 30.0) is wrong


@pytest.mark.parametrize("way", [{}, {"hold": 25}, {"step": 0.1, "speed": 200.0}, {"period": 15.0}, {"zeroed": 6.2}])
@pytest.mark.parametrize("share", [2.0, 0.5, 1.6])
def test_a_wire_that_follows_closely_tells_a_smaller_factor(share, way):
    """Twice the speed, of motor and command, gave 622 N m for 381, `valid`, for good."""
    first, last = said(sea(share, **way))
    assert first < 30.0
    assert last


def test_a_wire_that_follows_late_tells_no_small_factor():
    """What is late may be smaller as well: a filter that is half a second slow."""
    assert said(sea(1.6, late=0.5))[0] == math.inf


LAYERS = len(CRANE.drum.layer_radii)


@pytest.mark.parametrize("lies", [1.0, float(LAYERS)])
def test_a_layer_that_nobody_says_is_no_wrong_speed(lies):
    """The outer one is taken, and on the innermost the speed seems 1.42 times as large as it is."""
    assert said(sea(layer=math.nan, lies=lies))[0] == math.inf
    assert said(sea(2.0, layer=math.nan, lies=lies))[1]


def test_a_layer_said_one_too_far_is_no_wrong_speed():
    assert said(sea(layer=2.0))[0] == math.inf


def test_a_smaller_factor_is_told_with_what_else_may_be_why():
    own = Agreement(CRANE, ChannelRanges(CRANE))
    found = [own.contradictions(sample) for sample in sea(2.0)]
    assert found[-1] == ("motor_speed contradicts wire_out: it is 2 times as large, or the hook hangs in other falls",)


@pytest.mark.parametrize("way", [
    {"speed": 3.0, "share": -1.0},  # a low sea moves the wire less than a metre counts
    {"still": True}, {"late": 1.75, "share": -1.0}, {"drift": 1.0},
])  # fmt: skip
def test_where_the_wire_does_not_follow_nothing_can_be_told(way):
    """A counter that stands, one a quarter of a wave late or one that runs away is no speed of a wrong unit."""
    assert said(sea(**way))[0] == math.inf


def test_command_and_speed_that_turn_together_the_wrong_way_contradict_the_wire():
    """Both within the envelope, both of one program: the friction of the wrong direction was fed forward for good."""
    own = Agreement(CRANE, ChannelRanges(CRANE))
    found = [own.contradictions(sample) for sample in sea(-1.0)]
    assert found[100] == ()
    assert found[-1] == ("motor_speed contradicts wire_out: it turns the wrong way",)


def test_a_speed_in_revolutions_a_minute_is_told_by_its_factor():
    own = Agreement(CRANE, ChannelRanges(CRANE))
    found = [own.contradictions(sample) for sample in sea(RPM)]
    assert found[-1] == ("motor_speed contradicts wire_out: it is 9.6 times as large",)  # 60 / 2 pi = 9.55


def test_over_a_gap_nobody_knows_how_far_it_turned():
    """As if the speed after two minutes without a sample had lasted all the time."""
    before = list(sea(seconds=20.0))
    after = [replace(s, time=s.time + 130.0, wire_out=s.wire_out - 1.0) for s in sea(seconds=30.0) if s.time > 8.0]
    assert said([*before, *after]) == (math.inf, False)


def test_a_counter_that_is_set_to_zero_is_no_speed_of_another_unit():
    samples = list(sea(speed=0.0, seconds=20.0)) + [
        replace(s, time=s.time + 20.0, wire_out=s.wire_out - 290.0) for s in sea(seconds=20.0)
    ]
    assert said(samples) == (math.inf, False)


def test_the_estimator_learns_nothing_meanwhile():
    service = EstimatorService(CRANE, SEED, TOPICS)
    for sample in sea(-1.0, seconds=20.0):
        service.take_row(sample)
    assert service.contradiction == "motor_speed contradicts wire_out: it turns the wrong way"
