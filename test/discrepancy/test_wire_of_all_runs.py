"""Whether a wire gives is decided by all runs, also where the model is fitted to some of them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from campaign.gap_hard_cases import all_cases, runs_of
from campaign.rig import make_dataset
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.expansion import meet
from winch_friction.discrepancy.preparation.prepare import prepare, rung_out
from winch_friction.discrepancy.preparation.suspended_load import STILL, Mode, heavy_by_tune, swinging_mass
from winch_friction.discrepancy.preparation.wire_mode import DAMPING_RATIOS
from winch_friction.discrepancy.preparation.wires import ASKED, ringing_damping, swinging_along
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import BAR
from winch_friction.physics.signals import Run


@pytest.mark.long
def test_a_model_is_fitted_to_a_load_that_swings_as_all_runs_say_it_does(crane_150t, crane2_model):
    """Three of six runs tell a swing, of the four to learn from one: fitted to a rigid wire the model would be wrong by
    six times the noise."""
    (case,) = [each for each in all_cases(quick=False) if each.seed == 300_165]
    runs = runs_of(case)
    every = meet(runs, crane_150t, crane2_model)
    some = every.only([run.name for run in runs[:2]])
    assert [run.name for run in some.prepared] == [run.name for run in some.runs] == [run.name for run in runs[:2]]
    assert some.prepared == every.prepared[:2]
    result = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    assert result.verdict == "nothing_missing"
    held = result.holdout
    assert held.size_after.value < 1.5 * held.noise_floor


def test_a_swing_from_before_the_record_hides_no_wire(crane_150t, crane2_model):
    """A record cut out of a motion: what rings down at its beginning is larger than all that the motion excites."""
    columns = dict(make_dataset(77, "elastic_still", ())[6])
    told = prepare(Run("r", columns), crane_150t, crane2_model).wire_mode
    since = columns["time"] - columns["time"][0]
    ringing = 20.0 * BAR * np.exp(-0.06 * told.frequency * since) * np.cos(told.frequency * since)
    cut_out = Run("r", {**columns, "main.pressure_a": columns["main.pressure_a"] + ringing})
    found = prepare(cut_out, crane_150t, crane2_model)
    assert told.damping == pytest.approx(0.06, abs=0.01)
    assert found.wire_mode.damping == pytest.approx(told.damping, rel=0.1)


@pytest.mark.parametrize(("mode", "louder", "left_out"), [
    (Mode(8.0, 0.0), 10.0, 10.0), (Mode(8.0, 0.0), 1.0, 0.0), (Mode(8.0, 0.05), 10.0, 0.0), (Mode(0.0, 0.0), 10.0, 0.0),
])  # fmt: skip
def test_what_swings_at_first_alone_is_left_out_on_a_wire_that_is_taken_for_rigid(mode, louder, left_out):
    time = np.arange(0.0, 100.0, 0.02)
    gap = np.random.default_rng(1).standard_normal(len(time)) * np.where(time < 10.0, louder, 1.0)
    kept = rung_out(SimpleNamespace(time=time), mode, gap, np.ones(len(time), bool))
    assert time[kept][0] == pytest.approx(left_out, abs=0.1)


def heavy_wire(columns, share):
    """A run whose load swings as if two thirds of its wire's mass, `share` of what hangs, lay still: nothing is changed
    but what the load cell and the crane file say, in kg/m and N."""
    mass, length = float(np.median(columns["hook_load"])), float(np.median(columns["wire_out"]))
    return {"wire_mass": share * mass / length, "softer": 1.0 - STILL * share}


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_of_a_heavy_wire_a_third_swings_with_the_load(crane_150t, crane2_model, share):
    """Nulls of a 250 t crane at 2000 m kept 2 to 4 bar: a load with all its wire's mass swings a fifth too slowly."""
    columns = dict(make_dataset(77, "elastic_still", ())[6])
    stated = heavy_wire(columns, share)
    own = replace(
        crane_150t, wire_mass=stated["wire_mass"], wire_stiffness=crane_150t.wire_stiffness * stated["softer"]
    )
    (as_it_is,) = meet([Run("r", columns)], crane_150t, crane2_model).prepared
    (found,) = meet([Run("r", columns)], own, crane2_model).prepared
    assert found.wire_mode.frequency == pytest.approx(as_it_is.wire_mode.frequency, rel=0.005)


