"""Which crane changed and when, on series of which the truth is known."""

import numpy as np
import pytest

from winch_friction.fleet import drift
from winch_friction.fleet.drift import Series, _weights, find_steps, find_unlike, month_of, month_text, monthly

MONTHS = np.arange(24) + 2024 * 12


def series(crane, rng, step_at=None, size=0.0, slope=0.0, noise=1.0, trait="opposing"):
    values = 20.0 + slope * np.arange(24) + noise * rng.standard_normal(24)
    if step_at is not None:
        values[step_at:] += size
    return Series(crane, trait, MONTHS, values, np.full(24, noise))


def test_a_step_is_dated_and_sized():
    rng = np.random.default_rng(0)
    fleet = [series(f"c{k}", rng, slope=0.2) for k in range(20)] + [series("odd", rng, 9, -8.0, slope=0.2)]
    found = find_steps(fleet)
    assert [step.crane for step in found] == ["odd"]
    assert abs(found[0].month - MONTHS[9]) <= 1
    assert found[0].size == pytest.approx(-8.0, abs=2.0)


def test_wear_alone_is_no_step():
    """Slow drifts of any slope, in 40 fleets of 40: at most the stated share of fleets has a false step."""
    rng = np.random.default_rng(1)
    alarmed = sum(
        bool(find_steps([series(f"c{k}", rng, slope=rng.uniform(-0.5, 0.5)) for k in range(40)])) for _ in range(40)
    )
    assert alarmed <= 3  # 0.02 * 40 = 0.8 expected; 4 or more has probability 0.01


def test_two_steps_of_one_crane_are_both_found():
    rng = np.random.default_rng(2)
    twice = series("twice", rng, 6, 12.0)
    twice.values[16:] -= 15.0
    found = find_steps([twice, *(series(f"c{k}", rng) for k in range(10))])
    assert [step.month - MONTHS[0] for step in found] == pytest.approx([6, 16], abs=1)


def test_few_months_say_nothing():
    short = Series("short", "opposing", MONTHS[:5], np.array([0.0, 0.0, 50.0, 50.0, 50.0]), np.ones(5))
    assert find_steps([short]) == []


def test_the_crane_that_is_unlike_the_others_is_named():
    rng = np.random.default_rng(3)
    fleet = [series(f"c{k}", rng) for k in range(12)]
    fleet.append(Series("other", "opposing", MONTHS, np.full(24, 45.0), np.ones(24)))
    assert [each.crane for each in find_unlike(fleet)] == ["other"]
    assert find_unlike(fleet[:3]) == []


def test_a_crane_is_unlike_the_others_by_its_last_months():
    rng = np.random.default_rng(4)
    fleet = [series(f"c{k}", rng) for k in range(12)]
    mended, fallen = series("mended", rng), series("fallen", rng)
    mended.values[:6] += 30.0
    fallen.values[-6:] -= 30.0
    assert [each.crane for each in find_unlike([*fleet, mended, fallen])] == ["fallen"]


def test_months_are_calendar_months():
    assert month_text(month_of(1_709_251_199.0)) == "2024-02"  # 29 February 2024, 23:59:59
    assert month_text(month_of(1_709_251_200.0)) == "2024-03"
    rows = {("c", "t"): [(1_709_251_200.0, 1.0, 1.0), (1_709_260_000.0, 3.0, 1.0), (1_709_251_199.0, 7.0, 1.0)]}
    (own,) = monthly(rows)
    assert own.values.tolist() == [7.0, 2.0]
    assert own.stds.tolist() == pytest.approx([1.0, 2.0**-0.5])


def test_a_month_that_says_it_is_sure_decides_no_step():
    """One recording whose deviation came out as next to nothing; months do not differ by more than they scatter."""
    rng = np.random.default_rng(9)
    calm = [series(f"c{k}", rng) for k in range(6)]
    calm[0].values[12] += 3.0
    calm[0].stds[12] = 1e-9
    assert find_steps(calm) == []
    own = _weights(calm[0])
    assert own.max() / np.median(own) == pytest.approx(2.0)


def test_three_cranes_are_no_fleet_to_be_unlike():
    rng = np.random.default_rng(10)
    fleet = [*(series(f"c{k}", rng, noise=0.1) for k in range(2)), series("odd", rng, 0, 50.0)]
    assert find_unlike(fleet) == []
    assert [each.crane for each in find_unlike([*fleet, series("c3", rng, noise=0.1)])] == ["odd"]


