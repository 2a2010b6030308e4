"""A load that swings from a hole of its record, in which nobody knows how the shaft moved."""

import numpy as np
import pytest

from winch_friction.discrepancy.preparation.grid import Grid
from winch_friction.discrepancy.preparation.suspended_load import Mode, beside_holes

DT = 0.03
TIME = np.arange(0.0, 200.0, DT)
HOLES = ((40.0, 43.5), (90.0, 93.5), (150.0, 153.5))  # s


def holed(*holes):
    valid = np.ones(len(TIME), bool)
    for begin, end in holes:
        valid &= (begin >= TIME) | (end <= TIME)
    return Grid({"time": TIME}, DT, valid)


def ringing(since, size, frequency=2.0, ratio=0.25):
    gap = np.random.default_rng(0).standard_normal(len(TIME))
    later = since < TIME
    rings = np.exp(-ratio * frequency * (TIME[later] - since)) * np.cos(frequency * (TIME[later] - since))
    gap[later] += size * rings
    return gap


@pytest.mark.parametrize(("mode", "lasts"), [(Mode(2.0, 0.25), 8.0), (Mode(2.0, 0.0), 40.0)], ids=["told", "rigid"])
def test_what_rings_after_a_hole_is_left_out_until_it_has_died(mode, lasts):
    """Four decay times, of a wire that is taken for rigid those of a usual damping; after the hole that it follows."""
    kept = beside_holes(holed(*HOLES), mode, ringing(93.5, 20.0), np.ones(len(TIME), bool))
    assert (~kept == ((TIME > 93.4) & (93.5 + lasts - 0.1 > TIME))).mean() > 0.999


@pytest.mark.parametrize(("mode", "size"), [(Mode(2.0, 0.25), 0.0), (Mode(0.0, 0.0), 20.0)], ids=["quiet", "unknown"])
def test_after_a_hole_in_which_nothing_happened_all_counts(mode, size):
    """As on a wire of which no stiffness is known."""
    assert beside_holes(holed(*HOLES), mode, ringing(93.5, size), np.ones(len(TIME), bool)).all()


def test_a_cell_that_is_empty_is_no_hole_and_no_ringing_elsewhere_one_after_it():
    empty = beside_holes(holed((93.44, 93.52)), Mode(2.0, 0.25), ringing(93.5, 20.0), np.ones(len(TIME), bool))
    before = beside_holes(holed(*HOLES), Mode(2.0, 0.25), ringing(60.0, 20.0), np.ones(len(TIME), bool))
    assert empty.all()
    assert before.all()


def test_what_stands_rings_by_no_measure():
    moving = (TIME < 93.5) | (TIME > 101.5)
    assert beside_holes(holed(*HOLES), Mode(2.0, 0.25), ringing(93.5, 20.0), moving).all()
    rare = np.arange(len(TIME)) % 100 == 0  # too few to know a deviation by
    assert beside_holes(holed(*HOLES), Mode(2.0, 0.25), ringing(93.5, 20.0), rare).all()
