"""Block means: of the usable samples alone, and only where most of a block is usable; and chances among many."""

import numpy as np
import pytest

from winch_friction.discrepancy.engine.blocks import run_blocks, segment_length, usable_samples
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
