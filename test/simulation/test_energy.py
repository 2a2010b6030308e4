"""Energy is neither made nor lost: input = stored + dissipated, and friction only takes."""

import numpy as np
import pytest

from winch_friction.simulation import load_scenario, simulate


def closure(truth):
    """Largest energy that is unaccounted for, relative to the energy that went in and out."""
    stored = truth["energy_stored"] - truth["energy_stored"][0]
    moved = truth["energy_in"] + truth["energy_heave"] - truth["energy_friction"] - truth["energy_lost"]
    return np.abs(stored - moved).max() / np.abs(np.diff(truth["energy_in"])).sum()


@pytest.mark.parametrize(
    "name", ["ahc_55t_215", "ahc_secondary", "ahc_slow_pump", "test_06", "splash_zone", "normal_joystick", "warm_up"]
)
def test_energy_closes(name, crane, model):
    scenario = load_scenario(name).override({"duration": 90.0})
    assert closure(simulate(scenario, crane, model, seed=4).truth) < 1e-6


@pytest.mark.parametrize("effect", ["entrained_air", "accumulator_thermal", "line_pressure_drop", "tare_load"])
def test_energy_closes_with_effects_that_store_or_lose_energy(effect, ahc, cycle, crane, model):
    for scenario in (ahc, cycle):
        assert closure(simulate(scenario, crane, model, seed=4, hidden=[(effect, 2.0)]).truth) < 1e-6


def test_the_closure_notices_a_leak_of_a_thousandth(ahc, crane, model):
    truth = simulate(ahc, crane, model).truth
    columns = dict(truth.columns) | {"energy_lost": truth["energy_lost"] * 1.001}
    assert closure(columns) > 1e-6


@pytest.mark.parametrize("name", ["ahc_swell", "ahc_calming", "ahc_irregular"])
def test_friction_gives_back_no_more_than_the_bristle_holds(name, crane, model):
    scenario = load_scenario(name).override({"duration": 150.0, "presliding": 0.035})
    truth = simulate(scenario, crane, model, seed=5).truth
    taken = truth["energy_friction"]
    given_back = (np.maximum.accumulate(taken) - taken).max()
    bristle = np.abs(truth["friction_torque"]).max() * 0.035
    assert given_back <= bristle
    assert taken[-1] > 0.0


def test_sliding_friction_opposes_the_motion(cycle, crane, model):
    truth = simulate(cycle, crane, model).truth
    sliding = np.abs(truth["direction"]) > 0.999
    assert sliding.any()
    assert (truth["friction_torque"] * truth["motor_speed"])[sliding].min() > 0.0
