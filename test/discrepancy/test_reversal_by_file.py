"""What shows just after reversals beside names stands where the file of the names alone still shows it."""

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gap_rig import runs_with

from winch_friction.discrepancy import standing
from winch_friction.discrepancy.answer import GapOptions
from winch_friction.discrepancy.catalogue import all_candidates
from winch_friction.discrepancy.expansion import Split, meet
from winch_friction.discrepancy.search import Study
from winch_friction.discrepancy.several import by_reversals
from winch_friction.physics.friction.correction import Correction

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
    [(("a name",), "bristles", True), ((), "bristles", False), (("a name",), None, False)],
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
