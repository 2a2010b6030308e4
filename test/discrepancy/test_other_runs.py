"""What is in none of the locked runs is looked for once more with others locked."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import again, workflow
from winch_friction.discrepancy.answer import MISSING, UNEXPLAINED, GapOptions
from winch_friction.discrepancy.expansion import Split
from winch_friction.discrepancy.search import Study

FLOOR, FAR = 0.2, 1.0  # bar
RUNS = tuple(SimpleNamespace(name=f"run_{k}") for k in range(9))
SPLIT = Split(RUNS, tuple(run.name for run in RUNS[:6]), tuple(run.name for run in RUNS[6:]))


def side(left, by_run=()):
    """What is left of runs, in all and of each one's ten blocks."""
    size = SimpleNamespace(value=left, interval=(0.9 * left, 1.1 * left))
    return SimpleNamespace(
        size_after=size, floor=FLOOR, excused=FLOOR, runs=RUNS[: len(by_run)],
        blocks=SimpleNamespace(run=np.repeat(np.arange(len(by_run)), 10)), after=np.repeat(np.array(by_run), 10),
    )  # fmt: skip


def trial(kind, locked, by_run=(), names=(), train=FAR):
    search = SimpleNamespace(
        verdict=SimpleNamespace(kind=kind), given=None, explanation=SimpleNamespace(names=tuple(names))
    )
    return SimpleNamespace(search=search, holdout=side(locked), train=side(train, by_run))


@pytest.fixture
def asked(monkeypatch):
    """What a second search finds, and with which runs locked it was asked."""

    def answer(other):
        splits = []
        monkeypatch.setattr(again, "search_runs", lambda study, *_: splits.append(study.split))
        monkeypatch.setattr(again, "standing", lambda *_: other)
        return splits

    return answer


def looked(before):
    study, after = workflow._with_other_runs(Study(SPLIT, None, GapOptions(), np.random.default_rng(0)), before)
    return study.split, after


@pytest.mark.parametrize(
    ("by_run", "locked"),
    [
        # most first: run_1, run_4, run_3, run_0; every second one, in place of as many of the former
        ((0.5, 2.0, 0.1, 0.6, 1.0, 0.3), ("run_0", "run_4", "run_6")),
        ((0.1, 0.9, 0.1, 0.2, 0.5, 0.3), ("run_4", "run_6", "run_7")),
        ((0.5, 0.6, 0.7, 0.8, 0.9, 1.0), ("run_0", "run_2", "run_4")),
        ((0.1, 0.9, 0.1, 0.2, 0.1, 0.3), None),  # one alone cannot be learned from and proven on
    ],
)
def test_every_second_run_that_shows_something_is_locked(asked, by_run, locked):
    proven = trial(MISSING, FLOOR, names=["swivel_offset"], train=FLOOR)
    splits = asked(proven)
    before = trial(UNEXPLAINED, FLOOR, by_run)
    split, after = looked(before)
    if locked is None:
        assert (split, after, splits) == (SPLIT, before, [])
        return
    assert split.holdout == locked
    assert split.train == tuple(run.name for run in RUNS if run.name not in locked)
    assert splits == [split]
    assert after is proven


@pytest.mark.parametrize(
    ("before", "other", "taken"),
    [
        ((UNEXPLAINED, FLOOR, ()), (MISSING, FLOOR, FLOOR, ("notch_loss",)), True),
        ((UNEXPLAINED, FAR, ()), (MISSING, FLOOR, FLOOR, ("notch_loss",)), False),  # the locked runs show it too
        ((UNEXPLAINED, FLOOR, ()), (MISSING, 1.9 * FLOOR, FLOOR, ("notch_loss",)), False),
        ((UNEXPLAINED, FLOOR, ()), (MISSING, FLOOR, 2.5 * FLOOR, ("notch_loss",)), False),
        ((UNEXPLAINED, FLOOR, ()), (UNEXPLAINED, FLOOR, FLOOR, ()), False),
        ((MISSING, FLOOR, ("wear_drift",)), (MISSING, FLOOR, FLOOR, ("wear_drift", "notch_loss")), True),
        ((MISSING, FLOOR, ("wear_drift",)), (MISSING, FLOOR, FLOOR, ("notch_loss", "stribeck")), False),
        ((MISSING, FLOOR, ("wear_drift",)), (MISSING, FLOOR, FLOOR, ("wear_drift",)), False),
    ],
)
def test_only_names_that_close_the_gap_of_all_runs_are_taken(asked, before, other, taken):
    """The names that stood before are among them."""
    kind, locked, train, names = other
    proven = trial(kind, locked, names=names, train=train)
    asked(proven)
    before = trial(before[0], before[1], (FAR,) * 6, before[2])
    split, after = looked(before)
    assert (after is proven) is taken
    assert (after is before, split is SPLIT) == (not taken, not taken)
