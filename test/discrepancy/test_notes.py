"""What a result says besides its verdict: when an error is there, what is left, and what did not stand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.cli.gap_output import _found_as, _parameters, show_result
from winch_friction.discrepancy import workflow
from winch_friction.discrepancy.adequacy import Check, _divided, of_names
from winch_friction.discrepancy.answer import AMBIGUOUS, MISSING, UNEXPLAINED, Side
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import Size
from winch_friction.discrepancy.engine.selection import TAKEN, Considered, Finding, Selection
from winch_friction.discrepancy.next_experiment import nothing_compared
from winch_friction.discrepancy.workflow import _in_the_end, _inexact, _notes, _times
from winch_friction.physics.friction import FrictionModel, term_named
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.signals import Run
from winch_friction.report.gap_words import facts

RUNS = [Run(f"run_{k}", {"time": 1000.0 * k + np.arange(11.0), "motor_speed": np.ones(11)}) for k in range(3)]
MODEL = FrictionModel("m", (term_named("coulomb"),), (50.0,))


def with_errors(*corrections):
    return replace(MODEL, corrections=corrections)


def test_an_error_that_is_not_always_there_says_which_runs_have_it():
    there = Correction("pressure_offset", 1e5, during=((-1.0, 20.0), (1990.0, 2100.0)))
    always = Correction("tare_load", 500.0)
    creeps = Correction("pressure_creep", 1e5, during=((0.0, 2000.0),))
    (said,) = _times(with_errors(there, always, creeps), MODEL, RUNS)
    assert said == "pressure_offset is there in run_0, run_2; in no other of these runs"
    assert _times(with_errors(there), with_errors(there), RUNS) == []  # the given model said so already


@pytest.mark.parametrize(("left", "said"), [(0.2, False), (0.27, False), (0.3, True)])
def test_a_named_cause_whose_law_leaves_more_than_noise_says_so(left, said):
    """More than twice 0.14 bar, 0.1 of noise and 0.1 that no balance closes."""
    side = replace(nothing_compared(), size_after=Size(left, (left, left)), noise_floor=0.1, least_noise=0.1)
    assert isinstance(side, Side)
    notes = _inexact(side, [], "bar")
    assert bool(notes) is said
    more = _inexact(side, ["wire_out", "acceleration"], "bar")
    assert [note + ", and what is left goes with wire_out, acceleration" for note in notes] == more
    assert all("keep 0.3 bar where their noise is 0.1" in note for note in notes)


def test_what_was_taken_at_first_and_does_not_stand_is_not_called_taken():
    one, two = (Considered(name, "", 0.1, 0.001, stage, TAKEN) for stage, name in enumerate(("churning", "viscous")))
    other = Considered("stribeck", "", 0.0, 0.5, 0, "not significant")
    finding = Finding(Slot("churning", "", (0,)), (), 0.001, 0.1, 1.0)
    said = _in_the_end(Selection(SimpleNamespace(), SimpleNamespace(), (finding,), (one, two, other)))
    assert [each.verdict for each in said] == [TAKEN, "taken at first, but it does not stand in the end", other.verdict]


@pytest.mark.parametrize(("verdict", "said"), [("ambiguous", True), ("missing_effect", False)])
def test_names_that_no_scenario_tells_apart_say_so(tmp_path, capsys, verdict, said):
    parameters = {"D_0": {"value": 1e-7, "std": 1e-8, "unit": "m^3/rad"}}
    effect = {"name": "swivel_offset", "indistinguishable_from": ["pressure_scale"], "law_kind": "literature",
              "parameters": parameters, "evidence": {"cv_gain": 0.5}}  # fmt: skip
    gap = {"unit": "bar", "holdout": {"before": 1.0, "after": 0.2, "noise_floor": 0.1}}
    show_result(
        {"verdict": verdict, "effects": [effect], "gap": gap, "adequacy": [], "notes": [], "next_experiment": None},
        tmp_path,
    )
    shown = capsys.readouterr().out
    assert ("no scenario at hand tells these apart" in shown) is said
    assert "error lower by" in shown


@pytest.mark.parametrize(("variant", "said"), [
    ("hook, in some runs, 5 of 10", "tare_load (hook, in some runs, 5 of 10)"),
    ("the driving group, beyond 138 bar", "tare_load (the driving group, beyond 138 bar)"),
    ("n_sp = 3, w = 20", "tare_load"), ("layer 2, n = 3", "tare_load (layer 2)"), ("", "tare_load"),
])  # fmt: skip
def test_the_table_says_where_an_effect_was_found_unless_its_parameters_do(variant, said):
    assert _found_as({"name": "tare_load", "variant": variant}) == said


def test_the_table_has_a_date_for_an_instant():
    parameters = {
        "t_wl": {"value": 1.741788e9, "std": 82800.0, "unit": "s"},
        "k": {"value": 2.0, "std": 0.0, "unit": "1"},
    }
    said = _parameters({"parameters": parameters, "law_kind": "literature"})
    assert said == "t_wl = 2025-03-12 14:00 UTC ± 23 h, k = 2"


def test_what_runs_lack_is_said_once_and_names_are_not_counted(tmp_path, capsys):
    checks = [of_names("churning or viscous"), Check("moving samples", 12.0, 15.0, "s", False)]
    gap = {"unit": "bar", "holdout": {"before": None, "after": None, "noise_floor": None}}
    show_result(
        {"verdict": "insufficient", "effects": [], "gap": gap, "adequacy": [vars(each) for each in checks], "notes": [],
         "next_experiment": None}, tmp_path,
    )  # fmt: skip
    shown = capsys.readouterr().out.splitlines()
    assert shown[1] == "lacking: runs that tell more effects apart (churning or viscous)"
    assert shown[2] == "lacking: moving samples: 12 s, needed 15 s"
    told = facts(SimpleNamespace(holdout=nothing_compared(), unit="bar", adequacy=checks))
    assert told == [(checks[0].what, "none of these"), ("moving samples", "12 s, needed 15 s")]


def test_runs_without_a_layer_are_counted_as_they_were_given():
    """Of one log that was looked at as three runs it was said of six: each was divided for the proof."""
    groups = ("pressure_a", "pressure_b", "displacement")
    runs = [replace(run, columns=run.columns | {f"main.{each}": np.ones(11) for each in groups}) for run in RUNS]
    for given, said in ((runs, "3 runs"), (runs[:1], "1 run")):
        assert _notes(_divided(given, 0.5).runs, {}) == (f"no wire_layer in {said}: the outer layer is assumed",)


@pytest.mark.parametrize(("final", "kind"), [(True, MISSING), (False, MISSING), (True, UNEXPLAINED)])
def test_a_result_has_the_names_that_its_file_has_and_says_with_what_the_rest_goes(monkeypatch, final, kind):
    """Where another explanation than the selection's was fitted, what the selection found is not in the file."""
    depends = lambda name, p_value, share: SimpleNamespace(signal=name, p_value=p_value, share=share, size=9.0)
    left = (depends("chance", 0.9, 0.5), depends("sure", 0.0, 0.5), depends("of nothing", 0.0, 0.0))
    told = {}
    finding = SimpleNamespace(slot=SimpleNamespace(name="wear_drift"))
    selection = SimpleNamespace(final="final", found=(finding,))
    cross = SimpleNamespace(problem=SimpleNamespace(matters=1.0))
    explanation = SimpleNamespace(names=("wear_drift",))
    selection.final = explanation if final else SimpleNamespace(names=())
    given = SimpleNamespace(
        prepared=(), crane=SimpleNamespace(drive=SimpleNamespace(unit="bar")), model=MODEL, loads={}
    )
    search = SimpleNamespace(
        cross=cross, selection=selection, verdict=SimpleNamespace(kind=kind, refused=""), given=given,
        explanation=explanation, left=left, untestable=(),
    )  # fmt: skip
    repaired = SimpleNamespace(model=MODEL, cut=())
    trial = SimpleNamespace(search=search, repaired=repaired, train="train", holdout="holdout", levels="")
    for name, answer in (
        ("_company", SimpleNamespace(partners=(), no_room=())), ("drift_note", ""), ("unexplained_share", 0.0),
        ("_in_the_end", ()), ("_concluded", MODEL), ("_notes", ()), ("_amounts", ()), ("_times", ()),
    ):  # fmt: skip
        monkeypatch.setattr(workflow, name, lambda *_, answer=answer: answer)
    monkeypatch.setattr(workflow, "_effects", lambda search, found, repaired, tied: tuple(found))
    monkeypatch.setattr(workflow, "_inexact", lambda side, goes_with, unit: told.update(goes=goes_with) or ["inexact"])
    monkeypatch.setattr(workflow, "GapResult", SimpleNamespace)
    study = SimpleNamespace(split=SimpleNamespace(runs=()), options=SimpleNamespace(plan=False))
    result = workflow.assemble(study, trial)
    assert result.effects == ((finding,) if final else ())
    assert told == ({"goes": ["sure"]} if final else {})
    assert ("inexact" in result.notes) is final


@pytest.mark.parametrize(
    ("kind", "hydraulic", "planned"), [(AMBIGUOUS, True, True), (AMBIGUOUS, False, False), (MISSING, True, False)]
)
def test_an_experiment_is_planned_for_the_first_effect_that_has_rivals_on_a_hydraulic_drive(
    monkeypatch, kind, hydraulic, planned
):
    """No scenario of an electric drive can be written."""
    monkeypatch.setattr(workflow, "plan_experiment", lambda *own: own[-3:])
    found = [SimpleNamespace(slot=name, rivals=rivals) for name, rivals in (("a", ()), ("b", ("c",)), ("d", ("e",)))]
    search = SimpleNamespace(
        verdict=SimpleNamespace(kind=kind), selection=SimpleNamespace(found=found, final=None), expansion=None,
        cross=None,
    )  # fmt: skip
    crane = SimpleNamespace(drive=SimpleNamespace(hydraulic=hydraulic))
    own = workflow._experiment(crane, search, SimpleNamespace(seed=7))
    assert own == (("b", ("c",), 7) if planned else None)
