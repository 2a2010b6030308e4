"""Which crane a model belongs to, and what it assumes where it does not say how sure it is."""

from dataclasses import replace

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.winch.crane import Crane

SAME = 1e-3  # relative; a gear ratio or displacement is a nameplate figure, written with three digits or more
# relative sigma of a parameter whose model states none: the largest that paper 1 and 2 leave to a parameter that is
# identified at all (K5 22 %, C5 and K1 20 %)
ASSUMED_STD = 0.2


def refuse_other_crane(model: FrictionModel, crane: Crane) -> None:
    """Raise `InputError`, all contradictions in one line, when a model was made for another crane than this."""
    found = contradictions(model, crane)
    if found:
        raise InputError(
            f"model '{model.name}' does not belong to crane '{crane.name}': {'; '.join(found)}; "
            "give the crane that it was made for, or a model of this crane"
        )


def refuse_other_motor(motor: FrictionModel, crane: Crane) -> None:
    """`refuse_other_crane` for the motors alone, which may have served another winch: what counts is their size."""
    own = {name: value for name, value in motor.constants.items() if name == "max_displacement"}
    refuse_other_crane(replace(motor, crane="", constants=own), crane)


def contradictions(model: FrictionModel, crane: Crane) -> list[str]:
    """What speaks against a model being of this crane, in words; empty where nothing does."""
    found = []
    if model.crane and crane.name and model.crane != crane.name:
        found.append(f"it was made for crane '{model.crane}'")
    own = {"gear_ratio": crane.gear_ratio, "max_displacement": crane.max_displacement}
    names = {"gear_ratio": ("gear ratio", ""), "max_displacement": ("largest displacement", " m^3/rad")}
    for name, value in own.items():
        said = model.constants.get(name, value)
        if value > 0.0 and abs(said - value) > SAME * value:
            words, unit = names[name]
            found.append(f"its {words} is {said:.5g}{unit}, the crane's {value:.5g}{unit}")
    hydraulic = [term.name for term in model.terms if term.reads_groups]
    if hydraulic and not crane.drive.hydraulic:
        found.append(f"its terms {', '.join(hydraulic)} need pressures, the crane's drive is {crane.drive.kind}")
    return found


def with_stated_std(model: FrictionModel, share: float = ASSUMED_STD) -> tuple[FrictionModel, str]:
    """The model with a covariance, and what had to be assumed for it, in words (empty: nothing).

    A model without `std` gets `share` of each value, of a tenth of the typical size where the value is smaller.
    """
    if model.covariance is not None or not model.values:
        return model, ""
    size = [max(abs(v), 0.1 * abs(p.typical)) for v, p in zip(model.values, model.parameters, strict=True)]
    said = (
        f"model '{model.name}' states no std: {100.0 * share:g} % of each value is assumed (1 sigma); "
        "give every parameter its 'std' to say otherwise"
    )
    return replace(model, covariance=np.diag((share * np.array(size)) ** 2)), said


def unstated(model: FrictionModel, share: float = ASSUMED_STD) -> list[str]:
    """What has to be assumed of a model, in words, one entry per assumption; for the verbs to say."""
    said = with_stated_std(model, share)[1]
    return [said] if said else []
