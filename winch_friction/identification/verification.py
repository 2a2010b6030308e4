"""Does the model hold on what it has not seen? Friction per test (paper 2 Fig 16, 17), pressures (Fig 18, 21, 23)."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.signal import bilinear, lfilter, lfilter_zi, savgol_filter

from winch_friction.identification.fit_data import modelled
from winch_friction.identification.friction_curve import FrictionCurve, curve_data
from winch_friction.identification.plateaus import refuse_gaps
from winch_friction.physics.channels import GROUP_CHANNELS, RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.term import needed
from winch_friction.physics.signals import FloatArray, Run, held
from winch_friction.physics.winch import Crane, group_point, group_roles, operating_point
from winch_friction.physics.winch.crane import run_drum_torque, run_rope_radius
from winch_friction.physics.winch.operating_point import CHANNEL_SIGNALS, LEAST_DISPLACEMENT, TELLING_STROKE

LOW_SPEED = 250.0 * RPM  # paper 2: within 1 % of nominal above it
_HOOK_ONLY = 0.1  # of the heaviest test's torque
_SMOOTHING = 0.2  # s, window of the winch's acceleration
_WIRE_DAMPING = 1.5e5  # N s/m, load on rope, sheaves and boom: engineering judgement
_HOLE = 3.0  # s; half a quick wave: a straight line over more says nothing of the motion
_LOST = 1.5  # samples; where two rows are further apart than this, some between them are lost
_LEAST_SAMPLES = 10  # of a piece between holes
_STICKING = 0.5  # rad/s of the smoothed speed; a winch that creeps faster has the friction of its direction
STANDSTILL = 1.0  # rad/s, three encoder counts per scan; below it friction lies anywhere within the break-away level


@dataclass(frozen=True)
class TestError:
    """Modelled minus measured T_ft of one test over `speed` (n,), N m per motor.

    `nominal` is the test's load torque per motor, the heaviest test's where only the hook hung.
    """

    __test__ = False  # not a pytest class

    test: str
    speed: FloatArray
    measured: FloatArray
    modelled: FloatArray
    nominal: float

    @property
    def error(self) -> FloatArray:
        """N m per motor."""
        return self.modelled - self.measured

    @property
    def percent(self) -> FloatArray:
        """In % of nominal torque (paper 2 Fig 17)."""
        return 100.0 * self.error / self.nominal

    def worst(self, above: bool) -> float:
        """Largest |error| in % of nominal torque above (or below) 250 rpm; NaN without a point there."""
        chosen = np.abs(self.percent[(self.speed >= LOW_SPEED) == above])
        return float(chosen.max()) if len(chosen) else float("nan")


def test_errors(model: FrictionModel, curves: Sequence[FrictionCurve]) -> list[TestError]:
    """The errors of a whole winch model per test."""
    heaviest = max(curve.load_torque for curve in curves)
    return [
        TestError(
            test=curve.test,
            speed=curve.speed,
            measured=curve.friction_torque,
            modelled=modelled(model, curve_data([curve])),
            nominal=curve.load_torque if curve.load_torque > _HOOK_ONLY * heaviest else heaviest,
        )
        for curve in curves
    ]


test_errors.__test__ = False  # type: ignore[attr-defined]


@dataclass(frozen=True)
class PressureCheck:
    """Measured and predicted pressure drop of one group along a run, Pa over `time` s; `speed` rad/s, those that tell
    motion from rest times `speed_scale` (`Crane.speed_scale`).
    """

    run: str
    group: str
    time: FloatArray
    speed: FloatArray
    measured: FloatArray
    predicted: FloatArray
    speed_scale: float = 1.0

    @property
    def rms(self) -> float:
        """Root mean square error over the whole run, Pa."""
        return _root_mean_square(self.predicted - self.measured)

    @property
    def moving_rms(self) -> float:
        """Root mean square error while the winch turns, Pa: at standstill friction is undetermined."""
        moving = np.abs(self.speed) > STANDSTILL * self.speed_scale
        return _root_mean_square((self.predicted - self.measured)[moving])

    def mean_error(self, direction: int) -> float:
        """Mean of predicted minus measured while hoisting (+1) or lowering (-1), Pa; NaN where nothing shows it."""
        shown = (self.predicted - self.measured)[self.speed * direction > 10 * RPM * self.speed_scale]
        return float(np.mean(shown)) if len(shown) else np.nan


def _root_mean_square(errors: FloatArray) -> float:
    """NaN of none."""
    return float(np.sqrt(np.mean(errors**2))) if len(errors) else np.nan


def pressure_check(run: Run, crane: Crane, model: FrictionModel, displacement_scale: float = 0.0) -> PressureCheck:
    """Predict the driving group's pressure drop from the torque balance: load, motion, passive side.

    The driving group is `active` where there is one: it carries all the friction, the passive motors' too. While the
    winch sticks, friction is taken to turn over evenly from one side to the other. `displacement_scale` is the
    relative error of the displacement feedback that a joint fit found for these motors. A record with long holes
    is predicted piece by piece; where the driving motors are swung below a tenth, nothing is. Raises `InputError` for
    a missing column, NaN, also in what the model's terms read, for a winch that never turns, and for motors that are
    never above that.
    """
    refuse_unusable(run)
    refuse_gaps(run, needed(model.terms))
    run = _with_true_displacement(run, displacement_scale)
    group = "active" if "active" in run.groups else run.groups[0]
    pieces = _pieces(run)
    if not any(np.any(_turns(piece, crane)) for piece in pieces):
        raise InputError(f"{run.name}: the winch never turns; there is no friction to verify")
    drop = f"{group}.pressure_a", f"{group}.pressure_b"
    time, speed, high, low = (
        np.concatenate([each[name] for each in pieces]) for name in ("time", "motor_speed", *drop)
    )
    predicted = np.concatenate([_predicted(piece, crane, model, group) for piece in pieces])
    told = np.isfinite(predicted)
    if not told.any():
        raise InputError(f"{run.name}: {group}.displacement is below a tenth throughout: no pressure can be predicted")
    return PressureCheck(
        run.name, group, time[told], speed[told], (high - low)[told], predicted[told], crane.speed_scale
    )


def refuse_unusable(run: Run) -> None:
    """Raise `InputError` where a run's pressures could not be predicted: a column is missing or has gaps."""
    of_groups = (f"{group}.{channel}" for group in run.groups for channel in GROUP_CHANNELS)
    tip = ("heave_velocity",) if "heave_velocity" in run else ()
    refuse_gaps(run, ("time", "motor_speed", "hook_load", *of_groups, *tip))


