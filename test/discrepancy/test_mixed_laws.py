"""Causes that no single line of the catalogue says: a mixture of two laws, a long delay, an inertia behind a swing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gap_rig import gap_of, names_of, runs_with

from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.candidates.candidate import BALANCING, ParameterEstimate, Shape, Sides
from winch_friction.discrepancy.candidates.feedback import bowed_columns, feedback_candidates
from winch_friction.discrepancy.candidates.lateness import DELAY, SPEED
from winch_friction.discrepancy.candidates.signals import signal_candidates
from winch_friction.discrepancy.detectors.delay import without_delay
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.estimates import agreed, in_file, of_part, together
from winch_friction.discrepancy.expansion import as_rigid, meet, swings
from winch_friction.discrepancy.preparation.suspended_load import Mode
from winch_friction.discrepancy.preparation.wires import agreed_modes
from winch_friction.discrepancy.proof import at_the_floor
from winch_friction.discrepancy.regressors import key_of
from winch_friction.discrepancy.search import long_delay
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.corrections import corrected
from winch_friction.physics.friction.correction import Correction
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model, save_model


@pytest.mark.long
def test_a_mixture_of_two_laws_of_a_cause_is_one_name():
    found = gap_of(910, "quiet", ("layer_radius:one_layer", 1.0), ("layer_radius:rope_sinks_in", 0.7))
    assert [each.name for each in found.effects] == ["layer_radius"]
    assert found.effects[0].rivals == ()
    assert found.holdout.size_after.value < 0.05 * found.holdout.size_before.value
    assert len(found.effects[0].parameters) > 1  # the step of the layers, and what the load does


@pytest.mark.long
@pytest.mark.parametrize(
    ("seed", "flavour", "passive", "driving"),
    [(4408, "quiet", 4.0, 1.0), (4408, "quiet", -2.5, 2.0), (4408, "quiet", 5.0, 2.0), (4411, "paper", -2.5, 2.0)],
)
def test_two_feedbacks_with_a_zero_each_are_one_cause_and_two_numbers(
    seed, flavour, passive, driving, crane_150t, crane2_model
):
    """What the passive group's feedback shows too much, cm^3, and the driving one's: neither is the other's."""
    zeros = {
        group: CM3_PER_REV * (passive if group == "passive" else driving) for group in ("passive", "main", "active")
    }
    runs = [
        replace(run, columns={
            name: values + zeros[name.partition(".")[0]] if name.endswith(".displacement") else values
            for name, values in run.columns.items()
        })
        for run in runs_with(seed, flavour)
    ]  # fmt: skip
    found = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    # losses that go by the rope's true tension are tolerated: beside them a gain of the pressures may do as well
    assert [names - {"pressure_scale"} for names in names_of(found)] == [{"swivel_offset"}]
    assert at_the_floor(found.holdout)
    for group, zero in zeros.items():
        own = [each for each in found.model.corrections if group in each.groups or not each.groups]
        zeros_found = [each for each in own if each.name == "displacement_offset"]
        assert sum(each.value for each in zeros_found) == pytest.approx(zero, abs=0.05 * CM3_PER_REV), group
        assert all(abs(each.value) < 2.0 * each.std for each in own if each not in zeros_found)  # nothing, in effect
    # what is said is what the file holds, after its last fit as well
    known = found.effects[0].parameters
    assert all(" of " in name for name in known)
    held = [each.value for each in found.model.corrections if each.name == "displacement_offset"]
    said = [each.value for name, each in known.items() if name.startswith("D_0")]
    assert sorted(said) == pytest.approx(sorted(held), rel=1e-9)


