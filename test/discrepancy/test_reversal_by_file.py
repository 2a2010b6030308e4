"""What shows just after reversals beside names stands where the file of the names alone still shows it."""

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction.discrepancy import several, standing
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.expansion import Split, meet
from winch_friction.discrepancy.search import Study
from winch_friction.discrepancy.several import by_reversals
from winch_friction.physics.friction.correction import Correction

NAME = SimpleNamespace(origin=(SimpleNamespace(reversal_gain=None), None))
NAMED = SimpleNamespace(slots=("a name",))


@dataclass(frozen=True)
class Stands:
    """What `by_reversals` reads of a search."""

    given: Any
    reversal: Any
    explanation: Any


@pytest.mark.parametrize(
    ("hidden", "kept"),
    [((("presliding", 1.0),), True), ((("churning", 1.0),), False), pytest.param((), False, marks=pytest.mark.long)],
)
def test_bristles_stand_beside_names_where_their_file_leaves_something_of_bristles(
    hidden, kept, crane_150t, crane2_model
):
    runs = runs_with(41, "quiet", *hidden)
    names = tuple(run.name for run in runs)
    study = Study(Split(runs, names[:9], names[9:]), crane_150t, GapOptions(), np.random.default_rng(0))
    bristles = next(each for each in all_candidates() if each.name == "presliding")
    reversal = SimpleNamespace(slot=SimpleNamespace(origin=(bristles, None)))
    full = SimpleNamespace(search=Stands(meet(runs, crane_150t, crane2_model), reversal, NAMED))
    asked = []
    # a file that also corrects a signal: its runs are read without that error
    file = SimpleNamespace(model=replace(crane2_model, corrections=(Correction("pressure_offset", 10.0),)))

    def trial_of(search):
        asked.append(search.reversal)
        return SimpleNamespace(search=search, repaired=file)

    stands = by_reversals(study, full, reversal, trial_of)
    assert asked == [None]
    assert (stands is full) is kept
    assert stands.search.reversal is (reversal if kept else None)


@pytest.mark.parametrize(
    ("slots", "reversal", "asked"),
    [((NAME,), "bristles", True), ((), "bristles", False), ((NAME,), None, False)],
)
def test_what_stands_is_asked_of_its_file_where_names_and_a_reversal_are_in_it(monkeypatch, slots, reversal, asked):
    selection = SimpleNamespace(final=SimpleNamespace(slots=slots), untold="")
    search = SimpleNamespace(
        selection=selection, explanation=SimpleNamespace(slots=slots), reversal=reversal, ripple=None, flow=()
    )
    full, held = SimpleNamespace(search=search), object()
    monkeypatch.setattr(standing, "_replicated", lambda own, *_: own)
    monkeypatch.setattr(standing, "nameless", lambda own: own)
    monkeypatch.setattr(standing, "tried", lambda *_: full)
    monkeypatch.setattr(standing, "_sets", lambda own, _: [own])
    monkeypatch.setattr(standing, "_stands", lambda *_: (full, ""))
    monkeypatch.setattr(standing, "by_reversals", lambda study, own, shown, _: held if shown == "bristles" else own)
    study = SimpleNamespace(rng=None, split=None)
    assert standing._borne_out(study, search) is (held if asked else full)


@pytest.mark.parametrize(("ripple", "flow"), [(None, ()), ("wave", ()), (None, ("air",)), ("wave", ("air",))])
def test_names_are_judged_beside_a_refit_that_has_what_is_in_every_file(monkeypatch, ripple, flow):
    """A ripple and lost oil: of these no name takes anything off the locked gap."""
    empty = SimpleNamespace(slots=())
    search = SimpleNamespace(selection=SimpleNamespace(final=empty, untold=""), explanation=empty, reversal=None,
                             ripple=ripple, flow=flow)  # fmt: skip
    changed = lambda own, **more: SimpleNamespace(**{**vars(own), **more})
    judged = []
    monkeypatch.setattr(standing, "replace", changed)
    monkeypatch.setattr(standing, "_replicated", lambda own, *_: own)
    monkeypatch.setattr(standing, "nameless", lambda own: changed(own, ripple=None, flow=()))
    monkeypatch.setattr(standing, "tried", lambda study, own: SimpleNamespace(search=own))
    monkeypatch.setattr(standing, "_sets", lambda own, _: [own])
    monkeypatch.setattr(
        standing, "_stands", lambda own, beside, trial_of, _: judged.append(beside.search) or (trial_of(own), "")
    )
    standing._borne_out(SimpleNamespace(rng=None, split=None), search)
    assert [(each.ripple, each.flow) for each in judged] == [(ripple, flow)]


