"""Fading and bridging: how long what is carried takes to go, whatever happens on the way."""

import pytest

from winch_friction.compensation.parts import Bridge, Fade


def test_a_bridge_that_is_cut_on_the_way_is_over_when_it_was_to_be():
    bridge = Bridge(1.0)
    bridge.start(100.0)
    assert bridge.step(0.6) == pytest.approx(40.0)
    bridge.start_again(20.0)
    assert bridge.value() == pytest.approx(20.0)
    assert bridge.step(0.2) == pytest.approx(10.0)
    assert bridge.step(0.2) == 0.0


def test_a_bridge_that_is_over_carries_nothing_again():
    bridge = Bridge(1.0)
    bridge.start(100.0)
    bridge.step(1.0)
    bridge.start_again(20.0)
    assert bridge.value() == 0.0


@pytest.mark.parametrize(("down", "left"), [(None, 0.75), (2.0, 0.75), (8.0, 0.75), (1.0, 0.5), (0.5, 0.0)])
def test_a_fade_goes_down_within_the_shorter_of_two_times(down, left):
    fade = Fade(2.0, 1.0)
    assert fade.step(False, 0.5, down) == pytest.approx(left)
