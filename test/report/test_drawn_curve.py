"""A curve that the data drew is shown by its values, not by the rises that its parameters are."""

import re

import numpy as np
import pytest

from winch_friction.discrepancy.answer import Effect
from winch_friction.discrepancy.candidates.candidate import ParameterEstimate
from winch_friction.physics.friction import FrictionModel, Scope, term_named
from winch_friction.physics.friction.table import Table, tabulated
from winch_friction.report.gap import _curve, _effect

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
    whole = _text(_effect(effect, model))
    assert f"{VALVE.name}_1" not in whole
    assert ("R_line" in whole) is (law != VALVE.name)


def test_what_is_no_curve_over_one_signal_is_shown_as_before():
    effect, model = _found("line_pressure_power")
    assert _curve(effect, model) == (set(), "")
    assert f"{VALVE.name}_2" in _text(_effect(effect, model))
