"""The proposed experiment does what it promises: run it, and the rivals part."""

import numpy as np
import pytest

from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation import load_scenario, simulate

HIDDEN = [("pressure_offset", 1.0)]
MOST = 3  # experiments


def recorded(scenario: str, seed: int) -> Run:
    """A run of the simulated crane with the effect hidden in it."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    run = simulate(load_scenario(scenario), crane, model, seed=seed, hidden=HIDDEN).run
    return Run(f"{scenario}_{seed}", run.columns)


@pytest.mark.long
def test_running_the_proposed_scenarios_resolves_the_ambiguity():
    """Each experiment parts the two that it was proposed for, and a few of them leave the one that is there."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = [recorded("test_02", seed) for seed in range(6)]  # one load, one displacement
    result, at_first = find_gap(runs, crane, model), None
    for k in range(MOST):
        if result.verdict != "ambiguous":
            break
        plan = result.content()["next_experiment"]
        assert plan["expected_z"] > 3.0
        together = {result.effects[0].name, *result.effects[0].rivals}
        at_first = at_first or together
        assert set(plan["separates"]) <= together
        scenario = plan["scenario"].removesuffix(".yaml")
        runs += [recorded(scenario, 50 + 10 * k + j) for j in range(3)]
        result = find_gap(runs, crane, model)
        assert not set(plan["separates"]) <= {result.effects[0].name, *result.effects[0].rivals}
    assert at_first, "it was ambiguous"
    assert len(at_first) > 1
    assert result.verdict == "missing_effect"
    assert [effect.name for effect in result.effects] == ["pressure_offset"]


def test_a_single_run_without_an_effect_is_no_discovery():
    """Both halves of one voyage are told the same of its wire, so a refit to the first does not go astray: it moves no
    parameter by half of its deviation, and the other half is none the worse."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    for seed in (0, 1):
        run = simulate(load_scenario("ahc_55t_215"), crane, model, seed=seed).run
        result = find_gap([Run("voyage", run.columns)], crane, model)
        assert result.verdict == "nothing_missing"
        assert not result.effects
        moved = np.abs(np.subtract(result.model.values, model.values)) / np.array(model.std)
        assert moved.max() < 0.5
        assert result.holdout.size_after.value <= 1.01 * result.holdout.size_before.value
