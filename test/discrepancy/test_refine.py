"""Finer shapes around the one that was found."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.candidates.candidate import Shape
from winch_friction.discrepancy.candidates.families import CURVES, SURFACES, free_members, name_of
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.search import _refined
from winch_friction.physics.friction.symbols import WINCH_SIGNALS


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


def law(name):
    return next(each for each in all_candidates() if each.law_name == name)


def driven(fastest=200.0, oil=40.0):
    """A run with these speeds and this oil."""
    speed = np.linspace(-fastest, fastest, 500)
    top = float(np.percentile(np.abs(speed), 99))
    return SimpleNamespace(speed=speed, top_speed=top, channels={"oil_temperature": np.full(500, oil)})


@pytest.mark.parametrize(("name", "fastest", "most"), [
    ("notch_power", 120.0, 120.0), ("notch_any_stroke", 170.0, 170.0), ("stribeck_gauss", 60.0, 30.0),
])  # fmt: skip
def test_a_laws_own_speed_is_one_that_the_runs_have_seen(name, fastest, most):
    """A notch's maximum, and half as far the width of a Stribeck curve: beyond it the law has lost its shape. On the
    grid, and finer."""
    runs = [driven(fastest)]
    own = law(name)
    finer = own.refined(own.shapes(runs)[-1]).shapes(runs)
    speeds = [v for each in finer for k, v in each.values.items() if k.startswith(("w_", "v_"))]
    assert 0.75 * most < max(speeds) < most


@pytest.mark.parametrize(("oil", "widest"), [(20.0, 32.0), (40.0, 8.0), (60.0, None)])
def test_a_stribeck_curve_that_follows_the_oil_is_one_at_the_oil_of_the_runs(oil, widest):
    """Where the model's terms hold at 15 degC and the oil is at 60, it is nine times as wide as it says: wider than all
    that was driven, what is left of it goes with the load, whatever the viscosity."""
    kept = [each.values for each in law("viscosity_hersey").shapes([driven(100.0, oil)])]
    assert max((v["C4_h"] for v in kept if v["T_vh"] == 15.0), default=None) == widest
    assert max(v["C4_h"] for v in kept if v["T_vh"] == 50.0) == 32.0


def test_every_curve_and_surface_has_a_name_of_its_own():
    """By it a slot is found again, and a table in a model file."""
    names = [name_of(row) for row in (*CURVES, *SURFACES)]
    assert sorted(names) == sorted(set(names))


def covered():
    """A run that has seen every speed, load and displacement of a small winch."""
    n = 600
    speed = np.linspace(1.0, 200.0, n)
    index = {each.name: k for k, each in enumerate(WINCH_SIGNALS)}
    point = [np.ones(n) for _ in WINCH_SIGNALS]
    point[index["speed_magnitude"]], point[index["drum_torque"]] = speed, 1e3 * speed
    point[index["time"]] = 1.7e9 + 1e5 * speed
    return SimpleNamespace(
        used=np.ones(n, bool), time=speed, point=point, groups=[], drum_torque=1e3 * speed, gear_ratio=100.0,
        constants=(),
    )  # fmt: skip


@pytest.mark.parametrize("row", [row for row in CURVES if row.cause in ("gear_load_loss", "wear_drift", "stribeck")])
def test_a_curve_that_was_found_bends_in_twice_as_many_places(row):
    """What a coarse curve leaves of its own cause must not pass for a second one."""
    (coarse,) = free_members([covered()], SimpleNamespace(term_names=()), [row])
    fine = coarse.refined(coarse.shapes([])[0])
    (_, few), (_, many) = coarse.term.table.knots[0], fine.term.table.knots[0]
    assert set(few) < set(many)
    assert len(many) == 2 * len(few) - 1
    assert (fine.name, fine.law_name, fine.free) == (coarse.name, coarse.law_name, True)
    assert fine.refined(fine.shapes([])[0]) is fine


@pytest.mark.parametrize(("found", "free", "finer"), [
    ("sheave_bending", True, {"gear_load_loss", "sheave_bending"}),
    ("gear_load_loss", True, {"gear_load_loss", "sheave_bending"}),
    ("sheave_bending", False, {"sheave_bending"}),
    ("churning", True, {"churning"}),
])  # fmt: skip
def test_what_the_load_tells_of_the_gear_is_drawn_as_finely_of_the_sheaves(found, free, finer):
    """The one with more places to bend would leave less, and its twin would be no rival of it."""
    names = ("gear_load_loss", "sheave_bending", "churning")
    candidates = [
        SimpleNamespace(name=name, law_name=f"free_{name}", refined=lambda shape, name=name: name) for name in names
    ]
    slot = SimpleNamespace(name=found, law=f"free_{found}", free=free, origin=(None, Shape("")))
    assert {each for each in _refined(candidates, [slot]) if isinstance(each, str)} == finer


@pytest.mark.parametrize(
    "name", ["port_power", "line_pressure_power", "viscosity_each_way", "low_displacement_each_way"]
)
def test_no_law_is_refined_beyond_what_its_parameters_may_be(name):
    """A port's loss with the root of the displacement is churning, and in the file its exponent would be cut to 1."""
    own = law(name)
    bounds = {p.name: (p.lower, p.upper) for p in own.term.parameters}
    shapes = [shape for at in own.shapes([]) for shape in own.refined(at).shapes([])]
    for k in own.continuous:
        tried = [shape.values[k] for shape in shapes]
        assert bounds[k][0] <= min(tried)
        assert max(tried) <= bounds[k][1]
        assert len(set(tried)) > len({shape.values[k] for shape in own.shapes([])})
