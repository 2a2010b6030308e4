"""A torque that pushes against the motion, or against what is asked for, is let go at the slew limit as soon as what
carried it is gone: whatever goes wrong next."""

import dataclasses
import math
from collections.abc import Callable

import pytest
from sea import CRANE, PERIOD, TOPICS, Fed, check_invariants, swell

from winch_friction.compensation import CompensatorConfig
from winch_friction.compensation.safe_output import SafeOutput
from winch_friction.online.agreement import Agreement
from winch_friction.physics.channels import RPM
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.operating_point import ChannelRanges

SPEED, REFERENCE = "winch/joint_states", "winch/reference"
SWASH = "winch/active/displacement"
REVERSAL = 1005.0  # s; the swell's speed passes zero there
LONGEST = 0.35  # s against the motion that docs/safety.md allows beside the look-ahead


def sailing(until: float) -> Fed:
    """A service in full swing at `until`."""
    fed = Fed()
    fed.run(until - fed.now)
    assert abs(fed.torque) > 100.0
    return fed


def wrong_sign(sample: Sample) -> None:
    """The command's sign is exchanged."""
    sample.speed_reference = -sample.speed_reference


def against(fed: Fed, since: float) -> float:
    """The longest time, s, that what was published after `since` pushed against the swell's motion."""
    longest, began = 0.0, math.nan
    for now, said in fed.published:
        if now < since:
            continue
        speed = swell(now).motor_speed
        if said.friction_torque * speed < 0.0 and abs(said.friction_torque) > 5.0 and abs(speed) > 5.0:
            began = now if math.isnan(began) else began
            longest = max(longest, now - began)
        else:
            began = math.nan
    return longest


def left_over_at_a_reversal() -> Fed:
    """The command was lost before the reversal and is back after it: what is published still has the old sign."""
    fed = sailing(REVERSAL - 0.12)
    fed.run(0.14, skip=(REFERENCE,))
    fed.run(0.02)
    asked = fed.service.law._target.torque
    assert fed.torque * asked < 0.0
    assert abs(fed.torque) > 50.0
    return fed


def silent(fed: Fed) -> None:
    fed.wait(1.0)


def malformed(fed: Fed) -> None:
    fed.run(1.0, lambda sample: setattr(sample, "motor_speed", math.nan))


def reset_then_silent(fed: Fed) -> None:
    fed.service.reset()
    fed.wait(1.0)


def without_command(fed: Fed) -> None:
    fed.run(1.0, skip=(REFERENCE,))


def without_pressure(fed: Fed) -> None:
    fed.run(1.0, skip=("winch/active/pressure_a",))


def disabled(fed: Fed) -> None:
    fed.service.set_enabled(False)
    fed.run(1.0)


def ended(fed: Fed) -> None:
    began = fed.now
    for after, said in fed.service.ending(began):
        fed.now = began + after
        fed.hear(said)


ENDS = (silent, malformed, reset_then_silent, without_command, without_pressure, disabled, ended)


@pytest.mark.parametrize("then", ENDS)
def test_what_is_left_of_before_is_let_go_at_once_when_nothing_carries_it_any_more(
    then: Callable[[Fed], None],
) -> None:
    """Predicted: the motion has hardly begun to turn when its speed falls silent."""
    fed = left_over_at_a_reversal()
    left, sign, began = abs(fed.torque), math.copysign(1.0, fed.torque), fed.now
    then(fed)
    slew = fed.service.law.output.limits.slew
    late = [now - began for now, said in fed.published if now > began and said.friction_torque * sign > 0.5]
    assert max(late, default=0.0) <= fed.config.max_age + left / slew + 2.0 * PERIOD
    check_invariants(fed)


@pytest.mark.parametrize("then", ENDS)
def test_a_wrong_command_in_its_first_moment_leaves_nothing_that_fades_slowly(then: Callable[[Fed], None]) -> None:
    """One sample is enough to turn the torque; then the evidence is gone."""
    fed = sailing(REVERSAL + 1.0)
    began = fed.now
    fed.run(5 * PERIOD, wrong_sign)
    assert fed.torque * swell(fed.now).motor_speed < 0.0
    then(fed)
    assert against(fed, began) <= LONGEST
    check_invariants(fed)