def test_estimates_of_two_parts_of_the_machine_are_not_added():
    one = {"p_0": ParameterEstimate(2e5, 3e3, "Pa")}
    both = [Slot("pressure_offset", f"the {part} group, at port A", (k,), part=part) for k, part in enumerate("ab")]
    assert of_part(both[0], both, one) == {"p_0 of the a group": one["p_0"]}
    assert of_part(both[0], both[:1], one) == one
    every = Slot("pressure_offset", "all groups", (2,))
    assert set(of_part(every, (every, both[0]), one)) == {"p_0 of all groups"}
    assert set(of_part(both[0], (every, both[0]), one)) == {"p_0 of the a group, beside that of all"}
    twice = together(one, one)  # two laws for the same part: what both of them have adds
    assert twice["p_0"].value == pytest.approx(4e5)
    assert twice["p_0"].std == pytest.approx(3e3 * np.sqrt(2.0))


def test_an_estimate_is_read_from_the_one_correction_that_says_it():
    own = {each.law_name: each for each in feedback_candidates()}
    shape = Shape("the driving group", {"groups": BALANCING})
    sides = Sides(load_crane("crane_150t"), ("main",), ("passive",))
    before = Correction("displacement_offset", 1e-7, groups=("main",))
    found = {"D_0": ParameterEstimate(2e-7, 1e-9, "m^3/rad"), "D_b": ParameterEstimate(3e-7, 1e-9, "m^3/rad")}
    slot = Slot("swivel_offset", shape.label, (0,), origin=(own[""], shape))
    places = in_file(slot, {"D_0": found["D_0"]}, sides, {key_of(before): before})
    now = Correction("displacement_offset", 3.5e-7, 2e-9, groups=("main",))
    assert places["D_0"].key == key_of(now)
    assert places["D_0"].read(now, "m^3/rad").value == pytest.approx(2.5e-7)  # beside what the model had
    assert places["D_0"].read(now, "m^3/rad").std == pytest.approx(2e-9)
    bow = Slot("swivel_offset", shape.label, (0, 1), origin=(own["bows over the stroke"], shape))
    both = in_file(bow, found, sides, {})
    bound = {"D_0": ParameterEstimate(0.9999 * 20 * CM3_PER_REV, 1e-9, "m^3/rad")}  # its step would end beyond it
    assert in_file(slot, bound, sides, {})["D_0"].factor == pytest.approx(1.0)
    assert both["D_b"] is None  # it is a gain and a curvature
    assert both["D_0"] == replace(places["D_0"], before=0.0)
    assert agreed(places, places) == places
    assert agreed(places, both)["D_0"] is None  # one of the two knew another beginning


@pytest.mark.long
@pytest.mark.parametrize("seed", [915, 916])
def test_a_loss_with_one_ports_pressure_is_named_where_either_may_be_the_higher(seed, crane_150t, crane2_model):
    runs = runs_with(seed, "bare", ("case_pressure:port_b", 1.0), length=0.3)
    found = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    (own,) = found.effects
    assert (own.name, own.rivals, own.law_name) == ("case_pressure", (), "case_ports")
    assert found.holdout.size_after.value < 0.1 * found.holdout.size_before.value
    a, b = (own.parameters[name].value for name in ("K_pA", "K_pB"))
    assert a < 0.1 * b


@pytest.mark.long
def test_a_long_delay_is_taken_out_of_the_runs():
    found = gap_of(911, "elastic_still", ("signal_delay:longer", 1.3))
    assert names_of(found) == [{"signal_delay"}]
    assert found.holdout.size_after.value < 0.1 * found.holdout.size_before.value
    assert found.model.corrections[0].value == pytest.approx(0.117, abs=0.01)


@pytest.mark.long
@pytest.mark.parametrize(("law", "delay"), [("drains", 0.0), ("settles", 0.15)])
def test_a_delay_that_goes_or_comes_to_stay_is_taken_out_of_the_runs(law, delay):
    found = gap_of(918, "elastic_still", (f"signal_delay:{law}", 1.0))
    assert names_of(found) == [{"signal_delay"}]
    assert found.holdout.size_after.value < 0.2 * found.holdout.size_before.value
    own = {each.name.rpartition("_")[2]: each for each in found.model.corrections}
    assert own["backlog"].value == pytest.approx({"drains": 0.2, "settles": -0.15}[law], abs=0.02)
    assert own["backlog"].time_constant == pytest.approx(40.0, rel=0.2)
    assert (own["delay"].value if "delay" in own else 0.0) == pytest.approx(delay, abs=0.01)


