"""What is locked is not learned from."""

import numpy as np
import pytest

from winch_friction.discrepancy.adequacy import lock_holdout
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.signals import Run


def runs(count):
    return [Run(f"r{k}", {"time": np.arange(200.0) * 0.02}) for k in range(count)]


def test_no_locked_run_is_learned_from():
    split = lock_holdout(runs(9), 0.25, np.random.default_rng(17))
    assert set(split.train) | set(split.holdout) == {run.name for run in runs(9)}
    assert not set(split.train) & set(split.holdout)
    assert len(split.holdout) == 2


def test_of_each_kind_one_is_locked_where_there_are_two_of_it():
    """Three runs in heave compensation among twenty: a tenth of them is none."""
    active = {f"active.{name}": np.ones(200) for name in ("pressure_a", "pressure_b", "displacement")}
    some = [Run(f"ahc{k}", {**runs(1)[0].columns, **active}) for k in range(3)]
    split = lock_holdout([*runs(20), *some], 0.1, np.random.default_rng(19))
    assert sum(name.startswith("ahc") for name in split.holdout) == 1
    assert len(split.holdout) == 3


def test_of_a_few_runs_the_ends_are_locked_with_a_pause_between():
    few = lock_holdout(runs(2), 0.25, np.random.default_rng(18))
    times = {run.name: (run.time[0], run.time[-1]) for run in few.runs}
    assert len(few.train) == len(few.holdout) == 2
    for train, locked in zip(few.train, few.holdout, strict=True):
        assert times[train][1] < times[locked][0] - 0.9 * LIMITS.guard_time


@pytest.mark.parametrize("seed", range(5))
def test_what_is_locked_lies_within_what_is_learned_from(seed):
    """The heaviest and the lightest run, and the first and the last, are never locked where others are there."""
    rng = np.random.default_rng(seed)
    loads, days = rng.permutation(np.linspace(1e4, 1e5, 12)), rng.permutation(12)
    log = [
        Run(f"r{k}", {"time": 86400.0 * days[k] + np.arange(200.0) * 0.02, "hook_load": np.full(200, loads[k])})
        for k in range(12)
    ]
    locked = [int(name[1:]) for name in lock_holdout(log, 0.25, np.random.default_rng(seed)).holdout]
    assert len(locked) == 3
    assert not {int(np.argmin(loads)), int(np.argmax(loads)), int(np.argmin(days)), int(np.argmax(days))} & set(locked)


@pytest.mark.parametrize("seed", range(5))
def test_no_layer_of_the_drum_is_met_in_the_locked_runs_alone(seed):
    """Three of ten runs on the third of four layers; each of the others reaches beyond all in a signal of its own."""
    layers = (1, 2, 3, 3, 4, 2, 3, 4, 1, 2)
    log = [
        Run(
            f"r{k}",
            {
                "time": np.arange(200.0) * 0.02,
                "wire_layer": np.full(200, float(layer)),
                **{f"signal_{j}": np.full(200, 1.0 + (j == k)) for j in range(10) if layers[j] != 3},
            },
        )
        for k, layer in enumerate(layers)
    ]
    locked = {int(name[1:]) for name in lock_holdout(log, 0.3, np.random.default_rng(seed)).holdout}
    assert len(locked) == 3
    assert len({2, 3, 6} & locked) == 2


@pytest.mark.parametrize("seed", range(5))
def test_of_runs_that_others_cover_those_are_locked_that_cover_most(seed):
    loads = (10, 11, 12, 13, 14, 50, 80, 90, 100)
    log = [
        Run(f"r{k}", {"time": np.arange(200.0) * 0.02, "hook_load": np.full(200, 1e3 * load)})
        for k, load in enumerate(loads)
    ]
    locked = sorted(loads[int(name[1:])] for name in lock_holdout(log, 0.25, np.random.default_rng(seed)).holdout)
    assert locked == [11, 90]