def test_when_command_and_speed_agree_again_what_is_left_of_the_wrong_one_goes_at_once() -> None:
    """The wrong command, a silence, and the right one again: each took its own time before."""
    fed = sailing(REVERSAL + 0.8)
    began = fed.now
    fed.run(2 * PERIOD, wrong_sign)
    fed.wait(0.16)
    fed.run(0.6)
    assert against(fed, began) <= LONGEST - 0.05
    check_invariants(fed)


def test_a_reset_does_not_give_a_torque_against_the_motion_another_life() -> None:
    fed = sailing(REVERSAL + 0.8)
    began = fed.now
    fed.run(4 * PERIOD, wrong_sign)
    fed.service.reset()
    fed.run(0.6)
    assert against(fed, began) <= LONGEST - 0.05
    check_invariants(fed)


@pytest.mark.parametrize("every", [1, 2, 5])
def test_whoever_resets_at_every_sample_does_not_hold_the_torque(every: int) -> None:
    """Two senders of /clock that fight are a reset at every message: what was published stood still meanwhile."""
    fed = sailing(REVERSAL - 0.5)
    began = fed.now
    for k in range(100):
        if k % every == 0:
            fed.service.reset()
        fed.run(PERIOD)
    assert against(fed, began) <= LONGEST
    check_invariants(fed)


def test_stamps_that_fell_behind_give_no_leave_to_step() -> None:
    """By the clock 0.12 s had passed, by the stamps 0.02 s: the first message without the command stepped to zero."""
    fed = sailing(REVERSAL - 1.0)
    fed.service.configure(CompensatorConfig(ramp_time=0.02))
    for _ in range(20):
        fed.shift -= 0.5 * PERIOD
        fed.run(PERIOD)
    fed.now += 0.1
    fed.shift -= 0.1
    fed.service.set_enabled(False)
    fed.run(0.2)
    assert fed.torque == 0.0
    check_invariants(fed)


def test_a_beginning_after_a_pause_is_no_step() -> None:
    fed = sailing(REVERSAL + 1.0)
    list(fed.service.ending(fed.now))
    fed.service.reset()
    fed.now += 10.0
    assert abs(fed.run(PERIOD)[-1].friction_torque) <= 0.1 * 400.0  # 0.05 s of the ramp's 0.5 s


def test_a_fade_does_not_wait_for_the_age_limit_at_every_gap() -> None:
    """An input is lost and the speed comes in pieces: the fade is over within the ramp's time all the same."""
    fed = sailing(REVERSAL + 0.4)
    began = fed.now
    while fed.now < began + 1.0:
        fed.run(PERIOD, skip=(REFERENCE,))
        fed.wait(6 * PERIOD)
    over = [now for now, said in fed.published if now > began and said.friction_torque == 0.0]
    assert over[0] - began <= fed.config.max_age + fed.config.ramp_time + 2.0 * PERIOD
    check_invariants(fed)


def test_what_comes_back_unusable_after_a_silence_never_rises() -> None:
    """What was carried over from before must not come back with the first sample that cannot be used."""
    fed = sailing(REVERSAL + 0.4)
    fed.run(0.16, skip=(REFERENCE,))
    fed.run(3 * PERIOD)
    said = fed.wait(0.3)
    said += fed.run(0.5, skip=(REFERENCE,))
    sizes = [abs(each.friction_torque) for each in said]
    assert sizes == sorted(sizes, reverse=True)
    check_invariants(fed)


def test_a_silent_speed_leaves_the_torque_no_longer_than_it_may_push_against_the_motion() -> None:
    """With a ramp of 5 s: who does not know the motion does not fade slowly."""
    fed = Fed(config=CompensatorConfig(ramp_time=5.0))
    fed.run(7.0)
    assert abs(fed.torque) > 100.0
    began = fed.now
    fed.wait(1.0)
    over = [now for now, said in fed.published if now > began and said.friction_torque == 0.0]
    assert over[0] - began <= fed.config.max_age + LONGEST + PERIOD
    check_invariants(fed)


