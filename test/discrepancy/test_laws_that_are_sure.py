"""Which laws of the grammar are worth proposing, and which names a finding is said to share its place with."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import proposals as module
from winch_friction.discrepancy import ties
from winch_friction.discrepancy.candidates.candidate import Candidate, Shape
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import Explanation
from winch_friction.discrepancy.engine.grammar import Factor, Law, Scored
from winch_friction.discrepancy.engine.selection import Finding
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction.term import Parameter
from winch_friction.records.model_file import load_model

SEGMENTS, BEFORE, FLOOR = 40, 1000.0, 400.0
SHORT = Law((Factor("linear", "wire_out"),), opposing=True)
LONG = Law((Factor("above", "motor_speed", (("c", 90.0),)), Factor("wave", "wire_out", (("c", 9.0), ("h", 3.0)))), True)


def explained(slots, loss, scatter=0.0):
    losses = np.full(SEGMENTS, loss / SEGMENTS) + scatter * np.tile([1.0, -1.0], SEGMENTS // 2)
    return Explanation(tuple(slots), losses, np.zeros(0), loss, np.zeros((0, 0)))


def scored(law, loss, scatter=0.0):
    return Scored(law, 1.0, loss, loss, explained((), loss, scatter).losses)


def sure_laws(monkeypatch, *ranked):
    """Of laws that a search of the grammar has found, the best first."""
    monkeypatch.setattr(module, "Grammar", lambda *_: SimpleNamespace(search=lambda *_: list(ranked)))
    monkeypatch.setattr(module, "_tuned", lambda _, each, *__: each)
    monkeypatch.setattr(module, "WORDS", ())
    blocks = SimpleNamespace(run=np.zeros(3, int), y=np.zeros(3), direction=np.ones(3))
    cross = SimpleNamespace(
        problem=SimpleNamespace(blocks=blocks), explain=lambda _: explained((), BEFORE), floor=FLOOR
    )
    runs = [SimpleNamespace(unit_torque=2.0, groups=(), time=np.array([0.0, 60.0]))]
    found = module._sure_laws(SimpleNamespace(cross=cross), runs, np.random.default_rng(0))
    return [(each.law, each.loss) for each, _ in found]


@pytest.mark.parametrize(("left", "worth"), [(830.0, False), (810.0, True)])
def test_a_law_is_worth_saying_from_three_tenths_of_what_is_above_the_noise(monkeypatch, left, worth):
    """Of the 600 above it 170 are too few, 190 are enough."""
    assert bool(sure_laws(monkeypatch, scored(SHORT, left))) is worth


@pytest.mark.parametrize(("left", "beside"), [(750.0, True), (770.0, False)])
def test_beside_the_best_law_stands_what_closes_four_fifths_of_what_it_does(monkeypatch, left, beside):
    found = sure_laws(monkeypatch, scored(LONG, 700.0), scored(SHORT, left))
    assert (SHORT, left) in found or not beside
    assert len(found) == 1 + beside


def test_a_short_law_comes_before_a_long_one_that_leaves_little_less(monkeypatch):
    assert [law for law, _ in sure_laws(monkeypatch, scored(LONG, 700.0), scored(SHORT, 720.0))] == [SHORT, LONG]


@pytest.mark.parametrize(("scatter", "sure"), [(1.0, True), (200.0, False)])
def test_a_law_that_helps_half_of_the_segments_and_harms_the_others_is_not_sure(monkeypatch, scatter, sure):
    assert bool(sure_laws(monkeypatch, scored(SHORT, 700.0, scatter))) is sure


def test_nothing_found_is_nothing_sure(monkeypatch):
    assert sure_laws(monkeypatch) == []


@pytest.mark.parametrize("closely", [False, True])
def test_a_proposal_is_looked_at_closer_than_what_a_name_is_held_against(monkeypatch, closely):
    asked, moved = [], Law((Factor("step", "wire_out", (("c", 9.0),)),), opposing=True)
    blocks = SimpleNamespace(run=np.zeros(3, int), y=np.zeros(3), direction=np.ones(3))
    cross = SimpleNamespace(
        problem=SimpleNamespace(blocks=blocks), explain=lambda _: explained((), BEFORE), floor=FLOOR
    )
    runs = [SimpleNamespace(name="a", unit_torque=2.0, groups=(), time=np.array([0.0, 60.0]))]
    found = SimpleNamespace(search=lambda values, fit: asked.append((values, fit)) or [scored(SHORT, 700.0)])
    monkeypatch.setattr(module, "Grammar", lambda *_: found)
    monkeypatch.setattr(module, "WORDS", ())
    monkeypatch.setattr(module, "closer", lambda *_: ["closer"])
    monkeypatch.setattr(module, "evaluated", lambda wanted, *_: wanted)
    monkeypatch.setattr(module, "_tuned", lambda _, each, *__: each)
    monkeypatch.setattr(module, "fitted", lambda _, each, runs, most: (scored(moved, 650.0), {}))
    search = SimpleNamespace(cross=cross, expansion=SimpleNamespace(runs=runs))
    if closely:
        laws = [each.law for each, _ in module._laws(search, runs, np.random.default_rng(0))]
    else:
        laws = [each.law for each in module.near_laws(search, ("a",), np.random.default_rng(0))]
    ((values, fit),) = asked
    assert values == (["closer"] if closely else [])
    assert (fit is not None) is closely
    assert laws == [moved if closely else SHORT]


def test_no_more_laws_are_looked_at_closer_than_so_many(monkeypatch):
    many = [scored(SHORT, 700.0 + k) for k in range(LIMITS.grammar_judged + 5)]
    assert len(sure_laws(monkeypatch, *many)) == LIMITS.grammar_judged


# -- names that are tied
e = Parameter("e", "1", 0.1)


def slot_of(name, column, label="all layers"):
    return Slot(name, label, (column,), origin=(Candidate(name, linear=(e,)), Shape(label, {})))


RADIUS, WEAR, DRAG = slot_of("layer_radius", 0), slot_of("wear_drift", 1), slot_of("brake_drag", 2)
PRESSURE = slot_of("pressure_scale", 3, "all groups, both ports")


def company_of(monkeypatch, found, losses, size=2.0):
    """The company of a finding, where each name alone leaves so much, and nothing, or a name of which nothing is said,
    leaves 1000; each has the same size."""
    at = {"load_scale": 4, "displacement_scale": 5}

    def layout_of(_, fixed, *__):
        slots = [Slot(c.name, "", (at.get(c.name, k),), origin=(c, None)) for k, c in enumerate(fixed)]
        return SimpleNamespace(slots=tuple(slots))

    def explain(slots):
        beta = np.array([size])
        left = losses.get(slots[-1].name, 1000.0) if slots else 1000.0
        return Explanation(tuple(slots), np.full(SEGMENTS, left / SEGMENTS), beta, left, np.zeros((0, 0)))

    cross = SimpleNamespace(
        explain=explain, covariance=lambda _: np.array([[0.01]]),
        problem=SimpleNamespace(layout=SimpleNamespace(scales=np.ones(6))),
    )  # fmt: skip
    monkeypatch.setattr(ties, "layout_of", layout_of)
    monkeypatch.setattr(ties, "build_problem", lambda *_, **__: None)
    monkeypatch.setattr(ties, "CrossFit", lambda _: cross)
    monkeypatch.setattr(ties, "_shape_of", lambda candidate, member, runs: Shape(member.label, {}))
    search = SimpleNamespace(
        expansion=SimpleNamespace(
            model=load_model("a6vm215_crane2"), runs=(), layout=SimpleNamespace(base=None)
        ),
        train=(), selection=SimpleNamespace(final=SimpleNamespace(slots=(found.slot,))),
    )  # fmt: skip
    return ties.company(search, found)


def finding(own, *rivals, left_out=()):
    return Finding(own, rivals, 0.0, 0.1, 1.0, left_out)


@pytest.mark.parametrize(("left", "tied"), [(101.0, True), (400.0, False)])
def test_what_no_search_looks_for_joins_the_finding_that_it_is_tied_to_where_it_does_as_well(monkeypatch, left, tied):
    losses = {"pressure_scale": 100.0, "displacement_scale": left}
    own = company_of(monkeypatch, finding(PRESSURE), losses)
    assert own.rivals == (("displacement_scale",) if tied else ())
    assert [each.name for each in own.partners] == list(own.rivals)


def test_of_rivals_and_what_is_tied_to_the_finding_the_best_have_room(monkeypatch):
    losses = {"pressure_scale": 100.0, "displacement_scale": 101.0, "wear_drift": 103.0, "brake_drag": 102.0}
    own = company_of(monkeypatch, finding(PRESSURE, WEAR, DRAG, left_out=("coulomb",)), losses)
    assert own.rivals == ("displacement_scale", "brake_drag")
    assert own.no_room == ("wear_drift", "coulomb")


@pytest.mark.parametrize(("left", "rivals", "without"), [
    (99.0, ("displacement_scale", "pressure_scale"), "brake_drag"),
    (103.5, ("pressure_scale", "displacement_scale"), "brake_drag"),
    (105.0, ("pressure_scale", "brake_drag"), "displacement_scale"),
])  # fmt: skip
def test_what_is_tied_to_a_rival_has_room_where_it_is_among_the_best(monkeypatch, left, rivals, without):
    """A gain of the displacement feedback, fitting best of all, had no room beside two other names, twice in two
    draws."""
    losses = {"wear_drift": 100.0, "pressure_scale": 103.0, "displacement_scale": left, "brake_drag": 104.0}
    crowded = company_of(monkeypatch, finding(WEAR, PRESSURE, DRAG), losses)
    assert (crowded.rivals, crowded.no_room) == (rivals, (without,))
    assert [each.name for each in crowded.partners] == [name for name in rivals if name == "displacement_scale"]
    alone = company_of(monkeypatch, finding(WEAR, PRESSURE), losses)
    assert set(alone.rivals) == {"pressure_scale", "displacement_scale"}


def test_what_shows_as_a_product_with_the_finding_takes_no_rivals_room(monkeypatch):
    """A wrong radius and a wrong load are one on any runs: two other causes say more."""
    losses = {"layer_radius": 100.0, "load_scale": 100.0, "wear_drift": 103.0, "brake_drag": 102.0}
    own = company_of(monkeypatch, finding(RADIUS, WEAR, DRAG), losses)
    assert own.rivals == ("brake_drag", "wear_drift")
    assert own.no_room == ("load_scale",)


ASYMMETRY = slot_of("gear_asymmetry", 0, "one direction alone")


@pytest.mark.parametrize("found", [slot_of("layer_radius", 0, "the same depth"), PRESSURE, ASYMMETRY])
@pytest.mark.parametrize(("left", "size", "tied"), [
    (230.0, 0.005, True), (240.0, 0.005, False), (230.0, -0.019, True), (230.0, -0.021, False), (100.0, 0.03, False),
])  # fmt: skip
def test_a_load_cell_that_is_a_little_off_may_be_what_closes_nearly_as_much(monkeypatch, found, left, size, tied):
    """Cells that were all half a per cent high were a gear's asymmetry, and a radius, alone: no name says that a cell
    is right to a thousandth."""
    own = company_of(monkeypatch, finding(found), {found.name: 100.0, "load_scale": left}, size)
    assert own.rivals == (("load_scale",) if tied else ())


def test_a_load_cell_takes_no_room_from_what_is_an_effect(monkeypatch):
    losses = {"gear_asymmetry": 100.0, "load_scale": 90.0, "wear_drift": 103.0, "brake_drag": 102.0}
    own = company_of(monkeypatch, finding(ASYMMETRY, WEAR, DRAG), losses, 0.005)
    assert (own.rivals, own.no_room) == (("brake_drag", "wear_drift"), ("load_scale",))


def test_a_tie_of_one_layer_is_none_of_all(monkeypatch):
    """One layer's radius is no error of the load, which all layers show."""
    one = company_of(monkeypatch, finding(slot_of("layer_radius", 0, "layer 2"), PRESSURE), {
        "layer_radius": 100.0, "pressure_scale": 101.0, "displacement_scale": 500.0, "load_scale": 100.0,
    })  # fmt: skip
    assert one.rivals == ("pressure_scale",)
