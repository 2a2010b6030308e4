"""Regions say hoisting or lowering where the blocks differ in that, not the pressure that goes up and down with it."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.engine.regions import find_regions

RNG = np.random.default_rng(3)
DIRECTION = np.where(np.arange(600) % 2, 1.0, -1.0)
READ_AS = {"pressure": (1.0, "bar")}


def regions(gap, **features):
    blocks = SimpleNamespace(y=gap, direction=DIRECTION, features=features)
    return find_regions(blocks, gap, READ_AS)


def test_a_pressure_that_only_says_which_way_the_winch_turns_is_not_the_region():
    """Friction parts the pressure of hoisting from that of lowering; at a few reversals it is ahead of the motion."""
    ahead = np.where(RNG.random(600) < 0.03, -DIRECTION, DIRECTION)
    pressure = 100.0 + 20.0 * ahead + RNG.normal(0.0, 3.0, 600)
    gap = 2.0 * ahead + RNG.normal(0.0, 0.3, 600)
    found = regions(gap, **{"active.pressure": pressure})
    assert sorted(each.where for each in found)[:2] == ["hoisting", "lowering"]
    assert not any("pressure" in each.where for each in found[:2])


def test_a_part_of_one_direction_says_which_direction():
    """The gap is where lowering has the lowest pressures: both are said."""
    pressure = 100.0 + 20.0 * DIRECTION + RNG.normal(0.0, 3.0, 600)
    gap = np.where(pressure < np.quantile(pressure, 0.15), -5.0, 0.0) + RNG.normal(0.0, 0.1, 600)
    first = regions(gap, **{"active.pressure": pressure})[0]
    assert first.where.startswith("active.pressure < ")
    assert first.where.endswith("bar and lowering")
    assert set(first.signals) == {"active.pressure", "direction"}


def test_runs_of_one_direction_only_do_not_say_it_with_every_signal():
    pressure = RNG.uniform(50.0, 150.0, 600)
    gap = np.where(pressure > 120.0, 3.0, 0.0)
    blocks = SimpleNamespace(y=gap, direction=np.ones(600), features={"active.pressure": pressure})
    assert find_regions(blocks, gap, READ_AS)[0].where.startswith("active.pressure > ")


def test_a_signal_that_has_nothing_to_do_with_the_direction_keeps_its_words():
    pressure = RNG.uniform(50.0, 150.0, 600)
    gap = np.where(pressure > 120.0, 3.0, 0.0) + RNG.normal(0.0, 0.1, 600)
    first = regions(gap, **{"active.pressure": pressure})[0]
    assert first.where.startswith("active.pressure > ")
    assert "ing" not in first.where


def test_a_region_is_said_in_the_units_that_people_read_with_its_share_of_the_whole_gap():
    """Two parts of two speeds, of 5 and of 3 squared over as many blocks; the second is a share of all as well."""
    speed = np.linspace(0.0, 100.0, 600)
    gap = np.where(speed > 85.0, 5.0, np.where(speed < 15.0, -3.0, 0.0))
    blocks = SimpleNamespace(y=gap, direction=DIRECTION, features={"motor_speed": speed})
    first, second = find_regions(blocks, gap, {"motor_speed": (60.0 / (2.0 * np.pi), "rpm")})[:2]
    assert first.where == "motor_speed > 812 rpm"
    assert second.where == "motor_speed < 143 rpm"
    assert (first.mean_residual, second.mean_residual) == (5.0, -3.0)
    assert first.share_of_gap == pytest.approx(25.0 / 34.0, abs=0.01)
    assert first.share_of_gap + second.share_of_gap == pytest.approx(1.0, abs=1e-9)


def test_what_is_said_already_is_no_second_region():
    """Where one part has all of the gap, nothing is left to say."""
    speed = np.linspace(0.0, 100.0, 600)
    gap = np.where(speed > 85.0, 5.0, 0.0)
    blocks = SimpleNamespace(y=gap, direction=DIRECTION, features={"motor_speed": speed})
    assert [each.where for each in find_regions(blocks, gap, {})] == ["motor_speed > 85"]


def test_a_handful_of_blocks_is_no_region():
    """However far off: an outlier is nothing that a region says."""
    direction = np.where(np.arange(600) < 590, 1.0, -1.0)
    gap = np.where(direction < 0.0, 50.0, 0.0) + RNG.normal(0.0, 0.1, 600)
    blocks = SimpleNamespace(y=gap, direction=direction, features={})
    assert "lowering" not in [each.where for each in find_regions(blocks, gap, {})]


def test_a_region_has_its_share_of_the_square_and_its_own_mean():
    """Hoisting keeps 3, lowering -1: of the square nine tenths and one tenth."""
    found = regions(np.where(DIRECTION > 0, 3.0, -1.0))
    assert [each.where for each in found] == ["hoisting", "lowering"]
    assert [each.share_of_gap for each in found] == pytest.approx([0.9, 0.1])
    assert [each.mean_residual for each in found] == pytest.approx([3.0, -1.0])
    assert [each.signals for each in found] == [("direction",)] * 2


def test_no_gap_lies_nowhere():
    assert regions(np.zeros(600), pressure=RNG.uniform(50.0, 150.0, 600)) == []


@pytest.mark.parametrize(
    ("unit", "words"), [(READ_AS, "50 bar"), ({"pressure": (1e-5, "MPa")}, "0.0005 MPa"), ({}, "50")]
)
def test_a_threshold_is_a_quantile_in_the_unit_that_people_read(unit, words):
    """By the last part of a signal's name, and without a unit where none is known."""
    pressure = np.tile(np.linspace(0.0, 100.0, 300), 2)
    direction = np.repeat([1.0, -1.0], 300)
    gap = np.where(pressure > 50.0, 4.0, 0.0)
    blocks = SimpleNamespace(y=gap, direction=direction, features={"active.pressure": pressure})
    first = find_regions(blocks, gap, unit)[0]
    assert first.where == f"active.pressure > {words}"
    assert first.signals == ("active.pressure",)
    assert first.share_of_gap == pytest.approx(1.0)
    assert first.mean_residual == pytest.approx(4.0)


