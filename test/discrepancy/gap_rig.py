"""Measured runs of the campaign's own generator, which shares no code with the package."""

from functools import cache

from campaign.rig import make_dataset
from winch_friction.discrepancy.answer import GapOptions, GapResult
from winch_friction.discrepancy.workflow import find_gap
from winch_friction.physics.signals import Run
from winch_friction.records.crane_file import load_crane
from winch_friction.records.model_file import load_model

LENGTH = 0.45  # of a campaign's runs, to be quick


def runs_with(seed: int, flavour: str, *effects: tuple[str, float], length: float = LENGTH) -> list[Run]:
    """Twelve runs with these effects hidden."""
    dataset = make_dataset(seed, flavour, effects, length=length)
    return [Run(f"run_{k + 1:02d}.csv", columns) for k, columns in enumerate(dataset)]


@cache
def gap_of(
    seed: int, flavour: str, *effects: tuple[str, float], plan: bool = False, length: float = LENGTH
) -> GapResult:
    """The workflow's result, once per test session; laws for what has no name are test_proposals' matter."""
    crane, model = load_crane("crane_150t"), load_model("a6vm215_crane2")
    runs = runs_with(seed, flavour, *effects, length=length)
    return find_gap(runs, crane, model, GapOptions(plan=plan, proposals=False))


def names_of(result: GapResult) -> list[set[str]]:
    """For each effect, the names it may be."""
    return [{effect.name, *effect.rivals} for effect in result.effects]
