"""The whole product in a loop: an effect hidden in the crane is logged, named, added to the model, and compensated."""

import numpy as np
import pytest

from winch_friction.compensation import CompensatorConfig, FeedforwardCompensator
from winch_friction.discrepancy.workflow import GapOptions, find_gap
from winch_friction.records.model_file import load_model, save_model
from winch_friction.records.runs import read_run, write_run
from winch_friction.simulation.campaigns import gap_campaign
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import Simulator, simulate

HIDDEN = [("low_displacement_loss", 0.3)]  # at full size the safety envelope of 1.3 x the seed would clip the repair
SEED = 71


@pytest.fixture(scope="module")
def diagnosis(crane_150t, crane2_model, tmp_path_factory):
    """Twelve logged runs of the crane with the hidden effect, through bags and tables, and what `gap` makes of them."""
    folder = tmp_path_factory.mktemp("logs")
    runs = []
    for k, scenario in enumerate(gap_campaign(SEED)):
        suffix = ".mcap" if k == 8 else ".csv"
        path = folder / f"run_{k:02d}{suffix}"
        write_run(simulate(scenario, crane_150t, crane2_model, SEED + k, HIDDEN).run, path)
        runs.append(read_run(path))
    result = find_gap(runs, crane_150t, crane2_model, GapOptions(plan=False))
    return result, save_model(result.model, folder / "model.yaml")


def sail(crane, truth, seed_model, model):
    """Position error and friction error of the crane with the hidden effect under a compensator using `model`."""
    scenario = load_scenario("ahc_irregular").override({"duration": 60.0})
    simulator = Simulator(scenario, crane, truth, seed=5, hidden=HIDDEN)
    compensator = FeedforwardCompensator(crane, seed_model, CompensatorConfig(scale=1.0))
    compensator.load_model(model)
    torque = 0.0
    while not simulator.finished:
        if simulator.fresh:
            torque = compensator.step(simulator.sample).friction_torque
        simulator.step(torque)
    columns = simulator.result().truth
    late, moving = columns.time > 20.0, np.abs(columns["motor_speed"]) > 10.0
    gap = (columns["friction_torque"] - columns["friction_feedforward"])[late & moving]
    return np.std(columns["position_error"][late]), np.sqrt(np.mean(gap**2))


def test_the_hidden_effect_is_named_and_the_locked_gap_shrinks(diagnosis):
    content = diagnosis[0].content()
    named = {name for each in content["effects"] for name in (each["name"], *each["indistinguishable_from"])}
    assert HIDDEN[0][0] in named
    assert content["gap"]["holdout"]["after"] < 0.3 * content["gap"]["holdout"]["before"]


def test_the_repaired_model_makes_the_compensation_better(diagnosis, crane_150t, crane2_model):
    error_before, gap_before = sail(crane_150t, crane2_model, crane2_model, crane2_model)
    error_after, gap_after = sail(crane_150t, crane2_model, crane2_model, load_model(diagnosis[1]))
    assert error_after < 0.8 * error_before
    assert gap_after < 0.5 * gap_before
