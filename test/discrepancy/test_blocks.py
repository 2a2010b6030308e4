"""Block means: of the usable samples alone, and only where most of a block is usable; and chances among many."""

import numpy as np
import pytest

from winch_friction.discrepancy.engine.blocks import (
    Blocks,
    RunBlocks,
    first_halves,
    grams,
    joined,
    run_blocks,
    samples_of,
    scaled,
    segment_length,
    stretch,
    usable_blocks,
    usable_samples,
    without_column,
)
from winch_friction.discrepancy.engine.chance import varies
from winch_friction.discrepancy.engine.crossfit import flip_p_values
from winch_friction.discrepancy.thresholds import LIMITS

SIZE = 10


def test_a_block_is_the_mean_of_its_usable_samples_and_is_left_out_where_most_are_not():
    share = LIMITS.fullest_block
    usable = [SIZE, round(share * SIZE), round(share * SIZE) - 1, 0]
    mask = np.concatenate([np.arange(SIZE) < count for count in usable])
    gap = np.where(mask, 5.0, 1e6) + np.repeat([0.0, 1.0, 2.0, 3.0], SIZE)
    time = np.arange(len(gap)) * 0.02
    order = [1, 3, 0, 2]  # a column may come over all samples or over those of usable blocks alone
    mask, gap = (np.concatenate([each.reshape(-1, SIZE)[k] for k in order]) for each in (mask, gap))
    own = gap[usable_samples(mask, SIZE)]
    found = run_blocks(time, gap, [own[:, None], -gap[:, None]], mask, np.ones(len(gap)), {"load": gap}, SIZE, 0.3)
    assert found.position.tolist() == [0, 2]
    assert found.y == pytest.approx([6.0, 5.0])
    assert found.x == pytest.approx(np.array([[6.0, -6.0], [5.0, -5.0]]))
    assert found.features["load"] == pytest.approx([6.0, 5.0])
    assert found.segment.tolist() == [0, 1]


def test_segments_are_tens_of_seconds_for_a_campaign_and_never_too_short():
    assert segment_length(10.0 * LIMITS.segments_wanted) == pytest.approx(10.0)
    assert segment_length(1e6) == LIMITS.longest_segment
    assert segment_length(1.0) == LIMITS.shortest_segment


def test_the_chance_of_one_among_many_is_at_least_its_chance_alone():
    """The best of two hundred candidates that gain nothing looks sure by itself."""
    gains = np.random.default_rng(1).standard_normal((200, 40))
    alone = np.array([flip_p_values(each[None], np.random.default_rng(0))[0] for each in gains])
    among = flip_p_values(gains, np.random.default_rng(0))
    assert (among >= alone).all()
    assert among.min() > 3.0 * alone.min()


def table(y, segment, position, **features):
    y, ones = np.array(y, float), np.ones(len(y))
    own = {name: np.array(values, float) for name, values in features.items()}
    return RunBlocks(y, np.column_stack([y, 2.0 * y]), np.array(segment), np.array(position), own, -ones)


def test_records_are_joined_with_segments_of_their_own_and_weighted_by_their_own_noise():
    """What one of them does not log is known of none of its blocks."""
    first, second = table([1, 2, 3], [0, 0, 2], [0, 1, 5], load=[7, 8, 9]), table([4, 5], [0, 1], [2, 3], heave=[6, 6])
    both = joined([first, second], {0: 0.5, 1: 4.0})
    assert both.y.tolist() == [1, 2, 3, 4, 5]
    assert both.x.tolist() == [[k, 2 * k] for k in range(1, 6)]
    assert both.run.tolist() == [0, 0, 0, 1, 1]
    assert both.segment.tolist() == [0, 0, 2, 3, 4]
    assert both.position.tolist() == [0, 1, 5, 2, 3]
    assert both.weight.tolist() == [2.0, 2.0, 2.0, 0.25, 0.25]
    assert both.direction.tolist() == [-1.0] * 5
    assert {name: values.tolist()[:2] for name, values in both.features.items()}["load"] == [7, 8]
    assert np.isfinite(both.features["load"]).tolist() == [True] * 3 + [False] * 2
    assert np.isfinite(both.features["heave"]).tolist() == [False] * 3 + [True] * 2


def test_the_first_half_of_a_record_is_that_of_its_own_blocks():
    """A record that is usable from its second minute on has its halves there."""
    both = joined([table([0] * 4, [0] * 4, [10, 11, 12, 40]), table([0] * 3, [0] * 3, [0, 1, 2])], {0: 1.0, 1: 1.0})
    assert first_halves(both).tolist() == [True, True, False, False, True, True, False]


