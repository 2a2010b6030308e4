"""What a run tells whatever the model says is found once and held once, however many models meet it."""

import tempfile
from dataclasses import replace

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction.discrepancy import catalogue, regressors, standing, workflow
from winch_friction.discrepancy.answer import GapOptions, Verdict
from winch_friction.discrepancy.candidates.friction import shipped_friction
from winch_friction.discrepancy.candidates.signals import signal_candidates
from winch_friction.discrepancy.engine import regions
from winch_friction.discrepancy.engine.blocks import RunBlocks, on_disk, usable_samples, without_column
from winch_friction.discrepancy.expansion import Expansion, Split, expand_around, meet
from winch_friction.discrepancy.preparation import motors
from winch_friction.discrepancy.preparation import seen as seeing
from winch_friction.discrepancy.search import Study, nameless, search_runs


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
    runs, looks, motion_of = runs_with(917, "quiet", length=0.3), [], seeing.motion_of

    def counted(grid, crane, name, turning):
        if not turning:
            looks.append(name)
        return motion_of(grid, crane, name, turning)

    monkeypatch.setattr(seeing, "motion_of", counted)
    result = workflow.find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False))
    assert not any(run.means for side in (result.train, result.holdout) for run in side.runs)
    assert sorted(looks) == sorted(run.name for run in runs)


def _changed(run, **factors):
    """The run with some of its columns times so much, all others the very same."""
    return replace(run, columns={n: v * factors[n] if n in factors else v for n, v in run.columns.items()})


@pytest.mark.parametrize("uneven", [False, True])
def test_what_hangs_on_the_same_columns_is_not_seen_again(monkeypatch, crane_150t, uneven):
    """Nine tenths of what corrections are tried on a run for leaves all but a pressure as it is."""
    run = runs_with(917, "quiet", length=0.3)[0]
    if uneven:
        kept = np.delete(np.arange(len(run)), [70, 71, 150])
        run = replace(run, columns={name: values[kept] for name, values in run.columns.items()})
    first = seeing.see(run, crane_150t)
    group, _ = first.measured
    other = _changed(run, **{"main.pressure_a": 1.01})
    smoothed, smooth = [], motors.smooth_between_steps
    monkeypatch.setattr(motors, "smooth_between_steps", lambda *a: smoothed.append(1) or smooth(*a))
    again, anew = seeing.see(other, crane_150t, before=first), seeing.see(other, crane_150t)
    assert again.motion is first.motion
    assert again.grid.time is first.grid.time
    assert again.grid.columns["main.pressure_b"] is first.grid.columns["main.pressure_b"]
    for name, values in anew.grid.columns.items():
        np.testing.assert_array_equal(again.grid.columns[name], values)
    (own,), torque = again.measured
    assert not smoothed
    (wanted,), theirs = anew.measured
    np.testing.assert_array_equal(torque, theirs)
    for name in ("pressure", "pressure_sum", "low_pressure", "displacement", "logged"):
        np.testing.assert_array_equal(getattr(own, name), getattr(wanted, name))
    assert (own.count, own.balances, own.digit) == (wanted.count, wanted.balances, wanted.digit)
    assert own.displacement is group[0].displacement
    assert own.pressure is not group[0].pressure
    assert seeing.see(run, crane_150t, before=first) is first
    assert not again.known  # asked once, it is let go


@pytest.mark.parametrize("name", ["motor_speed", "main.displacement"])
def test_what_hangs_on_another_column_is_seen_again(crane_150t, name):
    run = runs_with(917, "quiet", length=0.3)[0]
    first = seeing.see(run, crane_150t)
    assert first.measured
    other = _changed(run, **{name: 1.02})
    again, anew = seeing.see(other, crane_150t, before=first), seeing.see(other, crane_150t)
    np.testing.assert_array_equal(again.motion.speed, anew.motion.speed)
    np.testing.assert_array_equal(again.motion.used, anew.motion.used)
    np.testing.assert_array_equal(again.measured[0][0].displacement, anew.measured[0][0].displacement)
    np.testing.assert_array_equal(again.measured[1], anew.measured[1])
    assert (again.motion is first.motion) == (name != "motor_speed")
    geared = replace(crane_150t, gear_ratio=100.0)
    assert seeing.see(run, geared, before=first).motion is not first.motion
    assert seeing.see(run, crane_150t, True, first).motion is not first.motion


def test_the_same_columns_over_another_time_are_another_grid(crane_150t):
    """What a log was stamped with is corrected as well: then nothing of it is where it was."""
    run = runs_with(917, "quiet", length=0.3)[0]
    kept = np.delete(np.arange(len(run)), [70, 71, 150])
    run = replace(run, columns={name: values[kept] for name, values in run.columns.items()})
    first = seeing.see(run, crane_150t)
    other = _changed(run, time=1.01)
    again, anew = seeing.see(other, crane_150t, before=first), seeing.see(other, crane_150t)
    for name, values in anew.grid.columns.items():
        np.testing.assert_array_equal(again.grid.columns[name], values)
    np.testing.assert_array_equal(again.motion.acceleration, anew.motion.acceleration)


