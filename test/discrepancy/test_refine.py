"""Finer shapes around the one that was found."""

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.catalogue import all_candidates
from winch_friction.discrepancy.candidates.families import CURVES, SURFACES, name_of


def candidate(name):
    return next(each for each in all_candidates() if each.name == name)


def test_the_finer_grid_keeps_the_old_shapes_and_divides_the_way_to_the_neighbours():
    own = candidate("accumulator_thermal")
    given = own.shapes([])
    finer = own.refined(given[1]).shapes([])
    tau = sorted(each.values["tau"] for each in finer)
    assert {each.values["tau"] for each in given} < set(tau)
    near = [t for t in tau if given[0].values["tau"] <= t <= given[2].values["tau"]]
    assert np.diff(np.log(near)).max() == pytest.approx(np.log(2.0) / 6.0)
    assert len({each.label for each in finer}) == len(finer)


def test_the_end_of_the_grid_is_refined_on_both_sides():
    own = candidate("accumulator_thermal")
    last = own.shapes([])[-1]
    assert max(each.values["tau"] for each in own.refined(last).shapes([])) > last.values["tau"]


@pytest.mark.parametrize("name", ["case_pressure", "wear_drift", "inertia_error", "pressure_scale"])
def test_what_has_no_grid_stays_as_it_is(name):
    own = candidate(name)
    assert own.refined(None) is own


def test_once_is_enough():
    own = candidate("port_turbulence")
    once = own.refined(own.shapes([])[0])
    assert once.refined(once.shapes([])[0]) is once


def test_every_curve_and_surface_has_a_name_of_its_own():
    """By it a slot is found again, and a table in a model file."""
    names = [name_of(row) for row in (*CURVES, *SURFACES)]
    assert sorted(names) == sorted(set(names))
