"""How a model meets runs: which are prepared with what, what each correction would change, and what hangs unweighed."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import expansion
from winch_friction.discrepancy.expansion import Expansion, Given
from winch_friction.discrepancy.preparation.suspended_load import Mode
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import Run

RIGID, SWINGS = Mode(3.0, 0.0), Mode(3.0, 0.05)
SIX = np.arange(6.0)
MODEL = FrictionModel("m", (term_named("coulomb"),), (50.0,), np.eye(1))


@dataclass(frozen=True)
class Prepared:
    """The part of a prepared run that its way through the models is told by."""

    name: str
    gap: np.ndarray = field(default_factory=lambda: np.zeros(6))
    wire_mode: Mode = RIGID
    spikes: object = "its spikes"
    seen: object = "what was seen"
    corrections: object = None
    time: np.ndarray = field(default_factory=lambda: SIX)
    start: float = 100.0
    used: np.ndarray = field(default_factory=lambda: np.ones(6, bool))
    shared: object = None

    def sharing(self, old):
        return replace(self, shared=old)


def run(name, **columns):
    return Run(name, {"time": SIX, "hook_load": np.full(6, 3e4), **columns})


@pytest.fixture
def asked(monkeypatch):
    """What each preparation was asked with, as (run, crane, model, load, the rest by name)."""
    calls = []

    def prepare(run, crane, model, load=np.nan, known=None, turning=False, mode=None, spikes=None, seen=None, **more):
        given = {"known": known, "turning": turning, "mode": mode, "spikes": spikes, "seen": seen, **more}
        calls.append(SimpleNamespace(name=run.name, crane=crane, model=model, load=load, **given))
        return Prepared(run.name, wire_mode=mode or RIGID)

    monkeypatch.setattr(expansion, "prepare", prepare)
    return calls


def given(crane, *prepared, model=MODEL, loads=None):
    runs = tuple(run(each.name) for each in prepared)
    return Given(runs, crane, model, loads or {}, tuple(prepared))


# -- by which wire, and after whom
@pytest.fixture
def agreeing(monkeypatch):
    """All runs agree that `b` swings, and only the first look at it did not."""
    monkeypatch.setattr(expansion, "swinging_along", lambda prepared, crane, again: list(prepared))
    modes = {"a": RIGID, "b": SWINGS, "c": RIGID}
    monkeypatch.setattr(expansion, "agreed_modes", lambda first: [modes[each.name] for each in first])
    told = []
    monkeypatch.setattr(
        expansion, "with_corrections", lambda runs, crane, model, loads, prepared, names: told.append(names) or prepared
    )
    return told


def test_a_run_whose_wire_all_others_see_otherwise_is_prepared_once_more_that_way(crane_150t, asked, agreeing):
    found = expansion.meet([run(name) for name in "abc"], crane_150t, MODEL)
    assert [each.name for each in asked] == ["a", "b", "c", "b"]
    assert (asked[3].mode, asked[3].spikes, asked[3].before.name) == (SWINGS, "its spikes", "b")
    assert [each.wire_mode for each in found.prepared] == [RIGID, SWINGS, RIGID]
    assert [each.before for each in asked[:3]] == [None] * 3


@pytest.mark.parametrize(("fitted", "told"), [(None, ["a", "b", "c"]), ((), []), (("c",), ["c"])])
def test_what_corrections_would_change_is_told_of_the_fitted_runs_or_of_all(crane_150t, asked, agreeing, fitted, told):
    expansion.meet([run(name) for name in "abc"], crane_150t, MODEL, fitted)
    assert list(agreeing[0]) == told


def test_what_is_known_of_a_run_is_that_of_its_name(crane_150t, asked, agreeing):
    known = given(crane_150t, Prepared("c"), Prepared("a"))
    expansion.meet([run(name) for name in "abc"], crane_150t, MODEL, None, known)
    assert [each.before for each in asked[:3]] == [known.prepared[1], None, known.prepared[0]]


def test_met_again_are_the_runs_of_before_with_the_wires_that_they_had(crane_150t, asked, agreeing):
    before = given(crane_150t, Prepared("a", wire_mode=SWINGS), Prepared("c"))
    found = expansion.meet_again(before, [run(name) for name in "abc"], crane_150t, MODEL)
    assert [(each.name, each.mode) for each in asked] == [("a", SWINGS), ("c", RIGID)]
    assert [each.before for each in asked] == list(before.prepared)
    assert [each.name for each in found.runs] == ["a", "c"]
    assert agreeing == [["a", "c"]]


def test_met_in_turn_are_runs_one_by_one_each_by_its_own_mode_and_without_the_models_errors(crane_150t, asked):
    own = replace(MODEL, corrections=(Correction("tare_load", 500.0),))
    turn = expansion.met_in_turn(given(crane_150t, Prepared("a"), Prepared("b")), own, {"a": RIGID, "b": SWINGS})
    first = next(turn)
    assert (first.name, len(asked)) == ("a", 1)
    assert [each.wire_mode for each in turn] == [SWINGS]
    looked = expansion._corrected([run("a")], crane_150t, own)[0][0]
    assert abs(looked["hook_load"][0] - 3e4) == pytest.approx(500.0)


def test_without_the_models_errors_the_crane_has_the_inertia_that_it_gives(crane_150t):
    heavier = replace(MODEL, corrections=(Correction("inertia", 0.3),))
    runs, crane = expansion._corrected([run("a"), run("b")], crane_150t, heavier)
    assert [each.name for each in runs] == ["a", "b"]
    assert crane.inertia != crane_150t.inertia
    assert expansion._corrected([run("a")], crane_150t, MODEL)[1] is crane_150t


def test_as_rigid_only_what_swings_is_prepared_anew_and_keeps_what_was_told_of_it(crane_150t, asked):
    swinging = Prepared("b", wire_mode=SWINGS, corrections="its corrections")
    before = given(crane_150t, Prepared("a"), swinging, loads={"b": 7e3})
    assert expansion.swings(before)
    found = expansion.as_rigid(before)
    assert not expansion.swings(found)
    (call,) = asked
    assert (call.name, call.mode, call.spikes, call.seen, call.load) == (
        "b", Mode(3.0, 0.0), "its spikes", "what was seen", 7e3
    )  # fmt: skip
    assert found.prepared[0] is before.prepared[0]
    assert found.prepared[1].corrections == "its corrections"
    assert not expansion.swings(given(crane_150t, Prepared("a")))


def test_of_given_runs_only_some_are_regressed_with_what_is_known(monkeypatch):
    monkeypatch.setattr(expansion, "build_problem", lambda runs, layout, known: (runs, known))
    monkeypatch.setattr(expansion, "CrossFit", lambda problem: problem)
    layout = SimpleNamespace(slot_like=lambda slot: slot.upper())
    own = Expansion((Prepared("a"), Prepared("b"), Prepared("c")), layout, MODEL)
    runs, known = own.cross(["c", "a"], ["x"])
    assert ([each.name for each in runs], known) == (["a", "c"], ["X"])
    assert own.cross(["b"])[1] == []


# -- what corrections would change
def test_a_correction_changes_the_gap_by_its_slope_at_the_same_instants(monkeypatch, crane_150t):
    """The gap is 5 a - 3e4 b + a b and falls by 2 a second of the clock; the second run, with what it is later by, is
    prepared from a later sample on."""
    corrections = (Correction("tare_load", 100.0, 20.0), Correction("pressure_scale", 0.01, 0.002))
    model = replace(MODEL, corrections=corrections)

    def gap_of(values, clock):
        a, b = values
        return 5.0 * a - 3e4 * b + a * b - 2.0 * clock

    monkeypatch.setattr(
        expansion,
        "_corrected",
        lambda runs, crane, one: ([SimpleNamespace(name=each.name, known=one.corrections) for each in runs], crane),
    )

    def prepare(run, crane, model, load, *, mode, spikes, seen):
        assert (mode, seen) == (SWINGS, "what was seen")
        assert not spikes.any()
        start = 100.0 + (run.name == "late")
        return Prepared(run.name, gap_of([each.value for each in run.known], start + SIX), start=start)

    monkeypatch.setattr(expansion, "prepare", prepare)
    old = [Prepared(n, gap_of((100.0, 0.01), 100.0 + SIX), SWINGS) for n in ("a", "late", "silent")]
    found = expansion.with_corrections([run(each.name) for each in old], crane_150t, model, {}, old, ["a", "late"])
    np.testing.assert_allclose(found[0].corrections, np.tile([-5.01, 3e4 - 100.0], (6, 1)), rtol=1e-6)
    np.testing.assert_allclose(found[1].corrections[1:], found[0].corrections[1:], rtol=1e-6)
    assert (found[0].seen, found[2].seen) == ("what was seen", None)
    assert found[2].corrections is None
    none = expansion.with_corrections([run("a")], crane_150t, MODEL, {}, old[:1], ["a"])
    assert none[0].corrections.shape == (6, 0)


# -- around what was found
@pytest.mark.parametrize("turning", [False, True])
def test_around_an_explanation_the_base_has_moved_by_it_inside_its_bounds(monkeypatch, crane_150t, asked, turning):
    viscous = term_named("viscous")
    seed = FrictionModel("m", (term_named("coulomb"), viscous), (50.0, 1.0), np.eye(2))
    base = SimpleNamespace(parameters=2, scale=np.array([10.0, 0.5, 99.0]))
    before = Expansion(
        (Prepared("a", corrections="told", wire_mode=SWINGS, spikes=np.ones(3, bool)),),
        SimpleNamespace(base=base), seed.with_values([60.0, 1.0]),
    )  # fmt: skip
    explanation = SimpleNamespace(beta=np.array([2.0, -7.0, 5.0]))
    monkeypatch.setattr(expansion, "accounted", lambda run, layout, found: ("accounted", run.name))
    (found,), model = expansion._prepared_around(
        given(crane_150t, Prepared("a"), model=seed, loads={"a": 8e3}), before, explanation, turning
    )
    assert model.values == (80.0, seed.bounds_of(viscous.parameters[0].name)[0])
    (call,) = asked
    assert (call.known, call.turning, call.mode, call.load) == (("accounted", "a"), turning, SWINGS, 8e3)
    assert call.spikes.tolist() == [not turning] * 3
    assert call.seen == "what was seen"
    assert (found.corrections, found.shared) == ("told", before.runs[0])
    assert (found.seen is None) == turning


# -- what nobody weighed
def weighed(monkeypatch, true, follows=1.0, ways=(-1.0, 1.0), friction=400.0):
    """A run without a load: the gap is `follows` times what the tried load lacks, and friction against the motion; far
    more samples hoist than lower, and one in ten is far off."""
    direction = np.array([w for w in ways for _ in range(40 if w > 0 else 11)])
    off = np.where(np.arange(len(direction)) % 10 == 3, 5e3, 0.0)
    calls = []

    def prepare(run, crane, model, load, *, mode, spikes, seen):
        calls.append((load, seen, mode, spikes.any()))
        gap = 0.004 * GRAVITY * follows * (true - load) + friction * direction * (1.0 + load / 5e4) + off
        used = np.append(False, np.ones(len(direction), bool))
        return SimpleNamespace(
            gap=np.append(1e9, gap), used=used, radius=np.full(len(used), 0.8), direction=np.append(1.0, direction),
            seen=f"seen {len(calls)}",
        )  # fmt: skip

    monkeypatch.setattr(expansion, "prepare", prepare)
    found = expansion._estimated_load(run("a"), SimpleNamespace(gear_ratio=200.0), MODEL, None)
    return found, calls


@pytest.mark.parametrize("follows", [0.7, 1.0, 1.3])
def test_a_load_that_nobody_weighed_is_what_hoisting_and_lowering_agree_on(monkeypatch, follows):
    found, calls = weighed(monkeypatch, 2e4, follows)
    assert found == pytest.approx(2e4, rel=1e-3)
    assert len(calls) == (2 if follows == 1.0 else 6)
    assert [each[1] for each in calls[:2]] == [None, "seen 1"]  # what was seen once serves again
    assert {(each[2], each[3]) for each in calls} == {(Mode(0.0, 0.0), False)}


def test_what_hangs_weighs_no_less_than_nothing_and_one_way_alone_has_its_friction_for_weight(monkeypatch):
    assert weighed(monkeypatch, -300.0)[0] == 0.0
    one_way, _ = weighed(monkeypatch, 2e4, ways=(1.0,), friction=0.004 * GRAVITY * 100.0)
    assert one_way == pytest.approx(2e4 + 100.0 * (1.0 + one_way / 5e4), rel=1e-3)


def test_only_what_is_not_weighed_in_any_way_is_estimated_and_only_by_pressures(monkeypatch, crane_150t):
    monkeypatch.setattr(expansion, "_estimated_load", lambda run, crane, model, _: 1.0)
    runs = [Run(name, {"time": SIX, name: SIX}) for name in ("hook_load", "rope_force", "load_torque", "wire_out")]
    assert expansion.estimated_loads(runs, crane_150t, MODEL) == {"wire_out": 1.0}
    electric = SimpleNamespace(drive=SimpleNamespace(hydraulic=False))
    assert expansion.estimated_loads(runs, electric, MODEL) == {}
