"""From a measured run to what every candidate reads: smooth signals, regimes, the base model's balance.

Regressors are never built from the noisy pressure that is being explained: the pressure of the group that closes the
torque balance is predicted from the base model (fixed point), only the passive group's is measured, smoothed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.ndimage import median_filter

from winch_friction.discrepancy.smoothing import dilated, noise_level, smooth, speed_window
from winch_friction.discrepancy.travel import resolution, travel_of
from winch_friction.discrepancy.wire_mode import on_the_wire, settling_time, swinging_load, wire_stiffnesses
from winch_friction.physics.errors import InputError
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.symbols import WINCH_SIGNALS
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.units import BAR, GRAVITY
from winch_friction.physics.winch import Crane, operating_point

GUARD_SHARE = 0.008  # of the largest speed: below it the direction is uncertain
FAR_SHARE, FAR_TIME = 0.03, 3.0  # travel per top speed (6 rad at 2000 rpm) and seconds after which a reversal is past
GUARD_SAMPLES = 4  # kept away from a reversal on both sides, beyond half a smoothing window
MIN_SAMPLES = 100
MOST_SETTLING = 0.2  # of a run, left out at its beginning while the load may still swing from before
MIN_DISPLACEMENT_SHARE = 0.05
FIXED_POINT_STEPS = 3
SPIKE, SPIKE_WINDOW, MOST_SPIKES = 12.0, 2.0, 0.01  # robust deviations, s, share of the moving samples
DRUM_TORQUE = [signal.name for signal in WINCH_SIGNALS].index("drum_torque")


@dataclass(frozen=True)
class GroupSignals:
    """One motor group along a run: motors, predicted or smoothed |dp|, sum of pressures, displacement; Pa, m^3/rad."""

    name: str
    count: int
    pressure: FloatArray  # signed drop
    pressure_sum: FloatArray
    low_pressure: FloatArray
    displacement: FloatArray
    balances: bool  # closes the torque balance: its pressure is predicted


@dataclass(frozen=True)
class PreparedRun:
    """A run on a uniform grid; SI. `gap` is measured minus predicted drive torque at the shaft in N m."""

    name: str
    start: float  # absolute time of the first sample, s
    dt: float
    time: FloatArray
    speed: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    angle: FloatArray
    load: FloatArray
    load_acceleration: FloatArray
    radius: FloatArray
    drum_torque: FloatArray
    groups: tuple[GroupSignals, ...]
    point: tuple[Any, ...]
    gap: FloatArray
    wire_mode: tuple[float, float]  # frequency rad/s and damping ratio of the load on its wire; 0: rigid
    load_friction: FloatArray  # friction torque per relative change of the drum torque, N m
    predicted: FloatArray  # drive torque of the base model, N m
    from_speed: FloatArray  # what of it the shaft's speed tells, N m: all but the acceleration of the heaving crane
    jacobian: FloatArray
    gear_ratio: float
    inertia: float
    constants: tuple[tuple[str, float], ...]  # for the candidates' equations
    unit_torque: float  # N m per bar of the balancing group (1 for an electric drive)
    moving: np.ndarray
    spikes: np.ndarray
    valid: np.ndarray
    present: frozenset[str]  # columns that the file had
    channels: Mapping[str, FloatArray]  # what a gap may depend on, for locating it

    @property
    def mode(self) -> tuple[str, ...]:
        """Names of the motor groups: which kind of run this is."""
        return tuple(group.name for group in self.groups)


@dataclass(frozen=True)
class Found:
    """What effects found so far add along a run, N m at the shaft: load on the motors, and what the passive side's
    signals have too much.
    """

    missing_torque: FloatArray | float = 0.0
    passive_error: FloatArray | float = 0.0


def prepare(
    run: Run,
    crane: Crane,
    model: FrictionModel,
    load: float = float("nan"),
    found: Found | None = None,
    turning: bool = False,
    mode: tuple[float, float] | None = None,
    spikes: np.ndarray | None = None,
) -> PreparedRun:
    """Everything the workflow derives from one run; `load` kg where the run has no `hook_load`.

    With what was `found` so far, on the run's uniform grid, the pressures that friction is reckoned with come close to
    the true ones. `turning` takes direction and travel from the angle and marks the samples just after reversals
    instead of the moving ones. `mode` is frequency rad/s and damping of the load on its wire where it is
    known already; otherwise it is looked for. `spikes` marks samples to leave out, looked for unless given.
    Raises `InputError` for a run that is too short or lacks a channel that the torque balance needs.
    """
    columns, dt, valid = _uniform(run)
    size = len(columns["time"])
    raw_speed = _motor_speed(run, columns, crane)
    window = speed_window(raw_speed)
    speed = smooth(raw_speed, window)
    acceleration = np.gradient(speed, dt)  # of the smoothed speed: the same kernel as the pressures'
    if "shaft_angle" in columns:
        angle = columns["shaft_angle"]
    else:
        angle = np.concatenate([[0.0], np.cumsum(0.5 * (raw_speed[1:] + raw_speed[:-1])) * dt])
    guard = max(GUARD_SHARE * np.percentile(np.abs(speed), 99.5), 4.0 * noise_level(raw_speed) / np.sqrt(window / 3.0))
    # a short touch of zero hides in the smoothed speed
    still = (np.abs(speed) <= guard) | (np.abs(smooth(raw_speed, 5, 1)) <= guard)
    moving = ~dilated(still, window // 2 + GUARD_SAMPLES)
    direction = np.sign(np.where(np.abs(speed) > guard / 8.0, speed, 0.0))
    state_speed = np.where(direction != 0.0, speed, 0.0)
    if turning:
        direction, state_speed, moving = _just_reversed(angle, raw_speed, speed, guard, dt)
    static, load_side = _load(run, columns, crane, load, acceleration, window, dt, size)
    mass, radius, drum_torque, load_acceleration, heave_acceleration = load_side
    lever = radius / crane.gear_ratio
    extra = _optional(columns, angle, run.time[0], size)

    def balance(of_load: FloatArray) -> Any:
        inertial = crane.inertia * acceleration + mass * lever * of_load
        return _balance(
            columns, run, crane, model, state_speed, direction, acceleration, drum_torque, static + inertial, extra,
            window, found or Found(),
        )  # fmt: skip

    if mode is None:
        measured, _, _, predicted, _, _ = balance(load_acceleration)
        gap = smooth(measured, window) - predicted
        # the last two are delays, of the speed or of the pressures
        shifts = np.gradient(predicted - mass * lever * heave_acceleration), np.gradient(predicted)
        friction = np.column_stack([speed, direction * speed**2, *shifts])
        mode = _wire_mode(gap, moving, load_acceleration, dt, mass, lever, columns, crane, friction)
    if mode[1] > 0.0:
        load_acceleration = on_the_wire(load_acceleration, dt, *mode)
        heave_acceleration = on_the_wire(heave_acceleration, dt, *mode)
        moving &= columns["time"] > min(settling_time(*mode), MOST_SETTLING * columns["time"][-1])
    measured, groups, point, predicted, jacobian, unit = balance(load_acceleration)
    # the same kernel on both sides of the balance: an oscillation that smoothing takes out of the acceleration must not
    # remain in the pressures
    measured = smooth(measured, window)
    if spikes is None:
        spikes = _spikes(measured - predicted, moving, dt)
    channels = _channels(run, columns, speed, acceleration, mass, groups, angle, crane)
    return PreparedRun(
        name=run.name, start=float(run.time[0]), dt=dt, time=columns["time"], speed=speed, acceleration=acceleration,
        direction=direction, angle=angle, load=mass, load_acceleration=load_acceleration, radius=radius,
        drum_torque=drum_torque, groups=groups, point=point, gap=measured - predicted,
        wire_mode=mode,
        load_friction=_load_friction(model, point), predicted=predicted, jacobian=jacobian,
        from_speed=predicted - mass * lever * heave_acceleration,
        gear_ratio=crane.gear_ratio, inertia=crane.inertia, constants=_constants(crane, model), unit_torque=unit,
        moving=moving & valid & ~spikes,
        spikes=spikes, valid=valid,
        present=frozenset(run.columns), channels=channels,
    )  # fmt: skip


def _load_friction(model: FrictionModel, point: tuple[Any, ...]) -> FloatArray:
    more = tuple(1.01 * values if k == DRUM_TORQUE else values for k, values in enumerate(point))
    return (np.asarray(model.torque(more)) - np.asarray(model.torque(point))) / 0.01


def _constants(crane: Crane, model: FrictionModel) -> tuple[tuple[str, float], ...]:
    own = {"max_displacement": crane.max_displacement, "gear_ratio": crane.gear_ratio, **model.constants}
    return tuple(sorted(own.items()))


def _uniform(run: Run) -> tuple[dict[str, FloatArray], float, np.ndarray]:
    time = run.time - run.time[0]
    if len(time) < MIN_SAMPLES:
        raise InputError(f"{run.name}: only {len(time)} samples; at least {MIN_SAMPLES} are needed")
    steps = np.diff(time)
    if not np.isfinite(time).all() or steps.min() <= 0.0:
        raise InputError(f"{run.name}: column 'time' is not increasing; sort or repair the file")
    dt = float(np.median(steps))
    grid = np.arange(0.0, time[-1] + 0.5 * dt, dt)
    even = len(grid) == len(time) and np.abs(grid - time).max() < 1e-3 * dt
    valid = np.ones(len(grid), bool)
    columns: dict[str, FloatArray] = {"time": grid}
    for name, values in run.columns.items():
        good = np.isfinite(values)
        if name == "time" or not good.any():
            continue
        columns[name] = values if even and good.all() else np.interp(grid, time[good], values[good])
        if not good.all():
            valid &= np.interp(grid, time, (~good).astype(float)) < 0.5
    holes = np.flatnonzero(steps > 5.0 * dt)
    for k in holes:
        valid &= ~((grid > time[k]) & (grid < time[k + 1]))
    return columns, dt, valid


def _motor_speed(run: Run, columns: Mapping[str, FloatArray], crane: Crane) -> FloatArray:
    if "motor_speed" in columns:
        return columns["motor_speed"]
    if "drum_speed" in columns:
        return columns["drum_speed"] * crane.gear_ratio
    raise InputError(f"{run.name}: neither 'motor_speed' nor 'drum_speed' holds values; one of them is needed")


def _just_reversed(angle, raw_speed, speed, guard, dt):  # type: ignore[no-untyped-def]
    """Direction, speed of the travel and the samples whose contact has begun to slide but not gone far."""
    least = resolution(raw_speed, dt)
    direction, travel, progress = travel_of(angle, least)
    top = float(np.percentile(np.abs(speed), 99))
    turned = np.flatnonzero(np.diff(direction) != 0.0) + 1
    since = (
        np.arange(len(angle)) - np.concatenate([[0], turned])[np.searchsorted(turned, np.arange(len(angle)), "right")]
    )
    near = (travel > 1.5 * least) & (travel < FAR_SHARE * top) & (since < FAR_TIME / dt)
    near &= (direction != 0.0) & (direction * speed > guard / 8.0)
    return direction, direction * progress / dt, near


def _load(run, columns, crane, load, acceleration, window, dt, size):  # type: ignore[no-untyped-def]
    mass = columns.get("hook_load", np.full(size, 0.0 if np.isnan(load) else load))
    steady = np.median(mass)
    # a load cell's noise is not the load: a hanging mass that stays within 5 % is constant
    mass = np.full(size, steady) if np.std(mass) <= 0.05 * abs(steady) else smooth(mass, 5 * window)
    radius = np.full(size, crane.drum.radius(float("nan")))
    if "wire_layer" in columns:
        layers = np.rint(columns["wire_layer"])
        for layer in np.unique(layers):
            radius[layers == layer] = crane.drum.radius(float(layer))
    heave_acceleration = np.zeros(size)
    if "heave_velocity" in columns:
        heave_acceleration = np.gradient(smooth(columns["heave_velocity"], window), dt)
    load_acceleration = radius / crane.gear_ratio * acceleration + heave_acceleration
    drum_torque = mass * GRAVITY * radius
    return drum_torque / crane.gear_ratio, (mass, radius, drum_torque, load_acceleration, heave_acceleration)


def _spikes(gap: FloatArray, moving: np.ndarray, dt: float) -> np.ndarray:
    """Short bursts far outside a run's own spread: the shaft stuck for an instant, or a sensor failed."""
    none = np.zeros(len(gap), bool)
    if moving.sum() < MIN_SAMPLES:
        return none
    size = max(int(SPIKE_WINDOW / dt), 3) | 1
    coarse = max(size // 25, 1)  # a running median over every few samples is as good and much faster
    slow = np.interp(
        np.arange(len(gap)), np.arange(0, len(gap), coarse), median_filter(gap[::coarse], max(size // coarse, 3))
    )
    off = np.abs(gap - slow)
    spread = 1.4826 * float(np.median(off[moving]))
    found = moving & (off > SPIKE * max(spread, 1e-12))
    return dilated(found, int(0.1 / dt)) if 0 < found.sum() < MOST_SPIKES * moving.sum() else none


def _wire_mode(gap, moving, rigid, dt, mass, lever, columns, crane, friction):  # type: ignore[no-untyped-def]
    """Frequency and damping of the load's swinging, where stiffness and length of the wire are known."""
    load = float(np.median(mass))
    if not np.isfinite(crane.wire_stiffness) or load <= 0.0 or moving.sum() < MIN_SAMPLES:
        return 0.0, 0.0
    stiffnesses = wire_stiffnesses(crane.wire_stiffness, columns.get("wire_out"))
    swing = swinging_load(gap, np.flatnonzero(moving), rigid, dt, load, lever, stiffnesses, friction)
    known = float(np.sqrt(stiffnesses[0] / load)) if "wire_out" in columns else swing.frequency
    return known, swing.damping


def _optional(columns: Mapping[str, FloatArray], angle: FloatArray, start: float, size: int) -> dict[str, Any]:
    extra: dict[str, Any] = {"time": columns["time"] + start, "shaft_angle": angle}
    for name in ("oil_temperature", "wire_layer", "wire_out"):
        if name in columns:
            extra[name] = columns[name]
    return extra


def _balance(
    columns, run, crane, model, speed, direction, acceleration, drum_torque, frictionless, extra, window, found
):  # type: ignore[no-untyped-def]
    """Measured and predicted drive torque, groups with predicted pressures, operating point, Jacobian, N m per bar."""
    size = len(speed)
    names = run.groups

    def point_of(groups: tuple[GroupSignals, ...]) -> tuple[Any, ...]:
        counts = [np.full(size, float(g.count)) for g in groups]
        return operating_point(
            direction=direction, speed=speed, drum_torque=drum_torque, acceleration=acceleration,
            groups=[(n, np.abs(g.pressure), g.pressure_sum, g.displacement)
                    for n, g in zip(counts, groups, strict=True)],
            motor_total=np.full(size, float(crane.motor_total(names))), **extra,
        )  # fmt: skip

    if crane.electric:
        total = crane.motor_total(())
        point = point_of(())
        if "motor_torque" not in columns:
            raise InputError(f"{run.name}: column 'motor_torque' is missing; an electric drive needs it")
        return (columns["motor_torque"] * total, (), point, frictionless + model.torque(point),
                model.jacobian(point), float(total))  # fmt: skip
    if not names:
        raise InputError(f"{run.name}: no motor group's pressures and displacement; they close the torque balance")
    groups = _corrected(_measured_groups(columns, run, crane, window), found.passive_error)
    drops = [columns[f"{g.name}.pressure_a"] - columns[f"{g.name}.pressure_b"] for g in groups]
    measured = sum(g.count * g.displacement * drop for g, drop in zip(groups, drops, strict=True))
    predicted = frictionless
    for _ in range(FIXED_POINT_STEPS):
        groups = _predicted_pressure(groups, predicted + found.missing_torque)
        point = point_of(groups)
        predicted = frictionless + model.torque(point)
    own = next(g for g in groups if g.balances)
    unit = BAR * own.count * float(np.median(own.displacement))
    return measured, groups, point, predicted, model.jacobian(point), unit


def _measured_groups(columns, run, crane, window) -> tuple[GroupSignals, ...]:  # type: ignore[no-untyped-def]
    names = run.groups
    balancing = next((name for name in ("active", "main") if name in names), names[0])
    groups = []
    for name in names:
        for channel in ("pressure_a", "pressure_b", "displacement"):
            if f"{name}.{channel}" not in columns:
                raise InputError(
                    f"{run.name}: column '{name}.{channel}' is missing or empty; the torque balance needs it"
                )
        a, b = columns[f"{name}.pressure_a"], columns[f"{name}.pressure_b"]
        displacement = smooth(columns[f"{name}.displacement"], 5 * window)
        steady = float(np.median(displacement))
        if np.std(displacement) <= 0.02 * steady:
            displacement = np.full(len(displacement), steady)
        if steady < MIN_DISPLACEMENT_SHARE * crane.max_displacement and name == balancing:
            raise InputError(f"{run.name}: '{name}.displacement' is nearly zero; its pressure cannot carry the load")
        groups.append(GroupSignals(name, crane.motor_count(name), smooth(a - b, 2 * window), smooth(a + b, 2 * window),
                                   smooth(np.minimum(a, b), 2 * window), displacement, name == balancing))  # fmt: skip
    return tuple(groups)


def _corrected(groups: tuple[GroupSignals, ...], error: FloatArray | float) -> tuple[GroupSignals, ...]:
    """Groups whose passive pressures are rid of an error that amounts to a torque (N m) at the shaft."""
    passive = sum(g.count * g.displacement for g in groups if not g.balances)
    return tuple(g if g.balances else replace(g, pressure=g.pressure - error / passive) for g in groups)


def _predicted_pressure(groups: tuple[GroupSignals, ...], torque: FloatArray) -> tuple[GroupSignals, ...]:
    rest = torque - sum(g.count * g.displacement * g.pressure for g in groups if not g.balances)
    out = []
    for g in groups:
        if not g.balances:
            out.append(g)
            continue
        pressure = rest / (g.count * np.maximum(g.displacement, 1e-9))
        out.append(GroupSignals(g.name, g.count, pressure, np.abs(pressure) + 2.0 * g.low_pressure, g.low_pressure,
                                g.displacement, True))  # fmt: skip
    return tuple(out)


def _channels(run, columns, speed, acceleration, mass, groups, angle, crane) -> dict[str, FloatArray]:  # type: ignore[no-untyped-def]
    size = len(speed)
    found: dict[str, FloatArray] = {"motor_speed": np.abs(speed), "acceleration": acceleration}
    if not crane.electric or "hook_load" in columns:
        found["hook_load"] = mass
    for group in groups:
        found[f"{group.name}.pressure"] = group.pressure
        found[f"{group.name}.displacement"] = group.displacement
    for name in ("oil_temperature", "wire_layer", "wire_out", "heave_velocity"):
        if name in columns:
            found[name] = columns[name]
    found["shaft_angle"] = np.mod(angle / crane.gear_ratio, 2.0 * np.pi)
    found["time"] = columns["time"]
    for name, values in run.aside.items():
        array = np.asarray(values)
        if array.dtype.kind in "fiu" and len(array) == len(run):
            found[name] = np.interp(columns["time"], run.time - run.time[0], np.nan_to_num(array.astype(float)))
    return {name: np.broadcast_to(values, size) for name, values in found.items()}