def test_where_two_signals_meet_both_are_said_the_direction_last():
    """A quarter of the plane, of which either signal alone has half nothing."""
    first, second = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, 40), np.linspace(0, 1, 40)))
    way = np.where(np.arange(1600) % 2, 1.0, -1.0)
    gap = np.where((first > 0.67) & (second < 0.33), -2.0, 0.0)
    blocks = SimpleNamespace(y=gap, direction=way, features={"a.load": first, "wire_out": second})
    found = find_regions(blocks, gap, {})[0]
    assert set(found.where.split(" and ")) == {"a.load > 0.667", "wire_out < 0.333"}
    assert set(found.signals) == {"a.load", "wire_out"}
    assert found.mean_residual < -1.5
    gap = np.where((first > 0.67) & (way < 0), -2.0, 0.0)
    found = find_regions(SimpleNamespace(y=gap, direction=way, features={"a.load": first}), gap, {})[0]
    assert found.where == "a.load > 0.667 and lowering"
    assert found.signals == ("a.load", "direction")


def test_a_condition_that_is_met_hardly_ever_is_none_and_what_is_not_known_is_in_none():
    pressure = np.tile(np.linspace(0.0, 100.0, 300), 2)
    pressure[::2] = np.nan
    gap = np.where(pressure > 85.0, 9.0, 0.0) + np.where(np.isnan(pressure), 1.0, 0.0)
    found = find_regions(SimpleNamespace(y=gap, direction=np.zeros(600), features={"pressure": pressure}), gap, {})
    high, known = next(each for each in found if each.where.startswith("pressure > 8")), pressure > 85.0
    assert high.mean_residual == pytest.approx(9.0, rel=0.1)
    assert high.share_of_gap == pytest.approx(81.0 * known.sum() / (81.0 * known.sum() + 300.0), rel=0.05)


def test_regions_that_overlap_have_each_its_whole_share_and_the_largest_comes_first():
    """Found first is what is largest in the mean: of what lies around it the second one has that as well."""
    pressure = np.tile(np.linspace(0.0, 100.0, 300), 2)
    gap = np.select([pressure > 85.0, pressure > 67.0], [9.0, 3.0], 0.0)
    blocks = SimpleNamespace(y=gap, direction=np.zeros(600), features={"pressure": pressure})
    found = find_regions(blocks, gap, {})
    assert [each.where for each in found[:2]] == ["pressure > 67", "pressure > 85"]
    for each in found:
        sign, border = each.where.split()[1:]
        own = pressure > float(border) if sign == ">" else pressure < float(border)
        assert each.share_of_gap == pytest.approx((gap[own] ** 2).sum() / (gap**2).sum(), rel=0.05)
        assert each.mean_residual == pytest.approx(gap[own].mean(), rel=0.05)


def test_no_region_is_a_band_of_one_signal():
    pressure = np.tile(np.linspace(0.0, 100.0, 300), 2)
    gap = np.where(np.abs(pressure - 59.0) < 8.0, 9.0, 0.0)
    for each in find_regions(SimpleNamespace(y=gap, direction=np.zeros(600), features={"p": pressure}), gap, {}):
        assert each.signals == ("p",)
        assert " and " not in each.where


def test_a_condition_that_is_mostly_of_one_direction_does_not_say_it():
    """Three quarters of the high pressures are of hoisting, and the gap is in all of them alike."""
    often = np.where(np.arange(600) % 8 < 6, 1.0, -1.0)
    pressure = np.where(np.arange(600) % 20 < 7, 150.0, 50.0) + RNG.uniform(-1.0, 1.0, 600)
    blocks = SimpleNamespace(y=None, direction=often, features={"active.pressure": pressure})
    gap = np.where(pressure > 100.0, 4.0, 0.0)
    blocks.y = gap
    (first, *_) = find_regions(blocks, gap, READ_AS)
    assert first.where.startswith("active.pressure > ")
    assert "ing" not in first.where
    assert first.signals == ("active.pressure",)


def test_of_runs_of_one_direction_no_condition_says_it():
    pressure = RNG.uniform(50.0, 150.0, 600)
    gap = np.where(pressure > 120.0, 3.0, 0.0)
    blocks = SimpleNamespace(y=gap, direction=np.ones(600), features={"active.pressure": pressure})
    found = find_regions(blocks, gap, READ_AS)
    assert found
    assert all("direction" not in each.signals for each in found if "active.pressure" in each.signals)