def named_by(slots):
    return SimpleNamespace(slots=slots)


@dataclass(frozen=True)
class Asked:
    """What `at_reversals` reads of a search, and what it makes of it."""

    given: Any
    expansion: Any
    cross: Any
    selection: Any
    names: tuple[str, ...] = ("one",)
    reversal: Any = None
    verdict: Any = None


JUDGED = SimpleNamespace(
    search=SimpleNamespace(verdict=SimpleNamespace(kind="nothing_missing"), selection=SimpleNamespace(found=()))
)
DWELL = SimpleNamespace(name="dwell_stiction", reversal_gain=0.1)
OTHER = SimpleNamespace(name="churning", reversal_gain=None)


@pytest.mark.parametrize(
    ("found", "shown", "holds", "named"),
    [
        ((DWELL,), "dwell_stiction", True, True),  # what is refused of the moving samples shows just after reversals
        ((DWELL,), "dwell_stiction", False, False),  # but not in the locked runs
        ((DWELL,), "presliding", True, False),  # there it is another cause than the one that the moving samples showed
        ((OTHER, DWELL), "dwell_stiction", True, True),
        ((DWELL,), None, True, False),
    ],
)
def test_what_is_refused_of_the_moving_samples_is_asked_of_the_reversals(monkeypatch, found, shown, holds, named):
    """Of a break-away the base takes up most while the drum turns: of one that stood 15 bar out of noise of 0.4 bar at
    each reversal so little was left that the verdict was nothing_missing."""
    finding = shown and SimpleNamespace(slot=SimpleNamespace(name=shown), holds_on=lambda names, rng: holds)
    asked = []
    monkeypatch.setattr(several, "after_reversals", lambda *given: asked.append(given) or finding)
    monkeypatch.setattr(several, "testable", lambda *_: ("known", ()))
    monkeypatch.setattr(several, "nameless", lambda search: replace(search, names=()))
    slots = tuple(SimpleNamespace(name=each.name, origin=(each, None)) for each in found)
    cross = SimpleNamespace(explain=lambda slots: ("explained by", slots))
    search = Asked(SimpleNamespace(prepared=(), model=None), "around", cross, SimpleNamespace(final=named_by(slots)))
    study = SimpleNamespace(split=Split((), ("a",), ("b",)), options=GapOptions(candidates=("known",)), rng=None)
    own = list(several.at_reversals(study, search))
    assert asked[0][:5] == (search.given, "around", ("explained by", ()), "known", ("a",))  # beside no name
    assert bool(own) is named
    if named:
        assert (own[0].names, own[0].reversal, own[0].verdict.kind) == ((), finding, "missing_effect")


@pytest.mark.parametrize(("cause", "asked"), [(DWELL, True), (OTHER, False)])
def test_only_of_a_cause_that_shows_just_after_reversals_these_are_asked(monkeypatch, cause, asked):
    alone, refused = SimpleNamespace(), []
    monkeypatch.setattr(standing, "at_reversals", lambda *_: refused.append(True) or [alone])
    monkeypatch.setattr(standing, "_replicated", lambda search, *_: search)
    monkeypatch.setattr(standing, "nameless", lambda search: search)
    monkeypatch.setattr(standing, "_sets", lambda *_: [])
    found = SimpleNamespace(search=SimpleNamespace(
        selection=SimpleNamespace(final=named_by(()), untold=""), reversal=None, explanation=named_by(())
    ))  # fmt: skip
    monkeypatch.setattr(standing, "tried", lambda *_: "refit")
    monkeypatch.setattr(standing, "_stands", lambda each, *_: (found, "") if each is alone else (None, "no"))
    monkeypatch.setattr(standing, "_judged", lambda *_: JUDGED)
    monkeypatch.setattr(standing, "replace", lambda trial, **_: JUDGED)
    slots = (SimpleNamespace(name=cause.name, origin=(cause, None)),)
    search = SimpleNamespace(ripple=None, flow=(), selection=SimpleNamespace(final=named_by(slots), found=("one",)),
                             verdict=SimpleNamespace(kind="missing_effect"))  # fmt: skip
    stands = standing._borne_out(SimpleNamespace(rng=None, split=None), search)
    assert bool(refused) is asked
    assert stands is (found if asked else JUDGED)