def test_of_motors_that_nobody_asked_for_nothing_is_held(crane_150t):
    """An electric drive has none, and the columns of the run as it was would stay for ever."""
    run = runs_with(917, "quiet", length=0.3)[0]
    first = seeing.see(run, crane_150t)
    assert not seeing.see(_changed(run, **{"main.pressure_a": 1.01}), crane_150t, before=first).known
    assert first.measured
    assert seeing.see(_changed(run, **{"main.pressure_a": 1.01}), crane_150t, before=first).known


def test_a_hole_in_a_column_that_moves_nothing_is_one_of_the_motion_too(crane_150t):
    """What stands still in the log has not been measured, whatever the speed says meanwhile."""
    run = runs_with(917, "quiet", length=0.3)[0]
    first = seeing.see(run, crane_150t)
    torn = run["main.pressure_a"].copy()
    torn[200:400] = np.nan
    other = replace(run, columns={**run.columns, "main.pressure_a": torn})
    again, anew = seeing.see(other, crane_150t, before=first), seeing.see(other, crane_150t)
    assert not again.grid.valid.all()
    np.testing.assert_array_equal(again.grid.valid, anew.grid.valid)
    np.testing.assert_array_equal(again.motion.used, anew.motion.used)
    assert again.motion.used.sum() < first.motion.used.sum()


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
    found = without_column(table, 1)
    assert np.shares_memory(found.x, table.x)
    weight, scale = x[:, 1], float(x[:, 1] @ x[:, 1])
    np.testing.assert_allclose(found.x, x - np.outer(weight, weight @ x / scale), atol=1e-12)
    np.testing.assert_allclose(found.y, y - weight * (weight @ y) / scale, atol=1e-12)


@pytest.mark.parametrize("name", ["presliding", "viscosity_temperature"])
def test_a_law_that_remembers_is_reckoned_over_the_whole_run(crane_150t, crane2_model, name):
    run = meet(runs_with(917, "quiet", length=0.1)[:1], crane_150t, crane2_model).prepared[0]
    run = replace(run, used=run.used & (run.time > 0.3 * run.time[-1]))
    candidate = next(each for each in shipped_friction() if each.name == name)
    layout, size = _layout([run], crane2_model, [candidate]), regressors.block_size(run)
    *_, columns = regressors.regressors(run, layout, size)
    whole = regressors.slot_columns(run, layout.slots[-1])[:, -1] * layout.scales[-1] / run.unit_torque
    kept = usable_samples(run.used, size)
    assert 0.1 < kept.mean() < 0.9
    np.testing.assert_array_equal(columns[:, -1], whole[kept])


def test_what_was_turned_round_keeps_nothing_to_prepare_it_again(monkeypatch, crane_150t, crane2_model):
    runs, grids, uniform = runs_with(917, "quiet", length=0.3), [], seeing.uniform
    given = meet(runs, crane_150t, crane2_model)
    monkeypatch.setattr(seeing, "uniform", lambda run, *known: grids.append(run.name) or uniform(run, *known))
    base = regressors.base_of(crane2_model, crane2_model)
    seed = Expansion(given.prepared, regressors.layout_of(base, [], given.prepared, crane2_model), crane2_model)
    none = seed.cross([run.name for run in given.prepared]).explain(())
    assert all(run.seen is None for run in expand_around(given, seed, none, [], turning=True).runs)
    assert not grids  # it is the same, and of a million rows a tenth of the peak
    assert all(run.seen is not None for run in expand_around(given, seed, none, []).runs)


def _layout(prepared, model, candidates):
    return regressors.layout_of(regressors.base_of(model, model), candidates, prepared, model)


def test_means_of_columns_that_were_asked_for_before_are_kept(monkeypatch, crane_150t, crane2_model):
    """A search that asks once more in another way puts hundreds of columns of the same runs to the same blocks."""
    prepared = meet(runs_with(917, "quiet", length=0.3), crane_150t, crane2_model).prepared
    candidates, _ = catalogue.testable(signal_candidates(), prepared, crane2_model)
    layout, asked, made = _layout(prepared, crane2_model, candidates), [], regressors.slot_columns
    monkeypatch.setattr(regressors, "slot_columns", lambda run, slot: asked.append(slot.name) or made(run, slot))
    first = regressors.build_problem(prepared, layout)
    slots = len(prepared) * len(layout.slots)
    assert len(asked) == slots > 100
    twice = replace(candidates[0], columns=lambda run, values: 2.0 * candidates[0].columns(run, values))
    again = regressors.build_problem(prepared, _layout(prepared, crane2_model, [*candidates, twice]))
    more = len(again.layout.slots) - len(layout.slots)
    assert len(asked) == slots + len(prepared) * more  # of another candidate of the same name they are made
    width = first.blocks.x.shape[1]
    np.testing.assert_array_equal(again.blocks.x[:, :width], first.blocks.x)
    own = layout.slots[0].columns[0]
    np.testing.assert_allclose(again.blocks.x[:, width], 2.0 * first.blocks.x[:, own])


