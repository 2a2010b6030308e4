"""The load on its elastic wire, part by part: which mode leaves least, and what runs say of each other."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.preparation.suspended_load import Mode
from winch_friction.discrepancy.preparation.wire_mode import (
    DAMPING_RATIOS,
    MOST_DAMPED,
    TOLD,
    WIRE_LENGTHS,
    _best_frequency,
    _best_ratio,
    _changes,
    _frequencies,
    _Judge,
    _mode,
    _nearby,
    least_left,
    wire_stiffnesses,
)
from winch_friction.discrepancy.preparation.wires import (
    _closest,
    _denied,
    _in_tune,
    _least,
    _leaves,
    _left_by,
    _one_damper,
    _one_ratio,
    _outvoted,
    _rings,
    _said,
    _sharp,
    _slow,
    agreed_damping,
    denies,
    ringing_damping,
)

DT = 0.02
TIME = np.arange(0.0, 120.0, DT)


# -- small parts, by hand
def valley(at, least=0.1):
    """What a mode leaves: least at a frequency and a damping ratio, more by the squares of what it is off."""
    return lambda frequency, ratio: least + 10.0 * np.log(frequency / at[0]) ** 2 + 0.1 * np.log(ratio / at[1]) ** 2


@pytest.mark.parametrize("ratio", [0.02, 0.061, 0.12, 0.33])
def test_the_damping_that_leaves_least_lies_between_those_that_are_tried(ratio):
    value, found = _best_ratio(lambda each: valley((7.0, ratio))(7.0, each))
    assert found == pytest.approx(ratio, rel=1e-6)
    assert value == pytest.approx(0.1, abs=0.01)


@pytest.mark.parametrize("ratio", [0.027, 0.045, 0.059, 0.085, 0.24])
def test_what_a_damping_leaves_is_least_between_those_that_are_tried(ratio):
    """A ratio of 0.059 left twice as much as one of 0.066 that had another's in it, for 0.07 was the nearest tried: a
    wire of a third of what hangs was said to swing whole, its load's frequency 5 % off, 10 bar of a quiet crane."""
    left = [valley((7.0, ratio), 0.002)(7.0, each) for each in DAMPING_RATIOS]
    assert least_left(left) == pytest.approx(0.002, abs=1e-4)
    assert min(left) > 0.0025
    assert _least(SimpleNamespace(swing_left=left, swing_noise=False)) == pytest.approx(0.012, abs=1e-4)


def test_the_least_that_a_damping_leaves_is_that_of_an_end_or_nothing():
    assert least_left(sorted(np.linspace(0.1, 1.1, len(DAMPING_RATIOS)))) == pytest.approx(0.1)
    assert least_left(sorted(np.linspace(0.1, 1.1, len(DAMPING_RATIOS)), reverse=True)) == pytest.approx(0.1)
    assert least_left([0.9, 0.7, 0.1, 0.01, 0.01, *[0.3] * 6]) == 0.0


@pytest.mark.parametrize(("ratio", "end"), [(0.001, DAMPING_RATIOS[0]), (3.0, DAMPING_RATIOS[-1])])
def test_at_an_end_of_the_dampings_the_end_is_taken(ratio, end):
    assert _best_ratio(lambda each: valley((7.0, ratio))(7.0, each))[1] == end


@pytest.mark.parametrize("off", [0.83, 0.95, 1.02, 1.2])
def test_a_frequency_is_found_from_a_fifth_off_to_half_a_percent(off):
    assert _best_frequency(valley((7.0, 0.05)), 7.0 * off, 0.05) == pytest.approx(7.0, rel=0.005)


@pytest.mark.parametrize(
    ("least", "ratio", "rings"), [(0.05, 0.06, True), (0.09, 0.06, True), (0.12, 0.06, False), (0.05, 0.6, False)]
)
def test_of_a_wire_of_unknown_length_a_mode_leaves_next_to_nothing_and_is_no_filters(least, ratio, rings):
    """Within the lengths that are tried; at either end of them it may lie beyond."""
    tried = [4.0, 5.0, 6.3, 7.9, 10.0]
    found = _mode(valley((7.0, ratio), least), tried)
    assert found == ((pytest.approx(7.0, rel=0.005), pytest.approx(ratio, rel=0.05)) if rings else (0.0, 0.0))
    assert _mode(valley((3.6, ratio), least), tried) == _mode(valley((10.9, ratio), least), tried) == (0.0, 0.0)