def test_an_input_that_came_long_ago_is_lost_however_young_its_stamp_looks() -> None:
    """The speed comes late, the displacement no more: by the stamps it is young, by the clock it is not."""
    fed = sailing(REVERSAL + 1.0)
    late = [swell(fed.now + PERIOD * (k + 1)) for k in range(10)]
    fed.send(late[0])
    fed.now += 0.3
    assert fed.service.tick(fed.now) is not None
    for sample in late[4:7]:
        fed.now += PERIOD
        fed.send(sample, skip=(SWASH,))
        assert "active.displacement" in fed.service.law.status()["missing"]


def test_a_held_value_gets_no_younger_by_messages_that_are_too_old_to_replace_it() -> None:
    """One command stamped 0.3 s ahead, then live ones under a stamp that stands still: once the speed reaches
    the first, it looked young, because the others had kept on arriving."""
    fed = sailing(REVERSAL + 1.0)
    began = fed.now
    first = True
    while fed.now < began + 1.0:
        fed.now += PERIOD
        fed.send(swell(fed.now), skip=(REFERENCE,))
        command = swell(fed.now)
        command.time = began + (0.3 if first else 0.02)
        first = False
        message = dict(fed.messages(command))[REFERENCE]
        fed.hear(fed.service.take(TOPICS.inputs[REFERENCE], message, fed.now, fed.now))
        fed.hear(fed.service.tick(fed.now))
        if fed.now > began + fed.config.max_age + 3.0 * PERIOD:
            assert "speed_reference" in fed.service.law.status()["missing"]
    over = [now for now, said in fed.published if now > began and said.friction_torque == 0.0]
    assert over[0] - began <= fed.config.max_age + fed.config.ramp_time + 3.0 * PERIOD
    check_invariants(fed)


def test_stamps_that_advance_slowly_do_not_stretch_the_patience():
    """By the clock the command turned against the speed long ago; by the stamps it has only begun."""
    agreement = Agreement(CRANE, ChannelRanges(CRANE))
    for k in range(15):
        sample = Sample(time=0.004 * k, motor_speed=-50.0, speed_reference=50.0)
        by_clock = agreement.contradictions(sample, 0.02 * k)
    assert "speed_reference turns against motor_speed" in by_clock


@pytest.mark.parametrize("channel", ["motor_speed", "speed_reference"])
def test_a_sender_with_two_voices_is_not_believed(channel):
    """Two messages of one instant with opposite values, now one first and now the other: a coin decided the sign."""
    fed = sailing(REVERSAL - 0.8)
    began = fed.now

    def flipped(sample: Sample) -> None:
        setattr(sample, channel, -getattr(sample, channel))

    for k in range(75):
        fed.now += PERIOD
        first, second = swell(fed.now), swell(fed.now)
        flipped(first if k % 3 == 0 else second)
        fed.send(first)
        fed.send(second)
        fed.hear(fed.service.tick(fed.now))
    assert fed.torque == 0.0
    assert against(fed, began) <= LONGEST
    topic = SPEED if channel == "motor_speed" else REFERENCE
    assert fed.service.inputs.arrivals[topic].reason == "two values under one stamp"
    fed.run(1.5)
    assert abs(fed.torque) > 50.0
    check_invariants(fed)


def test_a_message_that_comes_twice_is_no_second_voice():
    fed, alone = sailing(REVERSAL + 0.5), sailing(REVERSAL + 0.5)
    for _ in range(50):
        fed.now += PERIOD
        copy = swell(fed.now)
        copy.motor_speed += 0.5  # rad/s: what a coarse clock gives one stamp
        fed.send(swell(fed.now))
        fed.send(copy)
        fed.hear(fed.service.tick(fed.now))
    alone.run(50 * PERIOD)
    assert fed.torque == pytest.approx(alone.torque)


