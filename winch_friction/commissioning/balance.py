"""Does the torque balance close? A small Bayesian fit: what ordinary friction and ordinary errors may be is a prior.

Friction may be wrong by its share, the load by a layer or a tare, inertia by a third; a catalogue effect of twice its
usual size stays within these. What is left after them, and how far they had to be stretched, is the score: about the
number of effective samples when the record is the crane's, many times that when it is not.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg.blas import dtbsv
from scipy.linalg.lapack import dgesv
from scipy.ndimage import maximum_filter1d, uniform_filter1d

from winch_friction.commissioning.view import RunView
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.compiled import group_point, operating_point
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import group_roles

EFFECTIVE = 40.0  # samples that a run counts for: neighbouring blocks repeat each other
# ordinary errors, 1 sigma
FRICTION_SHARE = 0.3  # of a given model's friction
TYPICAL_SHARE = 0.6  # of the typical friction that stands in for a model
LOAD_FRICTION = 0.05  # of T_d/i: gear, sheave and seal losses that a model lacks
MOTOR_FRICTION = 0.010  # of the rated torque: brake drag, wear
FAST_FRICTION = 0.03  # of the rated torque at the run's top speed: line losses, churning
SLOW_FRICTION = 0.02  # of the rated torque near standstill: Stribeck
LOAD_SHARE = 0.05  # of T_d/i: a layer, a load cell, a displacement feedback
OFFSET_SHARE = 0.010  # of the rated torque: tare, transducer offsets
# an effect that a model lacks adds friction; only so many sigma may be missing from it
MISSING, LEAST_FRICTION = 0.3, 0.6
LEAST_INERTIA, MOST_INERTIA = 0.7, 2.0  # by how much the inertia may be wrong, as shares of it
# beyond these a friction law means nothing: the rest of a wrong channel must show as residual, not as friction
MOST_SPEED, MOST_PRESSURE = 650.0, 600e5  # rad/s, Pa
SLOW_SPEED = 0.1  # of the run's top speed: the e-fold of friction at low speed
INERTIA_SHARE = 0.3
# the mode of the load on its wire: a rope's usual damping ratio, what blocks follow of it, and its share of the inertia
BOUNCE_DAMPING, FASTEST_BOUNCE, MOST_BOUNCING = 0.04, 1.0, 1.2
HEAVE_SHARE, NO_HEAVE_SHARE = 0.15, 0.7  # of the load's inertia, with and without a logged heave
UNREST_BLOCKS, DYNAMIC_SHARE, MOST_UNREST = 5, 0.3, 0.04  # a second; of the dynamic torque; of the rated torque
NOISE_SHARE = 0.008  # of the rated torque: what no prior above covers
FRICTION_NOISE = 0.08  # of the friction
CAUCHY = 3.0  # sigma beyond which a block counts less
FEWEST = 5  # moving blocks; a run with fewer tells nothing
MOST_STRETCH = 4.0  # sigma; a load or an offset farther off is no ordinary error
MOST_WIRE, HEAVIER_WIRE = 0.3, 1.2  # of the rated torque, for a `wire_out` that is none; of the weight that is stated
FREE_OFFSET = 1.2  # of the rated torque, where no load is logged: what hangs there, which cannot push the wire


@dataclass(frozen=True)
class Closure:
    """How one run closes: `score`, residual as it stands and its RMS after ordinary errors, N m at the shaft.

    `needed` says how many sigma each ordinary error had to be stretched, by name; `level`: RMS of the load torque.
    """

    run: str
    score: float
    before: float
    after: float
    level: float
    needed: dict[str, float]
    time: FloatArray
    drive: FloatArray
    expected: FloatArray


def closure(view: RunView, model: FrictionModel | None) -> Closure:
    """Close one run's balance as well as ordinary errors allow."""
    with np.errstate(all="ignore"):
        friction, share = _friction(view, model), FRICTION_SHARE if model is not None else TYPICAL_SHARE
        load = static_torque(view)
        known = bool(np.isfinite(load).any())
        load = np.nan_to_num(load) if not known else load
        inertial = view.inertia * view.acceleration
        swing = _swing(view)
        drive = view.drive_torque
        expected = load + friction + inertial + swing
        rated = view.error_torque
        sign = np.sign(view.speed)
        relative = np.abs(view.speed) / top(view.speed)
        swings = HEAVE_SHARE if view.heave is not None else NO_HEAVE_SHARE
        errors = (
            _Error("friction", friction, share, -LEAST_FRICTION / share),
            _Error("load-proportional friction", sign * np.abs(load), LOAD_FRICTION, -MISSING),
            _Error("motor friction", sign * rated, MOTOR_FRICTION, -MISSING),
            _Error("friction at speed", sign * rated * relative**2, FAST_FRICTION, -MISSING),
            _Error("friction at low speed", sign * rated * np.exp(-relative / SLOW_SPEED), SLOW_FRICTION, -MISSING),
            _Error("load", load, LOAD_SHARE, -MOST_STRETCH, MOST_STRETCH),
            _offset(len(drive), rated, known, bool(view.groups)),
            _unweighed(view, rated),
            _Error("inertia", inertial, INERTIA_SHARE, -LEAST_INERTIA / INERTIA_SHARE, MOST_INERTIA / INERTIA_SHARE),
            _Error("load on its wire", _bouncing(view, load, swing), 1.0, 0.0, MOST_BOUNCING),
            _Error("load inertia", swing, swings, -1.0 / swings, 2.0 / swings),
        )
        noise = NOISE_SHARE * rated, FRICTION_NOISE * friction, _unrest(view, drive, inertial + swing, rated)
        sigma = np.sqrt(np.sum(np.square(np.broadcast_arrays(*noise)), axis=0))
        return _fit(view, drive, expected, errors, sigma, load)


