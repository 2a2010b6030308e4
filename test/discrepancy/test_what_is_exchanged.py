"""Which member of a set makes way for another, and which set of plain effects a search may begin from: each rule on a
table of what every set leaves."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.engine import selection as module
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import Explanation
from winch_friction.discrepancy.engine.selection import (
    _exchanged,
    _in_order,
    _no_worse,
    _of_fewest_causes,
    _plain_together,
    _pruned,
)

RNG = np.random.default_rng(0)
DECOY, GEAR, BRAKE = (Slot(name, "", (k,)) for k, name in enumerate(("decoy", "gear", "brake"), 1))
CURVE = Slot("decoy", "", (4,), law="curve", free=True)
KEYS = {DECOY: "d", GEAR: "g", BRAKE: "b", CURVE: "c"}


def explained(slots, loss, segments=40):
    return Explanation(tuple(slots), np.full(segments, loss / segments), np.zeros(0), loss, np.zeros((0, 0)))


def table(slots, losses, floor=0.0):
    """What a search asks of a cross-fit, with the loss of every set by the letters of its members."""

    def explain(own):
        return explained(own, losses["".join(sorted(KEYS[slot] for slot in own))])

    return SimpleNamespace(
        explain=explain, fit_beside=lambda *_: None, train_loss=lambda own: (explain(own).loss, None), floor=floor,
        excess=lambda each: each.loss - floor, gain=lambda before, after: 1.0 - after.loss / before.loss,
        inside_gain=lambda before, after: 1.0 - after.loss / before.loss,
        problem=SimpleNamespace(slots=slots, grams=SimpleNamespace(count=np.ones(1))),
    )  # fmt: skip


PAIRS = {"": 1000.0, "d": 400.0, "b": 500.0, "g": 600.0, "bd": 100.0, "dg": 300.0}


@pytest.mark.parametrize(
    ("left", "exchanged"),
    [(10.0, True), (99.5, True), (99.95, False), (101.0, False)],  # beside 100
)
def test_what_stood_in_for_two_makes_way_once_the_second_is_there(left, exchanged):
    """In its own place; by a thousandth at least, for less is no reason to change a name."""
    cross = table((DECOY, GEAR, BRAKE), {**PAIRS, "bg": left})
    own = _exchanged(cross, cross.explain((DECOY, BRAKE)))
    assert own.slots == ((GEAR, BRAKE) if exchanged else (DECOY, BRAKE))


@pytest.mark.parametrize(("left", "exchanged"), [(95.0, False), (75.0, True)])
def test_a_curve_of_another_cause_takes_a_laws_place_only_by_what_it_gives_back(left, exchanged):
    """Five per cent of the 400 that it saves are 20."""
    cross = table((BRAKE, GEAR, CURVE), {"": 1000.0, "b": 500.0, "g": 450.0, "c": 450.0, "bg": 100.0, "cg": 440.0,
                                         "bc": left})  # fmt: skip
    own = _exchanged(cross, cross.explain((BRAKE, GEAR)))
    assert own.slots == ((BRAKE, CURVE) if exchanged else (BRAKE, GEAR))


@pytest.mark.parametrize(("left", "exchanged"), [(40.0, True), (60.0, False)])
def test_the_curve_of_a_cause_takes_its_laws_place_where_it_leaves_less_than_half(left, exchanged):
    """Although five per cent of what it saves are 148: within one cause what counts is what is left."""
    cross = table((DECOY, CURVE), {"": 3000.0, "d": 100.0, "c": left})
    assert _exchanged(cross, cross.explain((DECOY,))).slots == ((CURVE,) if exchanged else (DECOY,))


@pytest.mark.parametrize(("left", "leads"), [(97.0, DECOY), (40.0, CURVE)])
def test_of_trials_a_curve_leads_only_by_more_than_it_gives_back(left, leads):
    cross = table((DECOY, CURVE), {})
    trials = [explained((CURVE,), left), explained((DECOY,), 100.0)]
    first = _in_order(cross, explained((), 1000.0), trials)[0]
    assert trials[first].slots == (leads,)


def test_what_every_machine_has_is_tried_all_at_once_each_by_its_best_shape_beside_what_has_one(monkeypatch):
    """But not what only follows another effect, nor what a machine need not have. A curve that is so wide that it is
    Coulomb friction does best alone; it stood in its place, with deviations that were twenty times too small."""
    monkeypatch.setattr(module, "_pruned", lambda _, own, rng: own)
    names = ("stribeck", "stribeck", "coulomb", "slope", "wear")
    wide, narrow, coulomb, slope, wear = (
        Slot(name, "", (k,), plain=name != "wear", brings=("coulomb",) * (name == "slope"))
        for k, name in enumerate(names)
    )
    losses = {(wide,): 300.0, (narrow,): 500.0, (coulomb,): 400.0, (coulomb, wide): 290.0, (coulomb, narrow): 10.0}
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(wide, narrow, coulomb, slope, wear)),
        fit_beside=lambda *_: None, train_loss=lambda own: (losses[own], None), explain=lambda own: explained(own, 1.0),
    )  # fmt: skip
    base = explained((), 1000.0)
    assert set(_plain_together(cross, base, RNG).slots) == {coulomb, narrow}
    cross.problem.slots = (wide, narrow, wear)
    assert _plain_together(cross, base, RNG) is base  # one alone needs no company


@pytest.mark.parametrize(("count", "as_good"), [(1, True), (2, False)])
def test_more_plain_effects_do_no_better_than_fewer_names_by_chance(count, as_good):
    sign = np.tile([1.0, -1.0], 20)
    slots = tuple(Slot(f"plain {k}", "", (k,), plain=True) for k in range(count))
    plain = Explanation(slots, 25.1 + sign, np.zeros(0), 0.0, np.zeros((0, 0)))
    assert _no_worse(plain, explained((DECOY,), 1000.0), RNG) is as_good


def test_the_weakest_is_what_falls_out_wherever_it_stands(monkeypatch):
    monkeypatch.setattr(module, "_evidence", lambda *_: np.array([1.0]))
    cross = table((DECOY, GEAR), {"d": 900.0, "g": 101.0, "dg": 100.0})
    assert _pruned(cross, cross.explain((DECOY, GEAR)), RNG).slots == (GEAR,)


@pytest.mark.parametrize(("plain", "left", "causes"), [
    (False, 2.6, ["gear", "gear"]), (False, 5.0, ["gear", "brake"]), (True, 2.6, ["gear", "brake"]),
])  # fmt: skip
def test_a_second_law_stands_for_another_name_within_the_noise_and_never_for_what_every_machine_has(
    plain, left, causes
):
    """The two causes leave no more than the noise: twice what is nobody's effect is as good, whatever twice zero is."""
    floor, least = 2.0, 0.35
    brake, bent = Slot("brake", "", (3,), plain=plain), Slot("gear", "", (5,), law="bent")
    losses = {(GEAR,): 40.0, (brake,): 40.0, (GEAR, brake): floor + 0.01, (GEAR, bent): left}
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(GEAR, brake, bent)), excess=lambda each: each.loss - floor, floor=floor,
        explain=lambda own: explained(own, losses[tuple(own)]), fit_beside=lambda *_: None,
        train_loss=lambda own: (losses[tuple(own)], None),
    )  # fmt: skip
    assert (left - floor < 2.0 * least) is (left < 3.0)
    found = _of_fewest_causes(cross, cross.explain((GEAR, brake)), RNG)
    assert [slot.name for slot in found.slots] == causes


