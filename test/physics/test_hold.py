"""The latest-sample hold: newest by stamp, never from the future, never too old."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from winch_friction.physics.errors import InputError
from winch_friction.physics.hold import InputHold


def test_takes_the_newest_value_stamped_no_later_than_the_sample():
    hold = InputHold(groups=["active"])
    for stamp, value in ((0.00, 1.0), (0.02, 2.0), (0.04, 3.0)):
        hold.put("active.pressure_a", stamp, value)
    assert hold.sample(0.03, 10.0).groups["active"].pressure_a == 2.0
    assert hold.sample(0.04, 10.0).groups["active"].pressure_a == 3.0


def test_too_old_absent_and_future_values_are_nan():
    hold = InputHold(groups=["active"], max_ages={"pressure_a": 0.05})
    hold.put("active.pressure_a", 0.0, 1.0)
    hold.put("speed_reference", 9.0, 5.0)
    sample = hold.sample(0.06, 10.0)
    assert math.isnan(sample.groups["active"].pressure_a)
    assert math.isnan(sample.groups["active"].displacement)
    assert math.isnan(sample.speed_reference)
    assert hold.ages(0.06) == {"active.pressure_a": 0.06, "speed_reference": math.inf}


def test_a_value_that_is_not_finite_leaves_the_last_good_one():
    hold = InputHold()
    assert hold.put("motor_torque", 0.0, 3.0)
    assert not hold.put("motor_torque", 0.01, math.nan)
    assert hold.sample(0.02, 1.0).motor_torque == 3.0


def test_unknown_channels_and_ages_are_refused():
    with pytest.raises(InputError, match="pressure_c"):
        InputHold(max_ages={"pressure_c": 1.0})
    with pytest.raises(InputError, match="above 0"):
        InputHold(default_max_age=0.0)


@given(st.permutations(list(range(12))), st.integers(0, 11))
def test_order_of_arrival_does_not_matter(order, at):
    ordered, shuffled = InputHold(), InputHold()
    for k in range(12):
        ordered.put("motor_torque", 0.01 * k, float(k))
    for k in order:
        shuffled.put("motor_torque", 0.01 * k, float(k))
    assert shuffled.sample(0.01 * at, 0.0).motor_torque == ordered.sample(0.01 * at, 0.0).motor_torque == float(at)
