"""Bounded linear least squares with variable projection.

Given the shape parameters (C4, C_n), every model of both papers is linear in the others, so their global optimum is one
bounded linear solve; the shape is then a search over a scalar.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear, minimize, minimize_scalar

from winch_friction.identification.fit_data import CountedModel, FitData
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray

_SCAN = 6  # coarse shape values before the bounded search: a Stribeck cost has more than one valley


@dataclass(frozen=True)
class LeastSquaresResult:
    """Values of all parameters in the model's order, the weighted squared error and the counted model evaluations."""

    values: tuple[float, ...]
    cost: float
    evaluations: int


def least_squares(model: FrictionModel, data: FitData) -> LeastSquaresResult:
    """Fit every parameter of the model within its bounds."""
    projection = _Projection(model, data)
    projection.solve(_search_shape(projection))
    return LeastSquaresResult(projection.best_values, projection.best_cost, projection.evaluations)


class _Projection:
    """The cost as a function of the shape parameters alone, the others solved for."""

    def __init__(self, model: FrictionModel, data: FitData) -> None:
        self.model, self.data = model, data
        self.shape = [k for k, each in enumerate(model.parameters) if each.shape]
        self.linear = [k for k in range(len(model.values)) if k not in self.shape]
        shaped = [term.name for term in model.terms if any(each.shape for each in term.parameters)]
        self.shaped = model.subset(shaped) if shaped else None
        self._fixed_columns, self.evaluations = _columns(_without(model, shaped), data)
        self.root = np.sqrt(data.weight)
        bounds = np.array([model.bounds_of(name) for name in model.parameter_names])
        self.lower, self.upper = bounds[:, 0], bounds[:, 1]
        self.best_cost, self.best_values = np.inf, model.values

    def solve(self, shape: Sequence[float]) -> float:
        """Cost at these shape values, with the best linear parameters; remembers the best seen."""
        columns = dict(self._fixed_columns)
        if self.shaped is not None:
            names = [self.model.parameter_names[k] for k in self.shape]
            at = _unit_linear(self.shaped).with_values(dict(zip(names, shape, strict=True)))
            found, spent = _columns(at, self.data)
            columns.update(found)
            self.evaluations += spent
        names = [self.model.parameter_names[k] for k in self.linear]
        solution = bounded_linear(
            np.column_stack([columns[name] for name in names]) * self.root[:, None],
            self.data.torque * self.root,
            self.lower[self.linear],
            self.upper[self.linear],
        )
        error = self.root * self.data.torque - sum(
            self.root * columns[name] * value for name, value in zip(names, solution, strict=True)
        )
        cost = float(error @ error)
        if cost < self.best_cost:
            self.best_cost, self.best_values = cost, self._values(shape, solution)
        return cost

    def _values(self, shape: Sequence[float], linear: FloatArray) -> tuple[float, ...]:
        values = np.empty(len(self.model.values))
        values[self.shape], values[self.linear] = shape, linear
        return tuple(float(value) for value in values)


def bounded_linear(columns: FloatArray, target: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Least squares within bounds, columns scaled to unit length first; exact active-set solution (BVLS)."""
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    free = np.linalg.lstsq(columns / scale, target, rcond=None)[0] / scale
    if np.all((free >= lower) & (free <= upper)):
        return free
    solution = lsq_linear(columns / scale, target, bounds=(lower * scale, upper * scale), method="bvls", tol=1e-14)
    return np.clip(solution.x / scale, lower, upper)


def _search_shape(projection: _Projection) -> Sequence[float]:
    lower, upper = projection.lower[projection.shape], projection.upper[projection.shape]
    if len(lower) == 0:
        return ()
    if len(lower) > 1:
        start = [projection.model.values[k] for k in projection.shape]
        return minimize(projection.solve, start, method="Powell", bounds=list(zip(lower, upper, strict=True))).x
    grid = np.geomspace(max(lower[0], 1e-3), upper[0], _SCAN)
    costs = [projection.solve([value]) for value in grid]
    best = int(np.argmin(costs))
    around = grid[max(best - 1, 0)], grid[min(best + 1, _SCAN - 1)]
    tolerance = 1e-6 * grid[best]
    return [
        minimize_scalar(
            lambda c: projection.solve([c]), bounds=around, method="bounded", options={"xatol": tolerance}
        ).x
    ]


def _without(model: FrictionModel, terms: list[str]) -> FrictionModel | None:
    rest = [name for name in model.term_names if name not in terms]
    return model.subset(rest) if rest else None


def _unit_linear(model: FrictionModel) -> FrictionModel:
    return model.with_values(
        [value if p.shape else 0.0 for p, value in zip(model.parameters, model.values, strict=True)]
    )


def _columns(model: FrictionModel | None, data: FitData) -> tuple[dict[str, FloatArray], int]:
    if model is None:
        return {}, 0
    counted = CountedModel(model, data)
    jacobian = counted.columns()
    names = [each.name for each in model.parameters if not each.shape]
    # a shape parameter's own column is not used here, and not counted
    return {name: jacobian[:, model.parameter_names.index(name)] for name in names}, counted.evaluations - sum(
        each.shape for each in model.parameters
    )