@pytest.mark.parametrize(("least", "rings"), [(0.45, True), (0.55, False)])
def test_of_a_wire_of_known_length_half_of_what_swings_has_to_go(least, rings):
    assert (_mode(valley((7.0, 0.06), least), [7.0])[0] > 0.0) is rings
    assert _mode(valley((7.0, 0.06), least), []) == (0.0, 0.0)


@pytest.mark.parametrize(("share", "found"), [(0.6, True), (0.85, True), (0.2, False), (1.0, False)])
def test_a_stiffness_beside_the_stated_one_is_taken_where_it_leaves_less_than_half(share, found):
    """Not from beyond all that are tried, and not where the stated one does as well."""
    own = 7.0 * np.sqrt(share)
    left = lambda frequency, ratio: min(valley((own, 0.06), 0.02)(frequency, ratio), 0.9)
    value, ratio = _best_ratio(lambda each: left(7.0, each))
    less, damped, frequency = _nearby(left, value, ratio, 7.0)
    assert frequency == pytest.approx(own if found else 7.0, rel=0.006)
    assert (less < 0.5 * value) is found
    assert (damped == pytest.approx(0.06, rel=0.05)) is (found or share == 1.0)


@pytest.mark.parametrize(
    ("lengths", "changes"),
    [(None, False), ([50.0, 50.4], False), ([50.0, 51.0], True), ([51.0, 50.0], True), ([0.0, 50.0], False)],
)
def test_a_wire_changes_its_mode_by_a_hundredth_of_its_length(lengths, changes):
    assert _changes(None if lengths is None else np.array(lengths)) is changes


def test_a_stiffness_is_of_the_median_length_or_of_usual_ones():
    assert wire_stiffnesses(3e8, np.array([40.0, 50.0, 400.0])) == (6e6,)
    assert wire_stiffnesses(3e8, np.array([-3.0, 0.1, 0.2])) == (3e8,)  # of a metre at least
    assert wire_stiffnesses(3e8, None) == tuple(3e8 / each for each in WIRE_LENGTHS)
    assert Mode(8.0, 0.05).settling_time == pytest.approx(10.0)  # four times 1 / (ratio * frequency)


@pytest.mark.parametrize(
    ("stiffness", "mass", "kept"), [(1e6, 1e4, True), (1e9, 1e4, False), (np.inf, 1e4, False), (1e6, 0.0, False)]
)
def test_a_mode_that_the_samples_cannot_follow_is_rigid_to_them(stiffness, mass, kept):
    """Of 10 rad/s in 0.02 s, and of 316."""
    assert list(_frequencies([stiffness], mass, DT)) == ([10.0] if kept else [])


def test_what_swings_is_judged_beside_other_causes_and_levels_of_its_own():
    """Of two stretches with a level each: a cause and what lies along it are nobody's swing."""
    wave, cause = np.sin(TIME), np.cos(3.0 * TIME)
    counts = (TIME < 40.0) | (TIME > 70.0)
    level = np.where(TIME < 40.0, 30.0, -20.0)
    whole = lambda frequency, ratio: -frequency * wave
    judge = _Judge(level + 2.0 * wave + 5.0 * cause, counts, whole, [cause[:, None]])
    assert judge.swinging(1) == pytest.approx(4.0 * 0.5, rel=0.05)
    assert judge.swinging(0) == pytest.approx(4.0 * 0.5 + 25.0 * 0.5, rel=0.05)
    assert judge.left(1, 2.0, 0.1) == pytest.approx(0.0, abs=1e-6)
    assert judge.left(1, 1.0, 0.1) == pytest.approx(0.25, rel=0.01)
    assert judge.left(1, -1.0, 0.1) == pytest.approx(2.25, rel=0.01)
    assert judge.by_damping(1, 1.0) == pytest.approx([0.25] * len(DAMPING_RATIOS), rel=0.01)
    assert judge.swinging(1, wave) == pytest.approx(9.0 * 0.5, rel=0.05)
    alone = _Judge(level + 2.0 * wave, counts, whole, [])  # a model without friction, and nothing else to hide it
    assert alone.left(0, 1.0, 0.1) == pytest.approx(0.25, rel=0.01)
    other = judge.of(lambda frequency, ratio: 0.0 * wave)
    assert other.left(1, 2.0, 0.1) == pytest.approx(1.0)
    assert judge.left(1, 2.0, 0.1) == pytest.approx(0.0, abs=1e-6)


