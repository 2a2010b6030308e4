"""A brake that drags by another amount in every run: asked last of all, and only what it closes alone is taken."""

from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy import again, next_experiment, workflow
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, NOTHING, UNEXPLAINED, GapOptions
from winch_friction.discrepancy.run_states import EACH_RUN
from winch_friction.discrepancy.search import Study
from winch_friction.physics.signals import Run

FLOOR, FAR = 0.2, 1.0  # bar
STUDY = Study(SimpleNamespace(train=()), None, GapOptions(), np.random.default_rng(0))


def side(left):
    size = SimpleNamespace(value=left, interval=(0.9 * left, 1.1 * left))
    return SimpleNamespace(size_after=size, floor=FLOOR, excused=FLOOR, left_by_run=())


def trial(kind, locked=FAR, train=FAR, law=EACH_RUN, names=("brake_drag",)):
    slot = SimpleNamespace(name="brake_drag", law=law)
    search = SimpleNamespace(
        verdict=SimpleNamespace(kind=kind), given=None, selection=SimpleNamespace(found=[SimpleNamespace(slot=slot)]),
        flow=(), ripple=None, explanation=SimpleNamespace(names=names, slots=()),
    )  # fmt: skip
    return SimpleNamespace(search=search, holdout=side(locked), train=side(train), levels="")


@pytest.mark.parametrize(
    ("other", "taken"),
    [
        (trial(MISSING, FLOOR, FLOOR), True),
        (trial(MISSING, 1.9 * FLOOR, FLOOR), False),  # the locked runs keep something
        (trial(MISSING, FLOOR, 2.5 * FLOOR), False),  # the runs to learn from do
        (trial(UNEXPLAINED, FLOOR, FLOOR), False),
        (trial(MISSING, FLOOR, FLOOR, law="in some runs"), False),
    ],
)
def test_only_what_it_closes_alone_is_taken(monkeypatch, other, taken):
    monkeypatch.setattr(again, "search_runs", lambda study, given, also: other.search)
    monkeypatch.setattr(again, "standing", lambda *_: other)
    before = trial(UNEXPLAINED)
    after = again.by_runs(STUDY, before)
    assert (after is other) is taken
    assert (after is before) is not taken


@pytest.mark.parametrize(
    ("first", "left_by_laws", "asked"),
    [
        (UNEXPLAINED, [], True),
        (UNEXPLAINED, [FAR, 2.0 * FAR], True),  # laws that close something of it
        (UNEXPLAINED, [FAR, FLOOR], False),  # one that closes all of it
        (MISSING, [], False),
        (NOTHING, [], False),
    ],
)
def test_it_is_asked_where_nothing_else_explains(monkeypatch, first, left_by_laws, asked):
    laws = tuple(SimpleNamespace(after=left, noise_floor=FLOOR, closed=FLOOR / left) for left in left_by_laws)
    named, seen = trial(MISSING, FLOOR, FLOOR), []
    runs = [Run(f"run_{k}", {"time": np.arange(3.0), "motor_speed": np.ones(3)}) for k in range(2)]
    adequacy = SimpleNamespace(

        apart=lambda runs: (runs, ()),
        long_enough=lambda runs: (runs, ()), of_records=lambda *_: [], of_prepared=lambda *_: [],
        of_swing=lambda *_: SimpleNamespace(met=True),
        refuse=lambda *_: None, lock_holdout=lambda *_: SimpleNamespace(runs=runs, train=(), holdout=()),
    )  # fmt: skip
    monkeypatch.setattr(workflow, "adequacy", adequacy)
    monkeypatch.setattr(workflow, "completed", lambda model, crane: model)
    monkeypatch.setattr(next_experiment, "of_wire", lambda *_: [])
    monkeypatch.setattr(next_experiment, "of_runs", lambda *_: [])
    monkeypatch.setattr(next_experiment, "levels_of", lambda *_: None)
    monkeypatch.setattr(workflow, "against_simulations", lambda runs, model, crane: list(runs))
    monkeypatch.setattr(workflow, "beside_climbs", lambda runs, crane: (runs, []))
    monkeypatch.setattr(workflow, "meet", lambda *_: None)
    searched = SimpleNamespace(verdict=SimpleNamespace(untold=False), flow=(), ripple=None)
    monkeypatch.setattr(workflow, "search_runs", lambda *_: searched)
    monkeypatch.setattr(workflow, "try_seed", lambda *_: SimpleNamespace(enough=False, refuted=None))
    monkeypatch.setattr(workflow, "standing", lambda *_: trial(first))
    monkeypatch.setattr(workflow, "_once_more", lambda study, given, trial, search: (study, trial))
    monkeypatch.setattr(workflow, "propose", lambda *_: laws)
    monkeypatch.setattr(workflow.again, "by_runs", lambda *_: seen.append(True) or named)
    monkeypatch.setattr(workflow, "replace", lambda result, **more: SimpleNamespace(**{**vars(result), **more}))
    monkeypatch.setattr(
        workflow, "assemble",
        lambda study, own: SimpleNamespace(
            effects=(), verdict=own.search.verdict.kind, notes=(), train=own.train, holdout=own.holdout
        ),
    )  # fmt: skip
    found = workflow.find_gap(runs, None, None, GapOptions())
    assert bool(seen) is asked
    assert found.verdict == (MISSING if asked else first)
    assert tuple(found.proposals) == (() if asked or first != UNEXPLAINED else laws)  # none beside a name
    asked_for_none = workflow.find_gap(runs, None, None, GapOptions(proposals=False))
    assert (asked_for_none.verdict, tuple(asked_for_none.proposals)) == (first, ())


