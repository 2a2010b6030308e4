"""A curve that the data drew is shown by its values, not by the rises that its parameters are."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.discrepancy.adequacy import of_names
from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.discrepancy.next_experiment import insufficient
from winch_friction.discrepancy.workflow import _amounts
from winch_friction.physics.friction import FrictionModel, Scope, term_named
from winch_friction.physics.friction.table import Table, tabulated
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.report.gap import _curve, _effect
from winch_friction.report.gap_words import next_steps

VALVE = Table(
    "free_line_pressure_drop_displacement", (("flow", (0.0, 0.01, 0.03)),), "Pa", ("displacement",), Scope.MOTOR,
    shape="rising", anchor="low",
)  # fmt: skip


def _found(law):
    term = tabulated(VALVE)
    model = FrictionModel(
        "m", (term_named("coulomb"), term), (50.0, 0.0, 2.5e5), covariance=np.diag([1.0, 4e6, 9e6])
    )  # fmt: skip
    parameters = {p.name: ParameterEstimate(v, 1.0, "Pa") for p, v in zip(term.parameters, (0.0, 2.5e5), strict=True)}
    own = {} if law == VALVE.name else {"R_line": ParameterEstimate(3.0, 0.1, "Pa*s^2/m^6")}
    return Effect("line_pressure_drop", (), "", "x^2", own | parameters, 1e-9, 0.9, 1.0, law_name=law, free=True), model


def _text(page):
    return re.sub(r"<[^>]*>", "", page).replace("\u200b", "")


@pytest.mark.parametrize("law", [VALVE.name, f"catalogue's and {VALVE.name}"])
def test_its_values_stand_at_its_knots(law):
    effect, model = _found(law)
    drawn, page = _curve(effect, model)
    assert drawn == {f"{VALVE.name}_1", f"{VALVE.name}_2"}
    cells = [float(each.split("<")[0]) for each in page.replace("</td>", "").split(">") if each[:1].isdigit()]
    assert cells == pytest.approx([0.0, 0.0, 0.0, 0.01, 0.0, 0.02, 0.03, 2.5, np.hypot(0.02, 0.03)], rel=1e-3)  # bar
    whole = _text(_effect(effect, SimpleNamespace(model=model)))
    assert f"{VALVE.name}_1" not in whole
    assert ("R_line" in whole) is (law != VALVE.name)


def test_a_brake_says_what_it_took_of_every_run():
    """Not as a formula of two dozen steps over Unix time."""
    table = Table(
        "brake_drag_by_run", (("time", (100.0, 200.0, 300.0, 400.0)),), scope=Scope.SYSTEM, shape="windows",
        weights=(0.25, 1.0),
    )  # fmt: skip
    model = FrictionModel("m", (term_named("coulomb"), tabulated(table)), (50.0, 8.0))
    known = {"brake_drag_by_run_0": ParameterEstimate(8.0, 0.1, "N*m")}
    effect = Effect("brake_drag", (), "", "x^2", known, 1e-9, 0.9, 1.0, law_name="by another amount in each run")
    runs = [
        SimpleNamespace(name=f"run_{k}", start=at, time=np.array([0.0, 60.0])) for k, at in enumerate((320, 120, 500))
    ]
    result = SimpleNamespace(
        model=model, train=SimpleNamespace(runs=runs[:2]), holdout=SimpleNamespace(runs=runs[2:])
    )  # fmt: skip
    page = _effect(effect, result)
    assert re.findall(r"run_\d|(?<=>)[\d.]+(?=<)", page) == ["run_1", "2", "run_0", "8", "run_2", "0"]
    assert "at each motor's shaft" in page or "at each motor&#x27;s shaft" in page
    assert "x^2" not in _text(page)
    assert "brake_drag_by_run_0" not in _text(page)
    of_log = [Run(each.name, {"time": each.start + np.arange(60.0)}) for each in runs]
    (note,) = _amounts(model, of_log)
    assert "run_0 8, run_1 2;" in note
    assert "run_2" not in note
    assert _amounts(replace(model, terms=model.terms[:1], values=(50.0,)), of_log) == []


@pytest.mark.parametrize(("law", "of_the_next"), [("by another amount in each run", False), ("in some runs", False),
                                                  ("since a date", True), ("", True)])  # fmt: skip
def test_a_file_that_says_nothing_of_the_next_run_is_not_to_be_loaded(law, of_the_next):
    effect = Effect("brake_drag", (), "", "x^2", {}, 1e-9, 0.9, 1.0, law_name=law)
    found = {"effects": [effect], "verdict": "missing_effect", "model": SimpleNamespace(corrections=(), terms=())}
    said = " ".join(next_steps(SimpleNamespace(next_experiment=None, adequacy=(), levels="", **found)))
    assert ("winch-friction load model.yaml" in said) is of_the_next
    assert ("nothing of the next one" in said) is not of_the_next


def test_what_is_no_curve_over_one_signal_is_shown_as_before():
    effect, model = _found("line_pressure_power")
    assert _curve(effect, model) == (set(), "")
    assert f"{VALVE.name}_2" in _text(_effect(effect, SimpleNamespace(model=model)))


@pytest.mark.parametrize(("note", "parted"), [("", True), ("tied in every scenario of the family", False)])
def test_an_experiment_that_parts_nothing_is_not_asked_for(note, parted):
    plan = {"scenario": "experiment_loads.yaml", "separates": ["brake_drag", "coulomb"], "expected_z": 4.0 * parted,
            "note": note}  # fmt: skip
    (said,) = next_steps(SimpleNamespace(next_experiment=plan, effects=[], verdict="ambiguous", levels="", adequacy=()))
    assert ("winch-friction simulate" in said) is parted
    assert ("another channel" in said) is not parted


def test_runs_that_would_supply_what_lacks_are_asked_for():
    """Not refused as an experiment that parts nothing: there is nothing for it to part."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    first, second = next_steps(insufficient([of_names("coulomb is not told from brake_drag")], (), crane, model))
    assert "winch-friction simulate experiment_loads.yaml" in first
    assert "supplies what these runs lack" in first
    assert "coulomb is not told from brake_drag" in second