# -- what runs say of each other
def test_a_damper_and_a_ratio_by_the_frequency_and_the_load():
    """2 z w m: 40 kN s/m of 50 t at 8 rad/s are 0.05; damped more than critically is as good as that."""
    damper, ratio = _one_damper(4e4), _one_ratio(0.07)
    assert damper(8.0, 5e4) == pytest.approx(0.05)
    assert damper(4.0, 5e4) == damper(8.0, 2.5e4) == pytest.approx(0.1)
    assert damper(0.1, 1e3) == 1.0
    assert ratio(8.0, 5e4) == ratio(1.0, 1.0) == 0.07


def test_what_a_damping_leaves_lies_between_those_that_were_tried_and_ends_with_them():
    left = np.linspace(0.1, 1.1, len(DAMPING_RATIOS))
    assert _left_by(left, DAMPING_RATIOS[3]) == pytest.approx(left[3])
    assert _left_by(left, np.sqrt(DAMPING_RATIOS[3] * DAMPING_RATIOS[4])) == pytest.approx(0.5 * (left[3] + left[4]))
    assert (_left_by(left, 1e-4), _left_by(left, 0.99)) == (pytest.approx(left[0]), pytest.approx(left[-1]))
    assert [denies(np.full(11, share), 0.05) for share in (1.19, 1.21)] == [False, True]
    assert denies((), 0.05)


def test_as_many_as_lie_within_a_fifth_of_one_of_them_are_alike():
    values = np.array([1.0, 1.15, 1.3, 1.5, 9.0, 9.1])
    assert _closest(values).tolist() == [True, True, True, False, False, False]
    assert _closest(1.0 / values).tolist() == [True, True, True, False, False, False]


def test_runs_leave_on_average_of_their_logarithms():
    """A hundredth is what nobody tells from nothing: a run that is left none of is not all there is."""
    swings = [((8.0, 0.05, 5e4), np.full(11, share)) for share in (0.0, 0.99)]
    assert _leaves(swings, _one_ratio(0.05)) == pytest.approx(np.sqrt(0.01 * 1.0))
    assert _leaves([], _one_ratio(0.05)) == 1.0


@pytest.mark.parametrize(
    ("ratio", "least", "length", "blunt", "sharp"),
    [
        (0.05, 0.1, 50.0, 0.3, True),
        (0.05, 0.1, np.nan, 0.3, False),  # a length that nobody logged
        (0.30, 0.1, 50.0, 0.3, False),  # damped like a filter
        (0.0, 0.1, 50.0, 0.3, False),
        (0.05, 0.6, 50.0, 1.8, False),  # that leaves more than half
        (0.05, 0.1, 50.0, 0.15, False),  # that any damping follows as well
    ],
)
def test_a_run_rings_as_on_a_rope_by_a_sharp_resonance_of_a_known_length(ratio, least, length, blunt, sharp):
    left = np.where(np.array(DAMPING_RATIOS) < 0.2, least, blunt)
    assert _sharp([(8.0, ratio, 5e4)], [left], [length]) == ([0] if sharp else [])


def run_of(frequency=8.0, damping=0.0, left=(), noise=False, dt=0.02, **more):
    return SimpleNamespace(
        wire_mode=Mode(frequency, damping), swinging=5e4, swing_left=left, swing_noise=noise, dt=dt, channels=more
    )


