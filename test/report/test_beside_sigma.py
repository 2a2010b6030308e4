"""A value that is nothing beside its standard deviation is shown as 0, wherever people read the two."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from winch_friction.cli import gap_output, identify_output
from winch_friction.cli.watch import view
from winch_friction.discrepancy.answer import ParameterEstimate
from winch_friction.physics.channels import NOTHING_BESIDE, beside
from winch_friction.report.curves import parameter_html
from winch_friction.report.tables import estimate_for_people

NOTHING, SIGMA = -6.91e-20, 5e-11


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [
        (NOTHING, SIGMA, 0.0),
        (-6e-12, SIGMA, -6e-12),
        (NOTHING, 0.0, NOTHING),
        (3.0, float("nan"), 3.0),
        (0.0, 1.0, 0.0),
    ],
)
def test_a_value_is_nothing_below_the_second_digit_of_its_sigma(value, std, shown):
    assert beside(value, std) == shown
    assert str(beside(NOTHING, SIGMA)) == "0.0"


def test_an_estimate_for_people_is_zero_there():
    assert estimate_for_people(NOTHING, SIGMA, "1") == (0.0, SIGMA, "–")
    assert estimate_for_people(-6e-12, SIGMA, "1")[0] == -6e-12


def test_the_result_of_gap_prints_zero():
    found = {"e_g": {"value": NOTHING, "std": SIGMA, "unit": "1"}}
    assert gap_output._parameters({"parameters": found, "law_kind": "literature"}) == "e_g = 0 ± 5e-11"


def test_tables_of_parameters_print_zero(crane2_model, capsys):
    values = [abs(NOTHING) if k == 0 else value for k, value in enumerate(crane2_model.values)]
    model = replace(crane2_model.with_values(values), covariance=np.diag(np.full(len(values), SIGMA**2)))
    identify_output.show_parameters(model, "fit")
    page = parameter_html(model)
    for said in (capsys.readouterr().out, page):
        assert "e-20" not in said
        assert "e−20" not in said


def test_a_watched_estimate_is_zero():
    from rich.console import Console

    values = {"b_l": str(NOTHING), "b_l std": str(SIGMA), "b_l status": "seed"}
    entries = {"estimator: parameters": {"level": 0, "message": "", "values": values}}
    console = Console(record=True, width=200)
    console.print(view({"time": 1.0, "status": entries}, {}))
    shown = console.export_text()
    assert "b_l" in shown
    assert "e-20" not in shown


def test_the_dashboard_judges_alike():
    script = Path("winch_friction/report/templates/dashboard.js").read_text()
    assert float(re.search(r"Math\.abs\(e\.value\) < ([\d.]+) \* e\.std \? 0", script)[1]) == NOTHING_BESIDE


def test_a_result_in_python_says_zero():
    from winch_friction.api.results import Gap

    effect = {"name": "line", "indistinguishable_from": [], "evidence": {"p_value": 0.01},
              "parameters": {"b_l": vars(ParameterEstimate(NOTHING, SIGMA, "1"))}}  # fmt: skip
    result = type("Result", (), {"content": lambda self: {"effects": [effect]}})()
    assert Gap(result).effects["parameters"]["line"] == "b_l = 0 ± 5e-11 1"
