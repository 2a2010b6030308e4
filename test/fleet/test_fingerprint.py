"""The traits of one recording."""

from dataclasses import replace

import pytest

from winch_friction.fleet.fingerprint import fingerprint
from winch_friction.physics.friction.correction import Correction
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate


def test_what_the_model_corrects_is_no_trait(crane_150t, crane2_model):
    """A zero error that the model file knows of is taken out before the crane is judged."""
    scenario = load_scenario("ahc_irregular").override({"duration": 40.0})
    run = simulate(scenario, crane_150t, crane2_model, seed=5, hidden=[("pressure_offset", 1.0)]).run
    plain = {each.name: each.value for each in fingerprint(run, crane_150t, crane2_model)}
    known = replace(crane2_model, corrections=(Correction("pressure_offset", 1.5e5),))
    without = {each.name: each.value for each in fingerprint(run, crane_150t, known)}
    assert abs(plain["constant_torque"] - without["constant_torque"]) > 5.0  # N m
    assert without["friction"] == pytest.approx(plain["friction"], abs=10.0)
