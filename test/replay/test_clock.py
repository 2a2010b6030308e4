"""The clock of a replay: the stamps within a recorder's lateness, the receipts beyond it, and never back."""

import math

import pytest

from winch_friction.replay.clock import JITTER, ReplayClock


@pytest.mark.parametrize(
    ("stamp", "receipt", "now"),
    [
        (10.0, 10.0, 10.0),
        (10.0, 10.4, 10.0),  # a recorder that was late
        (10.0, 12.0, 12.0 - JITTER),  # stamps that stand still
        (14.0, 12.0, 12.0 + JITTER),  # stamps that jump ahead
        (math.nan, 12.0, 12.0),
    ],
)
def test_the_stamps_are_believed_as_far_as_a_recorder_may_be_late(stamp, receipt, now):
    assert ReplayClock().read(stamp, receipt) == pytest.approx(now)


def test_the_clock_never_goes_back():
    clock = ReplayClock()
    clock.read(10.0, 10.0)
    assert clock.read(9.8, 10.0) == 10.0
    assert clock.read(3.0, 3.0) == 10.0
    assert clock.read(10.1, 10.1) == pytest.approx(10.1)
