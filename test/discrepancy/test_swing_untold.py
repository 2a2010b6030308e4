"""Records that are too short to tell how the load swings are said to be; a gap elsewhere stays one."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.adequacy import of_swing
from winch_friction.discrepancy.next_experiment import supplying
from winch_friction.discrepancy.preparation.suspended_load import Mode

RIGID, ELASTIC = SimpleNamespace(wire_stiffness=np.inf), SimpleNamespace(wire_stiffness=8e7)


def run(seconds, groups=2, damping=0.0, frequency=3.0, samples=1000):
    return SimpleNamespace(
        time=np.array([0.0, seconds]),
        groups=[None] * groups,
        wire_mode=Mode(frequency, damping),
        used=np.ones(samples, bool),
    )


QUIET, LOUD = np.full(50, 1.0), np.full(50, 9.0)  # floors


@pytest.mark.parametrize(
    ("left", "met"),
    [
        ([(run(100.0, groups=1), QUIET), (run(12.0), LOUD)], False),
        ([(run(100.0, groups=1), LOUD), (run(12.0), LOUD)], True),  # it is not the swing, or not it alone
        ([(run(100.0, groups=1), QUIET), (run(90.0), LOUD)], True),
        ([(run(100.0, groups=1), QUIET), (run(90.0, damping=0.04), LOUD)], True),  # it is told
        # what it began with has not died when its samples begin to count
        ([(run(100.0, groups=1), QUIET), (run(12.0, damping=0.04), LOUD)], False),
        ([(run(100.0, groups=1), QUIET), (run(40.0, damping=0.2), LOUD)], True),
        (
            [(run(100.0, groups=1), QUIET), (run(20.0, groups=1, frequency=0.0, samples=60), LOUD)],
            False,
        ),  # not looked for
        ([(run(100.0, groups=1), QUIET), (run(12.0, frequency=0.0), LOUD)], True),  # a wire that cannot give
        ([(run(100.0, groups=1), LOUD)], True),
    ],
)
def test_only_a_gap_that_lies_where_the_load_may_swing_is_put_down_to_it(left, met):
    assert of_swing(ELASTIC, left).met is met


def test_few_samples_hide_no_swing_of_a_wire_that_does_not_give():
    assert of_swing(RIGID, [(run(20.0, groups=1, frequency=0.0, samples=60), LOUD)]).met


def test_what_would_supply_it_is_heave_compensation():
    check = of_swing(ELASTIC, [(run(12.0), LOUD)])
    assert "12 s, needed 60 s" in check.sentence
    assert supplying([check]) == "ahc_55t_215"


@pytest.mark.parametrize(("kept", "met"), [(1.9, False), (2.1, True)])
def test_twice_the_floor_elsewhere_is_a_gap_that_is_no_swing(kept, met):
    assert of_swing(ELASTIC, [(run(100.0, groups=1), kept * QUIET), (run(12.0), LOUD)]).met is met


def test_the_longest_of_the_records_that_do_not_tell_counts():
    check = of_swing(ELASTIC, [(run(12.0), LOUD), (run(31.0), LOUD), (run(20.0), LOUD)])
    assert (check.value, check.met) == (31.0, False)
    assert of_swing(ELASTIC, [(run(12.0), LOUD), (run(61.0), LOUD)]).met
