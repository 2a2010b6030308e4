"""Which directions the data do not tell apart, by how little they see them, and which parameters act alike."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification.collinearity import _signed, identifiable, ties, unseen_directions

NAMES = ("K1", "C5", "C6")
DATA = SimpleNamespace(
    speed=np.array([10.0, 50.0, 90.0]), drop=np.full(3, 1e7), displacement=np.full(3, 3e-5),
    drum_torque=np.full(3, 5e5), motors=11,
)  # fmt: skip


def model(*columns):
    return SimpleNamespace(parameter_names=NAMES, jacobian=lambda points: np.column_stack(columns))


def test_how_much_is_seen_is_a_ratio_of_deviations_and_the_least_seen_comes_first():
    result = SimpleNamespace(information=np.diag([0.25, 4.0, 0.01]), model=SimpleNamespace(parameter_names=NAMES))
    found = unseen_directions(result)
    assert [each.seen for each in found] == pytest.approx([0.1, 0.5])
    assert [str(each) for each in found] == ["1.00 C6", "1.00 K1"]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_parameters_that_act_alike_or_just_against_each_other_are_tied(sign):
    speed = DATA.speed
    found = ties(model(speed, sign * 3.0 * speed, np.ones(3)), DATA)
    assert [(each.first, each.second) for each in found] == [("K1", "C5")]
    assert found[0].cosine == pytest.approx(sign)


@pytest.mark.parametrize(("alike", "tied"), [(0.98, False), (0.992, True), (-0.992, True), (0.9985, True)])
def test_what_is_alike_to_a_hundredth_is_tied(alike, tied):
    """The columns are of unit length: the cosine between the first two is as given, that to the third is zero."""
    first, third = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    found = ties(model(5.0 * first, np.array([alike, np.sqrt(1.0 - alike**2), 0.0]), third), DATA)
    assert [(each.first, each.second) for each in found] == ([("K1", "C5")] if tied else [])


def test_the_most_alike_come_first_whichever_their_sign_and_a_column_of_nothing_is_tied_to_none():
    first = np.array([1.0, 0.0, 0.0])
    near = [np.array([cosine, np.sqrt(1.0 - cosine**2), 0.0]) for cosine in (0.995, -0.9999)]
    found = ties(model(first, *near), DATA)
    assert [(each.first, each.second) for each in found[:2]] == [("K1", "C6"), ("K1", "C5")]
    assert [each.cosine for each in found[:2]] == pytest.approx([-0.9999, 0.995])
    with np.errstate(all="raise"):
        assert ties(model(first, 0.0 * first, 0.0 * first), DATA) == []


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_direction_is_named_by_its_large_components_the_largest_of_which_is_positive(sign):
    """Seen nowhere along (0.6, -0.75, 0.28), with a small part that is not said."""
    vector = np.array([0.6, -0.75, np.sqrt(1.0 - 0.36 - 0.5625)])
    assert 0.1 < vector[2] < 0.3
    information = 4.0 * (np.eye(3) - np.outer(sign * vector, sign * vector))
    (found,) = unseen_directions(SimpleNamespace(information=information, model=SimpleNamespace(parameter_names=NAMES)))
    assert str(found) == "- 0.60 K1 + 0.75 C5"
    assert _signed(sign * vector) == pytest.approx(-vector)
    assert found.components == pytest.approx(dict(zip(NAMES, -vector, strict=True)), abs=1e-9)
    assert found.seen == pytest.approx(0.0, abs=1e-6)


def test_what_tests_determine_are_sums_of_the_tied_ones_per_motor():
    """K3 acts at every motor of the shaft on its part of the load, C6 once on all of it."""
    names = ("K1", "K2", "K3", "K4", "K5", "C1", "C2", "C3", "C4", "C5", "C6")
    found = identifiable(SimpleNamespace(parameter_names=names), 250.0, 11)
    rows = {title: {names[k]: row[k] for k in np.flatnonzero(row)} for title, row in found.items()}
    assert rows["C6 + K3/(i N)"] == {"C6": 1.0, "K3": pytest.approx(1.0 / 2750.0)}
    assert (rows["K1 + C5"], rows["K4 + C2"]) == ({"K1": 1.0, "C5": 1.0}, {"K4": 1.0, "C2": 1.0})
    assert all(rows[name] == {name: 1.0} for name in ("K2", "K5", "C1", "C3", "C4"))