@pytest.mark.long
def test_a_delay_that_fills_up_and_starts_again_is_taken_out_of_the_runs():
    found = gap_of(917, "elastic_still", ("signal_delay:fills_up", 1.0))
    assert names_of(found) == [{"signal_delay"}]
    assert found.holdout.size_after.value < 0.2 * found.holdout.size_before.value
    (own,) = found.model.corrections
    assert own.name in ("signal_buffer", "pressure_buffer")
    assert own.value == pytest.approx(0.15, abs=0.01)
    assert 7.9 < own.time_constant < 60.2


@pytest.mark.long
def test_a_delay_of_no_known_course_is_drawn_and_its_file_takes_it_out_of_the_runs(tmp_path):
    """It goes to and fro between nothing and 150 ms, as the load of a network does: no law of the package."""
    found = gap_of(919, "elastic_still", ("signal_delay:wanders", 1.0))
    assert names_of(found) == [{"signal_delay"}]
    assert found.holdout.size_after.value < 0.2 * found.holdout.size_before.value
    (own,) = load_model(save_model(found.model, tmp_path / "model.yaml")).corrections
    time, share = np.transpose(own.course)
    at = np.linspace(0.0, 60.0, 50)
    drawn, true = own.value * np.interp(at, time, share), 0.15 * np.sin(np.pi * at / 70.0) ** 2
    assert np.sqrt(np.mean((drawn - true) ** 2)) < 0.02


def test_a_suspected_delays_column_is_what_the_runs_are_without_it(crane_150t, crane2_model):
    given = meet(runs_with(912, "quiet", ("signal_delay", 1.0), length=0.3), crane_150t, crane2_model)
    own = next(each for each in signal_candidates() if each.name == DELAY)
    late = next(each for each in own.shapes(given.prepared) if each.label == "speed late, about 100 ms")
    suspect = Slot(DELAY, late.label, (0,), origin=(own, late))
    other = SimpleNamespace(slots=())
    (exact,) = without_delay(given, [own], suspect, None, other, tuple(run.name for run in given.runs))
    assert long_delay([suspect], None, other) is suspect
    shape = next(each for each in exact.shapes(given.prepared) if each.values.get("delay") == pytest.approx(0.1))
    assert shape.values["late"] == SPEED
    model = replace(given.model, corrections=(Correction("signal_delay", 0.1),))
    after = meet(given.runs, given.crane, model).prepared
    for old, new in zip(given.prepared, after, strict=True):
        gap = np.interp(old.time + old.start, new.time + new.start, new.gap)
        np.testing.assert_allclose(0.1 * exact.columns(old, shape.values)[:, 0], old.gap - gap, atol=1e-9)
    # a small one is left to its first derivative
    small = own.shapes(given.prepared)[0]
    assert long_delay([Slot(DELAY, small.label, (0,), origin=(own, small))], None, other) is None


def test_an_inertia_that_is_wrong_does_not_hide_the_swing_of_the_load(crane_150t, crane2_model):
    runs = runs_with(913, "elastic_still", ("inertia_error", 6.0), length=0.4)
    given = meet(runs, crane_150t, crane2_model)
    assert swings(given)
    rigid = as_rigid(given)
    assert not swings(rigid)
    assert [run.name for run in rigid.prepared] == [run.name for run in given.prepared]


