"""A wire that does not give is asked for last, and its names stand only where their file leaves no swing either."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import again, next_experiment, workflow
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, GapOptions
from winch_friction.discrepancy.search import Study
from winch_friction.physics.signals import Run


@dataclass(frozen=True)
class Balance:
    """What stands in for runs met with a model."""

    swings: bool


ELASTIC, RIGID = Balance(True), Balance(False)
CLOSED, STILL_SWINGS = "its file leaves no swing", "its file leaves one"


@dataclass(frozen=True)
class Found:
    """What stands in for a search: a verdict, and the balance that it was read in."""

    kind: str
    given: Balance = ELASTIC
    flow: tuple = ()
    ripple: object = None

    explanation = SimpleNamespace(names=("one",), slots=())

    @property
    def verdict(self):
        return SimpleNamespace(kind=self.kind, untold=False)


@dataclass(frozen=True)
class Side:
    """The part of one side of the split that the workflow looks at."""

    left_by_run: tuple = ()


@dataclass(frozen=True)
class Result:
    """The part of a result that the workflow looks at."""

    verdict: str
    train: Side = Side()
    holdout: Side = Side()
    effects: tuple = ()
    model: object = None
    seed_model: object = None
    seed_refuted: tuple = ()
    adequacy: tuple = ()
    notes: tuple = ()
    proposals: tuple = ()


def trial(found, file=CLOSED):
    return SimpleNamespace(search=found, repaired=SimpleNamespace(model=file), levels="")


@pytest.fixture
def answers(monkeypatch):
    """What the next search and the judgement of its names answer; `asked` tells the balances searched."""
    own = SimpleNamespace(search=[], judged=[], asked=[])

    def search_runs(study, given, also=None):
        own.asked.append(given)
        return own.search.pop(0)

    def standing(study, search):
        kind, file = own.judged.pop(0)
        return trial(replace(search, kind=kind), file)

    for module in (again, workflow):
        monkeypatch.setattr(module, "search_runs", search_runs)
        monkeypatch.setattr(module, "standing", standing)
        monkeypatch.setattr(module, "swings", lambda given: given.swings)
        monkeypatch.setattr(module, "meet", lambda runs, crane, file, *_: ELASTIC if file == STILL_SWINGS else RIGID)
    for step in ("by_surfaces", "by_other_runs"):
        monkeypatch.setattr(again, step, lambda study, trial: (study, trial))
    monkeypatch.setattr(again, "by_groups", lambda study, trial: trial)
    monkeypatch.setattr(again, "without_implausible", lambda study, trial, _: trial)
    monkeypatch.setattr(workflow, "_surfaces_may_say_more", lambda search: True)
    monkeypatch.setattr(again, "as_rigid", lambda given: RIGID)
    monkeypatch.setattr(again, "by_levels", lambda study, trial: (study, trial))
    return own


@pytest.mark.parametrize(
    ("rigid", "judged", "file", "taken"),
    [
        (MISSING, MISSING, CLOSED, True),
        (AMBIGUOUS, AMBIGUOUS, CLOSED, True),
        (MISSING, MISSING, STILL_SWINGS, False),  # the load swings, whatever the signals do
        (MISSING, UNEXPLAINED, CLOSED, False),
        (UNEXPLAINED, None, None, False),
        (NOTHING, None, None, False),
    ],
)
def test_only_names_whose_file_leaves_no_swing_are_taken(answers, rigid, judged, file, taken):
    before = trial(Found(UNEXPLAINED))
    answers.search, answers.judged = [Found(rigid, RIGID)], [(judged, file)]
    study = Study(SimpleNamespace(runs=()), None, GapOptions(), np.random.default_rng(0))
    after = again.without_swing(study, ELASTIC, before)
    assert answers.asked == [RIGID]
    assert (after is not before) is taken
    if taken:  # judged, and proposed for, in the balance that the runs were met with
        assert after.search.given is ELASTIC


def surrounded(monkeypatch, met, told=True):
    """What stands around the searches: runs that suffice, met by a balance, whose swing is `told`."""
    runs = [Run(f"run_{k}", {"time": np.arange(3.0), "motor_speed": np.ones(3)}) for k in range(2)]
    split = SimpleNamespace(runs=runs, train=("run_0",), holdout=("run_1",))
    check = SimpleNamespace(met=told)
    adequacy = SimpleNamespace(
        apart=lambda runs: (runs, ()),
        long_enough=lambda runs: (runs, ()), of_records=lambda every, runs: [], of_prepared=lambda *_: [],
        of_swing=lambda crane, left: check, refuse=lambda *_: None, lock_holdout=lambda runs, share, rng: split,
    )  # fmt: skip
    monkeypatch.setattr(workflow, "adequacy", adequacy)
    monkeypatch.setattr(workflow, "completed", lambda model, crane: model)
    monkeypatch.setattr(next_experiment, "of_wire", lambda *_: ["how long is the wire"])
    monkeypatch.setattr(next_experiment, "of_runs", lambda sides: [f"which of {len(sides)} sides"])
    monkeypatch.setattr(next_experiment, "levels_of", lambda *_: None)
    monkeypatch.setattr(workflow, "not_borne_out", lambda search, stands: [f"{search.kind} at first"])
    monkeypatch.setattr(workflow, "against_simulations", lambda runs, model, crane: list(runs))
    monkeypatch.setattr(workflow, "beside_climbs", lambda runs, crane: (runs, []))
    monkeypatch.setattr(workflow, "meet", lambda runs, crane, file, *_: met if file is None else RIGID)
    monkeypatch.setattr(workflow, "try_seed", lambda search, rng: SimpleNamespace(enough=False, refuted=None))
    monkeypatch.setattr(workflow, "assemble", lambda study, trial: Result(trial.search.kind))
    return runs


@pytest.mark.parametrize(
    ("first", "met", "asked"),
    [
        (UNEXPLAINED, ELASTIC, [ELASTIC, RIGID]),
        (UNEXPLAINED, RIGID, [RIGID]),  # no wire gives
        (MISSING, ELASTIC, [ELASTIC]),  # a name stands already
        (NOTHING, ELASTIC, [ELASTIC]),
    ],
)
def test_a_rigid_wire_is_asked_for_where_nothing_explains_and_a_load_swings(answers, monkeypatch, first, met, asked):
    runs = surrounded(monkeypatch, met)
    answers.search, answers.judged = [Found(first), Found(MISSING, RIGID)], [(first, CLOSED), (MISSING, CLOSED)]
    found = workflow.find_gap(runs, None, None, GapOptions(proposals=False))
    assert answers.asked == asked
    assert found.verdict == (MISSING if RIGID in asked[1:] else first)
    open_still = ("how long is the wire", "which of 2 sides") if found.verdict == UNEXPLAINED else ()
    assert tuple(found.notes) == (f"{first} at first", *open_still)


def test_of_a_named_law_it_is_said_what_becomes_of_a_term_that_the_given_model_has(answers, monkeypatch):
    runs, given = surrounded(monkeypatch, RIGID), SimpleNamespace(term_names=("stribeck", "viscous"))
    answers.search, answers.judged = [Found(MISSING)], [(MISSING, CLOSED)]
    named = (("stribeck", ""), ("dwell_stiction", "dwell_by_speed"), ("coulomb", "viscous"), ("viscous", "free"))
    effects = tuple(SimpleNamespace(name=name, law_name=law) for name, law in named)
    monkeypatch.setattr(workflow, "assemble", lambda *_: Result(MISSING, effects=effects, model="written"))
    monkeypatch.setattr(workflow, "of_own_terms", lambda names, *models: [(tuple(names), *models)])
    found = workflow.find_gap(runs, None, given, GapOptions(proposals=False))
    assert (("stribeck", "viscous"), given, "written") in found.notes


@pytest.mark.parametrize(("verdict", "quiet", "said"), [
    (NOTHING, True, NOTHING), (NOTHING, False, "insufficient"), (UNEXPLAINED, True, "insufficient"),
    (MISSING, False, MISSING),
])  # fmt: skip
def test_a_gap_above_the_noise_of_runs_too_short_for_a_swing_is_not_nothing(answers, monkeypatch, verdict, quiet, said):
    """A floor that a load's swing has raised excuses no gap."""
    runs = surrounded(monkeypatch, RIGID, told=False)
    monkeypatch.setattr(workflow, "nobodys", lambda side: quiet)
    monkeypatch.setattr(workflow, "insufficient", lambda *_: Result("insufficient"))
    seen = []
    monkeypatch.setattr(workflow, "with_what_was_seen", lambda own, result: seen.append(result.verdict) or own)
    answers.search, answers.judged = [Found(verdict)], [(verdict, CLOSED)]
    assert workflow.find_gap(runs, None, None, GapOptions(proposals=False)).verdict == said
    assert seen == [verdict] * (said == "insufficient")


