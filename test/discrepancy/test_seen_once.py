"""What a run tells whatever the model says is found once and held once, however many models meet it."""

import numpy as np
from gap_rig import runs_with

from winch_friction.discrepancy import workflow
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.expansion import meet
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