def test_a_bow_of_the_feedback_is_nothing_at_its_ends_and_taken_out(crane_150t, crane2_model):
    largest, bow = crane_150t.max_displacement, 0.004 * crane_150t.max_displacement
    run = runs_with(914, "quiet", length=0.3)[0]
    true = np.linspace(0.0, largest, len(run))
    x = true / largest
    logged = replace(run, columns={**run.columns, "main.displacement": true + 4.0 * bow * x * (1.0 - x)})
    own = next(each for each in feedback_candidates() if each.law_name == "bows over the stroke")
    zero, bent = (
        bowed_columns(
            SimpleNamespace(
                constants=(("max_displacement", largest),),
                groups=[SimpleNamespace(count=3, displacement=true, pressure=np.full(len(run), 1e7), balances=True)],
                time=run.time,
            ),
            {"groups": 0.0},
        )
    ).T
    np.testing.assert_allclose(zero, 3e7)
    np.testing.assert_allclose(bent[[0, -1]], 0.0, atol=1e-6)
    estimates = {
        p.name: SimpleNamespace(value=v, std=0.0, unit=p.unit) for p, v in zip(own.linear, (0.0, bow), strict=True)
    }
    shape = SimpleNamespace(values={"groups": 0.0})
    sides = Sides(crane_150t, ("main",), ())
    corrections = tuple(own.corrects(estimates, shape, sides))
    right, _ = corrected(logged, crane_150t, replace(crane2_model, corrections=corrections))
    np.testing.assert_allclose(right.columns["main.displacement"], true, atol=1e-6 * bow)


def prepared(mode, left=(), groups=1, dt=0.05, variance=1.0, noise=False, length=None):
    """What a prepared run says of its wire."""
    return SimpleNamespace(
        channels={} if length is None else {"wire_out": np.full(3, length)},
        groups=[None] * groups,
        wire_mode=mode,
        load=np.full(3, 5e4),
        swinging=5e4,
        dt=dt,
        swing_left=left,
        swing_variance=variance,
        swing_noise=noise,
    )


def damped(runs):
    return [each.damping for each in agreed_modes(runs)]


RUNG, BLURRED = (40.0,) * 11, (0.7,) * 11  # of every damping; the second swings, but reversals hide half of it


def test_runs_that_ring_down_settle_what_damps_the_wire_where_compensation_is_at_odds():
    sea = [prepared(Mode(8.0, ratio), groups=2) for ratio in (0.05, 0.07, 0.1, 0.4)]
    cycles, rigid = [prepared(Mode(8.0, 0.06)) for _ in range(6)], prepared(Mode(8.0, 0.0), groups=2)
    assert damped(sea) == [0.0] * 4
    assert damped([*sea, *cycles]) == pytest.approx([0.06] * 10)
    assert damped([*sea[:1], rigid, rigid, *cycles]) == [0.0] * 9
    unsure = prepared(Mode(8.0, 0.0), BLURRED, groups=2)
    assert damped([*sea[:1], unsure, unsure, *cycles]) == pytest.approx([0.06] * 9)


def test_a_mode_that_is_damped_like_a_filter_falls_where_other_runs_deny_it():
    """A rigid wire: in heave compensation the mode takes a motion sensor's noise out, other runs would ring by it."""
    sea = [prepared(Mode(6.0, ratio), groups=2, dt=0.01) for ratio in (0.3, 0.36, 0.4)]
    rung, blurred = (prepared(Mode(6.0, 0.0), left, dt=0.01) for left in (RUNG, BLURRED))
    assert damped([*sea, rung, rung, rung]) == [0.0] * 6
    assert min(damped([*sea, blurred, blurred, blurred])) > 0.2
    assert min(damped([*sea, rung])) > 0.2  # one alone may have another cause


def test_what_swings_in_all_of_heave_compensation_outweighs_runs_that_hardly_move_the_motors():
    """A motion sensor's noise rings on the computed wire of light loads, and damps that of others like a filter."""
    swings, filtered = (0.9, 0.5, 0.2, 0.12, 0.2, *[0.5] * 6), (1.5, 1.0, 0.8, 0.6, 0.5, *[0.4] * 6)
    heavy = [prepared(Mode(3.0, 0.05), swings, groups=2)] * 3
    others = [prepared(Mode(5.0, 0.4), filtered, groups=2, variance=0.2)] * 2
    light, loud = ([prepared(Mode(9.0, 0.0), RUNG, groups=2, variance=v)] * 3 for v in (1e-3, 1.0))
    assert damped([*heavy, *others, *light]) == pytest.approx([0.05] * 8, rel=0.11)
    assert damped([*heavy, *others, *loud]) == [0.0] * 8


