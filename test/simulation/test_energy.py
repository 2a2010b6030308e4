"""Energy is neither made nor lost: input = stored + dissipated, and friction only takes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from winch_friction.physics.errors import InputError
from winch_friction.simulation import load_scenario, simulate
from winch_friction.simulation.hidden.catalogue import EFFECTS, effect_names
from winch_friction.simulation.scenario import scenario_from_content


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


CIRCUMSTANCES = st.fixed_dictionaries(
    {
        "mode": st.sampled_from(["ahc", "normal"]),
        "drive": st.sampled_from(["primary", "secondary"]),
        "load": st.floats(2e3, 120e3),
        "displacement": st.floats(1.2e-5, 3.4e-5),
        "sea": st.builds(lambda h: {"kind": "jonswap", "significant_height": h}, st.floats(0.2, 3.0)),
    }
)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(CIRCUMSTANCES, st.sampled_from(effect_names()), st.floats(-1.0, 2.0), st.integers(0, 1000))
def test_energy_closes_whatever_the_circumstances(crane, model, circumstances, effect, size, seed):
    profile = {"plateaus": (30.0, 60.0), "hold": 4.0}
    common = {"name": "any", "duration": 30.0, "profile": profile, "start_time": 1.71e9}
    scenario = scenario_from_content(common | circumstances | {"oil_temperature": {"start": 25.0}})
    size = size if EFFECTS[effect].either_sign else abs(size)
    hidden = [(effect, size)]
    missing = -size * (800.0 + 24.5 * scenario.wire_out)
    if effect == "tare_load" and missing >= scenario.load:  # more than hangs there
        with pytest.raises(InputError, match="take a smaller size or a larger load"):
            simulate(scenario, crane, model, seed, hidden)
        return
    truth = simulate(scenario, crane, model, seed, hidden).truth
    assert all(np.isfinite(column).all() for column in truth.columns.values())
    assert closure(truth) < 1e-6
