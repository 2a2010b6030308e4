"""The grammar of laws on blocks of which all is known: the amount, who acts, which way, and what is held out."""

import numpy as np
import pytest

from winch_friction.discrepancy.engine import grammar as module
from winch_friction.discrepancy.engine.blocks import Blocks, grams
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.engine.grammar import Factor, Grammar, Law, Scored, _best_of_each
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem

RUNS, BLOCKS = 6, 100
RUN, AT = np.repeat(np.arange(RUNS), BLOCKS), np.arange(RUNS * BLOCKS)
DIRECTION = np.where(AT % 7 < 4, 1.0, -1.0)
WIRE, LEVEL = 2.0 + np.sin(AT / 9.0), 3.0 + np.cos(AT / 23.0)
MEMBERS = np.vstack([np.full(len(AT), 3.0), np.where(RUN < 3, 2.0, 0.0)])  # motors of two groups; the second not always
PRESSURES = np.vstack([1.0 + np.sin(AT / 5.0) ** 2, 2.0 + np.cos(AT / 11.0)])
WIRES, LEVELS, GROUPS = Factor("linear", "wire_out"), Factor("linear", "wire_layer"), Factor("linear", "pressure")
SQUARE = Factor("square", "wire_out")
VALUES = {WIRES: WIRE[None], LEVELS: LEVEL[None], GROUPS: PRESSURES, SQUARE: WIRE[None] ** 2}
TORQUE = 0.5  # gap per N m