def test_a_run_that_cannot_tell_has_a_wire_that_follows_its_length_unless_the_others_deny_it():
    untold = [prepared(Mode(8.0, 0.0), BLURRED)] * 2
    for told, expected in (([True] * 5, True), ([None] * 5, True), ([False] * 4 + [True], False)):
        modes = agreed_modes([*(prepared(Mode(8.0, 0.06, each), BLURRED) for each in told), *untold])
        assert [each.follows for each in modes] == [*told, expected, expected]
        assert [each.damping for each in modes] == pytest.approx([0.06] * 7)


@pytest.mark.long
@pytest.mark.parametrize(("seed", "flavour", "length"), [(4418, "quiet", 0.45), (4415, "rough", 0.6)])
def test_a_transducer_of_one_group_and_the_feedback_of_another_are_two_causes(
    seed, flavour, length, crane_150t, crane2_model
):
    """In noise a second law of the feedback does on the runs to learn from what the transducer does; the locked ones
    tell."""
    zeros = {"passive.pressure_a": -3e5}
    zeros |= {f"{group}.displacement": 2.0 * CM3_PER_REV for group in ("main", "active")}
    runs = [
        replace(run, columns={name: values + zeros.get(name, 0.0) for name, values in run.columns.items()})
        for run in runs_with(seed, flavour, length=length)
    ]
    found = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    named = {each.name: each.parameters for each in found.effects}
    assert sorted(named) == ["pressure_offset", "swivel_offset"]
    assert at_the_floor(found.holdout)
    zero, stroke = named["pressure_offset"]["p_0"].value, named["swivel_offset"]["D_0"].value
    assert zero == pytest.approx(-3e5, abs=0.3e5)
    assert stroke == pytest.approx(2.0 * CM3_PER_REV, abs=0.1 * CM3_PER_REV)


@pytest.mark.long
def test_a_span_that_shifts_with_the_oil_is_the_transducers_gain(crane_150t, crane2_model):
    """Data sheets state it beside the zero's shift; an examiner's was four effects at once, and no name."""

    def shown(run):
        gain = 1.0 + 6e-4 * (run["oil_temperature"] - 40.0)
        columns = {name: values * gain if "pressure_" in name else values for name, values in run.columns.items()}
        return replace(run, columns=columns)

    runs = [shown(run) for run in runs_with(4419, "quiet")]
    found = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    (effect,) = found.effects
    assert (effect.name, effect.law_name) == ("pressure_scale", "thermal span shift")
    assert effect.parameters["e_T"].value == pytest.approx(6e-4, rel=0.15)
    assert at_the_floor(found.holdout)
    assert "pressure_thermal_span" in {each.name for each in found.model.corrections}


@pytest.mark.long
@pytest.mark.parametrize("rate", [1.5e-3, 3e-3])  # by the second no constant delay is sure
def test_a_clock_that_drifts_is_a_delay_that_grows_in_every_run(rate, crane_150t, crane2_model):
    """Two loggers that are set when a run begins: one delay for all of it left a fifth of the gap, and no name."""

    def shown(run):
        time = run.time - run.time[0]
        late = time - rate * time
        names = [name for name in run.columns if "pressure_" in name]
        return replace(run, columns={**run.columns, **{name: np.interp(late, time, run[name]) for name in names}})

    runs = [shown(run) for run in runs_with(4421, "quiet", length=0.6)]
    found = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False, proposals=False))
    (effect,) = found.effects
    assert effect.name == "signal_delay"
    (clock,) = [each for each in found.model.corrections if each.name == "pressure_clock"]
    assert clock.value == pytest.approx(rate, rel=0.05)
    assert at_the_floor(found.holdout)


