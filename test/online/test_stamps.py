"""Which stamps are believed: one case for every way in which a sender's clock goes wrong."""

import random

import pytest
from sea import TOPICS, Fed, swell

from winch_friction.online.agreement import CONFIRMED_BY, Stamp, StampWatch

PERIOD = 0.02  # s


def watch_at_work(seconds=1.0, **options):
    """A watch that has seen good stamps; with the time of the last."""
    watch, steps = StampWatch(**options), round(seconds / PERIOD)
    for k in range(steps + 1):
        assert watch.judge(100.0 + k * PERIOD, k * PERIOD) is Stamp.GOOD
    return watch, 100.0 + steps * PERIOD, steps * PERIOD


def test_a_stamp_that_stands_is_refused_at_once_and_for_ever():
    watch, stamp, now = watch_at_work()
    assert all(watch.judge(stamp, now + k * PERIOD) is Stamp.REPEATED for k in range(1000))


def test_the_same_stamp_at_the_same_moment_is_refused():
    """A burst repeats the last message before any time has passed."""
    watch, stamp, now = watch_at_work()
    assert watch.judge(stamp, now) is Stamp.REPEATED


@pytest.mark.parametrize(("pace", "worth"), [(0.05, Stamp.REPEATED), (0.5, Stamp.GOOD), (1.0, Stamp.GOOD)])
def test_stamps_that_creep_are_as_good_as_standing(pace, worth):
    """Slower than a tenth of the clock is no clock; half as fast is a slow simulation."""
    watch, stamp, now = watch_at_work()
    assert watch.judge(stamp + pace * 0.2, now + 0.2) is worth


def test_a_simulated_clock_may_creep_but_not_stand():
    watch, stamp, now = watch_at_work(paced=False)
    assert watch.judge(stamp + 0.001, now + 0.2) is Stamp.GOOD
    assert watch.judge(stamp + 0.001, now + 0.4) is Stamp.REPEATED


def test_one_stamp_of_the_future_is_refused_and_locks_nothing_out():
    watch, stamp, now = watch_at_work()
    assert watch.judge(stamp + 3600.0, now + PERIOD) is Stamp.AHEAD
    assert watch.judge(stamp + 2 * PERIOD, now + 2 * PERIOD) is Stamp.GOOD


def test_the_window_is_half_a_second():
    for ahead, worth in ((0.4, Stamp.GOOD), (0.6, Stamp.AHEAD)):
        watch, stamp, now = watch_at_work()
        assert watch.judge(stamp + PERIOD + ahead, now + PERIOD) is worth


@pytest.mark.parametrize("shift", [-5.0, 3600.0])
def test_a_clock_that_was_set_is_believed_once_messages_agree(shift):
    watch, stamp, now = watch_at_work()
    worths = [watch.judge(stamp + shift + k * PERIOD, now + k * PERIOD) for k in range(1, CONFIRMED_BY + 1)]
    refused = Stamp.AHEAD if shift > 0 else Stamp.BACK
    assert worths == [refused] * (CONFIRMED_BY - 1) + [Stamp.JUMP]
    assert watch.judge(stamp + shift + 6 * PERIOD, now + 6 * PERIOD) is Stamp.GOOD


@pytest.mark.parametrize("rate", [20.0, 50.0, 100.0, 200.0])
@pytest.mark.parametrize("shift", [-3600.0, 2.0])
def test_which_message_sets_the_clock_does_not_hang_on_how_late_it_came(rate, shift):
    """At 50 Hz the fifth or the sixth, as they came: a replay faded in a period apart from the node, by 2 % for 1 s."""
    rng, counted = random.Random(int(rate)), set()
    for _ in range(200):
        watch, stamp, now = watch_at_work()
        worths = [watch.judge(stamp + shift + k / rate, now + k / rate + rng.uniform(0.0, 0.006)) for k in range(1, 40)]
        counted.add(worths.index(Stamp.JUMP))
    assert len(counted) == 1


def test_late_by_less_than_a_jump_is_late():
    watch, stamp, now = watch_at_work()
    assert watch.judge(stamp - 0.5, now + PERIOD) is Stamp.LATE


def test_a_stray_stamp_before_the_first_speed_locks_no_input_out():
    """Nothing told yet that it was ahead: every good one after it was late, for ever."""
    fed = Fed()
    early = swell(fed.now)
    early.time += 3600.0
    topic = "winch/active/pressure_a"
    message = dict(fed.messages(early))[topic]
    fed.service.take(TOPICS.inputs[topic], message, fed.now, fed.now)
    assert fed.run(2.0)[-1].valid
