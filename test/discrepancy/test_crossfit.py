"""Evidence that an effect has the same size whichever run is left out, and curves where no run has been."""

import itertools
from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import t as student

from winch_friction.discrepancy.candidates.families import bending
from winch_friction.discrepancy.engine.blocks import Blocks, Slot, grams
from winch_friction.discrepancy.engine.crossfit import (
    CrossFit,
    Explanation,
    far_less,
    flip_p_values,
    on_their_own,
    other_start,
)
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem
from winch_friction.discrepancy.engine.trials import charged, fitted, heads, reshaped
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction.table import Table, tabulated

RUNS, BLOCKS = 9, 200
EFFECT = Slot("effect", "", (1,))


def problem_with(amplitudes, seed=0):
    """One base parameter and one effect of which each run has its own amplitude; it shows in a tenth of each run."""
    rng = np.random.default_rng(seed)
    run = np.repeat(np.arange(RUNS), BLOCKS)
    effect = np.tile(np.where(np.arange(BLOCKS) < BLOCKS // 10, 1.0, 0.0), RUNS)
    x = np.column_stack([rng.standard_normal(RUNS * BLOCKS), effect])
    y = np.asarray(amplitudes)[run] * effect + 0.3 * x[:, 0] + rng.standard_normal(RUNS * BLOCKS)
    position = np.tile(np.arange(BLOCKS), RUNS)
    blocks = Blocks(y, x, run, run * 10 + position // 20, np.ones_like(y), {}, np.ones_like(y), position)
    one = np.ones(1)
    base = Base(("b",), 1, one, 0.0 * one, -2.0 * one, 2.0 * one)
    bound = np.array([2.0, 100.0])
    layout = Layout(base, (EFFECT,), np.ones(2), -bound, bound)
    return Problem(layout, blocks, grams(blocks), dict.fromkeys(range(RUNS), 1.0))


def p_value(problem):
    cross = CrossFit(problem)
    return cross.jackknife_p_value(cross.explain((EFFECT,)))


def test_a_size_is_in_the_effects_own_unit():
    problem = problem_with(np.full(RUNS, 1.0))
    scaled = replace(problem, layout=replace(problem.layout, scales=np.array([1.0, 0.05])))  # a delay's 50 ms
    cross = CrossFit(scaled)
    found = cross.explain((EFFECT,))
    assert cross.size(found, EFFECT) == pytest.approx(0.05 * found.beta[1])
    assert found.beta[1] == pytest.approx(1.0, abs=0.3)


def test_the_same_size_in_every_run_is_sure():
    assert p_value(problem_with(np.full(RUNS, 1.0))) < 1e-4


def test_a_size_that_one_run_alone_makes_is_not():
    amplitudes = np.zeros(RUNS)
    amplitudes[4] = 9.0
    assert p_value(problem_with(amplitudes)) > 0.05


def test_without_the_effect_small_values_are_as_rare_as_they_should_be():
    values = np.array([p_value(problem_with(np.zeros(RUNS), seed)) for seed in range(200)])
    assert np.mean(values < 0.05) == pytest.approx(0.05, abs=0.05)
    assert np.mean(values < 0.001) <= 0.01


DATES = (0.0, 0.25, 0.5, 0.75, 1.0)


def dated(free):
    """Nine runs over the dates, of a friction that grows with their square; the curve has an interval of its own for
    the last run."""
    curve = tabulated(Table("aged", (("time", DATES),), shape="rising", anchor="low"))
    form = bending(curve.table)
    date = np.repeat([*np.linspace(0.0, 0.755, RUNS - 1), 1.0], BLOCKS)
    ramps = np.column_stack([np.clip((date - a) / 0.25, 0.0, 1.0) for a in DATES[:-1]])
    whole = np.zeros((5, 5))
    whole[1:, 1:] = form
    rng = np.random.default_rng(1)
    x = np.column_stack([rng.standard_normal(len(date)), ramps])
    y = 20.0 * date**2 + rng.standard_normal(len(date))
    run, position = np.repeat(np.arange(RUNS), BLOCKS), np.tile(np.arange(BLOCKS), RUNS)
    blocks = Blocks(y, x, run, run * 10 + position // 20, np.ones_like(y), {}, np.ones_like(y), position)
    one = np.ones(1)
    base = Base(("b",), 1, one, 0.0 * one, -2.0 * one, 2.0 * one)
    slot = Slot("wear", "", (1, 2, 3, 4), free=True)
    low = np.array([-2.0, 0.0, 0.0, 0.0, 0.0])
    layout = Layout(base, (slot,), np.ones(5), low, np.full(5, 1e3), None if free else whole)
    cross = CrossFit(Problem(layout, blocks, grams(blocks), dict.fromkeys(range(RUNS), 1.0)))
    return cross.explain((slot,)).losses.reshape(RUNS, -1).sum(axis=1) / BLOCKS


def test_beyond_the_runs_that_it_was_drawn_through_a_curve_goes_on_as_it_went():
    stiff, free = dated(False), dated(True)
    # flat beyond 0.755 it would be 8.6 below; the straight line is 1 to 2 below; freely fitted, a sliver decides
    assert stiff[-1] < 10.0 < free[-1]
    np.testing.assert_allclose(stiff[1:-2], free[1:-2], atol=1.0)


def test_a_straight_curve_is_not_held_back():
    knots = (0.0, 1.0, 4.0, 6.0)
    form = bending(Table("drag", (("wire_out", knots),), shape="rising", anchor="low"))
    assert np.diff(knots) @ form @ np.diff(knots) == pytest.approx(0.0, abs=1e-12)
    assert np.array([1.0, 1.0, 1.0]) @ form @ np.array([1.0, 1.0, 1.0]) > 0.1
    convex = bending(Table("drag", (("wire_out", knots),), shape="convex_rising", anchor="low"))
    assert np.array([1.0, 0.0, 0.0]) @ convex @ np.array([1.0, 0.0, 0.0]) == 0.0
    assert np.array([1.0, 1.0, 0.0]) @ convex @ np.array([1.0, 1.0, 0.0]) > 0.1
    assert bending(Table("map", (("wire_out", knots), ("pressure", knots)))) is None


def test_halves_of_gram_matrices_are_the_whole():
    blocks = problem_with(np.ones(RUNS)).blocks
    x = np.column_stack([blocks.x, blocks.x[:, 0] ** 2, blocks.y**3])
    weight = 1.0 / (1.0 + blocks.run)
    kept = grams(replace(blocks, x=x, weight=weight))
    z, y = x * weight[:, None], blocks.y * weight
    np.testing.assert_allclose(kept.total()[0], z.T @ z, rtol=1e-12)
    np.testing.assert_allclose(kept.total()[1], z.T @ y, rtol=1e-9, atol=1e-12)
    own = blocks.run == 3
    np.testing.assert_allclose(kept.total(3)[0], z[own].T @ z[own], rtol=1e-12)
    np.testing.assert_allclose(kept.total(3)[1], z[own].T @ y[own], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("runs", [RUNS, LIMITS.fewest_runs - 1])
def test_held_out_losses_are_those_of_fits_to_the_other_folds(runs):
    """Of every segment, by the coefficients of the fold that leaves it out, whatever the order of the blocks."""
    blocks = problem_with(np.ones(RUNS)).blocks
    mixed = np.random.default_rng(2).permutation(np.flatnonzero(blocks.run < runs))
    some = {f.name: getattr(blocks, f.name)[mixed] for f in fields(blocks) if f.name != "features"}
    blocks = replace(blocks, **some | {"weight": 1.0 / (1.0 + some["run"])})
    problem = replace(problem_with(np.ones(RUNS)), blocks=blocks, grams=grams(blocks))
    cross = CrossFit(problem)
    found, columns = cross.explain((EFFECT,)), list(problem.columns((EFFECT,)))
    for k, segment in enumerate(np.unique(blocks.segment)):
        own = blocks.segment == segment
        fold = problem.grams.fold[k]
        left_out = np.isin(blocks.segment, np.unique(blocks.segment)[problem.grams.fold == fold])
        z, y = (blocks.x[:, columns] * blocks.weight[:, None])[~left_out], (blocks.y * blocks.weight)[~left_out]
        beta = problem.fit(z.T @ z, z.T @ y, columns)
        left = (blocks.y - blocks.x[:, columns] @ beta)[own] * blocks.weight[own]
        assert found.losses[k] == pytest.approx(float(left @ left), rel=1e-6)


def test_segments_need_not_stand_in_order():
    blocks = problem_with(np.ones(RUNS)).blocks
    mixed = np.random.default_rng(1).permutation(len(blocks.y))
    shuffled = replace(
        blocks, y=blocks.y[mixed], x=blocks.x[mixed], run=blocks.run[mixed], segment=blocks.segment[mixed],
        weight=blocks.weight[mixed],
    )  # fmt: skip
    ours, theirs = grams(shuffled), grams(blocks)
    np.testing.assert_allclose(ours.upper, theirs.upper, rtol=1e-12)
    np.testing.assert_allclose(ours.b, theirs.b, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(ours.run, theirs.run)


def test_no_block_is_no_segment():
    blocks = problem_with(np.ones(RUNS)).blocks
    none = replace(blocks, **{f.name: getattr(blocks, f.name)[:0] for f in fields(blocks) if f.name != "features"})
    assert grams(none).total()[0].tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert grams(none).by_segment(none.y).tolist() == []


def test_what_is_asked_again_is_what_was_answered_first():
    """Of each order of the same effects, for the columns and so the coefficients follow it."""
    problem = problem_with(np.full(RUNS, 1.0))
    again = CrossFit(problem)
    for slots in ((), (EFFECT,), (), (EFFECT,)):
        fresh, kept = CrossFit(problem).explain(slots), again.explain(slots)
        np.testing.assert_array_equal(fresh.losses, kept.losses)
        np.testing.assert_array_equal(fresh.beta, kept.beta)
        np.testing.assert_array_equal(fresh.left_out, kept.left_out)
        assert fresh.train_loss == kept.train_loss == again.train_loss(slots)[0]
        assert kept.slots == slots
    assert again.explain([EFFECT]) is again.explain((EFFECT,))
    assert not again.explain((EFFECT,)).beta.flags.writeable


def test_fits_of_many_at_once_are_those_of_one_after_the_other():
    """Of as many columns or more, beside something and alone; what is known already is not asked for again."""
    problem = problem_with(np.full(RUNS, 1.0))
    blocks, rng = problem.blocks, np.random.default_rng(7)
    others = blocks.y[:, None] * np.array([0.3, 0.5, 0.2, 0.1, 0.4]) + rng.standard_normal((len(blocks.y), 5))
    more = np.column_stack([blocks.x, others])
    more = replace(blocks, x=more, weight=1.0 / (1.0 + blocks.run))
    slots = (EFFECT, *(Slot(name, name, at) for name, at in (("b", (2,)), ("c", (3, 4)), ("d", (5,)), ("e", (4, 6)))))
    lower, upper = np.array([-0.1, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0]), np.array([0.1, 9.0, 0.3, 1.0, 5.0, 0.2, 0.01])
    layout = replace(problem.layout, slots=slots, scales=np.ones(7), lower=lower, upper=upper)
    problem = replace(problem, layout=layout, blocks=more, grams=grams(more))
    for rest in ((), (slots[2],)):
        one, many, others = CrossFit(problem), CrossFit(problem), [each for each in slots if each not in rest]
        many.fit_beside(rest, others)
        asked, many.problem = many.problem, None  # nothing is fitted any more
        columns = [asked.columns((*rest, own)) for own in others]
        found = [many._fits[each] for each in columns]
        for (loss, beta), own in zip(found, others, strict=True):
            wanted = one.train_loss((*rest, own))
            assert loss == pytest.approx(wanted[0], rel=1e-9)
            np.testing.assert_allclose(beta, wanted[1], rtol=1e-7, atol=1e-9)
            assert not beta.flags.writeable
            assert beta[-1] > 0.0
        many.problem = asked
        many.fit_beside(rest, others)
        assert all(many._fits[each] is old for each, old in zip(columns, found, strict=True))


@pytest.mark.parametrize(("unresolved", "gain", "inside"), [(0.0, 0.5, 0.2), (156.0, 0.159, 0.073)])
def test_a_gain_is_of_the_held_out_error_and_inside_of_that_of_the_fit(unresolved, gain, inside):
    """What matters to nobody is saved by nothing."""
    problem = problem_with(np.ones(RUNS))
    cross = CrossFit(problem)
    cross.unresolved = unresolved
    before = replace(cross.explain(()), losses=np.full(2, 50.0), train_loss=100.0)
    after = replace(before, losses=np.full(2, 12.5), train_loss=64.0)
    assert float(cross.gain(before, after)) == pytest.approx(gain, abs=1e-3)
    assert float(cross.inside_gain(before, after)) == pytest.approx(inside, abs=1e-3)


def test_stretches_of_a_few_runs_are_too_alike_to_be_sure_by():
    """Though each of them has the effect of one size."""
    few = problem_with(np.ones(RUNS)).blocks
    own = few.run < LIMITS.fewest_runs - 1
    some = {f.name: getattr(few, f.name)[own] for f in fields(few) if f.name != "features"}
    problem = replace(problem_with(np.ones(RUNS)), blocks=replace(few, **some), grams=grams(replace(few, **some)))
    assert len(CrossFit(problem).sums_b) == LIMITS.folds
    assert p_value(problem) == 1.0


@pytest.mark.parametrize(("by_part", "found"), [(False, ["b"]), (True, ["a", "b"])])
def test_of_each_thing_that_a_law_may_speak_of_the_best_is_asked_where_they_are_told_apart(by_part, found):
    one, other = (Slot("zero", "", (1,), law="grows", part=part) for part in "ab")
    losses = {"a": 3.0, "b": 2.0}
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(one, other)),
        fit_beside=lambda *_: None,
        train_loss=lambda slots: (losses[slots[-1].part], None),
    )
    assert [slot.part for slot in fitted(cross, (), set(), by_part)] == found


def stub(slots=()):
    """A floor of 100 blocks of noise; what is plain leaves a little less than the law itself."""
    return SimpleNamespace(
        floor=100.0, excess=lambda each: (each.loss - 100.0) / 100.0, problem=SimpleNamespace(slots=slots),
        explain=lambda own: explained(own, 60.0 if own[-1].plain else 70.0),
    )  # fmt: skip


def explained(slots, above):
    return SimpleNamespace(slots=tuple(slots), loss=100.0 + above)


BENT, PLAIN = Slot("wear", "", (1,), law="bent"), Slot("wear", "", (2,), law="")


@pytest.mark.parametrize(
    ("laws", "above", "less"), [(1, 90.0, True), (1, 110.0, False), (2, 90.0, False), (2, 30.0, True)]
)
def test_a_set_of_more_laws_is_far_less_only_where_it_leaves_noise(laws, above, less):
    anew, current = explained([PLAIN, EFFECT][:laws], above), explained([BENT], 200.0)
    assert far_less(stub(), anew, current) is less


@pytest.mark.parametrize(("first", "above", "anew"), [(BENT, 90.0, True), (BENT, 30.0, False), (PLAIN, 90.0, False)])
def test_a_search_begins_anew_from_the_own_law_of_a_cause_whose_bent_one_leaves_more_than_noise(first, above, anew):
    lacked = replace(PLAIN, plain=True)  # and leaves less, as what every machine has
    cross = stub((BENT, lacked, PLAIN))
    found = other_start(cross, explained([first, EFFECT], above))
    assert (found is not None and found.slots == (PLAIN,)) is anew
    assert other_start(cross, explained([], above)) is None


# -- what is charged, who speaks for a cause, where else to begin
LACKED = Slot("coulomb", "", (1,), plain=True)
LAW, CURVE = Slot("wear", "", (2, 3), law="law"), Slot("wear", "", (4,), law="curve", free=True)
OWN, OIL = Slot("wear", "", (5,)), Slot("oil", "", (7,), law="other")


def left(slots, loss):
    return Explanation(tuple(slots), np.array([float(loss)]), np.zeros(0), float(loss), np.zeros((0, 0)))


@pytest.mark.parametrize(
    ("slot", "after", "expected"),
    [
        (LACKED, 600.0, 600.0),
        (OWN, 600.0, 600.0 + 0.001 * 400.0),
        (LAW, 600.0, 600.0 + 2 * 0.001 * 400.0),  # for each of its parameters
        (CURVE, 600.0, 600.0 + 0.05 * 400.0),
        (CURVE, 1200.0, 1200.0),  # who saves nothing gives nothing back
    ],
)
def test_what_imitates_gives_back_a_share_of_what_it_saves(slot, after, expected):
    assert charged(1000.0, after, slot) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("law", "curve", "speaks"),
    [(100.0, 60.0, "law"), (100.0, 54.0, "curve"), (10.3, 10.1, "law"), (100.0, 200.0, "law")],
)
def test_of_a_cause_the_curve_speaks_that_leaves_less_than_half_above_the_floor_of_more_than_nothing(
    law, curve, speaks
):
    """Of a floor of 10 and a block; the law comes first, for by what a curve gives back it is the better one."""
    cross = SimpleNamespace(floor=10.0, problem=SimpleNamespace(grams=SimpleNamespace(count=np.ones(1))))
    (own,) = heads(cross, 1000.0, [left((CURVE,), curve), left((LAW,), law)])
    if speaks == "curve" or curve + 0.05 * (1000.0 - curve) > law + 0.002 * (1000.0 - law):
        assert own.slots[-1].law == speaks
    both = heads(cross, 1000.0, [left((LACKED,), 500.0), left((CURVE,), curve), left((LAW,), law)])
    assert [each.slots[-1].name for each in both] == ["wear", "coulomb"]


@pytest.mark.parametrize(
    ("first", "excess", "begins"),
    [
        (LAW, 0.4, True),
        (LAW, 0.3, False),
        (OWN, 0.4, False),
        (None, 0.4, False),
        (Slot("oil", "", (7,), law="x"), 0.4, False),
    ],
)
def test_once_more_is_begun_from_the_own_law_of_a_cause_whose_other_law_leaves_more_than_noise(first, excess, begins):
    plain = Slot("wear", "plain", (8,), plain=True)
    losses = {OWN: 300.0, LAW: 200.0, plain: 100.0}
    cross = SimpleNamespace(
        excess=lambda _: excess, problem=SimpleNamespace(slots=(plain, OWN, LAW, CURVE)),
        explain=lambda slots: left(slots, losses[slots[0]]),
    )  # fmt: skip
    found = other_start(cross, left((first,) if first else (), 400.0))
    assert (found.slots if found else None) == ((OWN,) if begins else None)


@pytest.mark.parametrize(
    ("count", "loss", "less"), [(2, 54.0, True), (2, 56.0, False), (1, 54.0, True), (3, 54.0, False), (3, 10.3, True)]
)
def test_a_set_of_as_many_laws_is_far_better_by_half_and_one_of_more_by_leaving_noise(count, loss, less):
    """Beside two laws that leave 100, of a floor of 10."""
    cross = SimpleNamespace(floor=10.0, excess=lambda each: each.loss - 10.0)
    anew, current = left((OWN, LAW, CURVE)[:count], loss), left((OWN, LAW), 100.0)
    assert far_less(cross, anew, current) is less


def test_whatever_is_brought_along_or_a_bare_model_lacks_has_no_name_of_its_own():
    slope, late = Slot("slope", "", (6,), brings=("level",)), Slot("late", "", (7,), brings=("early",))
    level, early = Slot("level", "", (8,)), Slot("early", "", (9,))
    assert on_their_own((LACKED, level, slope, early, late, OWN)) == [slope, late, OWN]


def test_of_each_law_the_variant_is_taken_that_leaves_least_and_of_what_is_there_already_none():
    slow, fast = Slot("wear", "slow", (2,), law="law"), Slot("wear", "fast", (3,), law="law")
    own, of_gear = Slot("wear", "", (4,)), Slot("wear", "", (5,), part="gear")
    losses = {slow: 30.0, fast: 20.0, own: 25.0, of_gear: 27.0, LACKED: 40.0}
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=tuple(losses)),
        fit_beside=lambda *_: None,
        train_loss=lambda slots: (losses[slots[-1]], None),
    )
    assert fitted(cross, (), set()) == [fast, own, LACKED]
    assert fitted(cross, (), set(), by_part=True) == [fast, own, of_gear, LACKED]
    assert fitted(cross, (fast,), {"coulomb"}) == [slow, own]
    assert fitted(cross, (), {"wear"}) == [LACKED]


def test_a_gain_is_a_share_of_the_error_that_is_held_out_or_fitted_beside_what_matters_to_nobody():
    """Of losses of 91 and 16, with 9 that nobody minds: of errors of 10 and 5."""
    cross = CrossFit(problem_with(np.ones(RUNS)))
    cross.unresolved = 9.0
    before, after = (
        Explanation((), np.array([loss]), np.zeros(0), fitted_loss, np.zeros((0, 0)))
        for loss, fitted_loss in ((91.0, 40.0), (16.0, 27.0))
    )
    assert float(cross.gain(before, after)) == pytest.approx(0.5)
    assert float(cross.inside_gain(before, after)) == pytest.approx(1.0 - 6.0 / 7.0)


def test_a_fits_loss_is_what_its_coefficients_leave():
    problem = problem_with(np.linspace(0.5, 1.5, RUNS))
    cross = CrossFit(problem)
    loss, beta = cross.train_loss((EFFECT,))
    remains = problem.blocks.y - problem.blocks.x @ beta
    assert loss == pytest.approx(remains @ remains)
    found = cross.explain((EFFECT,))
    np.testing.assert_allclose(cross.remainder(found), remains, rtol=1e-9)
    assert cross.inside_excess(found) == pytest.approx(np.mean(remains**2 - 1.0 - problem.unresolved))
    some = np.arange(len(remains)) < 300
    assert cross.inside_excess(found, some) == pytest.approx(np.mean((remains**2 - 1.0 - problem.unresolved)[some]))
    assert cross.excess(found) == pytest.approx((found.loss - cross.floor) / len(remains))
    assert cross.floor == pytest.approx(len(remains) + problem.unresolved.sum())


@pytest.mark.parametrize("spread", [0.05, 0.3])
def test_how_steady_a_size_is_is_the_jackknifes_student_t(spread):
    """Of the sizes that leave one fold out: their mean over sqrt((n - 1)/n of their summed squares), both sides."""
    cross = CrossFit(problem_with(np.linspace(1.0 - spread, 1.0 + spread, RUNS)))
    found = cross.explain((EFFECT,))
    sizes = found.left_out[:, 1]
    n = len(sizes)
    error = np.sqrt((n - 1) / n * np.sum((sizes - sizes.mean()) ** 2))
    assert cross.jackknife_p_value(found) == pytest.approx(2.0 * student.sf(abs(sizes.mean()) / error, n - 1))


def test_chances_of_a_family_are_those_of_its_largest_t():
    """Counted over all signs of eight segments, of which a draw of many is a sample."""
    gains = np.array([[3.0, 1.0, 2.0, 1.0, 4.0, 1.0, 2.0, 1.5], [1.0, -1.0, 2.0, -2.0, 3.0, 1.0, -1.0, 2.0]])
    scaled = gains / np.linalg.norm(gains, axis=1)[:, None]
    signs = np.array(list(itertools.product((1.0, -1.0), repeat=8)))
    largest = (signs @ scaled.T).max(axis=1)
    expected = [np.mean(largest >= t - 1e-12) for t in scaled.sum(axis=1)]
    found = flip_p_values(gains, np.random.default_rng(0))
    assert found == pytest.approx(expected, abs=4.0 * np.sqrt(0.25 / LIMITS.flips))
    assert flip_p_values(100.0 * gains, np.random.default_rng(0)).tolist() == found.tolist()
    assert flip_p_values(np.zeros((1, 5)), np.random.default_rng(0)).tolist() == [1.0]


# -- sizes and bounds by figures
TWO, PLAIN_ONE = Slot("two", "", (3, 4), most=6.0), Slot("plain", "", (2,), most=6.0, plain=True)


def sized(*beta):
    """A base of one column, and beside it the plain effect of column 2 and the two amounts of columns 3 and 4."""
    layout = SimpleNamespace(upper=np.array([2.0, 9.0, 50.0, 1e9, 1e9]), scales=np.array([1.0, 1.0, 10.0, 100.0, 1e3]))
    problem = SimpleNamespace(columns=lambda slots: (0, *(c for each in slots for c in each.columns)), layout=layout)
    return SimpleNamespace(problem=problem), SimpleNamespace(slots=(PLAIN_ONE, TWO), beta=np.array([2.0, *beta]))


@pytest.mark.parametrize(
    ("beta", "plain", "two"),
    [
        ((7.0, 5.9, -5.9), False, False),  # what a bare model lacks is as large as its layout allows
        ((49.0, 6.0, 0.1), False, True),  # one of its amounts is enough
        ((49.0, 0.1, 6.0), False, True),
        ((50.0, 0.1, -6.0), True, True),  # whichever sign it has
        ((-50.0, -6.0, 0.0), True, True),
        ((0.0, 5.998, 0.0), False, True),  # so near to it the fit was stopped there
    ],
)
def test_an_effect_is_at_its_bound_where_one_of_its_amounts_is(beta, plain, two):
    cross, found = sized(*beta)
    assert (CrossFit.at_bound(cross, found, PLAIN_ONE), CrossFit.at_bound(cross, found, TWO)) == (plain, two)


def test_the_size_of_an_effect_is_that_of_its_first_amount_in_its_own_unit():
    cross, found = sized(7.0, 3.0, 4.0)
    assert (CrossFit.size(cross, found, PLAIN_ONE), CrossFit.size(cross, found, TWO)) == (70.0, 300.0)


def test_what_is_left_inside_is_the_square_above_the_noise_and_what_matters_to_nobody():
    unresolved = np.array([0.0, 2.0, 5.0, 0.5])
    cross = SimpleNamespace(
        problem=SimpleNamespace(unresolved=unresolved), remainder=lambda _: np.array([2.0, -2.0, 3.0, 1.0])
    )
    assert CrossFit.inside_excess(cross, None) == pytest.approx((3.0 + 1.0 + 3.0 - 0.5) / 4.0)
    assert CrossFit.inside_excess(cross, None, np.array([True, False, True, False])) == pytest.approx(3.0)


def test_a_law_is_shaped_anew_within_what_it_speaks_of_beside_the_others_as_they_are_then():
    """Another group's feedback has laws of its own, however well they fit."""
    first, second = (Slot("zero", f"shape {k}", (k,), law="bent", part="1") for k in (1, 2))
    strange = [Slot("zero", "", (3,), law="bent", part="2"), Slot("zero", "", (4,), part="1"), Slot("gain", "", (5,))]
    other, wider = Slot("wave", "narrow", (6,)), Slot("wave", "wide", (7,))
    losses = {first: 5.0, second: 4.0, other: 2.0, wider: 1.0, **dict.fromkeys(strange, 0.1)}
    cross = SimpleNamespace(
        problem=SimpleNamespace(slots=(first, second, *strange, other, wider)),
        # wide pays off beside the second shape alone
        fit_beside=lambda *_: None,
        train_loss=lambda slots: (sum(losses[s] + 3.0 * (s is wider and second not in slots) for s in slots), None),
    )
    assert reshaped(cross, (first, other)) == (second, wider)
    assert reshaped(cross, (other, first)) == (other, second)