def grammar(gap, shift=0.0, most=2.0, weight=4.0):
    """Of a gap over six runs of one base parameter, which is nearly nothing; blocks are weighted alike."""
    x = 1e-6 * np.ones((len(AT), 1))
    if shift:
        x = np.ones((len(AT), 1))
    one = np.ones(1)
    blocks = Blocks(gap, x, RUN, RUN * 10 + AT % BLOCKS // 20, np.full(len(AT), weight), {}, DIRECTION, AT % BLOCKS)
    layout = Layout(Base(("b",), 1, one, shift * one, -most * one, most * one), (), one, -most * one, most * one)
    cross = CrossFit(Problem(layout, blocks, grams(blocks), dict.fromkeys(range(RUNS), 1.0 / weight)))
    return Grammar(cross, cross.explain(()), np.full(len(AT), TORQUE), DIRECTION, MEMBERS)


DEPTH = 70.0 * RUN + 8.0 * np.sin(AT / 9.0)  # m of wire: each run goes up and down by a few, deep below the one before


@pytest.mark.parametrize("weight", [1.0, 4.0])
def test_a_wave_takes_what_it_is_with_its_phase_whatever_the_level_of_each_record(weight):
    """Three of a wave of 9 m, beside a friction of another size in each run."""
    wave = 3.0 * np.sin(2.0 * np.pi * DEPTH / 9.0 + 0.7)
    search = grammar(TORQUE * DIRECTION * (wave + 5.0 * RUN), weight=weight)
    gains, sines, cosines = search.periodic(DEPTH, np.array([1.0 / 9.0, 1.0 / 9.4]), apart=False)
    assert np.hypot(sines[0], cosines[0]) == pytest.approx(3.0, rel=1e-4)
    assert np.arctan2(cosines[0], sines[0]) == pytest.approx(0.7, abs=1e-4)
    level = sum(np.sum((wave[k == RUN] - wave[k == RUN].mean()) ** 2) for k in range(RUNS))
    assert gains[0] == pytest.approx((weight * TORQUE) ** 2 * level, rel=1e-3)
    assert gains[1] < 0.7 * gains[0]


def test_what_the_base_explains_is_no_wave():
    """A level of 1 that the base has room for; the direction makes a wave of it."""
    frequencies = np.linspace(0.05, 0.5, 40)
    explained = grammar(np.ones(len(AT)), shift=1.0).periodic(DEPTH, frequencies, apart=False)[0]
    alone = grammar(np.ones(len(AT))).periodic(DEPTH, frequencies, apart=False)[0]
    assert explained.max() < 0.01 * alone.max()


def test_apart_each_record_has_a_phase_of_its_own():
    search = grammar(TORQUE * DIRECTION * np.sin(2.0 * np.pi * DEPTH / 9.0 + 2.0 * RUN))
    frequency = np.array([1.0 / 9.0])
    together, apart = (search.periodic(DEPTH, frequency, apart=each)[0][0] for each in (False, True))
    assert together < 0.5 * apart


def test_waves_are_looked_at_in_parts_where_all_at_once_would_fill_a_memory(monkeypatch):
    search = grammar(TORQUE * DIRECTION * np.sin(DEPTH))
    frequencies = np.linspace(0.05, 0.5, 40)
    whole = search.periodic(DEPTH, frequencies, apart=False)
    monkeypatch.setattr(module, "AT_ONCE", 5 * len(AT))
    sizes, moments = [], Grammar._moments

    def counted(carrier, left, x, own):
        sizes.append(len(own))
        return moments(carrier, left, x, own)

    monkeypatch.setattr(Grammar, "_moments", staticmethod(counted))
    for each, of_all in zip(search.periodic(DEPTH, frequencies, apart=False), whole, strict=True):
        assert each == pytest.approx(of_all, rel=1e-9)
    assert max(sizes) <= 5


@pytest.mark.parametrize(
    ("law", "column"),
    [
        (Law((WIRES,), opposing=True), WIRE * DIRECTION),
        (Law((WIRES,), opposing=False), WIRE),
        (Law((WIRES, LEVELS), opposing=False), WIRE * LEVEL),
        (Law((GROUPS,), opposing=True, each=True), (PRESSURES * MEMBERS).sum(axis=0) * DIRECTION),
        (Law((GROUPS,), opposing=True), (PRESSURES * (MEMBERS > 0.0)).sum(axis=0) * DIRECTION),
    ],
)
def test_an_amount_is_in_newton_metres_of_what_the_law_says(law, column):
    """Per motor where each has its own, once per group that is there where not; whatever the blocks' noise."""
    for weight in (1.0, 4.0):
        search = grammar(7.0 * TORQUE * column, weight=weight)
        found = search.screened(law, VALUES)
        assert found.amount == pytest.approx(7.0, rel=1e-6)
        assert found.inside == pytest.approx(0.0, abs=1e-6)


def test_a_law_is_judged_on_runs_that_it_was_not_fitted_to():
    """The first run alone shows it: from the others nothing of it is foretold, and of itself they would be better."""
    gap = np.where(RUN == 0, TORQUE * WIRE, 0.0)
    search = grammar(gap)
    screened = search.screened(Law((WIRES,), opposing=False), VALUES)
    judged = search.judged(screened, VALUES)
    before = 16.0 * float(gap @ gap)
    assert screened.inside < before
    assert judged.loss > before
    assert judged.losses.sum() == pytest.approx(judged.loss)
    assert judged.losses[:5].sum() == pytest.approx(before, rel=1e-6)


def test_the_base_takes_only_what_its_seed_allows():
    """A level that the seed's deviation has room for costs what it is off the seed, from where the columns stand."""
    near, far = (grammar(np.full(len(AT), 0.01), shift=shift, weight=1.0) for shift in (-0.01, 5.0))
    law = Law((WIRES,), opposing=True)
    assert near.screened(law, VALUES).inside < 1e-6 < far.screened(law, VALUES).inside


def test_no_law_is_a_product_of_two_functions_of_one_signal():
    found = grammar(TORQUE * WIRE**3).search(VALUES)
    assert {len(each.law.factors) for each in found} == {1, 2}
    assert all(len(each.law.signals) == len(each.law.factors) for each in found)


def test_a_product_with_what_each_group_has_acts_once_per_motor():
    """The wire's length and the pressures of either group: found by what it leaves, and with its number of motors."""
    gap = 2.0 * TORQUE * WIRE * (PRESSURES * MEMBERS).sum(axis=0) * DIRECTION
    best = grammar(gap).search(VALUES)[0]
    assert set(best.law.signals) == {"wire_out", "pressure"}
    assert best.law.each
    assert best.amount == pytest.approx(2.0, rel=1e-6)


def test_what_acts_one_way_is_the_longer_law_of_two_that_say_the_same():
    """Friction opposes; a torque of one direction needs a cause that has one."""
    assert Law((WIRES,), opposing=False).weight == Law((WIRES,), opposing=True).weight + 1


def test_the_best_of_each_set_of_signals_is_kept_for_either_way_of_acting():
    laws = [(Law((f,), opposing=way), left) for f, left in ((WIRES, 3.0), (SQUARE, 1.0)) for way in (True, False)]
    scored = [Scored(law, 1.0, left, np.inf, np.zeros(0)) for law, left in laws]
    kept = _best_of_each(scored, 5)
    assert [(each.law.factors[0].kind, each.law.opposing) for each in kept] == [("square", True), ("square", False)]
    assert len(_best_of_each(scored, 1)) == 1


def test_there_is_more_to_read_of_a_law_with_constants_and_a_signal_is_said_once():
    plain, late = Factor("linear", "wire_out"), Factor("decay", "wire_out", (("tau", 2.0), ("after", 1.0)))
    assert (plain.weight, late.weight) == (1, 3)
    assert Law((plain, late), opposing=True).weight == 4
    assert Law((plain, late, LEVELS), opposing=True).signals == ("wire_out", "wire_layer")


@pytest.mark.parametrize("opposing", [True, False])
def test_a_torque_of_one_direction_is_found_as_surely_as_a_friction(opposing):
    best = grammar(3.0 * TORQUE * WIRE * (DIRECTION if opposing else 1.0)).search({WIRES: WIRE[None]})[0]
    assert (best.law, best.amount) == (Law((WIRES,), opposing=opposing), pytest.approx(3.0, rel=1e-6))


def test_what_is_multiplied_has_had_its_constants_moved_first():
    """The hump stands at 2.5, which the grid has not; its product with the layer is that of the moved one."""

    def made(c):
        return np.exp(-(((WIRE - c) / 0.2) ** 2))

    def hump(c):
        return Factor("hump", "wire_out", (("c", c),))

    search = grammar(TORQUE * DIRECTION * made(2.5) * LEVEL)

    def fit(each):
        if each.law.factors[0].kind != "hump":
            return each, {}
        moved = search.screened(Law((hump(2.5),), each.law.opposing), own := {hump(2.5): made(2.5)[None]})
        return moved, own

    values = {WIRES: WIRE[None], LEVELS: LEVEL[None], hump(2.2): made(2.2)[None], hump(2.8): made(2.8)[None]}
    best = search.search(values, fit)[0]
    assert best.law.factors == (LEVELS, hump(2.5))
    assert best.inside == pytest.approx(0.0, abs=1e-6)
    assert search.search(values)[0].inside > 1.0
    kept = [each.law for each in search.search(values, fit) if len(each.law.factors) == 1 and each.law.opposing]
    assert {law.factors[0].kind for law in kept if law.signals == ("wire_out",)} == {"hump", "linear"}


@pytest.mark.parametrize("read", [False, True])
def test_a_law_that_is_to_be_read_has_three_constants_at_most(read):
    hump = Factor("hump", "motor_speed", (("c", 2.0), ("h", 1.0)))
    others = [Factor("wave", "wire_out", (("c", 2.0), ("h", 1.0))), Factor("step", "wire_layer", (("c", 3.0),))]
    values = {hump: WIRE[None], others[0]: LEVEL[None], others[1]: np.sqrt(LEVEL)[None]}
    found = grammar(TORQUE * WIRE * LEVEL).search(values, (lambda each: (each, {})) if read else None)
    pairs = {frozenset(each.law.factors) for each in found if len(each.law.factors) == 2}
    assert {hump, others[1]} in pairs
    assert ({hump, others[0]} in pairs) is not read


def test_laws_stand_by_what_they_leave_of_runs_that_they_were_not_fitted_to():
    gap = TORQUE * np.random.default_rng(2).normal(size=len(AT)) * np.where(RUN == 2, 5.0, 1.0)
    found = grammar(gap).search(VALUES)
    losses, inside = [each.loss for each in found], [each.inside for each in found]
    assert losses == sorted(losses)
    assert inside != sorted(inside)
    assert {len(each.law.factors) for each in found} == {1, 2}


def test_a_product_with_what_differs_by_group_acts_once_per_motor_whichever_factor_comes_first(monkeypatch):
    """From the wire's length on, alone: the pressures are what makes it one per motor."""
    only = lambda scored, most, **_: [
        each for each in scored if each.law.factors[0] is WIRES or len(each.law.factors) > 1
    ]
    monkeypatch.setattr(module, "_best_of_each", only)
    search, tried = grammar(TORQUE * WIRE), []
    screened = search.screened
    search.screened = lambda law, values: tried.append(law) or screened(law, values)
    search.search({WIRES: WIRE[None], GROUPS: PRESSURES})
    pairs = [law for law in tried if len(law.factors) == 2]
    assert pairs
    assert all(law.each for law in pairs)


@pytest.mark.parametrize("weight", [1.0, 4.0])
def test_what_the_base_explains_is_no_laws_whatever_the_noise(weight):
    """A level of 1 that the base has room for, of blocks that are as sure as they may be."""
    found = grammar(np.ones(len(AT)), shift=1.0, weight=weight).screened(Law((WIRES,), opposing=True), VALUES)
    assert found.inside < 0.01 * weight**2 * len(AT)
    assert found.amount == pytest.approx(0.0, abs=0.01)
