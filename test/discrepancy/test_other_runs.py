"""What is in none of the locked runs is looked for once more with others locked."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import again, workflow
from winch_friction.discrepancy.answer import MISSING, UNEXPLAINED, GapOptions, Side
from winch_friction.discrepancy.detectors.lost_flow import Leakage
from winch_friction.discrepancy.expansion import Split
from winch_friction.discrepancy.search import Study

FLOOR, FAR = 0.2, 1.0  # bar
RUNS = tuple(SimpleNamespace(name=f"run_{k}") for k in range(9))
SPLIT = Split(RUNS, tuple(run.name for run in RUNS[:6]), tuple(run.name for run in RUNS[6:]))


class Left(SimpleNamespace):
    most_left_first = Side.most_left_first


def side(left, by_run=()):
    """What is left of runs, in all and of each one's ten blocks."""
    size = SimpleNamespace(value=left, interval=(0.9 * left, 1.1 * left))
    return Left(
        size_after=size, floor=FLOOR, excused=FLOOR, runs=RUNS[: len(by_run)],
        left_by_run=[(run, np.full(10, own) / FLOOR) for run, own in zip(RUNS, by_run, strict=False)],
    )  # fmt: skip


def trial(kind, locked, by_run=(), names=(), train=FAR):
    search = SimpleNamespace(
        verdict=SimpleNamespace(kind=kind), given=None, explanation=SimpleNamespace(names=tuple(names), slots=())
    )
    return SimpleNamespace(search=search, holdout=side(locked), train=side(train, by_run))


@pytest.fixture
def asked(monkeypatch):
    """What a second search finds, and with which runs locked it was asked."""

    def answer(other):
        splits = []
        monkeypatch.setattr(again, "search_runs", lambda study, _, also: splits.append(study.split) or also)
        monkeypatch.setattr(again, "standing", lambda study, also: drawn.append(also) or other)
        drawn.clear()
        return splits

    return answer


drawn = []  # what a second search was given beside the catalogue


def looked(before, *also):
    study, after = again.by_other_runs(Study(SPLIT, None, GapOptions(), np.random.default_rng(0)), before, *also)
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
    assert drawn == [None]
    looked(before, "curves")
    assert drawn == [None, "curves"]


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


def beyond(monkeypatch, full, other, grows=("run_7",), search=MISSING):
    """What comes of names that the training runs bear out by `full`, and that stand or not with other runs locked."""
    splits = []
    monkeypatch.setattr(again, "tried", lambda *_: full)
    monkeypatch.setattr(again, "worse_runs", lambda *_: grows)
    monkeypatch.setattr(again, "search_runs", lambda study, *_: splits.append(study.split))
    monkeypatch.setattr(again, "standing", lambda *_: other)
    before = trial(UNEXPLAINED, FAR, (0.5, 2.0, 0.1, 0.6, 1.0, 0.3))
    searched = SimpleNamespace(verdict=SimpleNamespace(kind=search))
    study = Study(SPLIT, None, GapOptions(), np.random.default_rng(0))
    study, after = again.by_beyond(study, before, searched)
    return study.split, after is not before, splits


def proven(kind, left, train):
    """Of 2 bar in the locked runs."""
    own = trial(kind, left, names=["pressure_offset"], train=train)
    own.holdout.size_before = SimpleNamespace(value=2.0)
    return own


def test_a_locked_run_that_lies_beyond_the_others_is_learned_from_where_the_law_was_right_in_these(monkeypatch):
    """A zero that settles: right in nine runs, and worse in one before them."""
    split, taken, splits = beyond(monkeypatch, proven(MISSING, FAR, FLOOR), proven(MISSING, 1.9 * FLOOR, FLOOR))
    assert taken
    assert split.holdout == ("run_4", "run_6", "run_8")  # of run_1 and run_4, which show most, the second
    assert split.train == ("run_0", "run_1", "run_2", "run_3", "run_5", "run_7")
    assert splits == [split]


@pytest.mark.parametrize(
    ("full", "other", "grows"),
    [
        (FAR, (MISSING, FLOOR, FLOOR), ("run_7",)),  # more than noise is left of the training runs
        (FLOOR, (MISSING, FLOOR, FLOOR), ()),  # refused for something else
        (FLOOR, (UNEXPLAINED, FLOOR, FLOOR), ("run_7",)),
        (FLOOR, (MISSING, 2.5 * FLOOR, FLOOR), ("run_7",)),  # 5 % of the new locked gap's square is left
        (FLOOR, (MISSING, FLOOR, 2.5 * FLOOR), ("run_7",)),  # the run that was locked before is as wrong as it was
    ],
)
def test_names_get_no_other_runs_where_they_are_not_right_in_all(monkeypatch, full, other, grows):
    split, taken, _ = beyond(monkeypatch, proven(MISSING, FAR, full), proven(*other), grows)
    assert not taken
    assert split == SPLIT


