"""Which crane changed and when, on series of which the truth is known."""

import numpy as np
import pytest

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
