"""The repaired model in the making: what is added to what, what is cut at a bound, and which step is taken."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import proposals, repair
from winch_friction.discrepancy.answer import UNEXPLAINED, Verdict
from winch_friction.discrepancy.candidates.candidate import CUT, Candidate, ParameterEstimate
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.estimates import InFile
from winch_friction.discrepancy.repair import REFITTED, REPAIRED, Repair, _changed, _Draft
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction

COULOMB = term_named("coulomb")
(C2,) = COULOMB.parameters


def drafted(std=3.0):
    return _Draft([COULOMB], {C2.name: 20.0}, {C2.name: std}, [], {})


def model(value=20.0, corrections=()):
    return FrictionModel("m", (COULOMB,), (value,), np.eye(1), {}, {}, {}, corrections, "crane")


def test_a_term_that_the_model_has_is_changed_and_both_deviations_count():
    own = drafted()
    own.add_term(None, COULOMB, {C2.name: ParameterEstimate(5.0, 4.0, "N*m")})
    assert own.at == {C2.name: 25.0}
    assert own.std == {C2.name: pytest.approx(5.0)}
    assert own.terms == [COULOMB]


def test_a_correction_that_the_model_has_is_changed_by_what_was_found():
    own = drafted()
    for value in (100.0, 30.0):
        own.add_correction(Correction("tare_load", value, 2.0))
    own.add_correction(Correction("pressure_scale", 0.01, 0.001))
    assert [(each.name, each.value) for each in own.corrections] == [("tare_load", 130.0), ("pressure_scale", 0.01)]


def test_what_is_cut_at_a_bound_says_what_it_would_have_been():
    each = Correction("pressure_scale", 0.01, 0.001, source="runs")
    upper = each.bounds[1]
    cut = _changed(each, 3.0 * upper, 0.002)
    assert cut.value == upper
    assert f"{3.0 * upper:g} {each.declared.parameter.unit}" in cut.source
    again = _changed(cut, 0.5 * upper, 0.002)
    assert (again.value, again.source) == (0.5 * upper, "runs")


@pytest.mark.parametrize(("size", "room"), [(2.0, 20.0), (0.01, 1.0), (-2.0, 20.0)])
def test_what_a_bare_model_lacks_has_room_to_move_beyond_its_usual_bound(size, room):
    """Ten times as far as it is off, and no less than usual; in upper bounds of a usual one."""
    own = drafted()
    own.at[C2.name] = size * C2.upper
    candidate = SimpleNamespace(term=COULOMB, merge=None, most_in=lambda _: LIMITS.unbounded)
    own.terms.clear()
    slot = SimpleNamespace(origin=(candidate, None))
    estimate = {C2.name: ParameterEstimate(size * C2.upper, 1.0, "N*m")}
    repair._add(own, slot, estimate, None, model(), np.ones(1))
    assert LIMITS.bare_room == 10.0
    assert own.room[C2.name] == pytest.approx((C2.lower, room * C2.upper))


@pytest.mark.parametrize(("typical", "room"), [(1.0, False), (-1.0, False), (100.0, True), (-100.0, True)])
def test_only_what_is_believed_beyond_the_usual_bound_has_room_of_its_own(typical, room):
    """A typical size may be negative, of a curve that falls; six of them are believed, and 100 N m are usual."""
    churning = term_named("churning")
    own, (amount, exponent) = drafted(), churning.parameters
    found = {amount.name: ParameterEstimate(2.0, 1.0, "N*m"), exponent.name: ParameterEstimate(1.9, 0.1, "1")}
    candidate = Candidate("churning", linear=(amount,), term=churning)
    repair._add(own, SimpleNamespace(origin=(candidate, None)), found, None, model(), np.array([typical]))
    assert own.room == ({amount.name: (amount.lower, 600.0)} if room else {})


@pytest.mark.parametrize(
    ("typical", "value", "upper", "inside"),
    [(100.0, 400.0, 600.0, 400.0), (100.0, 900.0, 600.0, 600.0), (2.5, 120.0, 100.0, 100.0)],
)
def test_a_file_holds_what_the_search_believes_of_a_machine_beyond_the_usual_bound(typical, value, upper, inside):
    """A slow motor's churning is stated at a speed three times its own: 400 N m there are 40 at its fastest."""
    churning = term_named("churning")
    own, (amount, exponent) = drafted(), churning.parameters
    candidate = Candidate("churning", linear=(amount,), term=churning)
    own_size = {amount.name: ParameterEstimate(value, 1.0, "N*m"), exponent.name: ParameterEstimate(1.9, 0.1, "1")}
    repair._add(own, SimpleNamespace(origin=(candidate, None)), own_size, None, model(), np.array([typical]))
    written = repair._model_of(own, model(), SimpleNamespace(name="crane"), {}, {})
    assert written.model.bounds_of(amount.name) == (amount.lower, upper)
    assert written.model.as_dict()[amount.name] == inside
    assert len(written.cut) == (value != inside)


