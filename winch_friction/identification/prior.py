"""What is known before the crane is measured: the supplier's fit, the spread between units, the sensors' tolerances."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.records.strict_yaml import Section, read_yaml, shipped

SCHEMA = "winch_friction.unit_spread/1"


@dataclass(frozen=True)
class UnitSpread:
    """Relative standard deviations by parameter, and of the systematic sensor errors (Pa for the pressure offset)."""

    relative_std: Mapping[str, float]
    displacement_scale: float
    pressure_scale: float
    pressure_offset: float
    load_scale: float

    def std(self, model: FrictionModel) -> FloatArray:
        """Absolute standard deviations (n,) of the model's parameters; typical values stand in for zeros."""
        pairs = zip(model.parameters, model.values, strict=True)
        return np.array([self._relative(p.name) * max(abs(value), 0.1 * abs(p.typical)) for p, value in pairs])

    def _relative(self, name: str) -> float:
        return self.relative_std.get(name, 1.0)


def load_unit_spread(path: str | Path = "unit_spread") -> UnitSpread:
    """The spread file by path or shipped name; raises `InputError` for anything incomplete."""
    found = shipped("suppliers", path)
    top = Section(read_yaml(found), str(found))
    if top.text("schema") != SCHEMA:
        raise InputError(f"{found}: schema '{top.text('schema')}' is not '{SCHEMA}'")
    relative = top.section("relative_std")
    spread = UnitSpread(
        relative_std={str(name): relative.number(name) for name in relative.content},
        displacement_scale=top.number("displacement_scale"),
        pressure_scale=top.number("pressure_scale"),
        pressure_offset=top.quantity("pressure_offset", "Pa"),
        load_scale=top.number("load_scale"),
    )
    top.close()
    return spread


def supplier_prior(fitted: FrictionModel, spread: UnitSpread) -> FrictionModel:
    """The supplier's fit with the spread between units added to its covariance."""
    own = fitted.covariance if fitted.covariance is not None else np.zeros((len(fitted.values),) * 2)
    return fitted.with_covariance(own + np.diag(spread.std(fitted) ** 2))