@pytest.mark.parametrize(
    ("verdict", "left", "told"),
    [(NOTHING, 0.2, True), (UNEXPLAINED, 0.3, True), (UNEXPLAINED, 0.5, False), (MISSING, 0.2, False)],
)
def test_a_seed_is_refuted_only_where_its_freed_parameters_close_the_gap(answers, monkeypatch, verdict, left, told):
    """A ship's roll of 23 s moved K4 by 3.9 deviations and left 1.3 bar of 1.8: it was called the seed's fault."""
    runs, size = surrounded(monkeypatch, RIGID), SimpleNamespace(value=left, interval=(left, left))
    monkeypatch.setattr(workflow, "try_seed", lambda search, rng: SimpleNamespace(enough=False, refuted="K4"))
    holdout = SimpleNamespace(size_after=size, floor=0.2, excused=0.2, left_by_run=())
    monkeypatch.setattr(workflow, "assemble", lambda *_: replace(Result(verdict), holdout=holdout))
    answers.search, answers.judged = [Found(verdict)], [(verdict, CLOSED)]
    found = workflow.find_gap(runs, None, None, GapOptions(proposals=False))
    assert found.seed_refuted == (("K4",) if told else ())


@pytest.mark.parametrize(("levels", "refuted"), [("", ("K4",)), ("cells are off", ())])
def test_a_seed_is_asked_anew_where_load_cells_are_not_believed(answers, monkeypatch, levels, refuted):
    """What levels did to the first search is no fault of the seed's."""
    runs, said = surrounded(monkeypatch, RIGID), ["K4", None]
    monkeypatch.setattr(workflow, "try_seed", lambda *_: SimpleNamespace(enough=False, refuted=said.pop(0)))
    monkeypatch.setattr(
        workflow, "_once_more",
        lambda study, given, trial, _: (study, SimpleNamespace(**{**vars(trial), "levels": levels})),
    )  # fmt: skip
    answers.search, answers.judged = [Found(NOTHING)], [(NOTHING, CLOSED)]
    assert workflow.find_gap(runs, None, None, GapOptions(proposals=False)).seed_refuted == refuted
