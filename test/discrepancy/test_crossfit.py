"""Evidence that an effect has the same size whichever run is left out."""

import numpy as np
import pytest

from winch_friction.discrepancy.engine.blocks import Blocks, Slot, grams
from winch_friction.discrepancy.engine.crossfit import CrossFit
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem

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