def _pieces(run: Run) -> list[Run]:
    """What lies between long holes: over one of them the speed would jump."""
    holes = np.flatnonzero(np.diff(run.time) > _HOLE) + 1
    pieces = (slice(*each) for each in itertools.pairwise([0, *holes.tolist(), len(run)]))
    cut = [replace(run, columns={n: v[piece] for n, v in run.columns.items()}) for piece in pieces]
    return [piece for piece in cut if len(piece) >= _LEAST_SAMPLES]


def _even(run: Run) -> Run:
    """A piece with straight lines over rows that are lost: what smooths and swings counts its samples as even."""
    step = _step(run)
    if np.diff(run.time).max() < _LOST * step:
        return run
    time = np.arange(run.time[0], run.time[-1] + 0.5 * step, step)
    nearest = np.searchsorted(0.5 * (run.time[1:] + run.time[:-1]), time)
    lines = {name: np.interp(time, run.time, values) for name, values in run.columns.items() if name != "wire_layer"}
    layers = {name: values[nearest] for name, values in run.columns.items() if name == "wire_layer"}
    return replace(run, columns={**lines, **layers, "time": time})


def _turns(run: Run, crane: Crane) -> Any:
    return np.abs(_smooth(run, run["motor_speed"], 0)) > _STICKING * crane.speed_scale


def _predicted(piece: Run, crane: Crane, model: FrictionModel, group: str) -> FloatArray:
    """Pa at the times of a piece."""
    run = _even(piece)
    drop = {name: run[f"{name}.pressure_a"] - run[f"{name}.pressure_b"] for name in run.groups}
    drum_torque = run_drum_torque(run, crane)
    inertia, acceleration = inertia_torque(run, crane)
    held = drum_torque / crane.gear_ratio + inertia - _other_groups(run, crane, group, drop)
    stroke = run[f"{group}.displacement"]
    floor = TELLING_STROKE * (crane.max_displacement or float(stroke.max()))
    capacity = crane.motor_count(group) * np.maximum(stroke, floor)
    predicted = held / capacity
    moving = _turns(run, crane)
    for _ in range(4 if moving.any() else 0):  # the driving group's friction depends on its own pressure, weakly
        points = _points(run, crane, {**drop, group: predicted}, drum_torque, acceleration)
        friction = np.asarray(model.torque(points))
        predicted = (held + _through_standstill(run.time, friction, moving)) / capacity
    predicted = np.where(stroke >= floor, predicted, np.nan)
    return predicted if run is piece else np.interp(piece.time, run.time, predicted)