def test_the_amount_of_a_locked_run_is_told_by_its_first_half_alone(monkeypatch):
    from winch_friction.discrepancy import catalogue

    asked = []
    monkeypatch.setattr(catalogue, "build_problem", lambda *_: SimpleNamespace(slots=[None]))
    monkeypatch.setattr(catalogue, "layout_of", lambda *_: None)
    monkeypatch.setattr(catalogue, "base_of", lambda *_: None)
    monkeypatch.setattr(catalogue, "follows_a_signal", lambda *_: False)

    def levels_of(problem, slot, runs, whole):
        asked.append(whole)
        return np.array([0.5, -1.0, 4.0, 2.0, 1.0, 3.0, 2.0, 1.0]), None

    monkeypatch.setattr(catalogue, "levels_of", levels_of)
    runs = [SimpleNamespace(name=f"run_{k}", start=1e9 - 600.0 * k, time=np.array([0.0, 60.0])) for k in range(8)]
    brake = next(each for each in catalogue.shipped_friction() if each.name == "brake_drag" and not each.law_name)
    model = SimpleNamespace(term_names=tuple(brake.presumes))
    found, worn = catalogue.another_in_each_run({"run_0", "run_3"}, runs, model)
    assert asked == [[name in ("run_0", "run_3") for name in (run.name for run in runs)]]
    # every run has a date of its own, so that what wears by any law of it, as to a new seal, is one with a brake
    assert (found.name, worn.name) == ("brake_drag", "wear_drift")
    assert worn.term.table.weights == found.term.table.weights
    # by date, which here runs backwards, beyond the least: a brake drives nothing
    assert found.term.table.weights == (0.4, 0.6, 0.8, 0.4, 0.6, 1.0, 0.0, 0.3)
    windows = found.term.table.knots[0][1]
    assert all(windows[2 * k] < runs[7 - k].start < runs[7 - k].start + 60.0 < windows[2 * k + 1] for k in range(8))
    assert catalogue.another_in_each_run(set(), runs, SimpleNamespace(term_names=())) == []
    # runs whose torque cannot be closed, as heave compensation without a logged pressure, tell nothing and need nothing
    monkeypatch.setattr(
        catalogue, "levels_of", lambda *_: (np.array([1.0, 2.0, 4.0, 3.0, 2.0, 1.0, *[np.nan] * 2]), None)
    )
    found, _ = catalogue.another_in_each_run({"run_0"}, runs, model)
    assert found.term.table.weights == (0.25, 0.5, 0.75, 1.0, 0.5, 0.25)
    assert found.term.table.knots[0][1][0] > runs[6].start + 60.0
    monkeypatch.setattr(catalogue, "levels_of", lambda *_: (np.array([1.0, 2.0, 4.0, 3.0, 2.0, *[np.nan] * 3]), None))
    assert catalogue.another_in_each_run({"run_0"}, runs, model) == []  # five are too few


# what a further search ends in, whether there is something to ask it for, and whether that is taken
FURTHER = [
    (trial(MISSING, FLOOR, FLOOR), True, True),
    (trial(MISSING, FLOOR, FLOOR), False, False),
    (trial(MISSING, 1.9 * FLOOR, FLOOR), True, False),  # the locked runs keep something
    (trial(MISSING, FLOOR, 2.5 * FLOOR), True, False),  # the runs to learn from do
    (trial(UNEXPLAINED, FLOOR, FLOOR), True, False),
]


@pytest.mark.parametrize(("other", "two", "taken"), FURTHER)
def test_an_error_of_one_driving_group_is_taken_where_it_closes_the_gap(monkeypatch, other, two, taken):
    asked = []

    def search(study, given):
        asked.append(study.options.candidates)
        return other.search

    monkeypatch.setattr(again, "of_one_group", lambda runs: ["one"] if two else [])
    monkeypatch.setattr(again, "every_candidate", lambda *_: ("every",))
    monkeypatch.setattr(again, "search_runs", search)
    monkeypatch.setattr(again, "standing", lambda *_: other)
    before = trial(UNEXPLAINED)
    before.search.given = SimpleNamespace(prepared=(), model=None)
    after = again.by_groups(STUDY, before)
    assert (after is other) is taken
    # alone, and where that does not do, beside everything else
    assert asked == [("one",), ("every", "one")][: two * (1 if taken else 2)]