def top(values: FloatArray) -> float:
    """The 99th percentile of the magnitudes, 0 of nothing: `np.percentile`, whose checks take several times as long as
    the work and come a hundred thousand times in a diagnosis."""
    good = np.abs(values[np.isfinite(values)])
    if not good.size:
        return 0.0
    rank = 0.99 * (good.size - 1)
    lower, upper = int(rank), min(int(rank) + 1, good.size - 1)
    good.partition((lower, upper))
    a, b, share = float(good[lower]), float(good[upper]), rank - lower
    return a + (b - a) * share if share < 0.5 else b - (b - a) * (1.0 - share)


def _unrest(view: RunView, drive: FloatArray, dynamic: FloatArray, rated: float) -> FloatArray:
    """Torque that ramps and the load bouncing on its wire leave open, N m: it dies away and says nothing of a mistake.

    Bounded, so that a torque which is wrong by orders of magnitude does not excuse itself.
    """
    swinging = drive - uniform_filter1d(np.nan_to_num(drive), UNREST_BLOCKS)
    both = np.hypot(np.nan_to_num(swinging), DYNAMIC_SHARE * np.nan_to_num(dynamic))
    lasting = maximum_filter1d(both, 2 * UNREST_BLOCKS + 1)
    return np.minimum(lasting, MOST_UNREST * rated)


def static_torque(view: RunView) -> FloatArray:
    """Torque of the load at rest at the shaft, N m; NaN where it is not known."""
    if view.load_torque is not None:
        return view.load_torque
    return view.load * GRAVITY * view.lever


def _swing(view: RunView) -> FloatArray:
    """Inertia of the load, with the crane's heave, N m at the shaft."""
    if view.load_torque is not None:
        return np.zeros(len(view.time))
    acceleration = view.lever * view.acceleration + view.heave_acceleration
    return np.nan_to_num(view.load * view.lever * acceleration)