def exact(*places, slope=0.0, sizes=(), trait="opposing"):
    """A series without noise: level 5, a drift in its whole length, and steps."""
    values = 5.0 + slope * np.arange(24) / 23.0
    for place, size in zip(places, sizes, strict=True):
        values[place:] += size
    return Series("c", trait, MONTHS, values, np.ones(24))


@pytest.mark.parametrize("slope", [0.0, 7.0, -3.0])
def test_sizes_are_told_from_the_drift_beside_them(slope):
    own = exact(6, 16, slope=slope, sizes=(12.0, -15.0))
    assert drift._sizes(own, [6, 16]) == pytest.approx([12.0, -15.0])
    assert drift._sizes(own, [16, 6]) == pytest.approx([-15.0, 12.0])
    assert drift._sizes(own, []) == []


@pytest.mark.parametrize("place", [2, 9, 22])
def test_a_step_is_looked_for_up_to_two_months_from_either_end(place):
    noise = 0.01 * np.random.default_rng(0).standard_normal(24)
    own = exact(place, sizes=(5.0,))
    own.values[:] += noise
    statistic, found = drift._likeliest(own, [])
    assert found == place
    assert statistic > 1e3
    rest, _ = drift._likeliest(own, [place])
    assert rest < 50.0


def test_a_chance_is_the_share_of_series_without_a_step_that_look_as_much_like_one(monkeypatch):
    monkeypatch.setattr(drift, "_null", lambda length, steps: np.array([1.0, 2.0, 3.0, 4.0]))
    assert [drift._chance(24, 0, statistic) for statistic in (0.5, 2.0, 4.5)] == pytest.approx([1.0, 0.8, 0.2])


@pytest.mark.parametrize(
    ("chances", "found"),
    [
        ((0.0066, 0.0099, 0.019), "abc"), ((0.0067, 0.0099, 0.001), "abc"), ((0.007, 0.009, 0.01), ""),
        ((0.006, 0.0101, 0.011), "a"), ((0.5, 0.006, 0.5), "b"),
    ],
)  # fmt: skip
def test_chances_of_a_fleet_are_shared_among_its_series(chances, found, monkeypatch):
    """Holm: the smallest of three has a third of 0.02, the next a half."""
    of = dict(zip("abc", chances, strict=True))
    monkeypatch.setattr(drift, "_steps_of", lambda each: [drift.Step(each.crane, "t", 1, 1.0, of[each.crane])])
    steps = find_steps([Series(name, "t", MONTHS, MONTHS, MONTHS) for name in "cab"])
    assert [step.crane for step in steps] == list(found)


def test_how_far_a_crane_is_off_is_in_robust_deviations_the_farthest_first():
    """The levels scatter by 1.4826 times 2 around 0: 3.5 of that are 10.38."""
    of = lambda crane, level: Series(crane, "t", MONTHS[:3], np.full(3, level), np.ones(3))
    levels = {"a": -2.0, "b": -1.0, "c": 0.0, "d": 1.0, "e": 2.0, "up": 10.4, "down": -20.0}
    first, second = find_unlike([of(*each) for each in levels.items()])
    assert (first.crane, first.level, first.fleet) == ("down", -20.0, 0.0)
    assert first.score == pytest.approx(20.0 / 2.9652)
    assert (second.crane, second.score) == ("up", pytest.approx(10.4 / 2.9652))
    assert len(find_unlike([of(*each) for each in (levels | {"up": 10.3}).items()])) == 1


def test_traits_are_compared_with_their_own_kind():
    rng = np.random.default_rng(11)
    fleet = [series(f"c{k}", rng, noise=0.1) for k in range(5)]
    other = [Series(f"c{k}", "other", MONTHS, 500.0 + each.values, each.stds) for k, each in enumerate(fleet)]
    assert find_unlike([*fleet, *other]) == []
    rows = {("b", "t"): [(1.7e9, 1.0, 2.0)], ("a", "u"): [(1.7e9, 5.0, 3.0), (1.7e9, 7.0, 4.0)]}
    assert [(each.crane, each.trait, each.values.tolist(), each.stds.tolist()) for each in monthly(rows)] == [
        ("a", "u", [6.0], [pytest.approx(np.sqrt(12.5 / 2.0))]), ("b", "t", [1.0], [2.0]),
    ]  # fmt: skip
