"""The proposed experiment does what it promises: run it, and the rivals part."""

from winch_friction.discrepancy.options import GapOptions
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation import load_scenario, simulate

HIDDEN = [("pressure_offset", 1.0)]


def recorded(scenario: str, seed: int) -> Run:
    """A run of the simulated crane with the effect hidden in it."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    run = simulate(load_scenario(scenario), crane, model, seed=seed, hidden=HIDDEN).run
    return Run(f"{scenario}_{seed}", run.columns)


def test_running_the_proposed_scenario_resolves_the_ambiguity():
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    poor = [recorded("test_02", seed) for seed in range(6)]  # one load, one displacement
    first = find_gap(poor, crane, model)
    assert first.verdict == "ambiguous"
    assert len(first.effects[0].rivals) >= 1
    plan = first.content()["next_experiment"]
    assert plan["expected_z"] > 3.0
    assert set(plan["separates"]) <= {first.effects[0].name, *first.effects[0].rivals}
    more = [recorded(plan["scenario"].removesuffix(".yaml"), seed) for seed in (50, 51, 52)]
    second = find_gap(poor + more, crane, model, GapOptions(plan=False))
    assert second.verdict == "missing_effect"
    assert [effect.name for effect in second.effects] == ["pressure_offset"]
