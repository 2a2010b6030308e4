"""The traits of one recording."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from winch_friction.fleet import fingerprint as module
from winch_friction.fleet.fingerprint import STRETCH, fingerprint
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


def made_up(share, constant, scatter, count=60):
    """A run of so many stretches whose gap is a share of the model's friction and a constant, off by chance in each."""
    size = int(STRETCH / 0.1)
    time = np.arange(count * size) * 0.1
    friction = 300.0 * np.sign(np.sin(2.0 * np.pi * time / (2.0 * STRETCH / 5.0) + 0.1))
    off = np.repeat(scatter * np.random.default_rng(3).standard_normal(count), size)
    return SimpleNamespace(
        time=time, dt=0.1, used=np.ones(len(time), bool), point=friction, gap=share * friction + constant + off
    )  # fmt: skip


def test_friction_is_in_per_cent_of_the_models_and_the_rest_a_torque_each_with_its_deviation(monkeypatch):
    monkeypatch.setattr(module, "corrected", lambda run, crane, model: (run, crane))
    monkeypatch.setattr(module, "prepare", lambda run, crane, model: run)
    model = SimpleNamespace(torque=lambda point: point)
    found = {each.name: each for each in fingerprint(made_up(0.08, 12.0, 6.0), None, model)}
    assert found["friction"].value == pytest.approx(8.0, abs=0.5)
    assert found["friction"].unit == "%"
    assert found["constant_torque"].value == pytest.approx(12.0, abs=3.0)
    rough = {each.name: each for each in fingerprint(made_up(0.08, 12.0, 60.0), None, model)}
    assert rough["constant_torque"].std == pytest.approx(60.0 / np.sqrt(60), rel=0.3)
    assert fingerprint(made_up(0.08, 12.0, 6.0, count=3), None, model) == []
