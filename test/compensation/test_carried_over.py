"""What is carried over from one model, setting or clock to the next leaves no step and does not stay behind."""

import math

import numpy as np
import pytest

from winch_friction.compensation.safe_output import SafeOutput

PERIOD = 0.02


def output(ramp_time=0.2, slew=1e5):
    return SafeOutput(absolute=1000.0, slew=slew, ramp_time=ramp_time, hold=0.1)


def samples(own, first, count, target, usable=True, reversal=math.inf):
    """What is said at so many samples from the `first` on."""
    said = []
    for k in range(first, first + count):
        own.arrive(k * PERIOD)
        said.append(own.follow(target, 1000.0, usable=usable, enabled=True, reversal=reversal, motion=50.0))
    return said


def test_another_model_while_the_first_still_fades_in_makes_no_step():
    """Half of the one torque is said, so that half of the difference is carried."""
    own = output(ramp_time=1.0)
    before = samples(own, 0, 26, 200.0)[-2:]
    assert before[-1] == pytest.approx(100.0)
    own.carry(200.0 - 300.0)
    after = samples(own, 26, 1, 300.0)[0]
    assert after - before[-1] == pytest.approx(before[-1] - before[-2], abs=3.0)


def test_a_jump_that_was_announced_is_no_step_and_goes_within_the_ramp_time():
    own, told = output(), output()
    assert samples(own, 0, 50, 300.0)[-1] == samples(told, 0, 50, 300.0)[-1] == pytest.approx(300.0)
    told.bump()
    assert samples(own, 50, 1, 100.0) == [pytest.approx(100.0)]
    after = samples(told, 50, 12, 100.0)
    assert 270.0 < after[0] <= 300.0
    assert after[-1] == pytest.approx(100.0, abs=1e-6)


@pytest.mark.parametrize("reversal", [0.06, 0.1])
def test_what_a_former_model_left_goes_with_the_rest_before_the_motion_turns(reversal):
    """An input is lost while 200 N m of the former model are still let go."""
    own = output()
    samples(own, 0, 50, 300.0)
    own.bump()
    samples(own, 50, 1, 100.0)
    lost = samples(own, 51, 6, 100.0, usable=False, reversal=reversal)
    assert lost[0] > 0.0
    assert lost[round(reversal / PERIOD) - 1] == pytest.approx(0.0, abs=1e-6)


def test_settings_that_come_in_the_midst_of_a_ramp_leave_it_where_it_is():
    own = output()
    samples(own, 0, 51, 300.0)
    own.decay(1.2)
    left = own.torque
    assert 0.0 < left < 300.0
    own.configure(1000.0, 1e5, 0.2, 0.1)
    assert own.remaining(1.2) == pytest.approx(left)
    assert own.remaining(1.21) < left
    own.decay(1.21)
    assert own.torque > left - 300.0 * 0.01 / 0.2 - 1e-6


@pytest.mark.parametrize("ahead", [1.0, 1.3])
def test_stamps_that_ran_ahead_have_no_time_to_spare_for_those_that_stand_still(ahead):
    """A sender's clock that was fast for five seconds: a fade is as quick by the steady clock as with any other."""
    own, stamp, at = output(ramp_time=0.5, slew=2000.0), 0.0, {}
    for k in range(400):
        now, lost = k * PERIOD, k * PERIOD > 5.0
        stamp += PERIOD * (0.3 if lost else ahead)
        own.arrive(stamp, now)
        at[now] = own.follow(200.0, 1000.0, usable=not lost, enabled=True, motion=50.0)
    said = np.array(list(at.values()))
    assert said[: round(5.0 / PERIOD)].max() == pytest.approx(200.0)
    assert said[round((5.0 + 0.1 + 0.5) / PERIOD) + 4 :].max() == 0.0
