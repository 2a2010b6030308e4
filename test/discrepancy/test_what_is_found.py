"""What is taken into a set of effects and what falls out of it, each rule on explanations of which all is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.engine import selection as module
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import Explanation
from winch_friction.discrepancy.engine.selection import _evidence, _forward, _found, _no_worse, _pruned, _with_company

ONE, TWO = Slot("one", "", (1,)), Slot("two", "", (2,))
RNG = np.random.default_rng(0)


def explained(slots, loss, segments=40):
    return Explanation(tuple(slots), np.full(segments, loss / segments), np.zeros(0), 0.0, np.zeros((0, 0)))


@pytest.mark.parametrize(
    ("gain", "inside", "worth", "outcome"),
    [
        (0.3, 0.3, 50.0, "taken"),
        (0.005, 0.3, 50.0, "gains only"),
        (0.3, 0.001, 50.0, "only steadies the fit of another effect"),
        (0.3, 0.3, 0.5, "its second order"),
    ],
)
def test_a_further_effect_is_useful_on_held_out_runs_and_on_those_it_is_fitted_to(
    monkeypatch, gain, inside, worth, outcome
):
    """The first effect took 1000 off: what takes less than one more is what its law has wrong."""
    base, current = explained((), 2000.0), explained((ONE,), 1000.0)
    trial = explained((ONE, TWO), 1000.0 - worth)
    monkeypatch.setattr(module, "candidate_trials", lambda *_: [trial])
    monkeypatch.setattr(module, "_evidence", lambda *_: np.array([1e-4]))
    monkeypatch.setattr(module, "_exchanged", lambda _, own: own)
    cross = SimpleNamespace(
        gain=lambda *_: gain, inside_gain=lambda *_: inside, problem=SimpleNamespace(slots=(ONE, TWO))
    )
    considered = []
    after = _forward(cross, base, current, RNG, 2, considered, {})
    assert (after is trial) is (outcome == "taken")
    assert outcome in considered[0].verdict


@pytest.mark.parametrize(("gain", "inside", "kept"), [(0.3, 0.3, 2), (0.3, 0.001, 1), (0.001, 0.3, 1)])
def test_what_takes_nothing_off_the_runs_it_is_fitted_to_is_superfluous(monkeypatch, gain, inside, kept):
    monkeypatch.setattr(module, "_evidence", lambda *_: np.array([1e-4]))
    losses = {1: 1000.0, 2: 900.0}
    cross = SimpleNamespace(
        gain=lambda *_: gain, inside_gain=lambda *_: inside,
        explain=lambda slots: explained(slots, losses[len(slots)] + (ONE not in slots)),
    )  # fmt: skip
    assert _pruned(cross, explained((ONE, TWO), 900.0), RNG).slots == (ONE, TWO)[:kept]


def test_the_same_size_in_every_run_is_less_sure_among_many_candidates():
    trials = [explained((ONE,), 0.0)] * 3
    cross = SimpleNamespace(jackknife_p_value=lambda _: 0.01)
    assert _evidence(cross, trials, np.zeros((3, 40)), RNG) == pytest.approx([0.03] * 3)


@pytest.mark.parametrize(("free", "as_good"), [(False, True), (True, False)])
def test_curves_of_what_every_machine_has_do_not_stand_for_a_law_that_leaves_less(free, as_good):
    """By chance alone they are the worse, but a curve imitates whatever there is."""
    sign = np.tile([1.0, -1.0], 20)
    plain = Explanation((Slot("coulomb", "", (3,), free=free),), 25.1 + sign, np.zeros(0), 0.0, np.zeros((0, 0)))
    assert _no_worse(plain, explained((ONE,), 1000.0), RNG) is as_good


def test_what_an_effect_brings_along_stands_before_it():
    slope = Slot("slope", "", (3,), brings=("two",))
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(ONE, TWO, slope)), explain=lambda slots: explained(slots, 1.0)
    )
    assert _with_company(cross, explained((ONE, slope), 2.0)).slots == (ONE, TWO, slope)


def test_the_worth_of_what_is_brought_along_is_what_it_takes_without_its_higher_order(monkeypatch):
    """Which takes nearly all of it over; and only the same column is another name for it."""
    slope, asked = Slot("slope", "", (3,), brings=("two",)), []
    losses = {(): 2000.0, (TWO,): 500.0, (slope,): 110.0, (TWO, slope): 100.0}
    cross = SimpleNamespace(
        explain=lambda slots: explained(slots, losses[tuple(slots)]),
        gain=lambda before, after: 1.0 - after.loss / before.loss,
    )
    monkeypatch.setattr(module, "rivals_of", lambda *_, same: asked.append(same) or ((), 1.0))
    whole = cross.explain((TWO, slope))
    assert _found(cross, whole, 0, {"two": 0.0}, RNG).gain == pytest.approx(0.75)
    assert _found(cross, whole, 1, {"slope": 0.0}, RNG).gain == pytest.approx(0.8)
    assert asked == [True, False]