def test_a_wire_that_the_load_cell_does_not_feel_swings_with_nothing(crane_150t, crane2_model):
    """A simulated load hangs on a wire without mass whatever the crane file says."""
    columns = dict(make_dataset(77, "elastic_still", ())[6])
    own = replace(crane_150t, wire_mass=heavy_wire(columns, 0.5)["wire_mass"])
    found, as_it_is = (meet([Run("r", columns)], each, crane2_model).prepared[0] for each in (own, crane_150t))
    assert found.wire_mode == as_it_is.wire_mode


@pytest.mark.parametrize(("wire", "swings"), [(0.0, 1.0), (0.3, 0.8), (0.89, 1.0 - 0.89 * STILL), (1.5, 1.0)])
def test_a_wire_heavier_than_what_hangs_is_not_weighed_by_the_cell(wire, swings):
    assert swinging_mass(100e3, wire * 100e3) == pytest.approx(swings * 100e3)


@pytest.mark.parametrize(("share", "heavy"), [(0.08, False), (0.12, True)])
def test_a_wire_is_heavy_whose_part_that_hangs_still_is_a_tenth_of_what_swings(share, heavy):
    """Of two thirds of it: 400 m of a wire of 3 kg/m with 8 t."""
    crane, asked = SimpleNamespace(wire_mass=3.0, wire_stiffness=1e8), []
    length = np.array([share * 8e3 / (STILL * 3.0)])
    run = SimpleNamespace(swinging=8e3, channels={"wire_out": length}, swing_left=(0.8,), swing_noise=False,
                          swing_variance=1.0, wire_mode=Mode(1.0, 0.0))  # fmt: skip
    swinging_along([run], crane, lambda k, wire: asked.append(wire) or run)
    assert asked == [pytest.approx(share * 8e3 / STILL)] * heavy


@pytest.mark.parametrize(("telling", "along"), [(6, True), (2, True), (0, False)])
def test_the_runs_that_swing_most_say_whether_a_heavy_wire_swings_along(telling, along):
    """Each costs a preparation: of eight six are asked, and the others follow only where these say so.

    Heave compensation that hardly moves its load, with an inertia that is wrong, "swings" most and tells nothing: what
    two others say counts. An elastic 150 t winch was taken for a rigid one, with 8 bar of swing.
    """
    crane = SimpleNamespace(wire_mass=10.0, wire_stiffness=1e8)
    loudest = [1, 3, 5, 4, 2, 7]

    def swinging(left, variance):
        return SimpleNamespace(swinging=1e4, channels={"wire_out": np.array([500.0])}, swing_left=(left,),
                               swing_noise=False, swing_variance=variance, wire_mode=Mode(1.0, 0.0))  # fmt: skip

    before = [swinging(0.8, variance) for variance in (1.0, 6.0, 2.0, 5.0, 3.0, 4.0, 0.5, 1.5)]
    asked = []

    def again(k, wire):
        asked.append(k)
        assert wire == 5000.0
        return swinging(0.6 if k in loudest[6 - telling :] else 0.8, before[k].swing_variance)

    after = swinging_along(before, crane, again)
    assert asked[:ASKED] == loudest
    assert sorted(asked) == (list(range(8)) if along else sorted(loudest))
    assert [own is not was for own, was in zip(after, before, strict=True)] == [along] * 8