def _bouncing(view: RunView, load: FloatArray, rigid: FloatArray) -> FloatArray:
    """What an elastic wire adds to the inertia of the load on a `rigid` one, N m at the shaft: soft and heavily loaded,
    it lets the load swing by a good part of its weight."""
    step = float(np.median(np.diff(view.time))) if len(view.time) > 1 else 0.0
    if not 0.0 < view.bounce * step < FASTEST_BOUNCE:
        return np.zeros(len(view.time))
    numerator, denominator = _mode(view.bounce, step)
    driven = np.convolve(rigid, numerator)[: len(rigid)]
    # the filter as a banded triangular system: importing `scipy.signal` takes half a second of every `check`
    found = dtbsv(2, np.repeat([denominator], len(rigid), axis=0).T, driven, lower=1, diag=1) - rigid
    return np.asarray(np.clip(found, -np.abs(load), np.abs(load)))


def _mode(bounce: float, step: float) -> tuple[FloatArray, FloatArray]:
    """The damped mode of a load on its wire, `bounce` rad/s, as a filter of samples every `step` s: bilinear, exact at
    the mode."""
    rate, damping, square = bounce / np.tan(0.5 * bounce * step), 2.0 * BOUNCE_DAMPING * bounce, bounce**2
    whole = rate**2 + damping * rate + square
    numerator = [damping * rate + square, 2.0 * square, square - damping * rate]
    denominator = [whole, 2.0 * (square - rate**2), rate**2 - damping * rate + square]
    return np.array(numerator) / whole, np.array(denominator) / whole


def _friction(view: RunView, model: FrictionModel | None) -> FloatArray:
    stateless = without_memory(model)
    if stateless is None:
        return typical_friction(view)
    return np.broadcast_to(np.asarray(stateless.torque(friction_point(view)), float), view.time.shape)


def friction_point(view: RunView) -> tuple[Any, ...]:
    """The operating point along a view, within what a friction law means."""
    size = view.time.shape
    roles = group_roles(tuple(view.groups))
    groups = [
        group_point(
            np.full(size, g.count),
            np.clip(g.drop, -MOST_PRESSURE, MOST_PRESSURE),
            np.clip(g.displacement, 0.0, view.max_displacement),
            np.clip(g.pressure_sum, 0.0, 2.0 * MOST_PRESSURE),
            roles[name],
        )
        for name, g in view.groups.items()
    ]
    speed = np.clip(view.speed, -MOST_SPEED, MOST_SPEED)
    drum = np.clip(np.nan_to_num(static_torque(view)), -view.rated_torque, view.rated_torque) * view.gear_ratio
    return operating_point(
        direction=np.sign(view.speed),
        speed=speed,
        drum_torque=np.abs(drum),
        groups=groups,
        motor_total=np.full(size, view.motors),
        time=view.time,
        **({} if view.oil is None else {"oil_temperature": np.where(np.isfinite(view.oil), view.oil, 40.0)}),
        wire_layer=np.where(np.isfinite(view.layer), view.layer, 1.0),
    )


def without_memory(model: FrictionModel | None) -> FrictionModel | None:
    """The model's terms without a state: memory averages out over blocks, and would need the whole record."""
    if model is None or all(term.state is None for term in model.terms):
        return model
    names = [term.name for term in model.terms if term.state is None]
    return model.subset(names) if names else None


def typical_friction(view: RunView) -> FloatArray:
    """Friction of a hydraulic winch where no model is given: 2 % of the rated torque, 4 % more at 200 rad/s, and 4.5 %
    of the load's (paper 2's cranes lie within a factor of two of it). N m at the shaft."""
    if not view.groups:
        return np.sign(view.speed) * 0.2 * np.nanmedian(np.abs(view.drive_torque))
    speed = np.minimum(np.abs(view.speed) / 200.0, 3.0)
    load = np.minimum(np.abs(np.nan_to_num(static_torque(view))), view.rated_torque)
    level = view.rated_torque * (0.02 + 0.04 * speed**2) + 0.045 * load
    return np.sign(view.speed) * level