def test_what_is_exchanged_stands_where_the_other_stood_and_is_looked_at_once_more():
    """First the decoy makes way, and only beside what came for it does the gear: two rounds."""
    cross = table((DECOY, GEAR, BRAKE, CURVE), {
        "": 1000.0, "d": 400.0, "g": 600.0, "b": 500.0, "c": 550.0, "dg": 100.0, "bd": 101.0, "bg": 90.0, "cd": 300.0,
        "cg": 95.0, "bc": 20.0,
    })  # fmt: skip
    found = _exchanged(cross, cross.explain((GEAR, DECOY)))
    assert set(found.slots) == {BRAKE, CURVE}
    assert found.loss == 20.0


def test_trials_that_come_to_the_same_stand_in_the_order_in_which_they_are_listed():
    """But for rounding: a cause's own law leads before its others, and what leaves clearly more comes behind both."""
    cross = table((GEAR, DECOY, BRAKE), {})
    trials = [explained((BRAKE,), 50.0), explained((DECOY,), 100.0 * (1.0 - 5e-6)), explained((GEAR,), 100.0)]
    order = _in_order(cross, explained((), 1000.0), trials[1:])
    assert [trials[1:][k].slots[0] for k in order] == [GEAR, DECOY]
    assert [trials[k].slots[0] for k in _in_order(cross, explained((), 1000.0), trials)][0] is BRAKE
    apart = [explained((DECOY,), 100.0 * (1.0 - 5e-5)), explained((GEAR,), 100.0)]
    assert [apart[k].slots[0] for k in _in_order(cross, explained((), 1000.0), apart)] == [DECOY, GEAR]


