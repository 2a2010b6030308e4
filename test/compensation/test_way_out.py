"""What the output remembers on its way out: how far the stamps lag, what it came from, how long it was wrong."""

import math

import pytest

from winch_friction.compensation.safe_output import (
    FASTEST_STAMPS,
    LONGEST_AGAINST,
    LONGEST_LAG,
    SafeOutput,
)

PERIOD, HOLD, RAMP, CARRIED = 0.02, 0.1, 0.5, 300.0  # s, s, s, N m
START = 100.0  # s, the steady clock's


class Driven:
    """An output that carries 300 N m since a second, with its stamps and the clock."""

    def __init__(self, slew=1e5, torque=CARRIED, **more):
        self.output = SafeOutput(absolute=1000.0, slew=slew, ramp_time=RAMP, hold=HOLD, **more)
        self.stamp, self.now = 0.0, START
        self.go(1.0, torque)
        assert self.output.torque == pytest.approx(torque)

    def go(self, seconds, torque, usable=True, pace=1.0, motion=50.0, steady=1.0):
        """So long by the clock, the stamps at another pace; the torque after every sample."""
        told = []
        for _ in range(round(seconds / PERIOD)):
            self.stamp, self.now = self.stamp + PERIOD * pace, self.now + PERIOD * steady
            self.output.arrive(self.stamp, self.now)
            told.append(self.output.follow(torque, 1000.0, usable, True, motion=motion))
        return told


def over_after(told):
    return next(k * PERIOD for k, each in enumerate(told, 1) if each == 0.0)


@pytest.mark.parametrize("pace", [1.0, 0.3])
def test_a_fade_takes_its_time_by_the_clock_however_slowly_the_stamps_go(pace):
    """What the stamps are behind counts once: counted again at each sample it is no fade but a step."""
    assert over_after(Driven().go(2.0, CARRIED, usable=False, pace=pace)) == pytest.approx(
        RAMP, abs=HOLD + 2.0 * PERIOD
    )
    told = Driven().go(0.5 * RAMP, CARRIED, usable=False, pace=pace)
    assert told[-1] > 0.25 * CARRIED


def test_a_ramp_after_a_fade_goes_on_as_steeply_as_the_fade():
    """From what was carried, not from what is left: of a tenth it would take as long again as of the whole."""
    driven = Driven()
    left = driven.go(0.8 * RAMP, CARRIED, usable=False)[-1]
    assert 0.0 < left < 0.25 * CARRIED
    assert driven.output.remaining(driven.stamp + 0.25 * RAMP) == 0.0


def test_a_ramp_is_no_steeper_for_what_was_carried_long_ago():
    driven = Driven()
    driven.go(2.0, 0.1 * CARRIED)
    left = driven.output.remaining(driven.stamp + HOLD + 0.1)
    assert left == pytest.approx(0.1 * CARRIED * (1.0 - 0.1 / 0.3), rel=0.05)


def test_what_pushes_the_wrong_way_goes_evenly_and_not_ever_more_slowly():
    """At a slow reversal's limit the way out is a fifth of a second of what it began with."""
    driven = Driven()
    driven.output.restrict(1.0)
    told = driven.go(2.0, CARRIED, usable=False, motion=-50.0)
    assert over_after(told) <= LONGEST_AGAINST + 2.0 * PERIOD


def test_what_pushed_the_wrong_way_once_does_not_make_the_next_step_steeper():
    driven = Driven()
    driven.go(2.0 * LONGEST_AGAINST, CARRIED, usable=False, motion=-50.0)
    assert driven.output.torque == 0.0
    driven.output.restrict(100.0)
    driven.go(1.0, -CARRIED, motion=-50.0)
    assert -driven.output.torque <= 100.0 * 1.0 + 1.0


def test_how_long_it_was_wrong_is_kept_while_the_motion_has_no_direction():
    """A winch that shakes about standstill between two pushes: it adds up."""
    driven, spell = Driven(lead=0.0), 0.8 * (LONGEST_LAG + LONGEST_AGAINST)
    driven.go(spell, CARRIED, motion=-50.0)
    assert driven.output.torque > 0.0
    driven.go(3.0 * PERIOD, CARRIED, motion=1.0)
    assert driven.go(LONGEST_AGAINST, CARRIED, motion=-50.0)[-1] == 0.0


def test_how_long_it_was_wrong_is_over_once_it_was_right():
    driven, spell = Driven(), 0.9 * LONGEST_LAG
    for _ in range(10):
        driven.go(spell, CARRIED, motion=-50.0)
        assert driven.output.torque == pytest.approx(CARRIED)
        driven.go(3.0 * PERIOD, CARRIED, motion=50.0)