@pytest.mark.parametrize(
    ("frequency", "slow", "told"), [(8.0, True, True), (60.0, True, False), (80.0, False, False), (0.0, False, False)]
)
def test_a_mode_is_followed_by_four_samples_and_told_by_six(frequency, slow, told):
    run = run_of(frequency)
    assert (_slow(run), _slow(run, TOLD)) == (slow, told)


@pytest.mark.parametrize(
    ("damping", "left", "noise", "denied", "rings", "plainly"),
    [
        (0.0, 1.5, False, True, False, True),
        (0.0, 1.5, True, False, True, True),  # a sensor's noise would ring, which denies nothing
        (0.0, 1.0, True, False, False, False),
        (0.05, 1.5, True, False, False, False),  # which swings itself
    ],
)
def test_what_a_rigid_run_says_against_a_swing_and_what_would_ring_in_it(damping, left, noise, denied, rings, plainly):
    run, agreed = run_of(damping=damping, left=(left,) * 11, noise=noise), _one_ratio(0.05)
    assert (_denied(run, agreed), _rings(run, agreed, False), _rings(run, agreed, True)) == (denied, rings, plainly)
    assert _said(run) == ((min(left, 1.0) if noise else left),) * 11
    assert not _rings(run_of(frequency=90.0, left=(1.5,) * 11, noise=True), agreed, True)


def test_as_many_that_deny_a_damping_as_ring_by_a_ropes_outvote_it():
    against, ringing, filtered = run_of(left=(1.5,) * 11), run_of(damping=0.1), run_of(damping=0.6)
    agreed = _one_ratio(0.05)
    assert _outvoted([against], agreed)
    assert _outvoted([against, ringing, filtered], agreed)
    assert not _outvoted([against, ringing, ringing], agreed)
    assert not _outvoted([filtered], agreed)


@pytest.mark.parametrize(("filters", "falls"), [(0.1, True), (0.14, False)])
def test_two_that_deny_a_swing_outvote_any_number_whose_noise_a_filter_takes_out_as_well(filters, falls):
    """A rigid winch's six seas left 0.12 to 0.5 by a damping of 0.2 to 0.45, hardly more by any other; two hoists that
    such a load would have swung by 30 and 8 times as much were outvoted, and a null kept 0.6 bar."""
    left = np.where(np.array(DAMPING_RATIOS) < MOST_DAMPED / 2.0, 0.1, filters)
    seas, against = [run_of(damping=0.3, left=tuple(left))] * 6, run_of(left=(8.0,) * 11)
    assert _outvoted([*seas, against, against], _one_ratio(0.3)) == falls
    assert not _outvoted([*seas, against], _one_ratio(0.3))  # one alone may have another cause


@pytest.mark.parametrize(("own", "found"), [(8.0, 8.0), (8.1, 8.1), (8.3, 8.0), (7.7, 8.0), (0.0, 0.0)])
def test_a_frequency_that_is_off_what_the_wire_gives_is_put_right(own, found):
    """A wire of 50 m and 50 t at 8 rad/s: k = 3.2e6 N/m, times its length 1.6e8 N."""
    run = run_of(own, wire_out=np.array([10.0, 50.0, 300.0]))
    assert _in_tune(run, 1.6e8) == pytest.approx(found)


