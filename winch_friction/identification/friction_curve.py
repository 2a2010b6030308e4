"""Total friction over speed from hoisting and lowering at equal speed (paper 2 eq 2-6)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from winch_friction.identification.fit_data import FitData
from winch_friction.identification.plateaus import Plateau
from winch_friction.physics.channels import CM3_PER_REV, RPM
from winch_friction.physics.corrections import LEAST_STROKE
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch import Crane, group_point, operating_point

SPEED_STEP = 25.0 * RPM  # paper 2 eq 9
_SAME_SPEED = 5.0 * RPM
_ONE_SETTING = 0.02  # of the displacement; plateaus of one setting differ by less, as within one (`plateaus._changes`)
# times: where the stroke sets the torque it is (T + F)/(T - F) hoisting over lowering, and friction a third of the load
_WIDEST = 2.0


@dataclass(frozen=True)
class FrictionCurve:
    """One test: arrays over `speed` (n,) in rad/s, a grid of 25 rpm (of slow motors less, in proportion)
    where hoisting and lowering overlap.

    `pressure_up`, `pressure_down` Pa interpolated to that speed; `displacement` m^3/rad per motor; `drum_torque` N m;
    `motors` on the shaft; `load_torque` N m per motor is the test's nominal torque T_d / (i N).
    """

    test: str
    speed: FloatArray
    pressure_up: FloatArray
    pressure_down: FloatArray
    displacement: float
    drum_torque: float
    motors: int
    load_torque: float

    @property
    def friction_pressure(self) -> FloatArray:
        """Paper 2 eq 5, Pa."""
        return 0.5 * (self.pressure_up - self.pressure_down)

    @property
    def friction_torque(self) -> FloatArray:
        """T_ft per motor, N m (paper 2 eq 6)."""
        return self.friction_pressure * self.displacement


def friction_curve(plateaus: Sequence[Plateau], crane: Crane, group: str = "main") -> FrictionCurve:
    """The friction curve of one test from its plateaus.

    Raises `InputError` when a direction is missing, when one has a single plateau, when their speeds do not overlap, or
    when they show no displacement, or several.
    """
    test = plateaus[0].run if plateaus else "test"
    motors = crane.motor_count(group)
    drum_torque = float(np.mean([each.drum_torque for each in plateaus])) if plateaus else 0.0
    displacement = _displacement(plateaus, crane)
    alike = [_at_load(_at_stroke(p, displacement), drum_torque, crane.gear_ratio * motors) for p in plateaus]
    same, step = _SAME_SPEED * crane.speed_scale, SPEED_STEP * crane.speed_scale
    up, down = _branch(alike, +1, test, same), _branch(alike, -1, test, same)
    grid = _common_grid(up[0], down[0], test, step)
    return FrictionCurve(
        test=test,
        speed=grid,
        pressure_up=np.interp(grid, *up),
        pressure_down=np.interp(grid, *down),
        displacement=displacement,
        drum_torque=drum_torque,
        motors=motors,
        load_torque=drum_torque / (crane.gear_ratio * motors),
    )


def _displacement(plateaus: Sequence[Plateau], crane: Crane) -> float:
    """Their mean, m^3/rad per motor; `InputError` where motors that turn the winch seem to be swung out, or a test has
    several settings: the pressure would be divided by nothing, or multiplied by a mean that it was never at."""
    least = LEAST_STROKE * crane.max_displacement
    for each in plateaus:
        if not each.displacement > least:
            raise InputError(
                f"{each.run}: displacement {each.displacement / CM3_PER_REV:.3g} cm^3/rev from {each.start:.6g} to "
                f"{each.end:.6g} s while the winch turns: is the feedback dead? leave this part out"
            )
    found = [each.displacement for each in plateaus]
    if found and max(found) > _WIDEST * min(found):
        shown = " and ".join(f"{each / CM3_PER_REV:.3g}" for each in (min(found), max(found)))
        raise InputError(f"{plateaus[0].run}: displacements of {shown} cm^3/rev in one test: give each as its own")
    return float(np.mean(found)) if found else 0.0


def _at_stroke(plateau: Plateau, mean: float) -> Plateau:
    """The plateau as its torque would show at the test's mean displacement: where the stroke sets the torque, friction
    shows in the stroke, and none in the pressures."""
    if abs(plateau.displacement - mean) <= _ONE_SETTING * mean:
        return plateau
    return replace(plateau, pressure_drop=plateau.pressure_drop * plateau.displacement / mean, displacement=mean)


def _at_load(plateau: Plateau, mean: float, shafts: float) -> Plateau:
    """The plateau as the test's mean load would show it: a change of wire layer is no friction, nor does the friction
    itself change much with it. `shafts`: motors times the gear ratio."""
    difference = (plateau.drum_torque - mean) / (shafts * plateau.displacement)
    return replace(plateau, pressure_drop=plateau.pressure_drop - difference)


def _branch(plateaus: Sequence[Plateau], direction: int, test: str, same: float) -> tuple[FloatArray, FloatArray]:
    """Speed magnitude and pressure drop of one direction, rising, those within `same` rad/s averaged."""
    word = "hoisting" if direction > 0 else "lowering"
    chosen = sorted((each for each in plateaus if each.speed * direction > 0), key=lambda each: abs(each.speed))
    if not chosen:
        raise InputError(f"{test}: no {word} at constant speed was found; friction needs both directions")
    levels: list[list[Plateau]] = []
    for each in chosen:
        if levels and abs(each.speed) - abs(levels[-1][0].speed) < same:
            levels[-1].append(each)
        else:
            levels.append([each])
    if len(levels) < 2:
        raise InputError(f"{test}: {word} has one constant speed only, at least two are needed; too few plateaus")
    speed = np.array([np.mean([abs(each.speed) for each in level]) for level in levels])
    return speed, np.array([np.mean([each.pressure_drop for each in level]) for level in levels])


def _common_grid(up: FloatArray, down: FloatArray, test: str, step: float) -> FloatArray:
    lower, upper = max(up[0], down[0]), min(up[-1], down[-1])
    grid = np.arange(np.ceil(lower / step - 1e-9), np.floor(upper / step + 1e-9) + 1) * step
    if upper <= lower or len(grid) < 1:
        spans = f"{up[0] / RPM:.0f}-{up[-1] / RPM:.0f} rpm and {down[0] / RPM:.0f}-{down[-1] / RPM:.0f} rpm"
        raise InputError(f"{test}: the speeds of hoisting and lowering do not overlap ({spans})")
    return grid


def curve_data(curves: Sequence[FrictionCurve], name: str = "friction tests") -> FitData:
    """All curves as data for a fit with the cost of paper 2 eq 9: every 25 rpm counts alike; groups are the tests.

    An observation is the mean friction of hoisting and lowering, each at its own pressure.
    """
    if not curves:
        raise InputError(f"{name}: no test is left to fit")
    if len({curve.motors for curve in curves}) > 1:
        raise InputError(f"{name}: the tests differ in their number of motors; fit them apart")
    lengths = [len(curve.speed) for curve in curves]
    stacked = [np.concatenate([getattr(curve, side) for curve in curves]) for side in ("pressure_up", "pressure_down")]
    displacement = np.repeat([curve.displacement for curve in curves], lengths)
    tests = np.repeat([curve.test for curve in curves], lengths)
    return FitData(
        name=name,
        points=winch_points(
            np.tile(np.concatenate([curve.speed for curve in curves]), 2),
            np.concatenate(stacked),
            np.tile(displacement, 2),
            np.tile(np.repeat([curve.drum_torque for curve in curves], lengths), 2),
            curves[0].motors,
        ),
        torque=np.concatenate([curve.friction_torque for curve in curves]),
        weight=np.ones(len(tests)),
        group=tests,
        cluster=tests,
        copies=2,
        motors=curves[0].motors,
    )


def winch_points(
    speed: FloatArray, pressure: FloatArray, displacement: FloatArray, drum_torque: FloatArray, motors: int
) -> tuple[FloatArray, ...]:
    """Operating points of a winch in normal mode at direction +1, so that friction is its magnitude."""
    count = np.full(len(speed), float(motors))
    return operating_point(
        direction=np.ones(len(speed)),
        speed=np.abs(speed),
        drum_torque=drum_torque,
        groups=[group_point(count, pressure, displacement)],
        motor_total=count,
    )
