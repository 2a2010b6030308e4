"""A command that comes more seldom than the speed: PLCs send at 25 or 50 Hz, encoders at 200 or 1000."""

import math

import pytest
from sea import START, Fed, check_invariants, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.online.agreement import CHATTER_TIME, Agreement
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.operating_point import ChannelRanges, SpeedPredictor

SWELL, SPEED = 6.0, 100.0  # s, rad/s


def sail(fast, slow, lead, seconds=7.0):
    """A swell whose speed comes at `fast` Hz and its command at `slow`: (stamp, what was published) after 2 s."""
    fed = Fed(config=CompensatorConfig(ramp_time=0.5, lead=lead))
    for k in range(round(seconds * fast)):
        fed.now = START + k / fast
        fed.send(swell(fed.now, SWELL, SPEED), skip=("winch/reference",) if k % (fast // slow) else ())
    check_invariants(fed)
    return [said for now, said in fed.published if now > START + 2.0]


@pytest.mark.parametrize("lead", [0.0, pytest.param(0.1, marks=pytest.mark.long), 0.2])
@pytest.mark.parametrize(("fast", "slow"), [(1000, 50), (200, 25)])
def test_between_two_commands_the_torque_neither_jumps_nor_turns(fast, slow, lead):
    """With 0.2 s of look-ahead every ninth torque had the wrong sign, and one in twenty a third of its size."""
    said = sail(fast, slow, lead)
    alike = sail(slow, slow, lead)
    for each in said:
        motion = math.sin(2.0 * math.pi * (each.time + lead) / SWELL)
        if abs(motion) > 0.3:
            assert each.friction_torque * motion > 0.0, each
    largest, usual = (max(abs(each.friction_torque) for each in some) for some in (said, alike))
    assert largest == pytest.approx(usual, rel=0.02)
    steps = [abs(b.friction_torque - a.friction_torque) for a, b in zip(said, said[1:], strict=False)]
    as_often = [abs(b.friction_torque - a.friction_torque) for a, b in zip(alike, alike[1:], strict=False)]
    assert max(steps) <= 1.1 * max(as_often)


def test_a_speed_that_is_asked_again_looks_as_far_ahead_as_the_first_time():
    predictor = SpeedPredictor(0.1, 0.0, 0.1)
    for k in range(20):
        first = predictor.step(0.02 * k, 50.0 * math.sin(0.02 * k))
    assert predictor.step(0.02 * 19, 50.0 * math.sin(0.02 * 19)) == first


def test_a_command_of_two_is_noticed_though_it_is_held_between_its_messages():
    """Each sample that shows it again was no jump, so that none of the others counted."""
    fed = Fed()
    ranges = ChannelRanges(fed.service.law.crane)
    own = Agreement(fed.service.law.crane, ranges)
    period = CHATTER_TIME / 25.0
    found = [
        own.contradictions(Sample(k * period, math.nan, speed_reference=0.3 * ranges.speed * (k // 4 % 2)))
        for k in range(25)
    ]
    assert "speed_reference jumps to and fro: two publishers?" in found[-1]