@pytest.mark.parametrize("each", [2, 3, 5, 7])
def test_a_second_sender_whose_command_comes_in_batches_does_not_push_for_long(each: int) -> None:
    """One sample of every batch had the right command: each time the doubt began anew, and what was published had not
    even passed zero. A torque against the motion stood for 0.35 s and more."""
    fed = sailing(REVERSAL + 0.5)
    began, waiting = fed.now, []
    for k in range(60):
        fed.now += PERIOD
        sample = swell(fed.now)
        other = swell(fed.now)
        other.speed_reference = -other.speed_reference
        own = dict(fed.messages(sample))
        late = dict(fed.messages(dataclasses.replace(other, time=other.time + 0.003)))
        waiting += [own.pop(REFERENCE), late[REFERENCE]]
        if k % each == 0:
            for message in waiting:
                fed.hear(fed.service.take(TOPICS.inputs[REFERENCE], message, fed.now, fed.now))
            waiting.clear()
        for topic, message in own.items():
            fed.hear(fed.service.take(TOPICS.inputs[topic], message, fed.now, fed.now))
        fed.hear(fed.service.tick(fed.now))
    assert against(fed, began) <= 0.3
    check_invariants(fed)


def test_a_command_that_is_right_now_and_then_is_a_contradiction_all_the_same() -> None:
    """Four samples wrong, one right: wrong for more than a lag, whoever looks at it every 0.1 s."""
    watch = Agreement(CRANE, ChannelRanges(CRANE))
    said = []
    for k in range(12):
        sample = swell(REVERSAL + 0.5 + k * PERIOD)
        if k % 5:
            sample.speed_reference = -sample.speed_reference
        said.append(watch.contradictions(sample))
    assert any("turns against" in name for names in said for name in names)


@pytest.mark.parametrize("lead", [0.0, 0.1])
def test_a_target_that_is_wrong_for_a_while_is_let_go_whatever_nobody_doubts(lead: float) -> None:
    """The last line: the torque itself, against the measured motion, whatever asks for it."""
    output = SafeOutput(2000.0, 1.5e4, 0.5, 0.1, lead)
    pushed = []
    for k in range(100):
        now = k * PERIOD
        output.arrive(now, now)
        wrong = k > 50 and k % 25 != 0
        pushed.append(output.follow(-300.0 if wrong else 300.0, 500.0, True, True, motion=80.0) < -5.0)
    longest = max(len(run) for run in "".join("x" if each else " " for each in pushed).split())
    assert 0.1 < longest * PERIOD <= lead + 0.3
    assert any(pushed[-20:])  # a target that is right begins anew


def test_a_command_in_another_unit_asks_for_no_friction_of_a_speed_that_nothing_turns_at() -> None:
    """In rpm it passes as rad/s around each reversal, and is doubted half a second later: meanwhile 2000 N m, all that
    is ever granted, were published of a winch whose friction is 375."""
    fed = Fed()
    fed.run(REVERSAL + 0.2 - fed.now)
    usual = max(abs(said.friction_torque) for _, said in fed.published)

    def in_rpm(sample: Sample) -> None:
        sample.speed_reference /= RPM

    said = fed.run(1.8, in_rpm)
    assert max(abs(each.friction_torque) for each in said) < 2.0 * usual
    check_invariants(fed)


def test_nobody_knows_whether_command_or_speed_is_wrong() -> None:
    """Friction by a measured speed that stands still while the command turns: what it asked for is let go at once, not
    over the ramp time."""
    config = CompensatorConfig(ramp_time=1.0, velocity_source="measured")
    fed = Fed(config)
    fed.run(REVERSAL - 0.3 - fed.now)
    speed, began = swell(fed.now).motor_speed, fed.now

    def stuck(sample: Sample) -> None:
        sample.motor_speed = speed

    fed.run(1.0, stuck)
    assert against(fed, began) <= LONGEST
    check_invariants(fed)
