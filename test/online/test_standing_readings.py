"""A controller that hangs and goes on sending what it read last, with new stamps."""

import math
from itertools import count

import pytest
from sea import PERIOD, SEED, Fed, check_invariants, swell

from winch_friction.online.doubt import PATIENCE, SAID, SPEED_SAID, StandingReadings
from winch_friction.online.estimator import EstimatorService
from winch_friction.physics.signals import Sample

MOVING = 5.0  # rad/s


def believed_no_longer(fed, hang, words):
    """What hangs ends the torque, is said in these words, and is forgiven once it sends again."""
    said = fed.run(PATIENCE + 0.5 + 0.5, hang)
    assert said[0].friction_torque != 0.0
    assert said[-1].friction_torque == 0.0
    assert not said[-1].valid
    assert words in fed.service.status(fed.now)["contradictions"]
    check_invariants(fed)
    assert fed.run(4.0)[-1].valid, "it sends again"


def test_a_sender_that_hangs_in_mid_wave_is_believed_no_longer():
    """Its last torque had been published, `valid`, for good."""
    fed = Fed()
    fed.run(7.0)
    last = swell(fed.now)

    def hang(sample):
        sample.motor_speed, sample.speed_reference, sample.groups = last.motor_speed, last.speed_reference, last.groups

    assert abs(last.motor_speed) > 50.0
    believed_no_longer(fed, hang, SAID)


def said_of(change, seconds=5.0, rate=50.0):
    own, said = StandingReadings(MOVING), ""
    for k in range(round(seconds * rate)):
        sample = Sample(k / rate, 60.0, 60.0, motor_torque=20.0, hook_load=math.nan)
        change(sample, k)
        said = own.contradiction(sample, 1.0 / rate)
    return said


def test_readings_that_stand_still_while_it_turns_are_a_sender_that_hangs():
    assert said_of(lambda sample, k: None) == SAID
    assert not said_of(lambda sample, k: None, seconds=0.9 * PATIENCE)


@pytest.mark.parametrize("channel", ["motor_speed", "motor_torque", "hook_load", "shaft_angle", "heave_velocity"])
def test_one_that_lives_is_enough(channel):
    """Also one that comes but twice a second: of a hook load, or of a slow bus."""
    assert not said_of(lambda sample, k: setattr(sample, channel, 50.0 + 0.1 * (k // 25)))


def test_at_rest_and_without_a_torque_nothing_need_move():
    def at_rest(sample, k):
        sample.motor_speed = sample.speed_reference = 0.0

    assert not said_of(at_rest)
    assert not said_of(lambda sample, k: setattr(sample, "motor_torque", math.nan))


def test_a_command_that_stands_beside_standing_readings_is_one_too():
    """Near a reversal the speed that was read last is small."""
    assert said_of(lambda sample, k: setattr(sample, "motor_speed", 0.5 * MOVING)) == SAID


def test_nothing_is_learned_from_a_sender_that_hangs():
    fed, numbers = Fed(), count()
    service = EstimatorService(fed.service.law.crane, SEED, fed.service.inputs.topics)

    def learn(seconds, change=lambda sample: None):
        for _ in range(round(seconds / PERIOD)):
            now = next(numbers) * PERIOD
            sample = swell(now)
            change(sample)
            service.take_row(sample)

    learn(8.0)
    last = swell(8.0 - PERIOD)

    def hang(sample):
        sample.motor_speed, sample.speed_reference = last.motor_speed, last.speed_reference

    learn(2.0 * PATIENCE, hang)
    assert service.contradiction == SAID
    learned = service.law.counts["learned_from"]
    learn(5.0, hang)
    assert service.law.counts["learned_from"] == learned
    learn(2.0)
    assert not service.contradiction


# -- the speed alone: command and speed hang, the pressures live
def hang_speeds(last):
    def hang(sample):
        sample.motor_speed, sample.speed_reference = last.motor_speed, last.speed_reference
        for group in sample.groups.values():
            group.pressure_a += 3e4 * math.sin(1e3 * sample.time)

    return hang


def test_speeds_that_hang_in_mid_wave_while_pressures_live_are_believed_no_longer():
    """The torque of one direction had been published, `valid`, through every wave that followed."""
    fed = Fed()
    fed.run(7.0)
    hang = hang_speeds(swell(fed.now))
    believed_no_longer(fed, hang, SPEED_SAID)


def test_nothing_is_learned_from_a_speed_that_hangs():
    fed = Fed()
    service = EstimatorService(fed.service.law.crane, SEED, fed.service.inputs.topics)
    hang = hang_speeds(swell(8.0))
    for k in range(600):
        sample = swell(k * PERIOD)
        if k >= 400:
            hang(sample)
        service.take_row(sample)
    assert service.contradiction == SPEED_SAID


def speed_said(speed, seconds=5.0, rate=50.0):
    """What is said of a speed in rad/s over time in s, after a wave of its own resolution."""
    own, said = StandingReadings(MOVING), ""
    for k in range(round((10.0 + seconds) * rate)):
        time = k / rate
        now = speed(60.0 * math.sin(0.6 * time) if time < 10.0 else 60.0)
        said = own.contradiction(Sample(time, now, 60.0, motor_torque=20.0 + math.sin(k)), 1.0 / rate)
    return said


@pytest.mark.parametrize("digit", [0.307, 0.105])
def test_a_speed_of_coarse_digits_may_stand_while_it_turns(digit):
    """An encoder's count, a PLC's whole revolution: a winch at one speed shows the same for seconds."""
    assert not speed_said(lambda speed: round(speed / digit) * digit)
    assert speed_said(lambda speed: speed) == SPEED_SAID
    assert not speed_said(lambda speed: speed, seconds=0.8 * PATIENCE)


def test_a_speed_that_creeps_or_stands_is_none_that_hangs():
    assert not speed_said(lambda speed: speed if speed != 60.0 else 0.9 * MOVING)
    assert not speed_said(lambda speed: speed if speed != 60.0 else 0.0)
