"""What is taken into a set of effects and what falls out of it, each rule on explanations of which all is known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.engine import selection as module
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import Explanation
from winch_friction.discrepancy.engine.selection import (
    Finding,
    Selection,
    _considered,
    _evidence,
    _forward,
    _found,
    _no_worse,
    _pruned,
    _with_company,
)
from winch_friction.discrepancy.thresholds import LIMITS

ONE, TWO = Slot("one", "", (1,)), Slot("two", "", (2,))
RNG = np.random.default_rng(0)


def explained(slots, loss, segments=40):
    return Explanation(tuple(slots), np.full(segments, loss / segments), np.zeros(0), 0.0, np.zeros((0, 0)))


@pytest.mark.parametrize(
    ("gain", "inside", "worth", "outcome"),
    [
        (0.3, 0.3, 50.0, "taken"),
        (0.3, 0.3, 1.5, "taken"),  # of what the first one took, not of all that there was
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
    saved = lambda share: lambda before, after: share if after is trial else -share
    cross = SimpleNamespace(gain=saved(gain), inside_gain=saved(inside), problem=SimpleNamespace(slots=(ONE, TWO)))
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


@pytest.mark.parametrize(
    ("worthy", "best", "gain", "inside", "p", "said"),
    [
        (True, True, 0.3, 0.3, 1e-4, "taken"),
        (True, False, 0.3, 0.3, 1e-4, "outdone in held-out loss"),
        (False, False, 0.3, 0.3, 0.06, "not significant on held-out segments (p = 0.06)"),
        (False, False, 0.005, 0.3, 1e-4, "gains only 0.5 % of the held-out error, less than 1 %"),
        (False, False, 0.3, 0.001, 1e-4, "only steadies the fit"),
        (False, False, 0.3, 0.3, 1e-4, "explains less than 0.2 % of what the first effect did"),
    ],
)
def test_what_was_not_taken_is_said_with_the_first_reason_that_holds(worthy, best, gain, inside, p, said):
    own = Slot("one", "its shape", (1,))
    found = _considered(explained((TWO, own), 1.0), gain, inside, p, 2, worthy, best)
    assert (found.name, found.variant, found.gain, found.p_value, found.stage) == ("one", "its shape", gain, p, 2)
    assert said.replace("0.2 %", f"{100 * LIMITS.least_share:g} %") in found.verdict


@pytest.mark.parametrize(("start", "most", "stages"), [((), 3, [0, 1, 2]), ((ONE,), 3, [1, 2]), ((ONE, TWO), 2, [])])
def test_effects_are_added_until_a_set_has_as_many_as_it_may(monkeypatch, start, most, stages):
    """From what a search begins with on; each of them says how sure it was when it came."""
    more = [Slot(f"more {k}", "", (5 + k,)) for k in range(4)]
    cross = SimpleNamespace(gain=lambda *_: 0.3, inside_gain=lambda *_: 0.3, problem=SimpleNamespace(slots=more))
    tried = lambda _cross, own, _names: [explained((*own.slots, more[len(own.slots)]), 0.5 * own.loss)]
    monkeypatch.setattr(module, "candidate_trials", tried)
    monkeypatch.setattr(module, "_evidence", lambda *_: np.array([1e-4]))
    monkeypatch.setattr(module, "_exchanged", lambda _, own: own)
    considered, p_values = [], {}
    after = _forward(cross, explained((), 3000.0), explained(start, 1000.0), RNG, most, considered, p_values)
    assert [each.stage for each in considered] == stages
    assert len(after.slots) == max(most, len(start))
    assert p_values == {each.name: 1e-4 for each in considered}


def test_the_surer_of_two_ways_to_be_sure_counts():
    """Most segments show it, though its size differs from run to run; or few do, and all runs agree on it."""
    trial = explained((ONE,), 0.0)
    for steady, gains, least in ((1.0, np.ones((1, 40)), 2e-3), (1e-3, np.zeros((1, 40)), 1e-3)):
        cross = SimpleNamespace(jackknife_p_value=lambda _, p=steady: p)
        assert _evidence(cross, [trial], gains, RNG)[0] <= least


def test_what_is_brought_along_is_there_once():
    slope, curve = (Slot(name, "", (k,), brings=("two",)) for k, name in ((3, "slope"), (4, "curve")))
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(ONE, TWO, slope)), explain=lambda slots: explained(slots, 1.0)
    )
    assert _with_company(cross, explained((slope, curve), 2.0)).slots == (TWO, slope, curve)
    whole = explained((slope, TWO), 2.0)
    assert _with_company(cross, whole) is whole


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_an_effect_has_as_many_names_as_a_set_has_room_for_and_says_which_others_do_as_well(monkeypatch, count):
    """Three names at most: its own and two more. Beyond three left out nobody is told anything."""
    rivals = tuple(Slot(f"rival {k}", "", (k,)) for k in range(count))
    losses = {(): 400.0, (ONE,): 100.0}
    cross = SimpleNamespace(
        explain=lambda slots: explained(slots, losses[tuple(slots)]), inside_gain=lambda *_: 0.1,
        gain=lambda before, after: 1.0 - np.sqrt(after.loss / before.loss),
    )  # fmt: skip
    monkeypatch.setattr(module, "rivals_of", lambda *_, same: (rivals, 0.7))
    own = _found(cross, cross.explain((ONE,)), 0, {"one": 0.004}, RNG)
    assert (own.rivals, own.no_room) == (rivals[:2], tuple(each.name for each in rivals[2:]))
    assert (own.p_value, own.gain, own.selection_frequency) == (0.004, pytest.approx(0.5), 0.7)
    assert not Selection(explained((), 1.0), explained((ONE,), 1.0), (own,)).untold


def test_a_set_that_leaves_out_more_names_than_it_has_room_for_tells_them_all():
    base, final = explained((), 1.0), explained((ONE, TWO), 1.0)
    three, four = (tuple("abcd"[:count]) for count in (3, 4))
    crowd = Finding(ONE, (Slot("r", "", (7,)),), 0.0, 0.1, 1.0, four)
    assert Selection(base, final, (replace(crowd, no_room=three),)).untold == ""
    assert Selection(base, final, (crowd, replace(crowd, slot=TWO, rivals=()))).untold == (
        "one is not told from r, a, b, c, d; two is not told from a, b, c, d"
    )


def test_what_is_taken_is_as_sure_as_it_is_itself_and_not_as_the_surest_beside_it(monkeypatch):
    """The one that takes less is surer."""
    trials = [explained((ONE,), 900.0), explained((TWO,), 500.0)]
    monkeypatch.setattr(module, "candidate_trials", lambda *_: trials)
    monkeypatch.setattr(module, "_evidence", lambda *_: np.array([1e-4, 7e-4]))
    monkeypatch.setattr(module, "_exchanged", lambda _, own: own)
    cross = SimpleNamespace(gain=lambda *_: 0.3, inside_gain=lambda *_: 0.3, problem=SimpleNamespace(slots=(ONE, TWO)))
    considered, p_values = [], {}
    assert _forward(cross, explained((), 2000.0), explained((), 2000.0), RNG, 1, considered, p_values) is trials[1]
    assert p_values == {"two": 7e-4}
    assert [(each.name, each.p_value, each.verdict) for each in considered] == [
        ("two", 7e-4, module.TAKEN),
        ("one", 1e-4, "significant and useful, but outdone in held-out loss by the one taken"),
    ]


@pytest.mark.parametrize(("segments", "as_good"), [(1, True), (40, False)])
def test_plain_effects_that_are_worse_in_every_segment_are_not_worse_by_chance(segments, as_good):
    """By as much in all; in one segment alone it may be chance."""
    behind = np.where(np.arange(40) < segments, 100.0 / segments, 0.0)
    other = replace(explained((TWO,), 0.0), losses=np.full(40, 10.0))
    assert _no_worse(replace(explained((ONE,), 0.0), losses=other.losses + behind), other, RNG) is as_good
    assert _no_worse(replace(other, losses=other.losses - behind), other, RNG)


@pytest.mark.parametrize(
    ("gain", "level"),
    [(0.5, 0.05), (0.1, 0.05), (0.0999, 0.01), (0.02, 0.01), (0.0199, 1e-3), (0.01, 1e-3), (0.001, 1e-3)],
)
def test_a_gain_has_the_level_of_the_least_that_it_reaches(gain, level):
    surer, less = (module._significant(np.array([p]), np.array([gain])).tolist() for p in (level, 1.01 * level))
    assert (surer, less) == ([True], [False])


def test_an_effect_that_was_never_asked_alone_is_as_sure_as_what_it_saves_of_each_segment(monkeypatch):
    losses = {(): 400.0, (ONE,): 100.0}
    cross = SimpleNamespace(explain=lambda slots: explained(slots, losses[tuple(slots)]), gain=lambda *_: 0.5)
    monkeypatch.setattr(module, "rivals_of", lambda *_, same: ((), 1.0))
    assert _found(cross, cross.explain((ONE,)), 0, {}, RNG).p_value == pytest.approx(1.0 / (1.0 + LIMITS.flips))


def test_what_could_stand_for_a_second_law_of_a_cause_is_no_other_name_for_it():
    first = Finding(ONE, (TWO,), 0.0, 0.1, 1.0, tuple("abcd"))
    again = replace(first, slot=replace(ONE, law="bent"))
    other = replace(first, slot=TWO)
    found = module._one_set_each((first, again, other))
    assert [(len(each.rivals), len(each.no_room)) for each in found] == [(1, 4), (0, 0), (1, 4)]
    assert [each.slot.law for each in found] == ["", "bent", ""]


@pytest.mark.parametrize(
    ("together", "anew", "taken"),
    [(90.0, None, "together"), (110.0, None, "one"), (110.0, 20.0, "anew"), (110.0, 90.0, "one"), (90.0, 20.0, "anew")],
)
def test_what_begins_otherwise_is_taken_where_it_leaves_less(monkeypatch, together, anew, taken):
    """One by one 100 are left; of plain effects all together less will do, of another first cause it must be half."""
    names = {name: Slot(name, "", (k,)) for k, name in enumerate(("one", "together", "anew"), start=1)}
    losses = {"one": 100.0, "together": together, "anew": anew}
    base = explained((), 1000.0)
    begun = {0.0: "one", 1.0: "together", 2.0: "anew"}
    start = explained((TWO,), 1.0)

    def forward(cross, base, start, rng, most, considered, p_values):
        name = begun[start.loss if start.slots else 0.0]
        considered.append(name)
        p_values[name] = 0.01
        return explained((names[name],), losses[name])

    monkeypatch.setattr(module, "_forward", forward)
    monkeypatch.setattr(module, "_whole", lambda cross, own, rng, apart: own)
    # from nothing: what was found one by one is what plain effects all together are held against
    monkeypatch.setattr(module, "_plain_together", lambda cross, begun, rng: start if begun is base else base)
    monkeypatch.setattr(module, "other_start", lambda *_: None if anew is None else explained((TWO,), 2.0))
    monkeypatch.setattr(module, "far_less", lambda cross, new, old: new.loss <= 0.5 * old.loss)
    monkeypatch.setattr(
        module, "_found", lambda cross, own, k, p, rng: Finding(own.slots[k], (), p[own.names[0]], 0, 1)
    )
    found = module.select(SimpleNamespace(explain=lambda _: base), RNG)
    assert (found.base, found.final.names, found.found[0].p_value) == (base, (taken,), 0.01)
    assert list(found.considered) == ["one"] + ["together"] * (together == 90.0) + ["anew"] * (taken == "anew")