def test_the_means_of_days_of_logs_are_not_kept(monkeypatch, crane_150t, crane2_model):
    prepared = meet(runs_with(917, "quiet", length=0.3), crane_150t, crane2_model).prepared
    candidates, _ = catalogue.testable(signal_candidates(), prepared, crane2_model)
    layout = _layout(prepared, crane2_model, candidates)
    regressors.build_problem(prepared, layout, by_sample=True)
    assert not any(run.means for run in prepared)  # of what just reversed nobody asks twice
    monkeypatch.setattr(regressors, "MOST_KEPT", 1000)
    large = regressors.build_problem(prepared, layout).blocks.x
    assert not any(run.means for run in prepared)
    monkeypatch.undo()
    small = regressors.build_problem(prepared, layout).blocks
    held = [isinstance(each, np.memmap) for each in (_owner(large), _owner(small.x))]
    assert held == [True, False]  # once they are summed up a search reads a part of them
    np.testing.assert_array_equal(large, small.x)
    monkeypatch.setattr(tempfile, "TemporaryFile", _full)
    assert on_disk(small).x is small.x


def _owner(values):
    while isinstance(values.base, np.ndarray):
        values = values.base
    return values


def _full(*_, **__):
    raise OSError("no space left on device")


def test_runs_around_a_point_are_prepared_once_as_long_as_somebody_holds_them(crane_150t, crane2_model):
    runs = runs_with(917, "quiet", length=0.3)
    given = meet(runs, crane_150t, crane2_model)
    seed = Expansion(given.prepared, _layout(given.prepared, crane2_model, []), crane2_model)
    none = seed.cross([run.name for run in given.prepared]).explain(())
    first = expand_around(given, seed, none, [])
    assert expand_around(given, seed, none, []).runs is first.runs
    moved = replace(none, beta=none.beta + 1e-6)
    other = expand_around(given, seed, moved, [])
    assert all(np.any(one.gap != two.gap) for one, two in zip(first.runs, other.runs, strict=True))
    assert expand_around(given, seed, none, [], turning=True).runs is not first.runs
    assert len(given.around) == 2
    del first, other
    assert not given.around


@pytest.mark.parametrize("names", [(), pytest.param(("tare_load",), marks=pytest.mark.long)])
def test_a_file_that_was_put_to_the_runs_before_is_not_fitted_again(names, monkeypatch, crane_150t, crane2_model):
    """What chance draws is drawn again, so that nothing after it hangs on whether a file was known."""
    runs = runs_with(917, "quiet", *((name, 1.0) for name in names), length=0.3)
    split = Split(tuple(runs), tuple(run.name for run in runs[:-3]), tuple(run.name for run in runs[-3:]))
    study = Study(split, crane_150t, GapOptions(plan=False), np.random.default_rng(1))
    search = search_runs(study, meet(runs, crane_150t, crane2_model))
    fits, polished = [], standing.polished
    monkeypatch.setattr(standing, "polished", lambda *all_of_it: fits.append(1) or polished(*all_of_it))

    def tried(search):
        return standing.tried(replace(study, rng=np.random.default_rng(2)), search)

    first, again = tried(search), tried(search)
    assert len(fits) == 1
    assert (again.holdout.size_before, again.holdout.size_after) == (
        first.holdout.size_before,
        first.holdout.size_after,
    )
    assert again.train.size_after == first.train.size_after
    assert np.isfinite(again.train.size_after.interval).all()
    kind = "ambiguous" if names else "unexplained"  # the same set of names under another verdict
    other = tried(replace(search, verdict=Verdict(kind)))
    assert (other.repaired.model.provenance["verdict"], len(fits)) == (kind, 1)
    assert other.repaired.model.values == first.repaired.model.values
    tried(nameless(search))
    assert len(fits) == 1 + len(names)


def test_regions_of_many_blocks_are_weighed_a_few_at_a_time():
    rng = np.random.default_rng(6)
    left = rng.standard_normal(regions.AT_ONCE + 77)
    conditions = [("", rng.uniform(size=len(left)) < share, ()) for share in (0.2, 0.5, 0.9)]
    counts, sums = regions._of_pairs(conditions, left)
    for i, (_, one, _) in enumerate(conditions):
        for j, (_, two, _) in enumerate(conditions):
            assert counts[i, j] == (one & two).sum()
            assert sums[i, j] == pytest.approx(left[one & two].sum())
