"""The recording that the benchmarks share: a simulated minute of heave compensation at 50 Hz."""

from functools import lru_cache

from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.hold import InputHold
from winch_friction.physics.signals import Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model
from winch_friction.simulation.scenario import load_scenario
from winch_friction.simulation.simulator import simulate


@lru_cache(maxsize=1)
def sea() -> tuple[Crane, FrictionModel, Run, list[Sample]]:
    """Crane, model, run and its samples."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    run = simulate(load_scenario("ahc_irregular").override({"duration": 60.0}), crane, model, seed=5).run
    return crane, model, run, list(InputHold(run.groups).samples(run))
