"""What was wrong for a moment, and never again, is no doubt."""

from winch_friction.online.doubt import FORGOTTEN, Doubt

STEP = 0.1  # s


def told(doubt: Doubt, wrong: bool | None, seconds: float) -> bool:
    """Whether it counts at the end of so many seconds of the same."""
    for _ in range(round(seconds / STEP)):
        doubt.step(wrong, STEP)
    return doubt.stands


def test_moments_that_are_half_a_minute_apart_do_not_add_up() -> None:
    """Spikes on an empty hook, where nothing else shows anything: after hours they were a second, and stood on."""
    doubt = Doubt(1.0)
    for _ in range(20):
        assert not told(doubt, True, 0.3)
        assert not told(doubt, None, FORGOTTEN + 1.0)


def test_the_halves_of_a_wave_that_show_nothing_do_not_end_what_the_others_show() -> None:
    doubt = Doubt(1.0)
    assert not told(doubt, True, 0.6)
    assert not told(doubt, None, 10.0)
    assert told(doubt, True, 0.6)
    assert told(doubt, None, 10.0 * FORGOTTEN)
    assert not told(doubt, False, 1.2)


def test_what_may_come_to_a_doubt_is_pending_until_it_is_forgotten() -> None:
    doubt = Doubt(1.0)
    assert not doubt.pending
    told(doubt, True, 0.3)
    told(doubt, None, 5.0)
    assert doubt.pending
    told(doubt, None, FORGOTTEN)
    assert not doubt.pending
    told(doubt, True, 1.2)
    assert doubt.pending
    told(doubt, False, 1.2)
    assert not doubt.pending


def test_a_doubt_that_stands_is_pending_while_it_is_not_over() -> None:
    """What was right for a moment after it is nothing yet."""
    doubt = Doubt(1.0, calm=0.5)
    assert told(doubt, True, 1.2)
    assert told(doubt, False, 0.2)
    assert doubt.pending
    assert not told(doubt, False, 0.5)
    assert not doubt.pending
