"""Two messages of one instant: whether they say different things, and for how long neither is believed."""

import pytest
from sea import CRANE, TOPICS, swell

from winch_friction.online.agreement import DOUBTED, TOGETHER, Voices
from winch_friction.physics.winch.operating_point import ChannelRanges
from winch_friction.records.bag_write import MESSAGES

SPEED = TOPICS.inputs["winch/joint_states"]


def message(speed: float, time: float = 10.0):
    sample = swell(time)
    sample.motor_speed = speed
    return dict(TOPICS.encode(sample, MESSAGES))[SPEED.topic]


def doubted(first: float, second: float, apart: float = 0.001) -> bool:
    voices = Voices(ChannelRanges(CRANE, TOPICS.groups))
    assert not voices.contradict(SPEED, message(first), 100.0)
    return voices.contradict(SPEED, message(second), 100.0 + apart)


@pytest.mark.parametrize(
    ("first", "second", "said"),
    [(100.0, -100.0, True), (100.0, 70.0, True), (100.0, 90.0, False), (0.5, -0.5, False), (0.0, 2.0, False)],
)
def test_copies_of_one_instant_differ_by_a_share_or_near_zero_by_a_share_of_the_reach(first, second, said):
    assert doubted(first, second) is said


def test_a_stamp_that_stands_still_for_a_period_is_another_matter():
    assert not doubted(100.0, -100.0, apart=2.0 * TOGETHER)


def test_neither_is_believed_again_before_the_torque_has_gone():
    voices = Voices(ChannelRanges(CRANE, TOPICS.groups))
    for speed in (100.0, -100.0):
        voices.contradict(SPEED, message(speed), 100.0)
    assert voices.contradict(SPEED, message(50.0, 10.1), 100.0 + 0.9 * DOUBTED)
    assert not voices.contradict(SPEED, message(50.0, 10.2), 100.0 + 1.1 * DOUBTED)
    voices.forget()
    assert not voices.contradict(SPEED, message(50.0, 10.3), 100.0)