def test_an_error_of_one_driving_group_that_does_not_show_is_not_asked_beside_everything_else(monkeypatch):
    """A second search of everything takes as long as the first."""
    asked = []
    nothing = SimpleNamespace(selection=SimpleNamespace(found=()))
    monkeypatch.setattr(again, "of_one_group", lambda runs: ["one"])
    monkeypatch.setattr(again, "every_candidate", lambda *_: ("every",))
    monkeypatch.setattr(again, "search_runs", lambda study, given: asked.append(study.options.candidates) or nothing)
    before = trial(UNEXPLAINED)
    before.search.given = SimpleNamespace(prepared=(), model=None)
    assert again.by_groups(STUDY, before) is before
    assert asked == [("one",)]


@pytest.mark.parametrize(("names", "other", "taken", "asked"), [
    ("ab", trial(MISSING, FLOOR, FLOOR), True, 1),
    ("ab", trial(MISSING, FLOOR, FLOOR, names="cd"), False, 1),  # as many names
    ("ab", trial(MISSING, FLOOR, 1.9 * FLOOR), False, 1),  # leaves more of the runs to learn from
    ("ab", trial(MISSING, 1.4 * FLOOR, FLOOR), False, 1),  # or of the locked ones
    ("a", trial(MISSING, FLOOR, FLOOR), False, 0),
])  # fmt: skip
def test_an_error_of_one_driving_group_that_leaves_no_more_outdoes_several_names(
    monkeypatch, names, other, taken, asked
):
    """A zero of 3.2 bar of the group that compensates heave was a feedback of the passive one and a radius that sinks
    in: without a word of doubt, for one group was asked only where nothing had a name."""
    calls = []
    monkeypatch.setattr(again, "of_one_group", lambda runs: ["one"])
    monkeypatch.setattr(again, "search_runs", lambda study, given: calls.append(study) or other.search)
    monkeypatch.setattr(again, "standing", lambda *_: other)
    before = trial(AMBIGUOUS, 1.3 * FLOOR, 1.6 * FLOOR, names=names)
    before.search.given = SimpleNamespace(prepared=(), model=None)
    assert (again.by_groups(STUDY, before) is other) is taken
    assert len(calls) == asked


@pytest.mark.parametrize(("kind", "names", "asked"), [
    (UNEXPLAINED, "", True), (AMBIGUOUS, "ab", True), (MISSING, "ab", True), (MISSING, "a", False),
])  # fmt: skip
def test_what_has_several_names_is_held_against_an_error_of_one_group_as_what_has_none(monkeypatch, kind, names, asked):
    before, calls = trial(kind, FLOOR, FLOOR, names=names), []
    monkeypatch.setattr(again, "by_groups", lambda study, found: calls.append(found) or found)
    monkeypatch.setattr(again, "without_implausible", lambda study, found, _: found)
    monkeypatch.setattr(again, "by_beyond", lambda study, found, _: (study, found))
    monkeypatch.setattr(again, "by_levels", lambda study, found: (study, found))
    monkeypatch.setattr(again, "by_other_runs", lambda study, found: (study, found))
    monkeypatch.setattr(workflow, "_surfaces_may_say_more", lambda search: False)
    monkeypatch.setattr(workflow, "swings", lambda given: False)
    study = SimpleNamespace(options=SimpleNamespace(candidates=(), told=lambda what: None))
    assert workflow._once_more(study, None, before, before.search)[1] is before
    assert calls == [before] * asked


def test_another_law_for_what_is_too_large_is_not_asked_of_what_has_names(monkeypatch):
    monkeypatch.setattr(again, "search_runs", lambda *_: pytest.fail("searched"))
    before = trial(MISSING, FLOOR, FLOOR, names="ab")
    final = SimpleNamespace(slots=[SimpleNamespace(name="pressure_scale", law="")])
    first = SimpleNamespace(selection=SimpleNamespace(final=final), cross=SimpleNamespace(at_bound=lambda *_: True))
    monkeypatch.setattr(again, "every_candidate", lambda *_: ())
    assert again.without_implausible(STUDY, before, first) is before


