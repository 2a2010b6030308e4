"""What was learned, beside what was told and what is true."""

from dataclasses import asdict, dataclass
from typing import Any

from winch_friction.physics.friction import FrictionModel


@dataclass(frozen=True)
class LearnedParameter:
    """One parameter, SI: in the seed, as learned with the standard deviation that the estimator states, and true."""

    name: str
    unit: str
    seed: float
    learned: float
    std: float
    truth: float

    @property
    def sigmas(self) -> float:
        """How many of its stated standard deviations it lies above the truth."""
        error = self.learned - self.truth
        return error / self.std if self.std > 0.0 else (0.0 if error == 0.0 else float("inf"))

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self) | {"sigmas_from_truth": self.sigmas}


def learned_parameters(seed: FrictionModel, learned: FrictionModel, truth: FrictionModel) -> list[LearnedParameter]:
    """Every parameter of the learned model."""
    return [
        LearnedParameter(p.name, p.unit, seed.value(p.name), learned.value(p.name), float(std), truth.value(p.name))
        for p, std in zip(learned.parameters, learned.std, strict=True)
    ]
