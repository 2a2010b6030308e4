"""What is locked is not learned from."""

import numpy as np

from winch_friction.discrepancy.holdout import lock_holdout
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.signals import Run


def runs(count):
    return [Run(f"r{k}", {"time": np.arange(200.0) * 0.02}) for k in range(count)]


def test_no_locked_run_is_learned_from():
    split = lock_holdout(runs(9), 0.25, np.random.default_rng(17))
    assert set(split.train) | set(split.holdout) == {run.name for run in runs(9)}
    assert not set(split.train) & set(split.holdout)
    assert len(split.holdout) == 2


def test_of_a_few_runs_the_ends_are_locked_with_a_pause_between():
    few = lock_holdout(runs(2), 0.25, np.random.default_rng(18))
    times = {run.name: (run.time[0], run.time[-1]) for run in few.runs}
    assert len(few.train) == len(few.holdout) == 2
    for train, locked in zip(few.train, few.holdout, strict=True):
        assert times[train][1] < times[locked][0] - 0.9 * LIMITS.guard_time