def test_a_shared_ripple_is_fitted_to_the_training_runs_alone(monkeypatch):
    asked = []
    monkeypatch.setattr(repair, "in_phase", lambda runs, *_: asked.extend(runs))
    search = SimpleNamespace(
        given=SimpleNamespace(runs=["of train", "of locked"], crane=None), train=("train",),
        expansion=SimpleNamespace(runs=[SimpleNamespace(name=name) for name in ("train", "locked")]),
    )  # fmt: skip
    repair._common_wave(search, None)
    assert asked == ["of train"]


def stepping(monkeypatch, misfits, step=1.0, priors=None):
    """Polishing where each model leaves so much; the steps are all alike, and `priors` what each was asked with."""
    left, priors = iter(misfits), [] if priors is None else priors
    known = {}
    monkeypatch.setattr(repair, "meet", lambda *_: SimpleNamespace(only=lambda _: "begun"))
    monkeypatch.setattr(repair, "meet_again", lambda _, __, ___, tried: tried)

    def one_step(_, prior, __):
        priors.append(prior.values[0])
        return np.array([step]), 9.0 * np.eye(1), np.zeros(0)

    monkeypatch.setattr(repair, "_step", one_step)

    def misfit(given, beside):
        assert given is not beside, "both over the samples that both count"
        key = given if isinstance(given, str) else given.values
        if key not in known:
            known[key] = next(left)
        return known[key]

    monkeypatch.setattr(repair, "misfit", misfit)
    return repair.polished(Repair(model(), {}), model(), [], (), None).model


@pytest.mark.parametrize(
    ("misfits", "value"),
    [
        ((1.0, 1.0), 20.0),
        ((0.9, 1.0, 0.9), 21.0),
        ((0.9, 1.0, 0.95, 0.93, 0.91), 21.0),  # nor its half, nor its quarter
        ((1.5, 1.0, 0.9, 0.9), 20.5),  # which went too far
        ((1.5, 1.0, 1.2, 0.9, 0.9), 20.25),
        ((0.9, 1.0, *np.geomspace(0.8, 0.1, 9)), 30.0),
    ],
)
def test_a_step_that_does_not_shrink_the_gap_is_not_taken_though_its_uncertainty_is(monkeypatch, misfits, value):
    polished = stepping(monkeypatch, misfits)
    assert polished.values == (value,)
    assert polished.std[0] == pytest.approx(3.0)


def test_each_step_has_its_room_where_the_one_before_came(monkeypatch):
    """Around the draft alone, a fit that has ten deviations to go stops after the first ten of them."""
    priors = []
    monkeypatch.setattr(repair, "with_room", lambda prior, tried, loose, seed: tried)
    stepping(monkeypatch, (0.9, 1.0, 0.8, 0.9, 0.9, 0.9), priors=priors)
    assert priors == [20.0, 21.0, 22.0]


@pytest.mark.parametrize(("left", "std"), [(1.0, 0.4), (9.0, 1.2), (100.0, 2.0)])
def test_a_fit_is_less_sure_where_more_than_noise_is_left_but_never_less_than_before_it(monkeypatch, left, std):
    """A fifth of the prior's deviation, 2, by the noise alone."""
    base = SimpleNamespace(parameters=1, names=("C2",), scale=np.array([2.0]))
    problem = SimpleNamespace(grams=SimpleNamespace(count=np.ones(50)))
    cross = SimpleNamespace(
        problem=problem, covariance=lambda _: 0.04 * np.eye(1),
        explain=lambda _: SimpleNamespace(beta=np.array([0.5]), train_loss=50.0 * left),
    )  # fmt: skip
    monkeypatch.setattr(repair, "base_of", lambda *_, **__: base)
    monkeypatch.setattr(repair, "layout_of", lambda *_: None)
    monkeypatch.setattr(repair, "build_problem", lambda *_: None)
    monkeypatch.setattr(repair, "CrossFit", lambda _: cross)
    step, covariance, _ = repair._step(SimpleNamespace(model=model(), prepared=()), model(), {})
    assert step.tolist() == [1.0]
    assert np.sqrt(covariance[0, 0]) == pytest.approx(std)


