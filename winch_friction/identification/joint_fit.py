"""Beyond the papers: motor and system fitted together to the plateaus, with the supplier's fit as prior.

Every plateau is one observation of the torque balance, so nothing is interpolated and a direction may be missing at a
speed. The sensors' systematic errors (displacement, pressure, the load of each test) are carried along as unknowns with
their tolerances, since the load they are seen against is known.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from winch_friction.identification.friction_curve import winch_points
from winch_friction.identification.plateaus import Plateau
from winch_friction.identification.prior import UnitSpread
from winch_friction.identification.system_fit import combined
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane

# in units of the spread between units: what neither data nor prior see has ten times its sigma and is not certain
_LEAST_INFORMATION = 1e-2
SENSOR_ERRORS = ("displacement_scale", "pressure_scale", "pressure_offset")


@dataclass(frozen=True)
class JointFit:
    """`model` carries the posterior covariance; `sensor_errors` (value, std) by name, `load_errors` (tests,) relative.

    `information` (n, n) is what the data alone say about the parameters, sensor errors marginalised; `noise_scale` is
    the ratio of residuals to the plateaus' standard errors; `residuals` N m per motor and plateau.
    """

    model: FrictionModel
    prior: FrictionModel
    sensor_errors: dict[str, tuple[float, float]]
    load_errors: FloatArray
    information: FloatArray
    noise_scale: float
    residuals: FloatArray
    evaluations: int


@dataclass(frozen=True)
class Observations:
    """Plateaus of all tests as columns (n,); `test` numbers the test of each plateau."""

    speed: FloatArray
    drop: FloatArray
    error: FloatArray
    displacement: FloatArray
    drum_torque: FloatArray
    test: Any
    motors: int
    gear_ratio: float

    @property
    def tests(self) -> int:
        """Number of tests."""
        return int(self.test.max()) + 1


def observations(tests: Sequence[Sequence[Plateau]], crane: Crane, group: str = "main") -> Observations:
    """Plateaus grouped by test as columns; the standard error of a plateau is its test's median one."""
    flat = [plateau for test in tests for plateau in test]
    if not flat:
        raise InputError("joint fit: no plateau was found in any test")
    error = [np.full(len(test), np.median([each.pressure_error for each in test])) for test in tests if test]
    columns = {
        name: np.array([getattr(each, name) for each in flat])
        for name in ("speed", "displacement", "drum_torque", "pressure_drop")
    }
    return Observations(
        speed=columns["speed"],
        drop=columns["pressure_drop"],
        error=np.concatenate(error),
        displacement=columns["displacement"],
        drum_torque=columns["drum_torque"],
        test=np.concatenate([np.full(len(test), k) for k, test in enumerate(tests)]).astype(int),
        motors=crane.motor_count(group),
        gear_ratio=crane.gear_ratio,
    )


def joint_fit(data: Observations, prior: FrictionModel, spread: UnitSpread) -> JointFit:
    """Fit all parameters of `prior`, a whole winch model.

    Parameters with a covariance of 0 in the prior (the system's, before any crane was measured) are left free.
    """
    problem = _Problem(data, prior, spread)
    first = problem.solve(1.0)
    scale = max(problem.noise(first.x), 1e-6)
    solution = problem.solve(scale)
    return problem.result(solution, scale, first.nfev + solution.nfev)