@pytest.mark.parametrize(("still", "along"), [(STILL, True), (0.0, False), (0.4, False), (0.42, False)])
def test_loads_that_ring_by_one_stiffness_say_whether_a_heavy_wire_swings_along(still, along):
    """Each run's own frequency makes up for the mass that is wrong, so that none swings less by another one; but of a
    25 t winch at 10 Hz the longest wires then gave all runs a stiffness 7 % too large, and a null kept 9 of 2 N m."""
    crane = SimpleNamespace(wire_mass=5.4, wire_stiffness=6e7)
    left = tuple(0.02 + abs(np.log(ratio / 0.04)) for ratio in DAMPING_RATIOS)

    def ringing(length, mass):
        own = float(np.sqrt(6e7 / length / (mass - still * 5.4 * length)))
        return SimpleNamespace(swinging=mass, channels={"wire_out": np.array([length])}, swing_left=left,
                               swing_noise=False, swing_variance=100.0, wire_mode=Mode(own, 0.04))  # fmt: skip

    runs = [ringing(*each) for each in [(750.0, 25e3), (850.0, 23e3), (250.0, 13e3), (230.0, 18e3), (470.0, 22e3)]]
    changed = [
        own is not was
        for own, was in zip(swinging_along(runs, crane, lambda k, _: ringing(900.0, 25e3)), runs, strict=True)
    ]
    assert changed == [along] * 5
    for count in (2, 3):  # of 100 t three hoists alone rang, 15 bar, beside nine runs in a sea that none resounds to
        few = runs[1:][:count]
        after = swinging_along(few, crane, lambda k, _: ringing(900.0, 25e3))
        assert (after == few) == (not along or count < 3)


def test_loads_that_ring_by_one_stiffness_as_they_are_ask_no_heavier_wire():
    """A friction that rises at low speed made a heavy wire leave a fifth less of some swings; loads whose frequencies
    one stiffness gave to a percent then rang by another mass each, 5 bar where the effect was 2."""
    crane = SimpleNamespace(wire_mass=5.4, wire_stiffness=6e7)
    left = tuple(0.02 + abs(np.log(ratio / 0.04)) for ratio in DAMPING_RATIOS)

    def ringing(length, mass, less=1.0):
        return SimpleNamespace(swinging=mass, channels={"wire_out": np.array([length])}, swing_noise=False,
                               swing_left=tuple(less * each for each in left), swing_variance=100.0,
                               wire_mode=Mode(float(np.sqrt(6e7 / length / mass)), 0.04))  # fmt: skip

    runs = [ringing(*each) for each in [(750.0, 25e3), (850.0, 23e3), (250.0, 13e3), (230.0, 18e3), (470.0, 22e3)]]
    assert swinging_along(runs, crane, lambda k, _: ringing(900.0, 25e3, 0.5)) == runs


@pytest.mark.parametrize(("astray", "along"), [(0.03, True), (0.015, None)])
def test_loads_that_are_in_tune_already_ask_for_no_other_mass(astray, along):
    """By less than a load is followed for, a third of the wire is no news, however well it fits."""
    heavier = 1.5 * (1.0 - np.exp(-2.0 * astray))
    length, hanging, wire = np.full(2, 1000.0), np.full(2, 10e3), np.array([0.0, heavier * 10e3])
    swinging = np.array(list(map(swinging_mass, hanging, wire)))
    frequency = np.sqrt(1e8 / length / swinging)
    assert np.std(np.log(frequency**2 * length * hanging)) == pytest.approx(astray, rel=1e-6)
    assert heavy_by_tune(frequency, length, hanging, wire) is along
    swing_in_tune = np.sqrt(1e8 / length / hanging)
    assert heavy_by_tune(swing_in_tune, length, hanging, wire) is (None if along is None else False)


def test_runs_that_follow_no_mode_do_not_say_whether_it_is_one_damper_or_one_ratio():
    """Four hoists ring by one ratio. Of heave compensation whose load swings by no mode any damping makes more, most
    the sharpest: it "agreed" with one damper, which damps a light load more, and the hoists kept twice as much."""
    tells = tuple(0.03 + np.log(ratio / 0.017) ** 2 for ratio in DAMPING_RATIOS)
    follows_none = tuple(1.0 + 6.0 * (0.01 / ratio) ** 2 for ratio in DAMPING_RATIOS)
    hoists = [(2.1, 0.017, 125e3), (3.5, 0.0165, 90e3), (2.0, 0.0175, 115e3), (3.0, 0.017, 140e3)]
    modes = [*hoists, (2.9, 0.3, 30e3), (3.5, 0.28, 40e3), (2.7, 0.3, 20e3)]
    left = [tells] * 4 + [follows_none] * 3
    length = [3e8 / (own**2 * mass) for own, _, mass in modes]
    agreed, _ = ringing_damping(modes, left, length, [200.0] * 4 + [20.0] * 3)
    assert [agreed(own, mass) for own, _, mass in modes] == pytest.approx([0.017] * 7)