# -- proposals
def proposal(after):
    return proposals.Proposal(None, {}, "", None, 2.0, after, 0.5, "bar", 0.0)


def test_laws_that_close_much_less_than_the_best_are_not_proposed(monkeypatch):
    """At most three; what closes is what is above the noise."""
    assert proposal(0.5).closed == pytest.approx(1.0)
    lefts = iter([0.8, 1.4, None, 0.7, 0.75, 0.7])
    monkeypatch.setattr(proposals, "_laws", lambda *_: [(None, 0.0)] * 6)
    monkeypatch.setattr(proposals, "_proven", lambda *_: None if (left := next(lefts)) is None else proposal(left))
    search = SimpleNamespace(verdict=Verdict(UNEXPLAINED), expansion=SimpleNamespace(runs=()))
    found = proposals.propose(SimpleNamespace(search=search), (), None, np.random.default_rng(0))
    assert [each.after for each in found] == [0.8, 0.7]


def test_a_law_that_closes_little_of_the_locked_gap_is_not_proposed(monkeypatch):
    """Of 2 bar with a noise of 0.5 bar: 30 % of the square above the noise is what 1.7 bar leaves."""
    assert [proposal(left).worthwhile for left in (1.75, 1.65, 0.5)] == [False, True, True]
    monkeypatch.setattr(proposals, "_laws", lambda *_: [(None, 0.0)])
    monkeypatch.setattr(proposals, "_proven", lambda *_: proposal(1.9))
    search = SimpleNamespace(verdict=Verdict(UNEXPLAINED), expansion=SimpleNamespace(runs=()))
    assert proposals.propose(SimpleNamespace(search=search), (), None, np.random.default_rng(0)) == ()


@pytest.mark.parametrize(
    ("laws", "surely", "order"),
    [
        ("5a 2b", "", "2b 5a"),  # closes as much: the one with less to read
        ("5a 2b", "ba", "5a 2b"),
        ("2b 5a", "", "2b 5a"),
        ("4a 3b 2c", "ca", "4a 2c 3b"),  # it need not beat every shorter one
        ("2b 2a", "ab", "2b 2a"),  # of equals the search's own order
    ],
)
def test_a_simpler_law_that_closes_as_much_stands_first(laws, surely, order, monkeypatch):
    """`surely`: which law is beaten on the locked runs, and by which. Laws are named by what there is to read."""
    monkeypatch.setattr(proposals, "adds", lambda fewer, more, _: f"{fewer}{more}" in surely.split())
    found = [replace(proposal(0.5), weight=int(law[0]), held=law[1]) for law in laws.split()]
    shown = proposals._simplest_first(found, np.random.default_rng(0))
    assert [f"{each.weight}{each.held}" for each in shown] == order.split()


@pytest.mark.parametrize(
    ("signals", "loss", "weight", "own"),
    [
        (("pressure",), 100.0, 2.0, True),
        (("pressure",), 127.0, 2.0, True),  # within a quarter of the logarithm of what the best leaves
        (("pressure",), 140.0, 2.0, False),
        (("pressure",), 127.0, 4.0, False),  # and no longer
        (("motor_speed", "pressure"), 100.0, 2.0, False),  # the best one with something added
    ],
)
def test_a_law_of_another_signal_that_leaves_hardly_more_is_shown_beside_the_best(signals, loss, weight, own):
    head, law = (
        SimpleNamespace(loss=left, law=SimpleNamespace(signals=read, weight=words))
        for left, read, words in ((100.0, ("motor_speed",), 2.0), (loss, signals, weight))
    )
    assert proposals._another(law, head, 1000.0) is own