@dataclass(frozen=True)
class _Error:
    """One ordinary error: its torque at 1, its sigma, and between how many sigma it may lie."""

    name: str
    torque: FloatArray
    sigma: float
    lower: float = -np.inf
    upper: float = np.inf


def _offset(size: int, rated: float, known: bool, hydraulic: bool) -> _Error:
    torque = np.full(size, rated)
    if known:
        return _Error("offset", torque, OFFSET_SHARE, -MOST_STRETCH, MOST_STRETCH)
    return _Error("offset", torque, FREE_OFFSET, -OFFSET_SHARE if hydraulic else -1.0, 1.0)


def _unweighed(view: RunView, rated: float) -> _Error:
    """The wire paid out, which a load cell at the hook does not weigh: as heavy as the crane file says, where both are
    known."""
    weight = np.zeros(len(view.time)) if view.wire is None else np.nan_to_num(view.wire) * view.lever
    return _Error("weight of the wire", np.clip(weight, 0.0, MOST_WIRE * rated), 1.0, 0.0, HEAVIER_WIRE)


def _fit(
    view: RunView, drive: FloatArray, expected: FloatArray, errors: Sequence[_Error], sigma: FloatArray,
    load: FloatArray,
) -> Closure:  # fmt: skip
    residual = drive - expected
    good = view.moving & np.isfinite(residual) & np.isfinite(sigma)
    for each in errors:
        good &= np.isfinite(each.torque)
    needed, score, before, after = {}, 0.0, np.nan, np.nan
    if good.sum() >= FEWEST:
        design = np.column_stack([each.torque[good] * each.sigma / sigma[good] for each in errors])
        limits = np.array([(each.lower, each.upper) for each in errors])
        theta, score, left = _robust_ridge(design, residual[good] / sigma[good], limits)
        needed = {each.name: value for each, value in zip(errors, theta.tolist(), strict=True)}
        before = float(np.sqrt(np.mean(residual[good] ** 2)))
        after = float(np.sqrt(np.mean((left * sigma[good]) ** 2)))
    level = float(np.sqrt(np.nanmean(load[good] ** 2))) if good.any() else 0.0
    return Closure(view.name, score, before, after, level, needed, view.time, drive, expected)


def _robust_ridge(design: FloatArray, target: FloatArray, limits: FloatArray) -> tuple[FloatArray, float, FloatArray]:
    """Errors in their sigmas, score (residual and stretching together) and residual; unit prior on every column."""
    limit = 1e12
    design, target = np.clip(design, -limit, limit), np.clip(target, -limit, limit)
    share = EFFECTIVE / len(target)
    weight = np.ones(len(target))
    theta = np.zeros(design.shape[1])
    left = target
    for _ in range(3):
        weighted = design * (share * weight)[:, None]
        theta = _bounded(weighted.T @ design + np.eye(len(theta)), weighted.T @ target, limits)
        left = target - design @ theta
        weight = 1.0 / (1.0 + (left / CAUCHY) ** 2)
    loss = CAUCHY**2 * np.log1p((left / CAUCHY) ** 2)
    return theta, float(share * loss.sum() + theta @ theta), left


def _bounded(matrix: FloatArray, target: FloatArray, limits: FloatArray) -> FloatArray:
    """The ridge solution with those errors held at their limit that would pass it, the farthest first."""
    free = np.ones(len(target), bool)
    theta = np.zeros(len(target))
    lower, upper = limits.T
    while free.any():
        loose, held = free.nonzero()[0], (~free).nonzero()[0]
        rest = target - matrix[:, held] @ theta[held] if held.size else target
        found = dgesv(matrix[loose[:, None], loose], rest[loose])[2]  # begins sooner than `np.linalg.solve`
        theta[loose] = found
        excess = np.maximum(lower[loose] - found, found - upper[loose])
        farthest = int(excess.argmax())
        if excess[farthest] <= 0.0:
            break
        worst = loose[farthest]
        theta[worst] = min(max(theta[worst], lower[worst]), upper[worst])
        free[worst] = False
    return theta
