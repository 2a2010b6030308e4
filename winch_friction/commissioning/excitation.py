"""What these runs can teach of a model's parameters, and which test would teach most of the rest."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.commissioning.balance import EFFECTIVE, friction_point, without_memory
from winch_friction.commissioning.view import RunView
from winch_friction.physics.channels import CM3_PER_REV, GRAVITY, RPM
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import operating_point
from winch_friction.physics.friction.model import with_stated_std
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

TAUGHT, SOME = 0.6, 0.9  # of the model's own sigma: below, a parameter is taught; between, a little
FIT_NOISE = 0.002  # of the rated torque: what a plateau's mean is good for (a transducer of 0.25 % less its offset)
# a grid of tests that a crane can make: speeds rpm, loads as shares of what the motors hold, displacements as shares
SPEEDS = (20.0, 60.0, 150.0, 400.0, 1000.0, 2000.0)
LOADS = (0.02, 0.3, 0.6, 0.9)
DISPLACEMENTS = (0.5, 0.75, 1.0)
CONSTANT = 1e-9  # of the largest displacement; means over equal numbers differ by their rounding
HOLDING_PRESSURE = 250e5  # Pa, of a normal load test


@dataclass(frozen=True)
class Taught:
    """A parameter: relative standard deviation in the model and after these runs, and what that means."""

    name: str
    before: float
    after: float

    @property
    def words(self) -> str:
        """In words."""
        share = self.after / self.before if self.before > 0.0 else 1.0
        return "much" if share < TAUGHT else "a little" if share < SOME else "nothing"


def taught(views: Sequence[RunView], model: FrictionModel) -> tuple[list[Taught], FloatArray]:
    """What the runs teach of every parameter of the terms without memory, and the information they bring."""
    plain = _with_prior(model)
    information = _prior_information(plain)
    for view in views:
        rows = _rows(view, plain)
        if len(rows):
            sigma = FIT_NOISE * view.rated_torque
            information = information + rows.T @ rows * EFFECTIVE / len(rows) / sigma**2
    before, after = _relative(plain, _prior_information(plain)), _relative(plain, information)
    names = zip(plain.parameter_names, before, after, strict=True)
    return [Taught(n, float(b), float(a)) for n, b, a in names], information


def log_next(crane: Crane, views: Sequence[RunView], model: FrictionModel, information: FloatArray) -> list[str]:
    """The tests that would teach most of what is still open, best first, in words; empty where little is open."""
    plain = _with_prior(model)
    best = []
    for speed, load, displacement in _tests(crane, _settings(crane, views)):
        rows = _test_rows(crane, plain, speed * RPM, load, displacement)
        sigma = FIT_NOISE * crane.motor_total(()) * crane.max_displacement * 300e5
        gained = information + rows.T @ rows * EFFECTIVE / 2.0 / sigma**2
        gain = float(np.linalg.slogdet(gained)[1] - np.linalg.slogdet(information)[1])
        best.append((gain, speed, load, displacement))
    best.sort(reverse=True)
    return [*_missing_channels(views), *(_said(crane, *each) for each in best[:3] if each[0] > 1.0)]


def _with_prior(model: FrictionModel) -> FrictionModel:
    return with_stated_std(without_memory(model) or model)[0]


def _prior_information(model: FrictionModel) -> FloatArray:
    floor = 1e-6 * np.array([abs(v) + abs(p.typical) for v, p in zip(model.values, model.parameters, strict=True)])
    covariance = np.asarray(model.covariance) + np.diag(floor**2)
    return np.linalg.inv(covariance)


def _relative(model: FrictionModel, information: FloatArray) -> FloatArray:
    size = np.array([abs(v) or abs(p.typical) or 1.0 for v, p in zip(model.values, model.parameters, strict=True)])
    return np.sqrt(np.diag(np.linalg.inv(information))) / size


def _rows(view: RunView, model: FrictionModel) -> FloatArray:
    with np.errstate(all="ignore"):
        rows = np.asarray(model.jacobian(friction_point(view)))
    return rows[view.moving & np.isfinite(rows).all(axis=1)]


def _settings(crane: Crane, views: Sequence[RunView]) -> tuple[float, ...]:
    """The shares of the largest displacement to test at; the one that there is, of motors whose displacement is the
    same to the last digit in all runs: a feedback is not, so nothing swings them."""
    shown = [group.displacement for view in views for group in view.groups.values()]
    known = np.concatenate([*shown, np.zeros(0)])
    known = known[np.isfinite(known)] / crane.max_displacement
    if not len(known) or not 0.0 < known[0] <= 1.0 or np.ptp(known) > CONSTANT:
        return DISPLACEMENTS
    return (float(known[0]),)


def _tests(crane: Crane, settings: Sequence[float]) -> Iterator[tuple[float, float, float]]:
    """The tests of the grid that are within what the crane file says that this crane may lift and turn, at these
    displacements."""
    fastest, heaviest = crane.rated_speed or np.inf, crane.rated_load or np.inf
    loads = [load for load in LOADS if _mass(crane, load) <= heaviest]
    return ((s, load, d) for s in SPEEDS if s * RPM <= fastest for load in loads for d in settings if load <= d)


def _mass(crane: Crane, load: float) -> float:
    """The mass, kg, on the outer layer that is this share of what the motors hold."""
    held = max(crane.groups.values()) * crane.max_displacement * HOLDING_PRESSURE * load
    return held * crane.gear_ratio / (GRAVITY * crane.drum.layer_radii[-1])


def _test_rows(crane: Crane, model: FrictionModel, speed: float, load: float, displacement: float) -> FloatArray:
    """Hoisting and lowering at one speed, load and displacement with all motors."""
    motors = float(max(crane.groups.values()))
    torque = motors * crane.max_displacement * HOLDING_PRESSURE * load
    drop = torque / (motors * crane.max_displacement * displacement)
    both = np.array([1.0, -1.0])
    point = operating_point(
        direction=both,
        speed=both * speed,
        drum_torque=np.full(2, torque * crane.gear_ratio),
        groups=[(np.full(2, motors), np.full(2, drop), np.full(2, drop + 50e5),
                 np.full(2, displacement * crane.max_displacement))],
        motor_total=np.full(2, motors),
    )  # fmt: skip
    return np.asarray(model.jacobian(point))


def _said(crane: Crane, gain: float, speed: float, load: float, displacement: float) -> str:
    mass = _mass(crane, load) / 1e3
    setting = displacement * crane.max_displacement / CM3_PER_REV
    return f"constant {speed:.0f} rpm up and down with about {mass:.0f} t at {setting:.0f} cm³/rev per motor, 8 s each"


def _missing_channels(views: Sequence[RunView]) -> Iterator[str]:
    if not any(np.isfinite(v.load).any() or v.load_torque is not None for v in views):
        yield "hook_load: without it friction that goes with the load cannot be told from the load"
    if not any(v.oil is not None and np.isfinite(v.oil).any() for v in views):
        yield "oil_temperature: without it a drift is undecided between temperature and wear"
    if not any(np.isfinite(v.layer).any() for v in views):
        yield "wire_layer: without it the outer layer is assumed, 6-8 % of the load's torque per layer"
    one_way = [v.name for v in views if v.moving.any() and len(np.unique(np.sign(v.speed[v.moving]))) < 2]
    if len(one_way) == len(views):
        yield "both directions: with one alone friction cannot be told from an error of the load"