# -- from an explanation to a file, by figures
TARE = Correction("tare_load", 100.0, 10.0, source="an owner")
SEED = FrictionModel("given", (COULOMB,), (50.0,), np.array([[4.0]]), {C2.name: (0.0, 90.0)}, {"k": 2.0}, {"by": "me"},
                     (TARE,), "")  # fmt: skip
VISCOUS = term_named("viscous")
(VISCOSITY,) = VISCOUS.parameters


def drafting(monkeypatch, candidate, **beside):
    """A draft of one slot in column 5: the base moves by 0.5 of a scale of 2 and -1 of one of 30, the slot's amount is
    3 of a scale of 4; deviations of these are 0.2, 0.3 and 0.5."""
    slot = Slot("effect", "", (5,), origin=(candidate, "shape"))
    base = SimpleNamespace(names=("C2", "timing", "tare_load"), parameters=1)
    layout = SimpleNamespace(scales=np.array([2.0, 1.0, 30.0, 9.0, 9.0, 4.0]))
    columns = lambda slots: (0, 1, 2, *(c for each in slots for c in each.columns))
    problem = SimpleNamespace(columns=columns, layout=layout, base=base)
    cross = SimpleNamespace(problem=problem, covariance=lambda _: np.diag([0.04, 0.01, 0.09, 0.25]))
    given = SimpleNamespace(model=SEED, crane=SimpleNamespace(name="own crane"), prepared=(), runs=())
    known = {"reversal": None, "ripple": None, "flow": (), **beside}
    search = SimpleNamespace(
        given=given, cross=cross, expansion=SimpleNamespace(model=SEED.with_values([60.0])), train=(), **known
    )
    monkeypatch.setattr(repair, "_sides", lambda _: "sides")
    monkeypatch.setattr(repair, "estimates_of", lambda slot, value, std, cross: estimated(value[0], std[0]))
    monkeypatch.setattr(repair, "of_part", lambda slot, slots, found: found)
    monkeypatch.setattr(repair, "in_file", lambda slot, found, sides, had: {"told": (sides, sorted(had))})
    explanation = SimpleNamespace(slots=(slot,), beta=np.array([0.5, 9.0, -1.0, 3.0]))
    return repair.draft(search, explanation, {"by": "gap", "at": "noon"})


def estimated(value, std, name=VISCOSITY.name):
    return {name: ParameterEstimate(float(value), float(std), VISCOSITY.unit)}


def test_a_draft_is_the_point_of_expansion_and_what_was_found_in_its_units(monkeypatch):
    found = drafting(monkeypatch, Candidate("viscous", linear=(VISCOSITY,), term=VISCOUS))
    model = found.model
    assert model.as_dict() == {C2.name: pytest.approx(61.0), VISCOSITY.name: pytest.approx(12.0)}
    assert list(model.std) == pytest.approx([0.4, 2.0])
    (tare,) = model.corrections
    assert (tare.name, tare.value, tare.std, tare.source) == ("tare_load", 70.0, pytest.approx(9.0), "an owner")
    assert (model.name, model.crane) == ("given_repaired", "own crane")
    assert (dict(model.constants), dict(model.provenance)) == ({"k": 2.0}, {"by": "gap", "at": "noon"})
    assert found.parameters == {"effect": estimated(12.0, 2.0)}
    assert found.said == {"effect": {"told": ("sides", [repair.key_of(TARE)])}}
    assert found.cut == ()
    assert model.bounds_of(C2.name) == (0.0, 90.0)


def test_a_draft_adds_what_corrects_what_flows_and_what_turns(monkeypatch):
    def corrects(found, shape, sides):
        assert (shape, sides) == ("shape", "sides")
        return [Correction("tare_load", 10.0 * next(iter(found.values())).value, 1.0)]

    leaks = SimpleNamespace(corrections=(Correction("slip_leakage", 1e-12), Correction("entrained_air", 0.01)))
    layout = SimpleNamespace(scales=np.array([1.0, 1.0, 8.0]))
    problem = SimpleNamespace(columns=lambda slots: (0, 2), layout=layout)
    own = SimpleNamespace(problem=problem, covariance=lambda _: np.diag([1.0, 0.0625]))
    slot = Slot("turning", "", (2,), origin=(Candidate("viscous", linear=(VISCOSITY,), term=VISCOUS), None))
    turning = SimpleNamespace(slot=slot, cross=own, fitted=SimpleNamespace(slots=(), beta=np.array([5.0, 0.5])))
    found = drafting(monkeypatch, Candidate("load", corrects=corrects), flow=(leaks,), reversal=turning)
    assert [(each.name, each.value) for each in found.model.corrections] == [
        ("tare_load", 70.0 + 120.0), ("slip_leakage", 1e-12), ("entrained_air", 0.01)
    ]  # fmt: skip
    assert found.model.as_dict()[VISCOSITY.name] == pytest.approx(4.0)
    assert found.model.std[1] == pytest.approx(2.0)
    assert found.parameters["turning"] == estimated(4.0, 2.0)


