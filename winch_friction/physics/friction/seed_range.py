"""How far a learned parameter may lie from its seed (docs/physics.md §4)."""

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.model import FrictionModel
from winch_friction.physics.friction.term import Parameter

SIGMAS_OF_ZERO_SEED = 3.0


def seed_range(seed: FrictionModel, fraction: float) -> dict[str, tuple[float, float]]:
    """Lower and upper value by parameter: seed +- `fraction` of it, inside the bounds.

    A parameter that is zero in the seed, or may have either sign, has no size of its own to take a fraction of: it
    may also move by three standard deviations of the seed (without a covariance: by its typical size).
    """
    return {p.name: _range(seed, k, p, fraction) for k, p in enumerate(seed.parameters)}


def _range(seed: FrictionModel, index: int, parameter: Parameter, fraction: float) -> tuple[float, float]:
    value = seed.values[index]
    lower, upper = seed.bounds_of(parameter.name)
    reach = fraction * abs(value)
    if value == 0.0 or lower < 0.0:
        std = float(seed.std[index]) if seed.covariance is not None else 0.0
        reach = max(reach, SIGMAS_OF_ZERO_SEED * std if std > 0.0 else abs(parameter.typical))
    return max(lower, value - reach), min(upper, value + reach)


def refuse_outside_seed(model: FrictionModel, seed: FrictionModel, fraction: float) -> None:
    """Raise `InputError` when a parameter that the seed has too lies outside `seed_range`."""
    allowed = seed_range(seed, fraction)
    for name, value in model.as_dict().items():
        lower, upper = allowed.get(name, (float("-inf"), float("inf")))
        slack = 1e-9 * max(abs(lower), abs(upper)) if name in allowed else 0.0
        if not lower - slack <= value <= upper + slack:
            raise InputError(
                f"model '{model.name}': parameter {name} = {value:.9g} is outside {lower:g} ... {upper:g}, "
                f"the range around the seed '{seed.name}'; the last good model is kept"
            )
