"""A radial piston motor on the drum that turns at 60 rpm: what is fast for it is slow for other motors."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest
from sea import CRANE, PERIOD, SEED, TOPICS, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.estimation import FrictionEstimator
from winch_friction.online.agreement import Agreement
from winch_friction.online.compensator import CompensatorService
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.signals import NAN
from winch_friction.physics.winch.operating_point import ChannelRanges

sys.path.insert(0, str(Path(__file__).parents[1] / "estimation"))
from driven_winch import rigid_samples

SLOW = replace(CRANE, rated_speed=60.0 * RPM)
SHARE = SLOW.rated_speed / CRANE.rated_speed


def published(speed: float, command: float, seconds: float) -> list[float]:
    """What the slow winch is told in N m while it turns at `speed` rad/s and is commanded another one."""
    service = CompensatorService(SLOW, SEED, TOPICS, CompensatorConfig(ramp_time=0.2))
    torques = []
    for k in range(round(seconds / PERIOD)):
        sample = replace(swell(k * PERIOD), motor_speed=speed, speed_reference=command)
        sample.hook_load += 0.1 * k  # readings live
        torques.append(service.take_row(sample).friction_torque)
    return torques


def test_friction_is_fed_forward_in_full_where_the_motor_turns_at_a_sixth_of_its_speed():
    """The sign was spread over 3 rad/s, half of what the motor turns at all."""
    sixth, full = (published(speed, speed, 2.0)[-1] for speed in (SLOW.rated_speed / 6.0, SLOW.rated_speed))
    assert sixth > 0.9 * full > 100.0


def test_a_command_that_turns_against_a_slow_motor_is_let_go_as_with_a_fast_one():
    """Below 5 rad/s nothing was taken for a motion: its torque stood against the motor for good."""
    torques = published(0.11 * SLOW.rated_speed, -0.11 * SLOW.rated_speed, 2.0)
    assert min(torques) < -20.0
    assert torques[-1] == 0.0
    against = sum(each < -5.0 for each in torques) * PERIOD
    assert against < 0.4


def test_a_command_against_a_slow_motor_is_doubted():
    each = Agreement(SLOW, ChannelRanges(SLOW, ("active", "passive")))
    sample = replace(swell(0.0), motor_speed=0.1 * SLOW.rated_speed, speed_reference=-0.1 * SLOW.rated_speed)
    found = [each.contradictions(replace(sample, time=PERIOD * k)) for k in range(20)]
    assert found[-1] == ("speed_reference turns against motor_speed",)


def test_the_friction_of_a_slow_motor_is_learned():
    """It was stick below 3 rad/s, and no excitation below 10: nothing was ever learned."""
    truth = SEED.with_values({"K4": 1.15 * SEED.value("K4")})
    estimator = FrictionEstimator(SLOW, SEED)
    for sample in rigid_samples(SLOW, truth, amplitude=0.8 * SLOW.rated_speed, duration=60.0):
        estimator.step(sample)
    assert estimator.counts["learned_from"] > 2000
    assert estimator.model().value("K4") == pytest.approx(truth.value("K4"), rel=0.06)


def test_what_is_set_by_hand_and_the_shipped_cranes_stay_as_they_are():
    assert SHARE < 0.02
    fast = CompensatorService(CRANE, SEED, TOPICS).law.config
    assert fast == CompensatorConfig()
    by_hand = CompensatorConfig(reversal_speed=0.5)
    service = CompensatorService(SLOW, SEED, TOPICS, by_hand)
    assert service.law.config == by_hand
    service.configure(CompensatorConfig())
    assert service.law.config.reversal_speed == pytest.approx(3.0 * SLOW.rated_speed / 100.0)


@pytest.mark.parametrize("litres", [8.0, 300.0])
def test_the_feedback_of_a_large_radial_motor_is_believed(litres: float) -> None:
    """Above 6.3 l/rev it was never held: the node waited for it for good. A crane file may say 300 l/rev."""
    full = litres * 1e3 * CM3_PER_REV
    service = CompensatorService(replace(SLOW, max_displacement=full), SEED, TOPICS, CompensatorConfig(ramp_time=0.2))
    for k in range(20):
        sample = replace(swell(k * PERIOD), motor_speed=3.0, speed_reference=3.0, hook_load=NAN)
        for group in sample.groups.values():
            group.displacement = 1.04 * full
        given = service.take_row(sample)
    assert service.status(20 * PERIOD)["missing"] == ""
    assert given.valid