@pytest.mark.parametrize("runs", [2, LIMITS.fewest_runs + 1])
def test_sums_over_all_parts_and_over_one_fold_are_those_of_the_weighted_columns(runs):
    """A fold leaves out a record, or of few records a stretch of time of all of them."""
    rng, count = np.random.default_rng(4), 40
    run = np.repeat(np.arange(runs), count)
    segment = 4 * run + np.tile(np.arange(count) // 10, runs)
    mixed = rng.permutation(len(run))
    y, x, weight = rng.standard_normal(len(run)), rng.standard_normal((len(run), 3)), 0.5 + run[mixed]
    blocks = Blocks(y, x, run[mixed], segment[mixed], weight, {}, y, mixed)
    sums = grams(blocks)
    z, target = x * weight[:, None], y * weight
    fold = sums.of_segments(sums.fold)
    assert len(np.unique(fold)) == (runs if runs >= LIMITS.fewest_runs else min(LIMITS.folds, 4 * runs))
    for chosen, own in ((None, np.ones(len(run), bool)), *((k, fold == k) for k in np.unique(fold))):
        whole, right = sums.total(chosen)
        np.testing.assert_allclose(whole, z[own].T @ z[own], atol=1e-9)
        np.testing.assert_allclose(right, z[own].T @ target[own], atol=1e-9)
    assert sums.y2.sum() == pytest.approx(target @ target)
    by_segment = [target[blocks.segment == k].sum() for k in np.unique(segment)]
    np.testing.assert_allclose(sums.by_segment(target), by_segment, atol=1e-9)
    assert sums.of_segments(np.unique(segment)).tolist() == blocks.segment.tolist()
    assert set(sums.count) == {10.0}


def test_what_one_column_could_explain_is_taken_out_of_gap_and_columns():
    own = table([1.0, -2.0, 3.0], [0] * 3, [0, 1, 2])
    own.x[:, 1] = [1.0, 1.0, 1.0]
    left = without_column(own, 1)
    assert left.y == pytest.approx([1.0 - 2.0 / 3.0, -2.0 - 2.0 / 3.0, 3.0 - 2.0 / 3.0])
    assert left.x == pytest.approx(np.column_stack([left.y, np.zeros(3)]))
    nothing = table([0.0, 0.0], [0, 0], [0, 1])
    assert without_column(nothing, 1) is nothing


def test_columns_come_in_units_of_their_scales_a_few_at_a_time_and_stay_as_they_were():
    columns = np.arange(1.0, 41.0).reshape(2, 20)
    scales = np.arange(1.0, 21.0)
    parts = list(scaled(columns, scales, 4.0))
    assert [part.shape[1] for part in parts] == [8, 8, 4]
    np.testing.assert_allclose(np.column_stack(parts), columns * scales / 4.0)
    assert columns[0, 0] == 1.0


def test_samples_of_usable_blocks_are_taken_of_every_column_alone():
    mask = np.array([True, True, False, False, True, True, True])
    own = usable_samples(mask, 2)
    assert usable_blocks(mask, 2) == 2 + (LIMITS.fullest_block <= 0.5)
    columns = np.arange(14.0).reshape(7, 2)
    assert samples_of(columns, own)[:4].tolist() == columns[[0, 1, 4, 5]].tolist()
    assert samples_of(columns, slice(None)) is columns


@pytest.mark.parametrize(
    ("places", "whole"), [([3, 4, 5], True), ([3], True), ([3, 5], False), ([], False), ([5, 4], False)]
)
def test_places_that_follow_each_other_are_a_stretch(places, whole):
    found = stretch(np.array(places, int))
    assert isinstance(found, slice) is whole
    assert np.arange(9)[found].tolist() == places


@pytest.mark.parametrize(
    ("values", "tells"),
    [
        (np.linspace(9.9, 10.0, 20), True), (np.linspace(9.9, 10.0, 19), False), (np.linspace(9.91, 10.0, 20), False),
        (np.linspace(-10.0, -9.89, 20), True), (np.linspace(-10.0, -9.91, 20), False), (np.zeros(20), False),
    ],
)  # fmt: skip
def test_a_signal_tells_of_something_where_it_differs_by_a_share_of_its_size(values, tells):
    """By a hundredth of ten, over four seconds."""
    assert varies(values, 0.00999) is tells