@pytest.mark.parametrize(("name", "written"), [
    ("m", "m_repaired"), ("m_repaired", "m_repaired"), ("m_refitted", "m_repaired"),
    ("m_repaired_refitted", "m_repaired"), ("m_refitted_x", "m_refitted_x_repaired"),
])  # fmt: skip
def test_a_model_is_called_repaired_once(name, written):
    assert (REPAIRED, REFITTED) == ("_repaired", "_refitted")
    own = _Draft([COULOMB], {C2.name: 20.0}, {C2.name: 3.0}, [], {})
    seed = replace(SEED, name=name, crane="its crane", corrections=())
    found = repair._model_of(own, seed, SimpleNamespace(name="another"), {}, {})
    assert (found.model.name, found.model.crane) == (written, "its crane")


def test_a_file_is_cut_at_the_seeds_own_bounds_and_says_from_where():
    """The seed's bounds count, not the usual ones, nor the room of what is new; a deviation is never nothing."""
    cut = Correction("tare_load", 5.0, 1.0, source=f"runs, {CUT} 3e+04 kg")
    own = _Draft(
        [COULOMB, VISCOUS], {C2.name: 95.04, VISCOSITY.name: 1.0}, {C2.name: 0.0, VISCOSITY.name: 0.2}, [cut],
        {C2.name: (0.0, 1e6), VISCOSITY.name: (0.0, 7.0), "of another": (0.0, 1.0)},
    )  # fmt: skip
    found = repair._model_of(own, SEED, SimpleNamespace(name=""), {"a": {}}, {})
    assert found.model.values == (90.0, 1.0)
    assert found.cut == (f"{C2.name}: {CUT} 95.04 {C2.unit}", f"{repair.key_of(cut)}: {CUT} 3e+04 kg")
    assert list(found.model.std) == pytest.approx([1e-12 * abs(C2.typical), 0.2])
    assert found.parameters == {"a": {}}
    assert dict(found.model.bounds) == {C2.name: (0.0, 90.0), VISCOSITY.name: (0.0, 7.0)}
    near = _Draft([COULOMB], {C2.name: 90.0 + 1e-3}, {C2.name: 1.0}, [], {})
    assert len(repair._model_of(near, SEED, SimpleNamespace(name=""), {}, {}).cut) == 1


def test_a_curve_of_the_same_cause_melts_in_and_shapes_do_not_add_up():
    churning = term_named("churning")
    amount, exponent = churning.parameters
    own = _Draft([churning], {amount.name: 9.0, exponent.name: 2.0}, {amount.name: 3.0, exponent.name: 0.1}, [], {})
    more = {amount.name: ParameterEstimate(5.0, 4.0, "N*m"), exponent.name: ParameterEstimate(1.5, 0.2, "1")}
    own.add_term(Candidate("churning", term=churning), churning, more)
    assert own.at == {amount.name: 14.0, exponent.name: 2.0}
    assert own.std == {amount.name: pytest.approx(5.0), exponent.name: 0.1}
    melted = Candidate(
        "churning", term=churning, merge=lambda at, new: {exponent.name: at[exponent.name] * new[exponent.name]}
    )
    own.add_term(melted, churning, more)
    assert own.at == {amount.name: 14.0, exponent.name: 3.0}
    assert own.std == {amount.name: pytest.approx(np.hypot(5.0, 4.0)), exponent.name: pytest.approx(np.hypot(0.1, 0.2))}