@pytest.mark.parametrize(("kind", "searched", "asked"), [
    (UNEXPLAINED, MISSING, True), (UNEXPLAINED, UNEXPLAINED, False), (MISSING, MISSING, False),
])  # fmt: skip
def test_only_names_that_fell_are_asked_beyond(monkeypatch, kind, searched, asked):
    calls, leaks = [], []
    before = trial(kind, FAR)
    monkeypatch.setattr(workflow.again, "by_lost_speed", lambda study, own, _: leaks.append(own) or (study, own))
    monkeypatch.setattr(workflow.again, "by_beyond", lambda study, own, _: calls.append("beyond") or (study, own))
    monkeypatch.setattr(workflow.again, "by_groups", lambda study, own: own)
    monkeypatch.setattr(workflow.again, "by_surfaces", lambda study, own: (study, own))
    monkeypatch.setattr(workflow.again, "without_implausible", lambda study, own, _: own)
    monkeypatch.setattr(workflow.again, "by_levels", lambda study, own: (study, own))
    monkeypatch.setattr(workflow, "swings", lambda _: False)
    monkeypatch.setattr(workflow, "_surfaces_may_say_more", lambda _: False)
    search = SimpleNamespace(verdict=SimpleNamespace(kind=searched), flow=("a leak",))
    workflow._once_more(Study(SPLIT, None, GapOptions(), np.random.default_rng(0)), None, before, search)
    assert (bool(calls), leaks) == (asked, [before])  # of a leak always, for it leaves the balance closed


@pytest.mark.parametrize(
    ("names", "train", "locked", "simpler"),
    [(1, 1.0, 1.0, True), (1, 1.1, 1.0, False), (1, 1.0, 1.1, False), (2, 0.5, 0.5, False), (3, 0.5, 0.5, False)],
)
def test_a_trial_is_simpler_by_fewer_names_that_leave_no_more_of_any_runs(names, train, locked, simpler):
    def trial(count, *left):
        sides = (SimpleNamespace(size_after=SimpleNamespace(value=each)) for each in left)
        explanation = SimpleNamespace(names={str(k) for k in range(count)})
        return SimpleNamespace(search=SimpleNamespace(explanation=explanation), train=next(sides), holdout=next(sides))

    assert again._simpler(trial(2, 1.0, 1.0), trial(names, train, locked)) is simpler


# -- a leak that the locked runs are too gentle to show
LOST = dict(zip((run.name for run in RUNS), (1.0, 9.0, 1.0, 8.0, 1.0, 7.0, 1.0, 1.0, 0.0), strict=True))  # rad/s


def leak(size=3.0):
    """One whose rows say in their second column what they lose."""
    own = dict.fromkeys(("slip_std", "p_value", "before", "after"), 0.0)
    return SoRead({"slip_leakage": (size, 0.1)}, size, **own)


class SoRead(Leakage):
    def lost(self, table):
        return table[:, 1]


def gentle(monkeypatch, flow, other, stands=(), lost=LOST, split=SPLIT, **options):
    """What comes of what the training runs lose by `flow`, of which `stands` holds in the locked ones, if other runs
    are locked."""
    splits = []

    def rows(runs, prepared, change):
        (run,) = runs
        follows = run.name != "run_8"  # of which the speed follows no command in any stretch
        return np.full((4 if follows else 0, 2), lost[run.name])

    monkeypatch.setattr(again, "stretches", rows)
    monkeypatch.setattr(again, "search_runs", lambda study, *_: splits.append(study.split))
    monkeypatch.setattr(again, "standing", lambda *_: other)
    before = trial(MISSING, FLOOR, names=["wear_drift"])
    before.search.flow = stands
    searched = SimpleNamespace(flow=flow, given=SimpleNamespace(prepared=RUNS))
    study = Study(split, None, GapOptions(**options), np.random.default_rng(0))
    study, after = again.by_lost_speed(study, before, searched)
    return study.split, after is not before, splits


def shown(flow, names=("wear_drift",), train=FLOOR):
    own = trial(MISSING, FLOOR, names=names, train=train)
    own.search.flow = flow
    return own


def test_of_the_runs_that_lose_most_every_second_one_is_locked(monkeypatch):
    """A valve that seeps above 100 bar lost 10 rad/s in the training runs and 1.8 in the locked ones, whose pressures
    were low, and by the law of the first they should have lost more."""
    split, taken, splits = gentle(monkeypatch, (leak(),), shown((leak(2.0),)))
    assert taken
    assert split.holdout == ("run_0", "run_3", "run_4")  # most first: run_1, run_3, run_5, run_0, run_2, run_4
    assert splits == [split]


@pytest.mark.parametrize(
    "more",
    [
        {"flow": ()},
        {"stands": (leak(),)},
        {"lost": LOST | {"run_6": 8.0}},  # a locked run has it as well, and refuses it
        {"lost": {**dict.fromkeys(LOST, 5.0), "run_8": 0.0}},
        {"candidates": ("some",)},
    ],
)
def test_where_the_locked_runs_could_tell_of_a_leak_they_have_said_it(monkeypatch, more):
    given = {"flow": (leak(),)} | more
    split, taken, splits = gentle(monkeypatch, given.pop("flow"), shown((leak(2.0),)), **given)
    assert (split, taken, splits) == (SPLIT, False, [])


@pytest.mark.parametrize(
    "other",
    [shown(("air",)), shown(()), shown((leak(),), names=()), shown((leak(),), train=2.5 * FLOOR)],
)
def test_a_leak_is_taken_only_where_it_holds_and_all_else_stands(monkeypatch, other):
    split, taken, splits = gentle(monkeypatch, (leak(),), other)
    assert (split, taken, len(splits)) == (SPLIT, False, 1)


def test_without_locked_runs_that_follow_a_command_nothing_is_said_of_a_leak(monkeypatch):
    only = Split(RUNS, SPLIT.train + SPLIT.holdout[:2], SPLIT.holdout[2:])
    assert gentle(monkeypatch, (leak(),), shown((leak(),)), split=only) == (only, False, [])
