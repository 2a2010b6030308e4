"""A model that is harder or easier to turn than another."""

from dataclasses import replace

from winch_friction.physics.friction.model import FrictionModel

SYSTEM_PLACE = "gear and drum"


def scaled_system(model: FrictionModel, factor: float) -> FrictionModel:
    """The model with its system friction (gear and drum) times `factor`; shapes such as C4 stay as they are."""
    system = {p.name for term in model.terms if term.place == SYSTEM_PLACE for p in term.parameters if not p.shape}
    values = {name: value * factor for name, value in model.as_dict().items() if name in system}
    bounds = {name: each for name, each in model.bounds.items() if name not in values}
    return replace(model, name=f"{model.name}_x{factor:g}", bounds=bounds).with_values(values)