def test_what_is_cut_below_says_so_as_well():
    each = Correction("pressure_scale", 0.01, 0.001, source="runs")
    cut = _changed(each, 3.0 * each.bounds[0], None)
    assert (cut.value, cut.std) == (each.bounds[0], None)
    assert cut.source == f"runs, {CUT} {3.0 * each.bounds[0]:g} 1"


def test_corrections_of_other_groups_are_two():
    own = drafted()
    for value, groups in ((1.0, ("a",)), (2.0, ("b",)), (4.0, ("a",))):
        own.add_correction(Correction("pressure_scale", 0.001 * value, 0.1 * value, groups=groups))
    assert [(each.value, each.std, each.groups) for each in own.corrections] == [
        (pytest.approx(0.005), pytest.approx(0.4), ("a",)), (0.002, 0.2, ("b",))
    ]  # fmt: skip


# -- the last fit, by figures
def test_before_the_fit_the_seed_is_known_as_it_is_and_what_was_found_by_its_size():
    found = FrictionModel(
        "m", (COULOMB, VISCOUS), (61.0, 12.0), np.diag([0.16, 4.0]), {}, {}, {},
        (replace(TARE, value=70.0, std=9.0), Correction("pressure_scale", 0.01, 0.003), Correction("inertia", 0.0)),
    )  # fmt: skip
    for named, value, loose in (({}, 50.0, 2.0), ({C2.name: None}, 61.0, 0.4 * LIMITS.loosened)):
        prior, room = repair._prior(Repair(found, {"effect": named}), SEED)
        assert prior.values == (value, 12.0)
        assert room == {
            C2.name: pytest.approx(loose), VISCOSITY.name: pytest.approx(2.0 * LIMITS.loosened),
            repair.key_of(TARE): 10.0, repair.key_of(found.corrections[1]): pytest.approx(0.003 * LIMITS.loosened),
            repair.key_of(found.corrections[2]): 0.0,
        }  # fmt: skip
    for away, kept in ((1.5, (TARE,)), (2.5, ())):  # what no effect changed has its room around what the seed says
        near = replace(found, corrections=(replace(TARE, value=TARE.value + away * TARE.std), *found.corrections[1:]))
        assert repair._prior(Repair(near, {}), SEED)[0].corrections == kept


def test_a_step_is_of_parameters_and_corrections_alone_each_in_its_unit(monkeypatch):
    base = SimpleNamespace(parameters=1, names=("C2", "timing", "tare_load"), scale=np.array([2.0, 7.0, 30.0]))
    covariance = np.array([[0.04, 0.0, 0.006], [0.0, 1.0, 0.0], [0.006, 0.0, 0.09]])
    cross = SimpleNamespace(
        problem=SimpleNamespace(grams=SimpleNamespace(count=np.full(2, 25.0))), covariance=lambda _: covariance,
        explain=lambda _: SimpleNamespace(beta=np.array([0.5, 9.0, -1.0]), train_loss=10.0),
    )  # fmt: skip
    monkeypatch.setattr(repair, "base_of", lambda *_, **__: base)
    monkeypatch.setattr(repair, "layout_of", lambda *_: None)
    monkeypatch.setattr(repair, "build_problem", lambda *_: None)
    monkeypatch.setattr(repair, "CrossFit", lambda _: cross)
    step, found, deviations = repair._step(SimpleNamespace(model=SEED, prepared=()), SEED, {})
    assert step.tolist() == [1.0, -30.0]
    assert found == pytest.approx(np.array([[0.16]]))  # less than the noise is left: no surer for that
    assert deviations.tolist() == [pytest.approx(9.0)]


def test_a_stepped_model_stays_inside_its_bounds_and_no_deviation_is_nothing():
    both = replace(SEED, terms=(COULOMB, VISCOUS), values=(50.0, 1.0), covariance=np.eye(2))
    told, untold = np.array([[9.0, 0.3], [0.3, 4.0]]), np.diag([9.0, 0.0])
    found, none = (
        repair._stepped(both, np.array([60.0, 0.5, -20.0]), each, np.array([4.0])) for each in (told, untold)
    )
    assert found.values == (90.0, 1.5)
    np.testing.assert_allclose(found.covariance, told)
    np.testing.assert_allclose(none.covariance, np.diag([9.0, (1e-9 * abs(VISCOSITY.typical)) ** 2]))
    assert [(each.value, each.std) for each in found.corrections] == [(80.0, 4.0)]
    bare = FrictionModel("bare", (), ())
    assert repair._stepped(bare, np.zeros(0), np.zeros((0, 0)), np.zeros(0)).covariance is None