class _Problem:
    """Residuals over the scaled unknowns: parameters, sensor errors, load errors."""

    def __init__(self, data: Observations, prior: FrictionModel, spread: UnitSpread) -> None:
        self.data, self.prior, self.spread = data, prior, spread
        self.scale = np.maximum(spread.std(prior), 1e-30)
        self.centre = np.array(prior.values)
        self.tolerances = np.array([getattr(spread, name) for name in SENSOR_ERRORS])
        self.load_tolerance = spread.load_scale
        self.root_prior = _root_information(prior, self.scale)
        self.sigma = np.maximum(data.error, 0.01e5) * data.displacement
        self.count = len(prior.values)

    # -- unknowns: u = [theta / scale, sensor errors / tolerance, load errors / tolerance]
    def split(self, u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        n, m = self.count, len(SENSOR_ERRORS)
        return u[:n] * self.scale, u[n : n + m] * self.tolerances, u[n + m :] * self.load_tolerance

    def torque_error(self, u: FloatArray) -> FloatArray:
        """Measured minus modelled drive torque per motor and plateau, N m."""
        theta, (d_scale, p_scale, p_offset), loads = self.split(u)
        data = self.data
        true_displacement = data.displacement / (1.0 + d_scale)
        true_drop = (data.drop - p_offset) / (1.0 + p_scale)
        points = winch_points(data.speed, true_drop, true_displacement, data.drum_torque, data.motors)
        functions = self.prior.compile(1)
        friction = np.asarray(functions.vector_torque(points, tuple(theta), ())) / data.motors
        load = data.drum_torque * (1.0 + loads[data.test]) / (data.gear_ratio * data.motors)
        return true_drop * true_displacement - load - np.sign(data.speed) * friction

    def residuals(self, u: FloatArray, noise_scale: float) -> FloatArray:
        prior = self.root_prior @ (u[: self.count] - self.centre / self.scale)
        return np.concatenate([self.torque_error(u) / (self.sigma * noise_scale), prior, u[self.count :]])

    def noise(self, u: FloatArray) -> float:
        error = self.torque_error(u) / self.sigma
        spent = self.count + len(SENSOR_ERRORS) + self.data.tests
        return float(np.sqrt(error @ error / max(len(error) - spent, 1)))

    def solve(self, noise_scale: float) -> Any:
        bounds = np.array([self.prior.bounds_of(name) for name in self.prior.parameter_names]) / self.scale[:, None]
        extra = np.full(len(SENSOR_ERRORS) + self.data.tests, np.inf)
        lower, upper = np.concatenate([bounds[:, 0], -extra]), np.concatenate([bounds[:, 1], extra])
        start = np.concatenate([self.centre / self.scale, np.zeros(len(extra))])
        inside = np.clip(start, lower + 1e-6, np.where(np.isfinite(upper), upper - 1e-6, upper))
        return least_squares(self.residuals, inside, bounds=(lower, upper), args=(noise_scale,), max_nfev=200)

    def result(self, solution: Any, noise_scale: float, iterations: int) -> JointFit:
        theta, sensors, loads = self.split(solution.x)
        jacobian = solution.jac
        n, m = self.count, len(SENSOR_ERRORS)
        bounds = np.array([self.prior.bounds_of(name) for name in self.prior.parameter_names])
        model = self.prior.with_values(np.clip(theta, bounds[:, 0], bounds[:, 1]).tolist())
        unit = np.ones(jacobian.shape[1])
        unit[:n] = np.maximum(self.spread.std(model), 1e-30) / self.scale
        seen, directions = np.linalg.eigh((jacobian * unit).T @ (jacobian * unit))
        covariance = (directions / np.maximum(seen, _LEAST_INFORMATION)) @ directions.T * np.outer(unit, unit)
        posterior = covariance[:n, :n] * np.outer(self.scale, self.scale)
        sensor_std = np.sqrt(np.diag(covariance))[n : n + m] * self.tolerances
        return JointFit(
            model=model.with_covariance(0.5 * (posterior + posterior.T)),
            prior=self.prior,
            sensor_errors={
                name: (float(v), float(s)) for name, v, s in zip(SENSOR_ERRORS, sensors, sensor_std, strict=True)
            },
            load_errors=loads,
            information=self._data_information(jacobian),
            noise_scale=noise_scale,
            residuals=self.torque_error(solution.x),
            evaluations=iterations * (len(solution.x) + 1),
        )

    def _data_information(self, jacobian: FloatArray) -> FloatArray:
        """Information of the data about the parameters in units of `scale`, the sensor errors marginalised."""
        rows = len(self.data.speed)
        own, other = jacobian[:rows, : self.count], jacobian[:rows, self.count :]
        inner = other.T @ other + np.eye(other.shape[1])
        return own.T @ own - own.T @ other @ np.linalg.solve(inner, other.T @ own)


def _root_information(prior: FrictionModel, scale: FloatArray) -> FloatArray:
    """A square root of the prior's information in units of `scale`; none for parameters whose variance is 0."""
    size = len(scale)
    root = np.zeros((size, size))
    if prior.covariance is None:
        return root
    known = np.flatnonzero(np.diag(prior.covariance) > 0.0)
    block = prior.covariance[np.ix_(known, known)] / np.outer(scale[known], scale[known])
    root[np.ix_(known, known)] = np.linalg.cholesky(np.linalg.inv(block)).T
    return root


def winch_prior(motor: FrictionModel, system: FrictionModel, name: str) -> FrictionModel:
    """The supplier's motor with its covariance and the system's terms left free: the prior of a joint fit."""
    whole = combined(motor.with_covariance(None), system.with_covariance(None), name)
    size, count = len(whole.values), len(motor.values)
    covariance = np.zeros((size, size))
    if motor.covariance is not None:
        covariance[:count, :count] = motor.covariance
    return replace(whole, covariance=covariance)