@pytest.mark.parametrize(("other", "too_large", "taken"), FURTHER)
def test_what_one_law_does_by_an_implausible_size_another_may_do_by_its_own(monkeypatch, other, too_large, taken):
    """The law that was too large is not asked again, its cause by another law is."""
    asked = []

    def search(study, given):
        asked.append([(each.name, each.law_name) for each in study.options.candidates])
        return other.search

    def named(cause, law):
        return SimpleNamespace(name=cause, law_name=law)

    every = [named("pressure_scale", "thermal span shift"), named("pressure_scale", ""), named("swivel_offset", ""),
             named("tare_load", "in some runs")]  # fmt: skip
    monkeypatch.setattr(again, "every_candidate", lambda *_: every)
    monkeypatch.setattr(again, "search_runs", search)
    monkeypatch.setattr(again, "standing", lambda *_: other)
    before = trial(UNEXPLAINED)
    before.search.given = SimpleNamespace(prepared=(), model=None)
    final = SimpleNamespace(slots=[SimpleNamespace(name="pressure_scale", law="thermal span shift")])
    first = SimpleNamespace(
        selection=SimpleNamespace(final=final), cross=SimpleNamespace(at_bound=lambda *_: too_large)
    )
    after = again.without_implausible(STUDY, before, first)
    assert (after is other) is taken
    assert (after is before) is not taken
    assert asked == [[("pressure_scale", ""), ("swivel_offset", ""), ("tare_load", "in some runs")]] * too_large


@pytest.mark.parametrize(("kind", "laws", "left", "may"), [
    (UNEXPLAINED, 0, 3.0, True),
    (MISSING, 1, 3.0, True),  # a name whose law is not exact
    (MISSING, 1, 0.1, False),
    (MISSING, 2, 3.0, False),
])  # fmt: skip
def test_surfaces_are_drawn_where_nothing_is_named_or_one_law_is_not_exact(kind, laws, left, may):
    search = SimpleNamespace(
        verdict=SimpleNamespace(kind=kind), explanation=SimpleNamespace(slots=("slot",) * laws),
        cross=SimpleNamespace(excess=lambda _: left),
    )  # fmt: skip
    assert workflow._surfaces_may_say_more(search) is may


# -- laws that only the data know
@pytest.mark.parametrize(
    ("first", "left", "other", "adds", "taken"),
    [
        (MISSING, 4.9, trial(MISSING), True, True),
        (MISSING, 5.1, trial(MISSING), True, False),  # more than half of what the names leave
        (UNEXPLAINED, 9.9, trial(MISSING), False, True),  # where nothing is named anything that stands is more
        (UNEXPLAINED, 0.1, trial(UNEXPLAINED), True, False),
        (MISSING, 0.1, trial(MISSING), False, False),  # the locked runs are surely left with no less
        (MISSING, 0.1, trial(UNEXPLAINED), True, False),
        (AMBIGUOUS, 5.1, trial(AMBIGUOUS), True, False),
        (AMBIGUOUS, 4.9, trial(AMBIGUOUS), True, True),
    ],
)
def test_a_law_of_the_data_stands_where_it_leaves_half_of_what_names_do(monkeypatch, first, left, other, adds, taken):
    asked = []
    before = trial(first)
    before.search.cross, before.search.explanation = SimpleNamespace(excess=lambda _: 10.0), None
    selection = SimpleNamespace(found=["law"], final=None)
    found = SimpleNamespace(selection=selection, cross=SimpleNamespace(excess=lambda _: left))

    def searched(study, given, also):
        asked.append(also)
        return found

    monkeypatch.setattr(again, "search_runs", searched)
    monkeypatch.setattr(again, "standing", lambda study, search: asked.append(search) or other)
    monkeypatch.setattr(
        again, "adds", lambda fewer, more, rng: adds and fewer is before.holdout and more is other.holdout
    )
    others = []
    monkeypatch.setattr(again, "by_other_runs", lambda *given: others.append(given) or given[:2])
    assert (again.by_surfaces(STUDY, before)[1] is other) is taken
    refused = first == other.search.verdict.kind == UNEXPLAINED  # perhaps only for what none of the locked runs shows
    assert [(study, trial, also.func) for study, trial, also in others] == [
        (STUDY, before, again.free_members)
    ] * refused
    assert (asked[0].func, asked[0].keywords) == (again.free_members, {"rows": again.SURFACES})
    assert asked[1:] in ([], [found])
    selection.found.clear()
    assert again.by_surfaces(STUDY, before) == (STUDY, before)  # the data know none


def test_effects_stand_in_the_order_in_which_they_were_found(monkeypatch):
    """The largest is found first, and a reader looks at it first; what one name has found twice stands once."""
    monkeypatch.setattr(workflow, "_effect", lambda _, own, *__: (own[0].slot.name, len(own)))
    names = ("viscous", "coulomb", "tare_load", "coulomb")
    found = [SimpleNamespace(slot=SimpleNamespace(name=name)) for name in names]
    search = SimpleNamespace(reversal=None, ripple=None, flow=())
    tied = dict.fromkeys(names)
    said = workflow._effects(search, found, None, tied)
    assert said == (("viscous", 1), ("coulomb", 2), ("tare_load", 1))