@pytest.mark.parametrize(
    ("ratios", "masses", "expected"),
    [
        ([0.05, 0.05, 0.05], [1e4, 3e4, 9e4], (0.05, 0.05)),  # one ratio
        ([0.09, 0.03, 0.01], [1e4, 3e4, 9e4], (0.09, 0.01)),  # one damper: 2 z w m
        ([0.6, 0.5, 0.55], [1e4, 3e4, 9e4], None),  # a filter's
        ([0.01, 0.3, 0.02], [1e4, 1e4, 9e4], None),  # neither
    ],
)
def test_runs_agree_on_whichever_scatters_less(ratios, masses, expected):
    found = agreed_damping([(8.0, ratio, mass) for ratio, mass in zip(ratios, masses, strict=True)])
    assert (found is None) if expected is None else (found(8.0, 1e4), found(8.0, 9e4)) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("less", "damped", "taken"), [(0.3, 0.06, True), (0.49, 0.06, True), (0.6, 0.06, False), (0.3, 0.55, False)]
)
def test_a_stiffness_beside_the_stated_one_leaves_half_of_what_that_leaves_and_is_a_ropes(less, damped, taken):
    """Three fifths of it; the stated one leaves 0.8 by any damping."""
    own = 7.0 * np.sqrt(0.6)
    left = lambda frequency, ratio: min(0.8, valley((own, damped), 0.8 * less)(frequency, ratio))
    found = _nearby(left, 0.8, 0.05, 7.0)
    assert (found[2] != 7.0) is taken
    assert found == (0.8, 0.05, 7.0) or found[0] == pytest.approx(0.8 * less, abs=0.02)


@pytest.mark.parametrize("size", [1e-16, 1.0, 1e16])
def test_a_cause_takes_no_part_of_a_swing_whatever_its_unit(size):
    wave, cause = np.sin(TIME), size * np.cos(3.0 * TIME)
    judge = _Judge(2.0 * wave + 5.0 * np.cos(3.0 * TIME), TIME >= 0.0, lambda *_: 0.0 * wave, [cause[:, None]])
    assert judge.swinging(1) == pytest.approx(2.0, rel=0.05)
    # the same cause once more takes nothing: what is left of it is rounding
    twice = _Judge(2.0 * wave, TIME >= 0.0, lambda *_: 0.0 * wave, [np.column_stack([cause, 2.0 * cause])])
    assert twice.swinging(1) == pytest.approx(2.0, rel=0.05)


# -- runs that ring
def rings(length=50.0, mass=5e4, ratio=0.05, stiffness=4e8, least=0.1, variance=10.0):
    """A run whose load rings on a rope of this length, m, and stiffness times length, N; and its variance."""
    left = np.where(np.array(DAMPING_RATIOS) < 0.2, least, 4.0 * least)
    return (np.sqrt(stiffness / length / mass), ratio, mass), left, length, variance


def rigid(variance=10.0, share=1.5):
    return (8.0, 0.0, 5e4), np.full(11, share), 50.0, variance


def told(*runs):
    found = ringing_damping(*map(list, zip(*runs, strict=True)))
    return None if found is None else found[1]


@pytest.mark.parametrize(
    ("runs", "stiffness"),
    [
        ((rings(50.0), rings(80.0, 3e4)), 4e8),
        ((rings(50.0), rings(80.0, stiffness=5e8)), None),  # of one wire all ring by one stiffness
        ((rings(50.0), rings(80.0, ratio=0.1)), None),  # and by one damping
        ((rings(50.0, least=0.09),), 4e8),  # one alone that rings plainly
        ((rings(50.0, least=0.12),), None),
        ((rings(50.0), rings(60.0, stiffness=4.08e8), rings(stiffness=9e8), rings(stiffness=2e9)), 4.04e8),
        ((rings(50.0), rings(80.0), rigid()), 4e8),
        ((rings(50.0), rings(80.0), rigid(), rigid()), None),  # as many say that the wire does not give
        ((rings(50.0), rings(80.0), rigid(), rigid(share=1.1)), 4e8),  # that one hardly does
        ((rings(50.0), rings(80.0), rigid(1.0), rigid(1.0)), 4e8),  # next to nothing beside what swings: 0.5 of 9
        ((rings(50.0), rings(80.0), rigid(3.0), rigid(3.0)), None),
        ((rings(50.0), rings(80.0, variance=100.0), rigid(3.0), rigid(3.0)), None),  # of the one that swings least
        ((rigid(), rigid()), None),
    ],
)
def test_runs_that_ring_tell_one_stiffness_where_no_more_deny_it(runs, stiffness):
    assert told(*runs) == (None if stiffness is None else pytest.approx(stiffness))