SHARP = (0.9, 0.5, 0.2, 0.12, 0.2, *[0.5] * 6)  # of a ratio of 0.05: what a load on a rope leaves
LIKE_A_FILTER = (0.6, 0.5, 0.45, 0.42, 0.4, 0.38, 0.35, 0.32, 0.3, 0.3, 0.3)
PLAIN = (3.9, 1.2, 0.2, 0.03, 0.05, 0.18, 0.35, 0.53, 0.7, 0.83, 0.9)  # where it is most of what the gap holds
STIFF = 5e4 * 9.0 * 200.0  # N: 3 rad/s of 50 t on 200 m


def ringing(off, ratio=0.05, left=SHARP, length=200.0, variance=1.0):
    """A run whose mode is so much off what the wire gives its load."""
    mode = Mode(off * float(np.sqrt(STIFF / (5e4 * length))), ratio, True)
    return prepared(mode, left, length=length, variance=variance)


@pytest.mark.parametrize(
    ("rings", "expected"),
    [
        ([ringing(1.0), ringing(1.004, length=320.0)], 0.05),
        ([ringing(1.0, 0.046), ringing(0.99, 0.054, length=90.0)], 0.05),
        ([ringing(1.0)], 0.23),  # one alone may be chance
        ([ringing(1.0, left=PLAIN)], 0.05),  # unless next to nothing of it is left
        ([ringing(1.0, left=PLAIN), ringing(1.05)], 0.23),  # nor beside one that rings as another wire
        ([ringing(1.0, left=PLAIN), prepared(Mode(3.0, 0.0), RUNG, length=200.0)], 0.23),  # nor where another denies it
        ([ringing(1.0), ringing(1.05)], 0.23),  # no wire has both
        ([ringing(1.0, 0.035), ringing(1.0, 0.07)], 0.23),  # nor both dampers
        ([ringing(1.0), ringing(1.0, left=LIKE_A_FILTER)], 0.23),  # any damping leaves as much
        ([ringing(1.0), ringing(1.0, left=tuple(3.0 * each for each in SHARP[:5]) + (1.0,) * 6)], 0.05),
        (
            [ringing(1.0), ringing(1.0, left=tuple(6.0 * each for each in SHARP[:5]) + (2.0,) * 6)],
            0.23,
        ),  # nothing rings
        ([prepared(Mode(3.0, 0.05, True), SHARP)] * 2, 0.23),  # whose length nobody logged
        (
            [*[ringing(1.0)] * 2, *[prepared(Mode(3.0, 0.0), RUNG, length=200.0)] * 2],
            0.23,
        ),  # as many say it does not give
        ([*[ringing(1.0)] * 3, *[prepared(Mode(3.0, 0.0), RUNG, length=200.0)] * 2], 0.05),
    ],
)
def test_runs_that_ring_tell_more_than_the_many_whose_sensors_seem_to(rings, expected):
    """Six seas below the mode, whose motion sensor's filter looks like a wire damped by 0.23 and 6 % softer."""
    seas = [ringing(0.94, 0.23, LIKE_A_FILTER, length) for length in (100.0, 150.0, 200.0, 250.0, 300.0, 350.0)]
    modes = agreed_modes([*seas, *rings])
    found = np.array([mode.damping for mode in modes])
    # of two whose frequencies are alike one damper or one ratio is no different; it differs for the others
    assert found == pytest.approx(expected, rel=0.5 if expected == 0.05 else 0.05)
    assert found[len(seas) :] == pytest.approx(expected, rel=0.15)
    asked = [np.sqrt(STIFF / (5e4 * run.channels["wire_out"][0])) for run in seas]
    off = np.array([mode.frequency for mode in modes[:6]]) / asked
    assert off == pytest.approx(1.0 if expected == 0.05 else 0.94, abs=0.01)
    for mode, run in zip(modes[6:], rings, strict=True):  # what rings keeps its own
        assert mode.frequency == run.wire_mode[0]


