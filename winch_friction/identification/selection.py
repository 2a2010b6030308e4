"""Which motor model to use: judged on displacements that the fit has not seen, with its parameters counted."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.identification.fit import FitResult, fit
from winch_friction.identification.fit_data import FitData, modelled
from winch_friction.identification.motor_models import initial_model, motor_model_named
from winch_friction.identification.supplier_table import SupplierTable
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray


@dataclass(frozen=True)
class ModelScore:
    """One model on one table.

    `held_out` is the RMS in N m on displacements left out one at a time (NaN with one displacement only),
    `held_out_by_group` the same for each, `bic` the Bayesian information criterion of the whole fit.
    """

    name: str
    fitted: FitResult
    held_out: float
    held_out_by_group: FloatArray
    bic: float


def score_models(table: SupplierTable, names: Sequence[str], weighting: str = "nominal") -> list[ModelScore]:
    """Fit every model and score it, best held-out displacement first (best BIC first with one displacement only)."""
    data = table.fit_data(weighting)
    scores = [_score(name, table, data) for name in names]
    return sorted(scores, key=lambda score: (score.held_out if np.isfinite(score.held_out) else 0.0, score.bic))


def _score(name: str, table: SupplierTable, data: FitData) -> ModelScore:
    start = initial_model(motor_model_named(name), table.max_displacement)
    result = fit(start, data)
    squares = [_left_out(start, data, group) for group in np.unique(data.group)] if _groups(data) > 1 else []
    return ModelScore(
        name=name,
        fitted=result,
        held_out=float(np.sqrt(np.mean(np.concatenate(squares)))) if squares else float("nan"),
        held_out_by_group=np.array([np.sqrt(np.mean(each)) for each in squares]),
        bic=bic(result),
    )


def _groups(data: FitData) -> int:
    return len(np.unique(data.group))


def _left_out(start: FrictionModel, data: FitData, group: float) -> FloatArray:
    inside = data.where(data.group != group)
    outside = data.where(data.group == group)
    return (outside.torque - modelled(fit(start, inside).model, outside)) ** 2


def bic(result: FitResult) -> float:
    """n ln(cost / n) + k ln n."""
    n = result.observations
    return float(n * np.log(max(result.cost, 1e-300) / n) + result.parameter_count * np.log(n))


def choose(scores: Sequence[ModelScore]) -> ModelScore:
    """The model with the fewest parameters whose held-out error is within one standard error of the best's."""
    if not scores:
        raise InputError("no model was scored: name at least one")
    best = scores[0]
    if not np.isfinite(best.held_out):
        return best
    near = [score for score in scores if _as_good(score, best)]
    return min(near, key=lambda score: (score.fitted.parameter_count, score.held_out))


def _as_good(score: ModelScore, best: ModelScore) -> bool:
    """Whether the held-out squared errors, displacement by displacement, are no worse than the best's by chance."""
    excess = score.held_out_by_group**2 - best.held_out_by_group**2
    return bool(excess.mean() <= excess.std(ddof=1) / np.sqrt(len(excess)))