def _with_true_displacement(run: Run, scale: float) -> Run:
    corrected = {f"{group}.displacement": run[f"{group}.displacement"] / (1.0 + scale) for group in run.groups}
    return replace(run, columns={**run.columns, **corrected})


def _through_standstill(time: FloatArray, friction: FloatArray, moving: Any) -> FloatArray:
    """Friction while moving, a straight line between; a run that starts at rest starts from none."""
    knots, values = time[moving], friction[moving]
    if not moving[0]:
        knots, values = np.append(time[0], knots), np.append(0.0, values)
    return np.interp(time, knots, values)


def _other_groups(run: Run, crane: Crane, group: str, drop: dict[str, FloatArray]) -> Any:
    others = [name for name in run.groups if name != group]
    return sum(crane.motor_count(name) * run[f"{name}.displacement"] * drop[name] for name in others)


def _points(
    run: Run, crane: Crane, drop: dict[str, FloatArray], drum_torque: FloatArray, acceleration: FloatArray
) -> tuple[Any, ...]:
    speed = _smooth(run, run["motor_speed"], 0)
    lower = {name: np.minimum(run[f"{name}.pressure_a"], run[f"{name}.pressure_b"]) for name in drop}
    roles = group_roles(tuple(drop))
    groups = [
        group_point(
            np.full(len(run), float(crane.motor_count(name))), p,
            np.maximum(run[f"{name}.displacement"], LEAST_DISPLACEMENT),
            np.abs(p) + 2.0 * lower[name],
            roles[name],
        )
        for name, p in drop.items()
    ]  # fmt: skip
    outer = np.full(len(run), float(len(crane.drum.layer_radii)))
    shown = {name: held(run[name]) for name in CHANNEL_SIGNALS if name in run}
    return operating_point(
        direction=np.sign(speed),
        speed=speed,
        drum_torque=drum_torque,
        groups=groups,
        motor_total=np.full(len(run), float(crane.motor_total(run.groups))),
        acceleration=acceleration,
        **{"wire_layer": outer, **{name: values for name, values in shown.items() if np.isfinite(values).all()}},
    )


def inertia_torque(run: Run, crane: Crane) -> tuple[FloatArray, FloatArray]:
    """Torque in N m at the motor shaft that accelerates winch and load, and the shaft's acceleration in rad/s^2.

    The load hangs on the wire as on a spring; a moving crane tip moves the wire too.
    """
    acceleration = _smooth(run, run["motor_speed"], 1)
    load = run["hook_load"]
    radius = run_rope_radius(run, crane) / crane.gear_ratio  # m of wire per rad
    wire_speed = radius * run["motor_speed"] + run.column("heave_velocity", 0.0)
    return crane.inertia * acceleration + load * radius * _load_acceleration(run, crane, wire_speed), acceleration


def _load_acceleration(run: Run, crane: Crane, wire_speed: FloatArray) -> FloatArray:
    """Acceleration of the load when the wire's upper end moves at `wire_speed`: a lightly damped spring and mass."""
    known = run.column("wire_out")[np.isfinite(run.column("wire_out"))]
    length = float(np.mean(known)) if len(known) else 0.0
    mass = float(np.mean(run["hook_load"]))
    # a counter may be zeroed anywhere, and of an empty hook a load cell may read nothing, or less
    stiffness = crane.wire_stiffness / length / mass if length > 0.0 and mass > 0.0 else np.inf
    if 2.0 * np.pi / np.sqrt(stiffness) < _SMOOTHING:  # a swing that nobody sees, but noise would excite
        return _smooth(run, wire_speed, 1)
    rest = [_WIRE_DAMPING / mass, stiffness]
    numerator, denominator = bilinear([*rest, 0.0], [1.0, *rest], fs=1.0 / _step(run))
    # the load moves with its wire when the record begins, which may be in the midst of a motion
    state = wire_speed[0] * lfilter_zi(numerator, denominator)
    return np.asarray(lfilter(numerator, denominator, wire_speed, zi=state)[0])


def _step(run: Run) -> float:
    return float(np.median(np.diff(run.time)))


def _smooth(run: Run, values: FloatArray, derivative: int) -> FloatArray:
    step = _step(run)
    window = max(int(_SMOOTHING / step) | 1, 5)
    return np.asarray(savgol_filter(values, min(window, len(values) // 2 * 2 - 1), 2, deriv=derivative, delta=step))
