"""Live against replayed: what is compared, what is missing, and what makes the two equal."""

import math

import numpy as np
import pytest

from winch_friction.physics.signals import Run
from winch_friction.replay.live import Comparison, _compared

TIMES = 1.7e9 + 0.02 * np.arange(5)


def run(*torque):
    return Run("x", {"time": TIMES[: len(torque)], "friction_torque": np.array(torque)})


def live(*torque):
    return dict(zip(TIMES.tolist(), torque, strict=False))


@pytest.mark.parametrize(("compared", "largest", "equal"), [
    (5, 0.0, True), (5, 0.9e-9, True), (5, 1.1e-9, False), (0, math.nan, False), (5, math.nan, False),
])  # fmt: skip
def test_nothing_compared_is_not_equal(compared, largest, equal):
    assert Comparison("compensator", compared, 0, largest, 0.0).equal is equal


def test_answers_that_no_message_was_recorded_of_are_missing():
    found = _compared("compensator", live(1.0, 2.0, 3.0), run(1.0, 2.0, 3.0, 4.0, 5.0))
    assert (found.compared, found.missing, found.largest) == (3, 2, 0.0)
    none = _compared("compensator", {}, run(1.0, 2.0))
    assert (none.compared, none.missing) == (0, 2)


def test_an_estimator_says_zero_where_a_sample_shows_no_friction():
    nan = math.nan
    assert _compared("estimator", live(0.0, 2.0, 0.0, 4.0), run(nan, 2.0, nan, 4.0)).equal
    assert not _compared("estimator", live(0.0, 2.0, 2.0, 4.0), run(nan, 2.0, nan, 4.0)).equal
    assert not _compared("compensator", live(0.0, 2.0, 0.0, 4.0), run(nan, 2.0, nan, 4.0)).equal


def test_the_largest_difference_is_relative_and_dated_and_of_next_to_nothing_absolute():
    found = _compared("compensator", live(100.0, 10.0, 1e-9), run(101.0, 10.5, 2e-9))
    assert found.largest == pytest.approx(0.05)
    assert found.at == TIMES[1]


def test_what_a_watchdog_said_in_silences_is_compared_and_never_missing():
    silences = Run("x", {"time": TIMES[3:], "friction_torque": np.array([8.0, 6.0])})
    found = _compared("compensator", live(1.0, 2.0, 3.0, 8.0), run(1.0, 2.0, 3.0), silences)
    assert (found.compared, found.missing, found.equal) == (4, 0, True)
    assert _compared("estimator", live(1.0, 2.0, 3.0, 7.0), run(1.0, 2.0, 3.0), silences).equal
