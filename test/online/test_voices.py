"""Two messages of one instant: whether they say different things, and for how long neither is believed."""

import pytest
from sea import CRANE, PERIOD, START, TOPICS, Fed, check_invariants, swell

from winch_friction.online.agreement import DOUBTED, TOGETHER, Motions, Voices
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


def test_a_copy_is_held_against_the_message_before_it():
    voices = Voices(ChannelRanges(CRANE, TOPICS.groups))
    told = [voices.contradict(SPEED, message(100.0, 10.0 + 0.02 * k), 100.0 + 0.02 * k) for k in range(3)]
    assert [*told, voices.contradict(SPEED, message(-100.0, 10.04), 100.041)] == [False, False, False, True]


# -- a recording or a simulator that sends beside the machine
OFFSETS = [0.0, 0.3, -0.3, -3600.0, 3600.0]  # s between the two clocks


def beside(fed: Fed, seconds: float, offset: float, speed: float = 40.0, live: bool = True) -> None:
    """The machine, and half a period after it another's opposite motion, under stamps that are `offset` s off."""
    for _ in range(round(seconds / PERIOD)):
        fed.now += 0.5 * PERIOD
        if live:
            fed.send(swell(fed.now, speed=speed))
        fed.now += 0.5 * PERIOD
        other = swell(fed.now + 3.0, speed=speed)
        other.time = fed.now + offset
        fed.send(other)
        fed.hear(fed.service.tick(fed.now))


@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("speed", [100.0, 40.0])
def test_a_recording_beside_the_machine_is_not_obeyed_and_holds_nothing(offset, speed):
    """Ahead by 0.3 s it took over, of the same clock it changed the torque's sign fifty times a second: `active`."""
    fed = Fed()
    fed.run(2.0, lambda sample: setattr(sample, "motor_speed", sample.motor_speed * speed / 100.0))
    beside(fed, 1.0, offset, speed)
    before = len(fed.published)
    beside(fed, 5.0, offset, speed)
    assert {said.friction_torque for _, said in fed.published[before:]} <= {0.0}
    assert "two motions in turn" in fed.service.inputs.arrivals[SPEED.topic].reason
    assert fed.service.status(fed.now)["state"] == "stale"
    check_invariants(fed)


@pytest.mark.parametrize("offset", OFFSETS)
def test_the_machine_is_not_obeyed_less_for_a_recording_that_was_there_first(offset):
    """Whoever came first was believed for as long as the recording was played: against the motion, and `valid`."""
    fed = Fed()
    beside(fed, 3.0, offset, live=False)
    assert abs(fed.torque) > 50.0
    beside(fed, 1.0, offset)
    assert fed.torque == 0.0
    back = fed.run(5.0)
    assert back[-1].state == "active"
    assert back[-1].friction_torque * swell(fed.now).motor_speed > 0.0
    check_invariants(fed)


def test_a_machine_that_pauses_does_not_hand_over_to_a_recording():
    fed = Fed()
    fed.run(2.0)
    beside(fed, 1.0, -3600.0)
    before = len(fed.published)
    beside(fed, 0.4, -3600.0, live=False)
    beside(fed, 3.0, -3600.0)
    assert {said.friction_torque for _, said in fed.published[before:]} <= {0.0}


def test_a_coarse_encoder_and_a_sender_that_sends_the_same_twice_are_no_two_motions():
    fed, states, steps = Fed(), set(), iter(range(10**6))

    def coarse(sample) -> None:
        sample.motor_speed = 20.0 * (round(sample.motor_speed / 20.0) + next(steps) % 2)

    states |= {said.state for said in fed.run(8.0, coarse)[50:]}
    for _ in range(200):  # a second gateway whose clock is off
        fed.now += PERIOD
        fed.send(swell(fed.now))
        copy = swell(fed.now)
        copy.time -= 7200.0
        fed.send(copy)
    assert states == {"active"}
    assert fed.published[-1][1].state == "active"


def test_a_recording_without_commands_is_seen_by_its_stamps():
    fed = Fed()
    fed.run(2.0)
    for _ in range(100):
        fed.now += 0.5 * PERIOD
        fed.send(swell(fed.now), skip=("winch/reference",))
        fed.now += 0.5 * PERIOD
        other = swell(fed.now + 3.0)
        other.time = fed.now - 3600.0
        fed.send(other, skip=("winch/reference",))
    assert "two motions" in fed.service.status(fed.now)["missing"]


def test_a_network_that_exchanges_messages_is_no_second_machine():
    """Every second one six periods late at the steepest of a wave: 16 rad/s, and the same of the command."""
    motions = Motions(ChannelRanges(CRANE, TOPICS.groups))
    for k in range(200):
        now = START + k * PERIOD
        stamp = now - (0.12 if k % 2 else 0.0)
        for column in ("motor_speed", "speed_reference"):
            motions.hear(column, stamp, 130.0 * (stamp - START - 2.0), now)
        motions.note(now)
        assert not motions.two(now)


def test_where_two_motions_cross_neither_is_believed():
    fed, valid = Fed(), []
    fed.run(2.0)
    beside(fed, 1.0, -3600.0)
    before = len(fed.published)
    for _ in range(3):
        beside(fed, 1.0, -3600.0)
        beside(fed, 1.2, -3600.0, speed=0.0)
        valid += [said.valid for _, said in fed.published[before:]]
    assert not any(valid)
