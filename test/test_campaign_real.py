"""The campaign on real winches: its power error is that of the model file, and every data set has its expectation."""

import numpy as np
import pytest

from campaign.real import carried_through, power_error, studies
from campaign.real_page import EXPECTED
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.runs import write_run

RIGHT = """\
schema: winch_friction.model/1
name: right
crane: winch_100kw
terms: [viscous]
parameters:
  C5: {value: 200, unit: N*m*s/rad, std: 1, lower: 0, upper: 1000}
corrections:
  inertia: {value: 3000, unit: kg*m^2, std: 1, lower: -100000, upper: 100000, source: test}
provenance: {source: test}
"""


def test_the_power_error_is_that_of_the_written_model(tmp_path):
    """A winch of 3000 kg with 200 N s/m: the model file that says so predicts its power, the rope force alone does
    not."""
    time = np.arange(0.0, 120.0, 0.1)
    speed = 4.0 * np.sin(2.0 * np.pi * time / 30.0)
    force = 2000.0 + 300.0 * np.sin(2.0 * np.pi * time / 17.0)
    torque = force + 3001.0 * np.gradient(speed, time) + 200.0 * speed
    columns = {"time": time, "motor_speed": speed, "rope_force": force, "mechanical_power": torque * speed}
    write_run(Run("cycle", columns), tmp_path / "cycle.csv")
    (tmp_path / "right.yaml").write_text(RIGHT, encoding="utf-8")
    crane, cycles = load_crane("winch_100kw"), [tmp_path / "cycle.csv"]
    assert power_error(cycles, crane, tmp_path / "right.yaml") < 0.03
    assert power_error(cycles, crane, "rope_force_alone") > 0.2


def test_every_data_set_has_what_is_expected_of_it():
    names = {study.name for study in studies()}
    assert {"winch_100kw", "worm_drive"} <= names <= set(EXPECTED)


@pytest.mark.shared
def test_the_real_winch_goes_the_whole_way(tmp_path, shared_data):
    """From the rope force alone: every verb answers, and the power of cycles that were not used is far better told."""
    study = next(each for each in studies() if each.name == "winch_100kw")
    out = carried_through(study, tmp_path)
    said = {verb: (status, sentence) for verb, status, sentence in out.steps}
    status, sentence = said.pop("identify system")
    assert status == 2
    assert "identify fits what hydraulic motors lose" in sentence
    assert [status for status, _ in said.values()] == [0, 0, 0, 0, 0], "nothing needs --force"
    others = [path for k, path in enumerate(out.runs) if k % study.every]
    crane = load_crane(study.crane)
    assert power_error(others, crane, out.written) <= 0.26 < 0.4 * power_error(others, crane, study.model)
