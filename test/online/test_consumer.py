"""The consumer's duty: hold for a moment, let go, and take no nonsense."""

import math

import pytest

from winch_friction.online.compensator import mark, read_mark
from winch_friction.online.consumer import FADE_TIME, HOLD_TIME, RETURN_TIME, HeldTorque


def applying(torque: float, now: float, text: str = "", **options: float) -> HeldTorque:
    """A consumer that has begun beside a compensator at rest, and applies a torque from `now` s on."""
    held = HeldTorque(**options)
    assert held.take(0.0, now - 0.02)
    assert held.take(torque, now, text)
    return held


def test_a_torque_that_stands_already_is_taken_up_without_a_step() -> None:
    """A controller that was restarted applied all of it at once."""
    held, values = HeldTorque(), [0.0]
    for k in range(20):
        held.take(300.0, 10.0 + 0.02 * k, mark(True, 500 + k))
        values.append(held.value(10.0 + 0.02 * k))
    assert max(b - a for a, b in zip(values[:-1], values[1:], strict=True)) <= 300.0 * 0.021 / RETURN_TIME
    assert values[-1] == 300.0


def test_a_torque_is_held_for_a_moment_and_let_go() -> None:
    held = applying(300.0, 10.0, mark(True, 1))
    assert held.value(10.0 + 0.99 * HOLD_TIME) == 300.0
    values = [held.value(10.0 + HOLD_TIME + 0.01 * k) for k in range(round(FADE_TIME / 0.01) + 2)]
    assert values == sorted(values, reverse=True)
    assert max(a - b for a, b in zip(values[:-1], values[1:], strict=True)) < 300.0 * 0.03
    assert values[-1] == 0.0


@pytest.mark.parametrize("looked_at", [(), (0.5,), (0.5, 0.9, 1.2)])
def test_what_is_let_go_does_not_hang_on_how_often_it_is_asked_for(looked_at: tuple[float, ...]) -> None:
    """A slow controller asks before the hold is over and again behind it: only what is behind it counts."""
    held = applying(300.0, 10.0, mark(True, 1))
    for share in looked_at:
        held.value(10.0 + share * HOLD_TIME)
    assert held.value(10.0 + HOLD_TIME + 0.1 * FADE_TIME) == pytest.approx(0.9 * 300.0)


def test_after_a_silence_it_comes_back_without_a_step() -> None:
    held = applying(300.0, 10.0, mark(True, 1))
    assert held.value(12.0) == 0.0
    values = []
    for k in range(30):
        held.take(300.0, 12.0 + 0.02 * k, mark(True, 2 + k))
        values.append(held.value(12.0 + 0.02 * k))
    assert max(abs(b - a) for a, b in zip([0.0, *values], values, strict=False)) <= 300.0 * 0.021 / RETURN_TIME
    assert values[-1] == values[round(RETURN_TIME / 0.02) + 1] == 300.0


@pytest.mark.parametrize("nonsense", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_is_no_message(nonsense: float) -> None:
    held = applying(300.0, 10.0)
    assert not held.take(nonsense, 10.05)
    assert held.value(10.05) == 300.0
    assert held.value(11.0) == 0.0  # and does not keep the last one alive


def test_what_the_crane_could_never_say_is_no_message() -> None:
    held = applying(300.0, 1.0, largest=2000.0)
    assert not held.take(1e300, 1.02)
    assert not held.take(-2001.0, 1.02)
    assert held.value(1.02) == 300.0


def test_an_old_number_is_an_old_message_but_not_for_ever() -> None:
    held = HeldTorque()
    assert held.take(300.0, 10.0, mark(True, 500))
    assert not held.take(-300.0, 10.02, mark(True, 499))
    assert not held.take(-300.0, 10.02, mark(True, 500))
    assert held.take(10.0, 11.0, mark(True, 1))  # the compensator was started anew


def test_the_mark_and_text_of_another_origin() -> None:
    assert read_mark(mark(False, 17)) == (False, 17)
    assert read_mark("") == read_mark("base_link") == read_mark("valid x") == (True, -1)


@pytest.mark.parametrize("number", ["\u00b2", "1\u00b2", "9" * 20, "9" * 5000, "-1", "1_0", " 7", "\u0663"])
def test_a_number_that_no_compensator_counts_to_is_text_of_another_origin(number: str) -> None:
    """A superscript is a digit and no number; of 5000 digits Python makes none: whoever held the torque died."""
    assert read_mark(f"invalid {number}") == (True, -1)
    held = HeldTorque()
    assert held.take(100.0, 1.0, f"valid {number}")
    assert held.take(200.0, 1.02, mark(True, 3))
