"""What is locked is not learned from."""

import numpy as np
import pytest

from winch_friction.discrepancy.adequacy import _beyond, _covered, _drawn, _unseen, lock_holdout, refuse
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.errors import InputError
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


def test_of_a_divided_run_the_last_part_is_locked_and_both_keep_what_the_run_said():
    time = 100.0 + np.arange(0.0, 20.01, 0.1)
    run = Run("long", {"time": time, "hook_load": 5.0 * time}, {}, ("a warning",), {"made": "by hand"})
    split = lock_holdout([run], 0.25, np.random.default_rng(0))
    assert (split.train, split.holdout) == (("long (first part)",), ("long (last part)",))
    first, last = split.runs
    assert (first.time[0], last.time[0], last.time[-1]) == pytest.approx((100.0, 115.0, 120.0))
    assert first.time[-1] == pytest.approx(115.0 - LIMITS.guard_time, abs=0.11)
    for part in split.runs:
        assert part["hook_load"] == pytest.approx(5.0 * part.time)
        assert (tuple(part.warnings), part.metadata) == (("a warning",), {"made": "by hand"})


@pytest.mark.parametrize(
    ("kinds", "fraction", "counts"),
    [
        ([8], 0.25, [2]), ([8, 4], 0.25, [2, 1]), ([2], 0.1, [1]), ([1, 6], 0.5, [0, 3]), ([1, 6], 0.6, [0, 4]),
        ([3], 0.6, [2]), ([2], 0.6, [1]), ([2, 2], 0.05, [1, 1]),
    ],
)  # fmt: skip
def test_of_every_kind_a_share_is_locked_and_never_all(kinds, fraction, counts):
    places = np.split(np.arange(sum(kinds)), np.cumsum(kinds)[:-1])
    for seed in range(20):
        locked = _drawn([own.tolist() for own in places], fraction, np.random.default_rng(seed))
        assert [len(locked & set(own.tolist())) for own in places] == counts


def test_what_is_locked_reaches_beyond_the_others_by_ranges_of_all_runs():
    """Of loads of 1 to 5 t: what the locked ones reach below and above, less a small part of what they cover."""
    loads = np.array([[1.0, 2.0], [2.0, 3.0], [3.0, 4.0], [4.0, 5.0], [np.nan, np.nan]])
    small = LIMITS.lock_cover / 4.0
    for locked, far in (({1}, -small), ({0}, 0.25 - small), ({3}, 0.25 - small), ({0, 3}, 0.5 - 4.0 * small)):
        assert _beyond(frozenset(locked), [loads]) == pytest.approx(far)
        assert _beyond(frozenset(locked), [loads, 1e6 * loads]) == pytest.approx(2.0 * far)
    assert _beyond(frozenset({4}), [loads]) == 0.0  # it has none of it
    assert _beyond(frozenset(range(4)), [loads]) == 0.0  # and neither have the others


def test_a_run_covers_a_column_without_its_rarest_values():
    values = np.append(np.arange(101.0), np.nan)
    some = [Run("a", {"time": np.arange(102.0), "hook_load": values}), Run("b", {"time": np.arange(3.0)})]
    found = _covered("hook_load", some)
    assert found[0] == pytest.approx([5.0, 95.0])
    assert np.isnan(found[1]).all()


@pytest.mark.parametrize(("locked", "unseen"), [({0}, 0), ({0, 1}, 1), ({2}, 2), ({0, 2}, 2), ({0, 1, 2}, 3)])
def test_layers_that_only_locked_runs_are_on_are_counted(locked, unseen):
    layers = [frozenset({1.0, 2.0}), frozenset({1.0, 2.0}), frozenset({3.0, 4.0}), frozenset({2.0})]
    assert _unseen(frozenset(locked), layers) == unseen


@pytest.mark.parametrize(
    ("fraction", "seed", "why"),
    [(0.05, 0, ""), (0.6, 3, ""), (0.04, 0, "--holdout 0.04"), (0.61, 0, "--holdout 0.61"), (0.25, -1, "seed -1")],
)
def test_a_share_or_a_seed_that_is_none_is_refused_by_its_value(fraction, seed, why):
    if not why:
        refuse(runs(2), fraction, seed)
        return
    with pytest.raises(InputError, match=why):
        refuse(runs(2), fraction, seed)


def test_no_run_is_refused():
    with pytest.raises(InputError, match="no run given"):
        refuse([], 0.25, 0)


@pytest.mark.parametrize(("count", "whole"), [(3, False), (4, True)])
def test_four_runs_are_enough_to_lock_whole_ones(count, whole):
    split = lock_holdout(runs(count), 0.25, np.random.default_rng(3))
    assert len(split.runs) == (count if whole else 2 * count)
    assert len(split.holdout) == (1 if whole else count)
