"""What a run tells whatever the model says is found once and held once, however many models meet it."""

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction.discrepancy import regressors, workflow
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.engine import regions
from winch_friction.discrepancy.engine.blocks import RunBlocks
from winch_friction.discrepancy.expansion import Expansion, expand_around, meet
from winch_friction.discrepancy.preparation import prepare as preparing


def _other(model):
    return model.with_values([1.1 * value for value in model.values])


def test_another_model_meets_known_runs_as_it_would_meet_them_anew(crane_150t, crane2_model):
    runs = runs_with(917, "quiet", length=0.3)
    other = _other(crane2_model)
    known = meet(runs, crane_150t, crane2_model)
    again, anew = meet(runs, crane_150t, other, None, known), meet(runs, crane_150t, other)
    for old, one, two in zip(known.prepared, again.prepared, anew.prepared, strict=True):
        for name in ("gap", "predicted", "jacobian", "load", "speed", "used", "drum_torque", "from_speed"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
        assert (one.wire_mode, one.swing_left) == (two.wire_mode, two.swing_left)
        assert one.seen is old.seen
        assert one.gap is not old.gap
        assert all(getattr(one, name) is getattr(old, name) for name in ("load", "angle", "radius"))


def test_a_search_that_finds_nothing_looks_at_each_run_once(monkeypatch, crane_150t, crane2_model):
    """Each look smooths every channel; four models meet the runs: the seed, the draft, the fitted, the written."""
    runs, looks = runs_with(917, "quiet", length=0.3), []
    see = preparing.see

    def counted(run, crane, turning=False):
        if not turning:
            looks.append(run.name)
        return see(run, crane, turning)

    monkeypatch.setattr(preparing, "see", counted)
    workflow.find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False))
    assert sorted(looks) == sorted(run.name for run in runs)


def test_the_columns_of_all_runs_are_held_once(monkeypatch, crane_150t, crane2_model):
    """Those of each run and all of them behind each other were a fifth of the peak of a million rows each."""
    runs, taken = runs_with(917, "quiet", length=0.3), []
    given = meet(runs, crane_150t, crane2_model)
    layout = regressors.layout_of(regressors.base_of(crane2_model, crane2_model), [], given.prepared, crane2_model)
    made = regressors.problem_of
    monkeypatch.setattr(regressors, "problem_of", lambda tables, *more: taken.extend(tables) or made(tables, *more))
    found = regressors.build_problem(given.prepared, layout).blocks
    ends = np.cumsum([0] + [len(table.y) for table in taken])
    assert ends[-1] == len(found.y) > 100
    for table, a, b in zip(taken, ends[:-1], ends[1:], strict=True):
        assert np.shares_memory(table.x, found.x)
        np.testing.assert_array_equal(table.x, found.x[a:b])
    assert np.isfinite(found.x).all()


def test_what_a_constant_weight_could_explain_goes_in_place():
    rng = np.random.default_rng(5)
    x, y = rng.standard_normal((50, 3)), rng.standard_normal(50)
    table = RunBlocks(y, x.copy(), np.zeros(50, int), np.arange(50), {}, np.ones(50))
    found = regressors._weightless(table, 1)
    assert np.shares_memory(found.x, table.x)
    weight, scale = x[:, 1], float(x[:, 1] @ x[:, 1])
    np.testing.assert_allclose(found.x, x - np.outer(weight, weight @ x / scale), atol=1e-12)
    np.testing.assert_allclose(found.y, y - weight * (weight @ y) / scale, atol=1e-12)


def test_what_was_turned_round_keeps_nothing_to_prepare_it_again(crane_150t, crane2_model):
    runs = runs_with(917, "quiet", length=0.3)
    given = meet(runs, crane_150t, crane2_model)
    base = regressors.base_of(crane2_model, crane2_model)
    seed = Expansion(given.prepared, regressors.layout_of(base, [], given.prepared, crane2_model), crane2_model)
    none = seed.cross([run.name for run in given.prepared]).explain(())
    assert all(run.seen is None for run in expand_around(given, seed, none, [], turning=True).runs)
    assert all(run.seen is not None for run in expand_around(given, seed, none, []).runs)


def test_regions_of_many_blocks_are_weighed_a_few_at_a_time():
    rng = np.random.default_rng(6)
    left = rng.standard_normal(regions.AT_ONCE + 77)
    conditions = [("", rng.uniform(size=len(left)) < share, ()) for share in (0.2, 0.5, 0.9)]
    counts, sums = regions._of_pairs(conditions, left)
    for i, (_, one, _) in enumerate(conditions):
        for j, (_, two, _) in enumerate(conditions):
            assert counts[i, j] == (one & two).sum()
            assert sums[i, j] == pytest.approx(left[one & two].sum())