def test_of_two_names_the_one_that_came_last_gives_way_to_a_second_law_and_never_what_another_brings():
    """Either would do; what a higher order brings along goes with that alone."""
    gear, brake = (Slot(name, "", (k,)) for k, name in ((2, "gear"), (3, "brake")))
    bent, dragged = Slot("gear", "", (5,), law="bent"), Slot("brake", "", (6,), law="bent")
    slope = Slot("gear", "", (2,), brings=("brake",))
    for first, expected in ((gear, (gear, bent)), (slope, (slope, brake))):
        losses = {(first,): 40.0, (brake,): 40.0, (first, brake): 2.01, (first, bent): 2.02}
        losses[(brake, dragged)] = losses[(dragged, brake)] = 2.02 if first is gear else 50.0
        cross = SimpleNamespace(
            problem=SimpleNamespace(slots=(first, brake, bent, dragged)),
            excess=lambda each: each.loss - 2.0, floor=2.0,
            explain=lambda own, losses=losses: explained(own, losses[tuple(own)]),
            fit_beside=lambda *_: None, train_loss=lambda own, losses=losses: (losses[tuple(own)], None),
        )  # fmt: skip
        assert _of_fewest_causes(cross, cross.explain((first, brake)), RNG).slots == expected


def test_a_second_law_that_is_drawn_freely_pays_for_it_beside_two_names_as_well():
    """It leaves a little less than the stated law, as whatever bends does."""
    gear, brake = (Slot(name, "", (k,), plain=True) for k, name in ((2, "gear"), (3, "brake")))
    third = Slot("third", "", (4,))
    drawn, bent = Slot("gear", "", (5,), law="drawn", free=True), Slot("gear", "", (6,), law="bent")
    last = {third: 2.01, drawn: 2.02, bent: 2.03}
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(gear, brake, third, drawn, bent)), excess=lambda each: each.loss - 2.0,
        floor=2.0, explain=lambda own: explained(own, last.get(own[-1], 50.0) if len(own) == 3 else 40.0),
        fit_beside=lambda *_: None, train_loss=lambda own: (last.get(own[-1], 50.0) if len(own) == 3 else 40.0, None),
    )  # fmt: skip
    assert _of_fewest_causes(cross, cross.explain((gear, brake, third)), RNG).slots == (gear, brake, bent)


def test_the_last_effect_of_a_set_is_never_superfluous(monkeypatch):
    """Whether it stands at all is asked by what added it."""
    monkeypatch.setattr(module, "_evidence", lambda *_: np.array([1.0]))
    cross = table((DECOY,), {"": 101.0, "d": 100.0})
    assert _pruned(cross, cross.explain((DECOY,)), RNG).slots == (DECOY,)
