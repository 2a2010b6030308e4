"""One fit of one model: by Box's complex method or by least squares, with standard errors and condition number."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.identification.complex_method import complex_method
from winch_friction.identification.fit_data import CountedModel, FitData
from winch_friction.identification.least_squares import least_squares
from winch_friction.physics.errors import InputError, counted
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray

METHODS = ("least_squares", "complex")
SAME_DIRECTION = 1e-10  # of the largest singular value: below it rounding alone tells two columns apart
LEAST_SEEN = 1e-12  # of the largest information of unit columns, a square: what has less is rounding
_BOX_MARGIN = 3.0  # a term alone may explain three times the largest torque


@dataclass(frozen=True)
class FitResult:
    """A fitted model: `model` carries values and covariance; `cost` is sum w e^2; `rms` N m.

    `condition` is that of the Jacobian with columns scaled to unit length; `at_bound` names parameters on a bound.
    """

    model: FrictionModel
    method: str
    cost: float
    rms: float
    evaluations: int
    condition: float
    at_bound: tuple[str, ...]
    observations: int

    @property
    def parameter_count(self) -> int:
        """Number of fitted parameters."""
        return len(self.model.values)


def fit(
    model: FrictionModel, data: FitData, method: str = "least_squares", *, seed: int = 0, **options: int
) -> FitResult:
    """Fit all parameters of `model`; `options` go to the complex method (restarts, max_evaluations)."""
    if len(data) < len(model.values):
        raise InputError(
            f"{data.name}: {counted(len(data), 'observation', 'observations')} cannot determine the "
            f"{len(model.values)} parameters of '{model.name}'"
        )
    values, cost, evaluations = _solver(method)(model, data, seed, options)
    fitted = model.with_values(values)
    jacobian = CountedModel(fitted, data).columns()
    errors = data.torque - CountedModel(fitted, data).torque(values)
    sizes = np.array([max(abs(value), abs(p.typical)) for value, p in zip(values, model.parameters, strict=True)])
    return FitResult(
        model=fitted.with_covariance(clustered_covariance(jacobian, errors, data, sizes)),
        method=method,
        cost=cost,
        rms=float(np.sqrt(np.mean(errors**2))),
        evaluations=evaluations,
        condition=condition_number(jacobian * np.sqrt(data.weight)[:, None]),
        at_bound=tuple(name for name in fitted.parameter_names if _at_bound(fitted, name)),
        observations=len(data),
    )


def _solver(method: str) -> Callable[..., tuple[tuple[float, ...], float, int]]:
    solvers = {"least_squares": _by_least_squares, "complex": _by_complex}
    if method not in solvers:
        raise InputError(f"fit method '{method}' is not known; methods are {', '.join(METHODS)}")
    return solvers[method]


def _by_least_squares(
    model: FrictionModel, data: FitData, seed: int, options: dict[str, int]
) -> tuple[tuple[float, ...], float, int]:
    result = least_squares(model, data)
    return result.values, result.cost, result.evaluations


def _by_complex(
    model: FrictionModel, data: FitData, seed: int, options: dict[str, int]
) -> tuple[tuple[float, ...], float, int]:
    counted = CountedModel(model, data)
    lower, upper = search_box(model, data)
    result = complex_method(counted.cost, lower, upper, seed=seed, **options)
    return tuple(float(value) for value in result.x), result.cost, result.evaluations


def search_box(model: FrictionModel, data: FitData) -> tuple[FloatArray, FloatArray]:
    """Bounds for a population: the declared ones, cut to what a term alone could need to explain the torque."""
    bounds = np.array([model.bounds_of(name) for name in model.parameter_names])
    columns = np.abs(CountedModel(model, data).columns()).max(axis=0)
    reach = _BOX_MARGIN * np.abs(data.torque).max() / np.where(columns > 0.0, columns, np.inf)
    shape = np.array([each.shape for each in model.parameters])
    lower = np.where(shape, bounds[:, 0], np.maximum(bounds[:, 0], -reach))
    upper = np.where(shape, bounds[:, 1], np.minimum(bounds[:, 1], reach))
    return lower, np.maximum(upper, lower)


def clustered_covariance(jacobian: FloatArray, errors: FloatArray, data: FitData, sizes: FloatArray) -> FloatArray:
    """Covariance (parameters, parameters) of a weighted least-squares estimate whose errors (n,), N m, are alike inside
    clusters.

    A table's misfit and rounding persist over a displacement and over a pressure: the spreads over both are added. Of
    what no observation saw nothing is known but the parameters' `sizes` (parameters,), SI: they are its deviation.
    """
    scale = _column_scale(jacobian)
    root = np.sqrt(data.weight)
    design, target = jacobian / scale * root[:, None], errors * root
    clusters = np.asarray(data.cluster).reshape(len(data), -1).T
    spreads = [_jackknife(design, target, np.unique(each, return_inverse=True)[1].ravel()) for each in clusters]
    unseen = _unseen(design.T @ design)
    among = unseen @ unseen.T
    ignorance = among @ np.diag((sizes * scale) ** 2) @ among
    return np.asarray((np.sum(spreads, axis=0) + ignorance) / np.outer(scale, scale))


def _jackknife(design: FloatArray, target: FloatArray, labels: Any) -> FloatArray:
    """The spread of the estimates that leave one cluster out (CR3), in closed form.

    What one cluster alone has seen, the others cannot estimate: there its errors count as one that all its observations
    share, of the size that errors have.
    """
    information = design.T @ design
    count = labels.max() + 1
    if count < 2:
        return _inverse(information) * np.var(target)
    shifts, alone = np.zeros((count, design.shape[1])), np.zeros_like(information)
    for k in range(count):
        part = design[labels == k]
        left = information - part.T @ part
        shifts[k] = _inverse(left) @ (part.T @ target[labels == k])
        if (lost := _unseen(left)).size:
            shared = len(part) * np.mean(target**2) * lost.T @ _inverse(information) @ lost
            alone += lost @ shared @ lost.T
    return (count - 1) / count * shifts.T @ shifts + alone


def _unseen(information: FloatArray) -> FloatArray:
    """The directions (parameters, k) that it says nothing of."""
    seen, directions = np.linalg.eigh(information)
    return np.asarray(directions[:, seen <= LEAST_SEEN * seen[-1]])


def _inverse(information: FloatArray) -> FloatArray:
    """The inverse, and zero along what it says nothing of."""
    if _unseen(information).size:
        return np.asarray(np.linalg.pinv(information, LEAST_SEEN, hermitian=True), float)
    return np.asarray(np.linalg.pinv(information), float)


def condition_number(jacobian: FloatArray) -> float:
    """Condition number with the columns scaled to unit length; infinite when a direction is not seen at all."""
    singular = np.linalg.svd(jacobian / _column_scale(jacobian), compute_uv=False)
    return float(singular[0] / singular[-1]) if singular[-1] > 1e-14 * singular[0] else float("inf")


def exchangeable(jacobian: FloatArray, names: Sequence[str]) -> tuple[str, ...]:
    """The parameters that can be changed together without any change of the torque at the points of the Jacobian.

    One whose own column is zero (the shape of a term that was fitted to nothing) is none of them.
    """
    seen = np.flatnonzero(np.linalg.norm(jacobian, axis=0) > 0.0)
    design = jacobian[:, seen] / _column_scale(jacobian[:, seen])
    _, singular, directions = np.linalg.svd(design, full_matrices=False)
    lost = directions[singular <= SAME_DIRECTION * singular.max(initial=0.0)]
    shares = np.abs(lost).max(axis=0, initial=0.0)
    return tuple(names[int(k)] for k, share in zip(seen, shares, strict=True) if share > 1e-6)


def _column_scale(jacobian: FloatArray) -> FloatArray:
    scale = np.linalg.norm(jacobian, axis=0)
    return np.where(scale > 0.0, scale, 1.0)


def _at_bound(model: FrictionModel, name: str) -> bool:
    lower, upper = model.bounds_of(name)
    value = model.value(name)
    return bool(value <= lower + 1e-9 * abs(lower) or value >= upper - 1e-9 * abs(upper))
