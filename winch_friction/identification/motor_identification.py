"""Step 1 of the practice: from the supplier's table to a motor model with honest uncertainty."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from winch_friction.identification.fit import FitResult, exchangeable, fit
from winch_friction.identification.fit_data import CountedModel
from winch_friction.identification.motor_models import initial_model, motor_model_named
from winch_friction.identification.selection import ModelScore, choose, score_models
from winch_friction.identification.supplier_table import FitRange, SupplierTable
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel

Progress = Callable[[Any, str], Any]


def silent(items: Any, description: str) -> Any:
    """No progress bar."""
    return items


@dataclass(frozen=True)
class MotorIdentification:
    """`table` inside the range; `scores` best first; `by_complex` the complex method's fits by model name, beside them;
    `recommended` by what `recommended_by` says; `chosen` is the fit that becomes the seed.
    """

    table: SupplierTable
    weighting: str
    scores: tuple[ModelScore, ...]
    by_complex: dict[str, FitResult]
    recommended: str
    chosen: ModelScore

    @property
    def recommended_by(self) -> str:
        """What the models were compared by: with one displacement, none can be held out."""
        held_out = np.isfinite(self.chosen.held_out)
        return "held-out displacement" if held_out else "BIC, with one displacement in the fit"


def identify_motor(
    table: SupplierTable,
    models: Sequence[str],
    *,
    chosen: str = "",
    fit_range: FitRange | None = None,
    weighting: str = "nominal",
    with_complex: bool = True,
    seed: int = 0,
    progress: Progress = silent,
    complex_options: Mapping[str, int] | None = None,
    force: bool = False,
) -> MotorIdentification:
    """Fit every model both ways and score it.

    `chosen` overrides the recommended model; `fit_range`: which rows count, `FitRange.usual` of the table without it;
    `complex_options`: restarts, max_evaluations; `force`: take a fit that ends where no motor is. Raises `InputError`.
    """
    names = list(dict.fromkeys(motor_model_named(name).name for name in models))
    if chosen and motor_model_named(chosen).name not in names:
        names.append(motor_model_named(chosen).name)
    inside = (fit_range or FitRange.usual(table)).select(table)
    scores = score_models(inside, names, weighting)
    by_complex = {}
    for name in progress(names if with_complex else [], "complex method"):
        start = initial_model(motor_model_named(name), inside.max_displacement)
        by_complex[name] = fit(start, inside.fit_data(weighting), "complex", seed=seed, **(complex_options or {}))
    recommended = choose(scores)
    wanted = motor_model_named(chosen).name if chosen else recommended.name
    best = next(each for each in scores if each.name == wanted)
    _refuse_undetermined(best, inside)
    if (beyond := at_largest(best)) and not force:
        raise InputError(f"{table.name}: {beyond}? Correct it there; identify --force takes the fit all the same")
    return MotorIdentification(
        table=inside,
        weighting=weighting,
        scores=tuple(scores),
        by_complex=by_complex,
        recommended=recommended.name,
        chosen=best,
    )


def _refuse_undetermined(chosen: ModelScore, table: SupplierTable) -> None:
    """Raise `InputError` where other values of some parameters fit as well: their deviations would say nothing."""
    model = chosen.fitted.model
    tied = exchangeable(CountedModel(model, table.fit_data()).columns(), model.parameter_names)
    if not tied:
        return
    many = {name: len(np.unique(getattr(table, name).round(12))) for name in ("speed", "pressure", "displacement")}
    counts = ", ".join(f"{number} {name}{'s' * (number > 1)}" for name, number in many.items())
    raise InputError(
        f"{table.name}: {', '.join(tied)} of '{chosen.name}' cannot be told apart by a table of {counts}: bring rows "
        f"at another {min(many, key=lambda name: many[name])}, or choose a model with fewer parameters"
    )


def at_largest(chosen: ModelScore) -> str:
    """In words, the parameters that end at the largest value that a motor may have, and what that is a sign of: speeds
    in rad/s under rpm ended at a K2 that loses twice the motor's torque at the speed that it truly turns at."""
    fitted = chosen.fitted
    values = zip(fitted.model.parameters, fitted.model.values, strict=True)
    largest = [each.name for each, value in values if each.name in fitted.at_bound and value > max(each.lower, 0.0)]
    if not largest:
        return ""
    return (
        f"{', '.join(largest)} of '{chosen.name}' end at the largest value that any motor has: is the unit of the "
        "speed, the pressure or the displacement another than its header says"
    )


def motor_seed(found: MotorIdentification, name: str, provenance: dict[str, Any]) -> FrictionModel:
    """The chosen fit as a seed model: values, covariance, where they come from."""
    result = found.chosen.fitted
    said = {
        "method": f"bounded least squares, weighting '{found.weighting}'",
        "paper1_model": found.chosen.name,
        "cost": result.cost,
        "rms": {"value": result.rms, "unit": "N*m"},
        "observations": result.observations,
        "condition": result.condition,
        **provenance,
    }
    if beyond := at_largest(found.chosen):
        said["forced"] = beyond
    return replace(result.model, name=name, provenance=said)