def test_a_wire_that_no_run_tells_to_give_follows_no_length_and_swings_what_it_swung():
    still = [prepared(Mode(3.0, 0.0, True)._replace(share=0.7), RUNG, length=length) for length in (100.0, 200.0)]
    assert [(*mode[:3], mode.share) for mode in agreed_modes(still)] == [(3.0, 0.0, None, 0.7)] * 2


def test_heave_compensation_that_denies_a_swing_is_outvoted_by_more_runs_that_ring():
    """Where a swing is told by runs that agree only, both of two such seas would take it away."""
    hoists = [ringing(1.0, length=length) for length in (150.0, 200.0, 300.0)]
    seas = [prepared(Mode(3.0, 0.0), RUNG, groups=2, length=200.0) for _ in range(2)]
    assert [mode.damping > 0.0 for mode in agreed_modes([*hoists, *seas])] == [True] * 5


@pytest.mark.parametrize(("variance", "rings"), [(42.0, True), (12.0, False)])
def test_what_a_motion_sensors_noise_rings_by_denies_no_load_that_swings_plainly(variance, rings):
    """On a workboat one of 12 runs swung by 6.5 bar; another's noise rang by 1 more: all were rigid, an alarm."""
    hoist = ringing(1.0, left=PLAIN, variance=variance)
    calm = [prepared(Mode(3.0, 0.0), (3.0,) * 11, length=200.0), prepared(Mode(3.0, 0.0), (0.98,) * 11, length=200.0)]
    modes = agreed_modes([hoist, *calm])
    assert [mode.damping > 0.0 for mode in modes] == [rings] * 3
    assert [mode.unheard for mode in modes] == [False, rings, False]  # in the noisy one nothing is heard of the wire


@pytest.mark.parametrize("damper", [True, False])
def test_what_all_runs_leave_tells_whether_those_that_ring_have_one_damper_or_one_ratio(damper):
    """Two of one frequency ring by 0.05; five seas at a third of it leave least by 0.15, or by 0.05 as well."""
    of_damper = (0.9, 0.8, 0.7, 0.6, 0.4, 0.15, 0.1, 0.2, *[0.5] * 3)  # of a ratio of 0.14
    seas = [ringing(1.0, 0.3 if damper else 0.28, of_damper if damper else SHARP, length=1800.0) for _ in range(5)]
    modes = agreed_modes([*seas, ringing(1.0), ringing(1.0)])
    assert [mode.damping for mode in modes] == pytest.approx([0.15 if damper else 0.05] * 5 + [0.05] * 2, rel=0.05)


@pytest.mark.parametrize(("noise", "expected"), [(True, 0.06), (False, 0.0)])
def test_a_noisy_motion_sensor_denies_no_swing_that_the_other_runs_tell(noise, expected):
    """Held loads, whose measured motion is noise at the wire's mode: it would ring there, and nothing does."""
    hoists = [prepared(Mode(5.0 + k, 0.06, False)) for k in range(4)]
    held = [prepared(Mode(7.0, 0.0), RUNG, groups=2, noise=noise) for _ in range(3)]
    modes = agreed_modes([*hoists, *held])
    assert [mode.damping for mode in modes] == pytest.approx([expected] * 7)
    assert [mode.unheard for mode in modes] == [False] * 4 + [noise] * 3


def test_a_log_that_does_not_say_how_long_its_wire_is_has_no_share_of_one_damper():
    """Runs that agree on a damper give a ratio by frequency, which that log has none of."""
    hoists = [prepared(Mode(5.0 + k, 0.3 / (5.0 + k), False)) for k in range(4)]
    modes = agreed_modes([*hoists, prepared(Mode(0.0, 0.0), RUNG, noise=True)])
    assert [mode.damping > 0.0 for mode in modes] == [True] * 4 + [False]
    assert not modes[-1].unheard
