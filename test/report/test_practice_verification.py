"""The practice's page: the friction of all motors is drawn, measured and modelled."""

import base64
import json
import re
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification.verification import PressureCheck, TestError
from winch_friction.physics.channels import BAR, RPM
from winch_friction.report.practice_verification import compared_html, pressure_html


def drawn(html):
    """Frames by name, each with its columns."""
    content = json.loads(re.search(r'application/json">(.*)</script></figure>', html).group(1))
    unpacked = lambda packed: np.frombuffer(base64.b64decode(packed), "<f4")
    return {f["name"]: {k: unpacked(v) for k, v in f["columns"].items()} for f in content["frames"]}


def test_the_friction_per_test_is_that_of_all_motors_over_rpm():
    error = TestError("a.csv", np.array([10.0, 50.0]), np.array([20.0, 22.0]), np.array([21.0, 23.0]), 400.0)
    system = SimpleNamespace(tests=[SimpleNamespace(curve=SimpleNamespace(motors=11))], held_out=[])
    frames = drawn(compared_html(SimpleNamespace(system=system, errors={"joint fit": [error]})))
    assert frames["a"]["T_ft, all motors [N·m]"] == pytest.approx([231.0, 253.0])
    assert frames["a, measured"]["T_ft, all motors [N·m]"] == pytest.approx([220.0, 242.0])
    assert frames["a"]["motor speed [rpm]"] == pytest.approx(np.array([10.0, 50.0]) / RPM)


def test_pressures_are_in_bar_and_the_error_is_predicted_minus_measured():
    measured, predicted = np.array([100.0, 110.0]) * BAR, np.array([103.0, 109.0]) * BAR
    check = PressureCheck("r.csv", "main", np.arange(2.0), np.array([10.0, 20.0]), measured, predicted)
    html = pressure_html({"joint fit": check}, "said")
    content = json.loads(re.search(r'application/json">(.*)</script></figure>', html).group(1))
    last = {k: np.frombuffer(base64.b64decode(v), "<f4") for k, v in content["frames"][-1]["columns"].items()}
    assert last["error [bar]"] == pytest.approx([3.0, -1.0])
    assert drawn(html)["measured"]["Δp [bar]"] == pytest.approx([100.0, 110.0])