def test_estimates_are_told_as_the_last_fit_has_them():
    """What is new by its term, what a correction says by that; what the seed had, and what nobody says, as found."""
    model = replace(SEED, terms=(COULOMB, VISCOUS), values=(55.0, 13.0), covariance=np.diag([1.0, 9.0]))
    said = {"load": {"mass": InFile(repair.key_of(TARE), 2.0, 60.0), "gone": InFile("nowhere", 1.0, 0.0), "no": None}}
    before = ParameterEstimate(1.0, 1.0, "kg")
    names = {"load": {"mass": before, "gone": before, "no": before}, "drag": {C2.name: before, VISCOSITY.name: before}}
    found = repair._reported(Repair(model, names, said=said), SEED)
    assert found["load"] == {"mass": ParameterEstimate(20.0, 5.0, "kg"), "gone": before, "no": before}
    assert found["drag"] == {C2.name: before, VISCOSITY.name: ParameterEstimate(13.0, 3.0, "kg")}


def test_polishing_fits_the_training_runs_and_reports_what_it_found(monkeypatch):
    asked = []
    monkeypatch.setattr(
        repair,
        "meet",
        lambda *met: asked.append(met) or SimpleNamespace(only=lambda names: asked.append(names) or "now"),
    )
    monkeypatch.setattr(repair, "meet_again", lambda now, runs, crane, tried: "then")
    monkeypatch.setattr(repair, "_step", lambda *_: (np.array([1.0]), 25.0 * np.eye(1), np.zeros(0)))
    monkeypatch.setattr(repair, "misfit", lambda given, _: {"now": 1.0, "then": 1.0}[given])
    monkeypatch.setattr(repair, "_as_found", lambda best, drafted, seed: replace(best, name="as found"))
    monkeypatch.setattr(repair, "_reported", lambda best, seed: {best.model.name: {}})
    found = repair.polished(Repair(model(), {}, cut=("c",)), model(), ["runs"], ("a", "b"), "crane", "known")
    assert asked == [(["runs"], "crane", model(), ("a", "b"), "known"), ("a", "b")]
    assert (found.model.name, found.parameters, found.cut) == ("as found", {"as found": {}}, ("c",))


@pytest.mark.parametrize("has", [False, True])
def test_a_ripple_that_the_model_has_is_not_added_to_it_once_more(monkeypatch, has):
    ripple = term_named("torque_ripple")
    wave = {p.name: ParameterEstimate(p.typical, 1e-3, p.unit) for p in ripple.parameters}
    monkeypatch.setattr(repair, "_common_wave", lambda *_: wave)
    if has:
        values = (50.0, *(p.typical for p in ripple.parameters))
        whole = replace(SEED, terms=(COULOMB, ripple), values=values, covariance=np.eye(4), corrections=())
        base = SimpleNamespace(names=whole.parameter_names, parameters=4)
        problem = SimpleNamespace(
            columns=lambda _: (0, 1, 2, 3), layout=SimpleNamespace(scales=np.ones(4)), base=base
        )  # fmt: skip
        cross = SimpleNamespace(problem=problem, covariance=lambda _: np.eye(4))
        given = SimpleNamespace(model=whole, crane=SimpleNamespace(name="own"), prepared=(), runs=())
        search = SimpleNamespace(
            given=given, cross=cross, expansion=SimpleNamespace(model=whole), train=(), reversal=None, ripple="line",
            flow=(),
        )  # fmt: skip
        monkeypatch.setattr(repair, "_sides", lambda _: "sides")
        found = repair.draft(search, SimpleNamespace(slots=(), beta=np.zeros(4)), {}).model
        assert found.values == values
    else:
        candidate = Candidate("viscous", linear=(VISCOSITY,), term=VISCOUS)
        found = drafting(monkeypatch, candidate, ripple="line").model
        assert {name: found.as_dict()[name] for name in wave} == {name: each.value for name, each in wave.items()}
    assert "torque_ripple" in found.term_names
