"""The repaired model in the making: what is added to what, what is cut at a bound, and which step is taken."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import proposals, repair
from winch_friction.discrepancy.answer import UNEXPLAINED, Verdict
from winch_friction.discrepancy.candidates.candidate import Candidate, ParameterEstimate
from winch_friction.discrepancy.repair import Repair, _changed, _Draft
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


def test_what_a_bare_model_lacks_has_room_to_move_beyond_its_usual_bound():
    own = drafted()
    own.at[C2.name] = 2.0 * C2.upper
    candidate = SimpleNamespace(term=COULOMB, merge=None, most_in=lambda _: LIMITS.unbounded)
    own.terms.clear()
    slot = SimpleNamespace(origin=(candidate, None))
    repair._add(own, slot, {C2.name: ParameterEstimate(2.0 * C2.upper, 1.0, "N*m")}, None, model(), np.ones(1))
    assert own.room[C2.name] == (C2.lower, LIMITS.bare_room * 2.0 * C2.upper)


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

    def misfit(given):
        key = given if isinstance(given, str) else given.values
        if key not in known:
            known[key] = next(left)
        return known[key]

    monkeypatch.setattr(repair, "_misfit", misfit)
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
