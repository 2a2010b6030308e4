"""How quickly a torque goes to zero that nothing carries any more: by sample, ramp time and reversal."""

import math

import pytest

from winch_friction.compensation.safe_output import LONGEST_AGAINST, LONGEST_BLIND, SafeOutput

PERIOD, HOLD, CARRIED = 0.02, 0.1, 300.0


def carrying(ramp_time=0.2, slew=1e5, reversal=math.inf, motion=50.0, torque=CARRIED):
    """After a second that asks for 300 N m, the last sample at 1 s."""
    output = SafeOutput(absolute=1000.0, slew=slew, ramp_time=ramp_time, hold=HOLD)
    for k in range(51):
        output.arrive(k * PERIOD)
        output.follow(torque, 1000.0, usable=True, enabled=True, reversal=reversal, motion=motion)
    assert output.torque == pytest.approx(torque)
    return output


def over_after(output):
    """Seconds from the last sample to the first stamp at which nothing is left, to the millisecond."""
    return next(k * 1e-3 for k in range(2000) if output.remaining(1.0 + k * 1e-3) == 0.0)


@pytest.mark.parametrize(("ramp_time", "lasts"), [(0.2, 0.2), (0.6, LONGEST_BLIND)])
def test_what_nobody_steers_is_gone_within_the_ramps_time_and_never_later_than_the_motion_may_turn(ramp_time, lasts):
    output = carrying(ramp_time)
    assert output.remaining(1.0 + HOLD) == pytest.approx(CARRIED)
    assert output.remaining(1.0 + HOLD + 0.5 * lasts) == pytest.approx(0.5 * CARRIED)
    assert over_after(output) == pytest.approx(HOLD + lasts, abs=2e-3)


@pytest.mark.parametrize(("reversal", "over"), [(0.15, 0.15), (0.25, 0.25), (9.0, HOLD + 0.2)])
def test_a_ramp_is_over_before_the_reversal_that_is_foreseen(reversal, over):
    assert over_after(carrying(reversal=reversal)) == pytest.approx(over, abs=2e-3)


def test_a_reversal_that_comes_before_the_ramp_leaves_it_what_the_slew_limit_takes():
    assert over_after(carrying(reversal=0.05, slew=15_000.0)) == pytest.approx(HOLD + CARRIED / 15_000.0, abs=2e-3)


def test_a_slow_slew_limit_holds_no_ramp_up_longer_than_it_must():
    """1000 N m/s would take 0.3 s to a reversal in 0.05 s; what pushes the wrong way by then is let go in 0.2 s."""
    output = SafeOutput(absolute=1000.0, slew=2000.0, ramp_time=0.2, hold=HOLD)
    for k in range(51):
        output.arrive(k * PERIOD)
        output.follow(CARRIED, 1000.0, usable=True, enabled=True, reversal=HOLD + 0.05, motion=50.0)
    output.restrict(1000.0)
    output.restrict(5000.0)
    assert output.limits.slew == 2000.0, "never beyond what was set"
    output.restrict(1000.0)
    assert over_after(output) == pytest.approx(HOLD + LONGEST_AGAINST, abs=2e-3)


def test_a_ramp_that_began_with_an_input_lost_goes_on_as_steeply_in_a_silence():
    """From what was carried last: not from what is left, which would never let go of the last of it."""
    output = carrying(ramp_time=0.2)
    for k in range(1, 6):
        output.arrive(1.0 + k * PERIOD)
        output.follow(CARRIED, 1000.0, usable=False, enabled=True, motion=50.0)
    left, at = output.torque, 1.0 + 5 * PERIOD
    assert left == pytest.approx(0.5 * CARRIED, rel=0.1)
    assert output.remaining(at + 0.05) == pytest.approx(left - 0.05 * CARRIED / 0.2)


def test_an_output_that_was_ended_is_not_carried_by_the_samples_that_still_come():
    """Until somebody resets it."""
    output = carrying(ramp_time=0.3)
    output.end(1.0)
    said = []
    for k in range(1, 20):
        output.decay(1.0 + k * PERIOD)
        said.append(output.torque)
    assert said[-1] == 0.0
    assert said == sorted(said, reverse=True)


@pytest.mark.parametrize("late", [0.0, -0.5])
def test_only_stamps_that_went_back_are_counted_as_such(late):
    """The watchdog may have said the ramp at a later stamp than that of the next sample."""
    output = carrying()
    output.decay(1.3)
    output.arrive(1.1 + late)
    assert output.steps_back == (late < 0.0)
