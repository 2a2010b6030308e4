"""The practice's page of a winch of another size than the papers': its own motors, loads and torques."""

import base64
import json
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.identification.friction_curve import FrictionCurve
from winch_friction.physics.channels import CM3_PER_REV
from winch_friction.physics.winch.crane import Drum
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.report.practice_loops import derived_html, motor_change_html
from winch_friction.report.practice_system import breakdown_html

LOADS = (43.0, 43.2, 700.0, 703.0, 1400.0)  # N m at the drum, two of them twice


def curve(test, drum_torque):
    own = np.array([10.0, 20.0])
    return FrictionCurve(test, own, 1e7 + own, 9e6 + own, 28 * CM3_PER_REV, drum_torque, 1, drum_torque / 25.0)


@pytest.fixture
def practice():
    crane = replace(
        load_crane("crane_150t"), gear_ratio=25.0, groups={"main": 1}, max_displacement=28 * CM3_PER_REV,
        drum=Drum((0.15,)), rated_load=1e3,
    )  # fmt: skip
    model = load_model("a6vm215_crane2")
    loop = SimpleNamespace(motor=model.only("motor"), system=model.only("gear and drum"))
    tests = [SimpleNamespace(curve=curve(f"t{k}.csv", each)) for k, each in enumerate(LOADS)]
    system = SimpleNamespace(tests=tests, held_out=[], loops=[loop, loop])
    return SimpleNamespace(folder=SimpleNamespace(crane=crane), system=system)


def frames(html):
    content = json.loads(re.search(r'application/json">(.*?)</script></figure>', html).group(1))
    return {f["name"]: f["columns"] for f in content["frames"]}


def test_the_motor_is_drawn_at_settings_that_it_has(practice):
    drawn = {each.partition(" cm³/rev")[0] for each in frames(motor_change_html(practice))}
    assert drawn == {"28", "18.9", "9.12"}


def test_tests_of_one_load_share_a_figure(practice):
    html = derived_html(practice)
    assert re.findall(r"T_d = ([^:]*):", html) == ["0.0431 kN·m", "0.7015 kN·m", "1.4 kN·m"]


def test_the_parts_are_drawn_at_a_load_of_its_own(practice):
    html = breakdown_html(practice)
    assert "System friction at 0.67 t" in html
    packed = frames(html)["system"]["gear_load_loss [N·m]"]
    own = np.frombuffer(base64.b64decode(packed), "<f4")
    crane = practice.folder.crane
    expected = load_model("a6vm215_crane2").value("C6") * crane.drum_torque(670.0)
    assert own == pytest.approx(expected, rel=1e-5)