def test_a_burst_gains_the_age_limit_once_and_no_more():
    """What the stamps may gain on the clock is used up, and is earned by the clock alone."""
    driven = Driven(slew=1000.0, torque=100.0)
    for _ in range(3):
        before = driven.output.torque
        driven.go(1.0, -100.0, motion=math.nan, steady=0.0)
        gained = before - driven.output.torque
        assert gained <= 1000.0 * HOLD + 1e-6
        driven.go(0.2 * HOLD, -100.0, motion=math.nan, pace=0.0)
        before = driven.output.torque
        driven.go(1.0, -100.0, motion=math.nan, steady=0.0)
        assert before - driven.output.torque <= 1000.0 * FASTEST_STAMPS * 0.2 * HOLD + 1e-6


def test_a_long_silence_earns_no_more_than_the_age_limit():
    driven = Driven(slew=1000.0, torque=100.0)
    driven.now += 60.0
    before = driven.output.torque
    driven.go(1.0, -100.0, motion=math.nan, steady=0.0)
    assert before - driven.output.torque <= 1000.0 * (HOLD + 2.0 * PERIOD)


def test_once_the_end_has_begun_no_sample_takes_the_torque_up_again():
    driven = Driven()
    driven.output.end(driven.stamp)
    first = driven.output.decay(driven.stamp + 0.1)
    assert 0.0 < first < CARRIED
    driven.stamp += 0.1
    driven.now += 0.1
    assert driven.go(0.1, CARRIED)[0] <= first
    other = Driven()
    other.output.end(other.stamp)
    assert other.go(PERIOD, CARRIED)[0] < CARRIED, "also where none was published between"


@pytest.mark.parametrize(("pace", "followed"), [(1.0, 1.0), (1.4, 1.4), (4.0, 1.5)])
def test_stamps_that_run_faster_than_the_clock_move_the_torque_half_as_fast_again_at_most(pace, followed):
    """N m per second of the clock, not of a sender's stamps; an age limit was saved up before, and is gone."""
    driven = Driven(slew=1000.0, torque=199.0)
    told = driven.go(8.0 * PERIOD, -1000.0, motion=math.nan, pace=pace)
    assert told[2] - told[5] == pytest.approx(3.0 * PERIOD * 1000.0 * followed, rel=0.02)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_what_is_held_before_a_reversal_goes_as_quickly_whichever_way_it_pushes(way):
    """In a silence that may outlast the motion's way; at a slow reversal's limit as well."""
    driven = Driven()
    driven.go(2.0, way * CARRIED, motion=way * 50.0)
    driven.output.restrict(1.0)
    driven.stamp, driven.now = driven.stamp + PERIOD, driven.now + PERIOD
    driven.output.arrive(driven.stamp, driven.now)
    held = driven.output.follow(way * CARRIED, 1000.0, True, True, reversal=0.5 * HOLD, motion=way * 50.0)
    assert held == pytest.approx(way * CARRIED)
    left = driven.output.remaining(driven.stamp + HOLD + 0.5 * LONGEST_AGAINST)
    assert left == pytest.approx(0.5 * way * CARRIED, rel=0.05)


def test_a_sample_that_begins_anew_after_a_pause_is_no_step():
    """A second by both clocks, and whoever began anew at the sample before as well gets a twentieth of one."""
    output = SafeOutput(absolute=1000.0, slew=2000.0, ramp_time=0.5, hold=0.1)
    output.arrive(10.0, 100.0)
    output.restart()
    output.arrive(11.0, 101.0)
    output.restart()
    assert output.arrive(12.0, 102.0) == pytest.approx(0.05)
    output.restart()
    assert output.arrive(12.02, 102.03) == pytest.approx(0.02)


@pytest.mark.parametrize(("passed", "left"), [(0.05, 100.0), (0.15, 75.0), (0.25, 25.0), (0.5, 0.0)])
def test_what_pushes_against_the_measured_motion_is_let_go_soon_after_the_longest_lag(passed, left):
    """100 N m that have only begun to push against a motion; a healthy winch lags behind by a tenth of a second."""
    output = SafeOutput(absolute=1000.0, slew=1e6, ramp_time=0.5, hold=1.0)
    output.torque, output._motion, output._passed = 100.0, -50.0, passed
    assert output._not_for_long(100.0) == pytest.approx(left)
