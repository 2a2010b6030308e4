"""A change between two training runs is placed among the locked runs between them by what their first halves show."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from gap_rig import names_of, runs_with

from winch_friction.discrepancy.adequacy import lock_holdout
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.workflow import find_gap

DRAG = 6.0  # N m per motor; the catalogue's brake takes 3
OPTIONS = GapOptions(plan=False, proposals=False)


def dragging(run, crane, since):
    """The run with more Coulomb friction after that time: the pressures that overcome it."""
    groups = [name for name in ("main", "active") if f"{name}.pressure_a" in run.columns]
    swept = sum(crane.groups[name] * run[f"{name}.displacement"] for name in groups)
    torque = DRAG * sum(crane.groups.values()) * np.sign(run["motor_speed"]) * (run.time > since)
    more = {f"{name}.pressure_a": run[f"{name}.pressure_a"] + torque / swept for name in groups}
    return replace(run, columns={**run.columns, **more})


@pytest.mark.long
@pytest.mark.parametrize("before", [True, False])
def test_a_locked_run_between_tells_on_which_side_of_a_change_it_lies(before, crane_150t, crane2_model):
    runs = runs_with(4407, "quiet", length=0.3)
    by_name = sorted(runs, key=lambda run: run.name)
    split = lock_holdout(by_name, OPTIONS.holdout, np.random.default_rng(OPTIONS.seed))
    dates = sorted(runs, key=lambda run: run.time[0])
    k = next(k for k in range(2, 10) if dates[k].name in split.holdout and dates[k + 1].name in split.train)
    first, second = (k - 1, k) if before else (k, k + 1)
    since = 0.5 * (dates[first].time[-1] + dates[second].time[0])
    result = find_gap([dragging(run, crane_150t, since) for run in runs], crane_150t, crane2_model, OPTIONS)
    # what drags since a date may be a brake as well as what wore, or broke, all at once
    assert names_of(result) == [{"brake_drag", "wear_drift"}]
    assert result.effects[0].law_name == "wear_sudden"
    # half the way to the next instant between two runs; it was a tenth of the time since 1970
    between = np.diff([0.5 * (a.time[-1] + b.time[0]) for a, b in itertools.pairwise(dates)])
    assert 0.5 * between.min() <= result.effects[0].parameters["t_wd"].std <= 0.5 * between.max()
    value = result.model.as_dict()["t_wd"]
    assert dates[first].time[-1] < value < dates[second].time[0]
    assert result.holdout.size_after.value <= 1.5 * result.holdout.noise_floor
