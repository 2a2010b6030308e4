"""A model as a friction curve: the torque over speed at one load and displacement, the winch in balance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.physics.channels import BAR, FASTEST_ROPE, GRAVITY, RPM
from winch_friction.physics.corrections import corrected_crane
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction.compiled import group_point, operating_point
from winch_friction.physics.friction.model import FrictionModel, completed
from winch_friction.physics.friction.symbols import GROUP_SIGNALS, WINCH_SIGNALS
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.winch.crane import Crane

TOP_SPEED = 2000.0 * RPM  # rad/s; supplier tables and the paper's tests end near it
LOWEST_SPEED = 5.0 * RPM  # rad/s; at rest friction is whatever holds the load
OF_RATED = (15.0 / 150.0, 55.0 / 150.0, 100.0 / 150.0)  # the papers' loads, of a crane rated for 150 t
_HOLDING = 300.0 * BAR  # of the papers' motors in service
_RATED_OF_HELD = 0.4  # of what the motors hold then on the innermost layer, a crane is rated for; 150 of 359 t theirs
_DRAWN = 200  # speeds of a curve
_BALANCE_STEPS = 4  # the pressure that carries the friction moves the friction by under 2 %: each step gains two digits


@dataclass(frozen=True)
class ModelCurve:
    """Friction over speed while turning steadily: all arrays (n,), speed rad/s (negative: lowering), torque N m at the
    motor shaft (all motors), `std` N m (NaN without covariance), `parts` torque by term, `pressure` drop in Pa (zero on
    an electric drive).
    """

    model: str
    load: float
    displacement: float
    speed: FloatArray
    torque: FloatArray
    std: FloatArray
    parts: dict[str, FloatArray]
    pressure: FloatArray


def usual_loads(crane: Crane) -> tuple[float, float, float]:
    """A light, a middle and a heavy hanging mass of this crane in kg, two digits each: 15, 55 and 100 t of 150 t rated.

    Of a crane whose file names no rated load by what its motors hold, or its torque limit.
    """
    lever = GRAVITY * crane.drum.layer_radii[0] / crane.gear_ratio
    torque = max(crane.groups.values(), default=0) * crane.max_displacement * _HOLDING or crane.absolute_torque_limit
    rated = crane.rated_load or _RATED_OF_HELD * torque / lever
    light, middle, heavy = (float(f"{share * rated:.2g}") for share in OF_RATED)
    return light, middle, heavy


def model_curve(
    model: FrictionModel,
    crane: Crane,
    *,
    load: float = 0.0,
    displacement: float | None = None,
    speed: Sequence[float] | FloatArray | None = None,
) -> ModelCurve:
    """The friction of `model` on `crane` at a hanging mass `load` kg and a motor setting `displacement` m^3/rad.

    `speed` in rad/s, default hoisting, 5 ... 2000 rpm or as far as the crane can run (`usual_speeds`); the group that
    drives is `main`, or the crane's first. Raises `InputError` for a load, setting or speed that cannot be.
    """
    model, crane = completed(model, crane), corrected_crane(crane, model.corrections, model.name)
    setting = crane.max_displacement if displacement is None else float(displacement)
    if load < 0.0 or not np.isfinite(load):
        raise InputError(f"load {load:g} kg: give the hanging mass, 0 or more")
    if crane.drive.hydraulic and not 0.0 < setting <= 1.001 * crane.max_displacement:
        raise InputError(f"displacement {setting:g} m^3/rad is outside 0 ... {crane.max_displacement:g} of the motor")
    omega = np.asarray(usual_speeds(model, crane) if speed is None else speed, float)
    if omega.ndim != 1 or not omega.size or not np.isfinite(omega).all():
        raise InputError("speed: give one finite speed or more, rad/s")
    group = "main" if "main" in crane.groups else next(iter(crane.groups), "")
    count = crane.motor_count(group) if crane.drive.hydraulic else 1
    drum, sign = np.full_like(omega, crane.drum_torque(load)), np.sign(omega)

    def points(drop: FloatArray) -> tuple[FloatArray, ...]:
        groups = (
            [group_point(np.full_like(omega, count), drop, np.full_like(omega, setting))]
            if crane.drive.hydraulic
            else []
        )
        total = np.full_like(omega, crane.motor_total((group,) if group else ()))
        return operating_point(direction=sign, speed=omega, drum_torque=drum, groups=groups, motor_total=total)

    drop = np.zeros_like(omega)
    if crane.drive.hydraulic:
        for _ in range(_BALANCE_STEPS):
            drop = (drum / crane.gear_ratio + _torque(model, points(drop))) / (count * setting)
    at = points(drop)
    parts = {name: np.array(part, float) for name, part in model.contributions(at, _settled(model, at)).items()}
    return ModelCurve(model.name, load, setting, omega, _torque(model, at), _std(model, at), parts, drop)


def usual_speeds(model: FrictionModel, crane: Crane) -> FloatArray:
    """Speeds (n,) rad/s of a curve: 5 ... 2000 rpm; of a crane that names no rated speed to where its rope runs off
    faster than any, and of an electric one to where friction alone takes its torque limit. From a 400th at most.
    """
    top = TOP_SPEED
    if not crane.rated_speed:
        top = min(top, FASTEST_ROPE * crane.gear_ratio / crane.drum.layer_radii[0])
    if not crane.drive.hydraulic and np.isfinite(crane.absolute_torque_limit):
        tried = np.geomspace(1e-4 * top, top, _DRAWN)
        beyond = np.abs(model_curve(model, crane, speed=tried).torque) > crane.absolute_torque_limit
        top = float(tried[int(np.argmax(beyond))]) if beyond.any() else top
    return np.linspace(min(LOWEST_SPEED, top * LOWEST_SPEED / TOP_SPEED), top, _DRAWN)


def _torque(model: FrictionModel, at: tuple[FloatArray, ...]) -> FloatArray:
    return np.array(np.broadcast_to(model.torque(at, _settled(model, at)), at[0].shape), float)


def _std(model: FrictionModel, at: tuple[FloatArray, ...]) -> FloatArray:
    if model.covariance is None:
        return np.full(at[0].shape, np.nan)
    jacobian = model.jacobian(at, _settled(model, at))
    return np.sqrt(np.einsum("ni,ij,nj->n", jacobian, model.covariance, jacobian))


def _settled(model: FrictionModel, at: tuple[FloatArray, ...]) -> tuple[FloatArray, ...]:
    """What terms with memory remember once the winch has turned like this for long: dz/dt = gain - decay z is zero."""
    functions = model.compile((len(at) - len(WINCH_SIGNALS)) // len(GROUP_SIGNALS))
    initial = functions.initial_states
    if not initial:
        return ()
    rates = [np.broadcast_to(rate, at[0].shape) for rate in functions.vector_state_rates(at, model.values, initial)]
    lasting = zip(initial, rates[::2], rates[1::2], strict=True)
    return tuple(np.where(decay > 0.0, gain / np.where(decay > 0.0, decay, 1.0), z) for z, gain, decay in lasting)
