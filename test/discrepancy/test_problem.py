"""The regression that every question is put to: its noise, what matters to nobody, its prior, its covariance."""

from dataclasses import replace

import numpy as np
import pytest

from winch_friction.discrepancy.engine.blocks import Blocks, RunBlocks, Slot, grams, joined, run_blocks
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.noise import noise_of_run
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem, problem_of
from winch_friction.discrepancy.engine.trials import charged
from winch_friction.discrepancy.thresholds import LIMITS

RUNS, BLOCKS = 6, 240
AT = np.arange(BLOCKS)
RING = np.where(AT % 2 == 0, 1.0, -1.0)  # too quick for any parabola
EFFECT = Slot("effect", "", (1,), most=3.0)
ONE = np.ones(1)


def layout(shift=0.0, bound=2.0):
    base = Base(("b",), 1, ONE, shift * ONE, -bound * ONE, bound * ONE)
    most = np.array([bound, 50.0])
    return Layout(base, (EFFECT,), np.ones(2), -most, most)


def tables(size, noise=0.5, seed=0):
    """Runs whose base column is slow and whose effect rings, of this size, beside independent noise."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(RUNS):
        x = np.column_stack([1.0 + 0.1 * np.sin(AT / 40.0), RING])
        y = size * RING + noise * rng.standard_normal(BLOCKS)
        found.append(RunBlocks(y, x, AT // 20, AT, {}, np.ones(BLOCKS)))
    return found


def known_problem(weight=1.0, shift=0.0, bound=2.0, level=0.0, least=None):
    """One problem over blocks that are all one, with this base level."""
    run = np.repeat(np.arange(RUNS), BLOCKS)
    x = np.column_stack([np.ones(len(run)), np.tile(RING, RUNS)])
    y = np.full(len(run), level)
    blocks = Blocks(y, x, run, run * 20 + np.tile(AT, RUNS) // 20, np.full(len(y), weight), {}, np.ones(len(y)),
                    np.tile(AT, RUNS))  # fmt: skip
    return Problem(layout(shift, bound), blocks, grams(blocks), dict.fromkeys(range(RUNS), 1.0 / weight), least)


# -- noise
def test_the_noise_of_a_few_blocks_is_that_of_one_not_of_the_difference_of_two():
    values = np.random.default_rng(0).standard_normal(11)
    assert len(values) < LIMITS.noise_window
    assert noise_of_run(values, np.arange(11)) == pytest.approx(np.std(np.diff(values)) / np.sqrt(2.0))


def test_what_lies_on_either_side_of_a_gap_is_no_noise():
    """Windows that a gap cuts are left out: its sides have nothing to do with each other."""
    values, position = 0.2 * np.random.default_rng(0).standard_normal(240), AT + 1000 * (AT // 6)
    position[:48] = AT[:48]
    apart = values + np.where(AT < 48, 0.0, 9.0 * RING * (AT // 6 % 2))
    assert noise_of_run(apart, position) == pytest.approx(0.2, rel=0.4)


def test_what_a_known_effect_rings_by_is_no_noise_of_the_runs_it_explains():
    """And no run is noisier for it: what it leaves, or what was there, is the noise, whichever is less."""
    least = np.full(RUNS, 0.01)
    rung, quiet = problem_of(tables(4.0), layout(), least), problem_of(tables(4.0), layout(), least, (EFFECT,))
    assert min(rung.noise.values()) > 3.0
    assert max(quiet.noise.values()) == pytest.approx(0.5, rel=0.25)


def test_blocks_that_are_weighted_anew_are_what_they_would_be_from_the_start():
    again = problem_of(tables(4.0), layout(), np.full(RUNS, 0.01), (EFFECT,))
    afresh = grams(joined(tables(4.0), again.noise))
    np.testing.assert_allclose(again.blocks.weight, joined(tables(4.0), again.noise).weight)
    np.testing.assert_allclose(again.grams.upper, afresh.upper)
    np.testing.assert_allclose(again.grams.b, afresh.b)
    np.testing.assert_allclose(again.grams.y2, afresh.y2)


# -- what matters to nobody
def test_what_no_balance_closes_is_left_beside_the_noise_and_not_twice():
    """Noise of 1 where 2 matter to nobody: three more of its variance; where 0.5 do, none."""
    least = np.where(np.arange(RUNS) == 0, 2.0, 0.5)
    problem = known_problem(least=least)
    assert problem.unresolved.reshape(RUNS, -1)[:, 0] == pytest.approx([3.0, *[0.0] * (RUNS - 1)])
    assert problem.matters == 0.5
    assert known_problem().matters == 0.0
    cross = CrossFit(problem)
    assert cross.floor == pytest.approx(RUNS * BLOCKS + 3.0 * BLOCKS)
    left = Explanation((), np.array([cross.floor + 0.35 * RUNS * BLOCKS]), np.zeros(0), 0.0, np.zeros((0, 0)))
    assert cross.excess(left) == pytest.approx(0.35)


# -- the fit
@pytest.mark.parametrize(("shift", "value"), [(0.0, 0.0), (1.0, -1.0), (-1.0, 1.0)])
def test_without_data_a_base_parameter_returns_to_its_seed(shift, value):
    """`shift` is where the columns were taken, as seen from the seed, in its deviations."""
    problem = known_problem(weight=1e-9, shift=shift)
    beta = problem.fit(*problem.grams.total(), (0,))
    assert beta == pytest.approx([value], abs=1e-6)


@pytest.mark.parametrize("square", [4.0, 1e-6])
def test_a_column_is_held_by_a_millionth_of_itself_and_one_without_data_is_nothing(square):
    """Whichever way it is fitted: by itself, with folds left out, or beside others."""
    problem, start = known_problem(), np.array([0.0, 0.1])
    g, b = np.diag([0.0, square]), np.array([0.0, 2.0 * square])
    held = 2.0 * square / (square * (1.0 + 1e-6) + 1e-9)
    assert problem.fit(g, b, (0, 1), start)[1] == pytest.approx(held, rel=1e-12)
    assert problem.fits(g[None], b[None], (0, 1), start)[0, 1] == pytest.approx(held, rel=1e-12)
    assert problem.fits_beside(g, b, (0,), [(1,)], start[:1])[0, 1] == pytest.approx(held, rel=1e-12)
    nothing = np.zeros((2, 2)), np.zeros(2)
    assert problem.fit(*nothing, (0, 1), start) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_deviation_is_the_priors_without_data_and_thinned_by_its_weight_with_them():
    """Of N blocks of one of noise each N / 10 count."""
    blind, told = known_problem(weight=1e-9), known_problem(weight=1.0)
    assert blind.covariance(blind.grams.total()[0], (0,)) == pytest.approx(1.0, rel=1e-6)
    blocks = RUNS * BLOCKS / LIMITS.prior_weight
    assert told.covariance(told.grams.total()[0], (0,)) == pytest.approx(1.0 / (1.0 + blocks), rel=1e-6)


@pytest.mark.parametrize(("plain", "size", "full"), [(False, 2.9, False), (False, 3.1, True), (True, 3.1, False),
                                                     (True, 50.0, True)])  # fmt: skip
def test_what_a_model_lacks_may_be_of_any_size_that_its_layout_allows(plain, size, full):
    """Of a named effect more than `most` is not believed."""
    slot = replace(EFFECT, plain=plain)
    cross = CrossFit(known_problem())
    own = Explanation((slot,), np.zeros(1), np.array([0.0, size]), 0.0, np.zeros((0, 0)))
    assert cross.at_bound(own, slot) is full


@pytest.mark.parametrize(
    ("slot", "left"),
    [
        (replace(EFFECT, plain=True), 100.0),
        (EFFECT, 100.9),  # a thousandth of the 900 that it saves
        (replace(EFFECT, columns=(1, 2, 3)), 102.7),  # for each of its three
        (replace(EFFECT, free=True, columns=(1, 2, 3)), 145.0),  # and a curve a twentieth, whatever its knots
    ],
)
def test_what_a_law_gives_back_for_being_chosen(slot, left):
    assert charged(1000.0, 100.0, slot) == pytest.approx(left)
    assert charged(100.0, 120.0, slot) == 120.0  # what saves nothing has nothing to give


@pytest.mark.parametrize(("runs", "folds"), [(LIMITS.fewest_runs, LIMITS.fewest_runs), (2, LIMITS.folds)])
def test_of_enough_runs_each_is_left_out_once(runs, folds):
    """Of fewer a stretch of time is."""
    whole = known_problem()
    own = whole.blocks.run < runs
    blocks = replace(
        whole.blocks, y=whole.blocks.y[own], x=whole.blocks.x[own], run=whole.blocks.run[own],
        segment=whole.blocks.segment[own], weight=whole.blocks.weight[own], direction=whole.blocks.direction[own],
        position=whole.blocks.position[own],
    )  # fmt: skip
    cross = CrossFit(Problem(layout(), blocks, grams(blocks), dict.fromkeys(range(runs), 1.0)))
    assert len(np.unique(cross.fold)) == folds


# -- blocks
def test_segments_of_two_records_are_never_one():
    assert len(np.unique(joined(tables(1.0), dict.fromkeys(range(RUNS), 1.0)).segment)) == RUNS * BLOCKS // 20


def test_the_direction_of_a_block_is_where_most_of_it_goes():
    """A sign and no mean: a block of which a third goes the other way is none of a third of a direction."""
    time = 0.01 * np.arange(60)
    way = np.where(np.arange(60) % 20 < 15, 1.0, -1.0) * np.where(np.arange(60) < 20, 1.0, -1.0)
    found = run_blocks(time, time, (time[:, None],), np.ones(60, bool), way, {}, 20, 1.0)
    np.testing.assert_array_equal(found.direction, [1.0, -1.0, -1.0])


# -- the noise by theory
@pytest.mark.parametrize("size", [1.0, 40.0])
def test_the_noise_of_a_long_record_is_its_deviation_whatever_slow_motion_it_has(size):
    """Twelve blocks less a parabola leave nine degrees of freedom, of which the quieter quarter tells."""
    count = 30_000
    slow = 1e3 * np.sin(np.arange(count) / 200.0)
    values = size * np.random.default_rng(5).standard_normal(count) + slow
    assert noise_of_run(values, np.arange(count)) == pytest.approx(size, rel=0.015)


@pytest.mark.parametrize("blocks", [2, 11, 240])
def test_a_record_as_good_as_noise_free_has_a_hundredth_of_what_no_balance_closes(blocks):
    for least in (0.1, 7.0):
        assert noise_of_run(np.zeros(blocks), np.arange(blocks), least) == pytest.approx(0.01 * least)


def test_where_most_of_a_record_rings_the_quieter_quarter_tells_its_noise():
    """Seven tenths of it ring by thirty times the noise."""
    count = 6000
    noise = np.random.default_rng(6).standard_normal(count)
    rings = np.where(np.arange(count) < 0.7 * count, 30.0 * (-1.0) ** np.arange(count), 0.0)
    assert noise_of_run(noise + rings, np.arange(count)) == pytest.approx(1.4, abs=0.5)


def test_each_run_is_as_noisy_as_its_own_balance_closes_at_least():
    """Runs without any noise, before and after what is known of them."""
    least = np.linspace(0.1, 0.6, RUNS)
    for known in ((), (EFFECT,)):
        found = problem_of(tables(0.0, noise=0.0), layout(), least, known)
        assert [found.noise[k] for k in range(RUNS)] == pytest.approx(list(0.01 * least))
        assert found.least_noise is least
