"""Heave compensation that is too short to tell how the load swings is said to be; a gap elsewhere stays one."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.adequacy import of_swing, supplying


def run(seconds, groups=2, damping=0.0, frequency=3.0):
    return SimpleNamespace(time=np.array([0.0, seconds]), groups=[None] * groups, wire_mode=(frequency, damping))


QUIET, LOUD = np.full(50, 1.0), np.full(50, 9.0)  # floors


@pytest.mark.parametrize(
    ("left", "met"),
    [
        ([(run(100.0, groups=1), QUIET), (run(12.0), LOUD)], False),
        ([(run(100.0, groups=1), LOUD), (run(12.0), LOUD)], True),  # it is not the swing, or not it alone
        ([(run(100.0, groups=1), QUIET), (run(90.0), LOUD)], True),
        ([(run(100.0, groups=1), QUIET), (run(12.0, damping=0.04), LOUD)], True),  # it is told
        ([(run(100.0, groups=1), QUIET), (run(12.0, frequency=0.0), LOUD)], True),  # a wire that cannot give
        ([(run(100.0, groups=1), LOUD)], True),
    ],
)
def test_only_a_gap_that_lies_where_the_load_may_swing_is_put_down_to_it(left, met):
    assert of_swing(left).met is met


def test_what_would_supply_it_is_heave_compensation():
    check = of_swing([(run(12.0), LOUD)])
    assert "12 s, needed 60 s" in check.sentence
    assert supplying([check]) == "ahc_55t_215"
