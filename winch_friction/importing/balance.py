"""Does the torque balance close? The motors must hold the load, and friction must oppose the motion.

Signs, ports, groups and units that a log does not say are told by it: the mean over hoisting and lowering, from which
friction drops out, must be the load's torque; what is left must grow with the speed's sign.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import POWER, Crane

_LOAD_SHARE = 0.20  # of the load's torque: transducers, displacement feedback, rope, a layer, an unequal friction
_CAPACITY_SHARE = 0.025  # of the largest torque: what boost, tare and offsets make at an empty hook
_FULL_PRESSURE = 3.0e7  # Pa, of the largest torque
_SURE = 6.0  # standard errors from which a sign counts as told
_MOST = 4000  # samples looked at

Columns = Mapping[str, FloatArray]


@dataclass(frozen=True)
class Closure:
    """`mismatch`: |motors - load| over what may be unexplained (closes below 1); torques: means, N m at the shaft."""

    mismatch: float
    motors: float
    load: float

    @property
    def closes(self) -> bool:
        """Whether the motors hold the load."""
        return self.mismatch < 1.0


def groups_of(columns: Columns) -> list[str]:
    """The motor groups with all their channels."""
    names = [name.rpartition(".")[0] for name in columns if name.endswith(".pressure_a")]
    return [g for g in names if f"{g}.pressure_b" in columns and f"{g}.displacement" in columns]


def closure(columns: Columns, crane: Crane) -> Closure | None:
    """How well the balance closes on average; None when load, drive or speed are not in the log.

    None for a drive known by its power as well: a mean of power over speed hangs on the slowest moments.
    """
    if crane.drive.kind == POWER:
        return None
    drive, load = drive_torque(columns, crane), load_torque(columns, crane)
    if drive is None or load is None or "motor_speed" not in columns:
        return None
    speed = columns["motor_speed"]
    usable = np.isfinite(drive) & np.isfinite(load) & np.isfinite(speed)
    if usable.sum() < 10:
        return None
    motors, held = _mean_of_both_ways(drive, speed, usable), _mean_of_both_ways(load, speed, usable)
    allowed = _LOAD_SHARE * abs(held) + _CAPACITY_SHARE * _capacity(columns, crane, drive)
    return Closure(abs(motors - held) / max(allowed, 1e-12), motors, held)


def drive_torque(columns: Columns, crane: Crane) -> FloatArray | None:
    """Torque of all motors at the shaft in N m, or None where the log lacks what it takes."""
    groups = [g for g in groups_of(columns) if g in crane.groups]
    if crane.drive.hydraulic and not groups:
        return None
    kept = {n: v for n, v in columns.items() if "." not in n or n.rpartition(".")[0] in groups}
    try:
        return np.asarray(crane.drive.of_run(Run("log", kept), crane), dtype=float)
    except InputError:
        return None


def load_torque(columns: Columns, crane: Crane) -> FloatArray | None:
    """Torque of the load at the motor's shaft in N m, or None."""
    radii = crane.drum.layer_radii
    layers = columns.get("wire_layer")
    radius = np.full(1, radii[-1])
    if layers is not None:
        index = np.clip(np.nan_to_num(layers, nan=len(radii)).round().astype(int), 1, len(radii)) - 1
        radius = np.asarray(radii)[index]
    if "load_torque" in columns:
        return columns["load_torque"]
    if "hook_load" in columns:
        return columns["hook_load"] * GRAVITY * radius / crane.gear_ratio
    if "rope_force" in columns:
        return columns["rope_force"] * radius / crane.gear_ratio
    return None


def power_ratio(columns: Columns, crane: Crane) -> float | None:
    """Mechanical power over the load's torque times the speed, by least squares: about 1 in either sign, or None."""
    load, power = load_torque(columns, crane), columns.get("mechanical_power")
    if load is None or power is None or "motor_speed" not in columns:
        return None
    lifted = load * columns["motor_speed"]
    usable = np.isfinite(lifted) & np.isfinite(power)
    size = float(np.dot(lifted[usable], lifted[usable]))
    return float(np.dot(power[usable], lifted[usable])) / size if size > 0.0 else None


def _mean_of_both_ways(torque: FloatArray, speed: FloatArray, usable: Any) -> float:
    """Mean of hoisting and of lowering with equal weight, so that friction drops out; plain mean without both."""
    up, down = torque[usable & (speed > 0.0)], torque[usable & (speed < 0.0)]
    if min(len(up), len(down)) < 5:
        return float(np.mean(torque[usable]))
    return float(0.5 * (np.mean(up) + np.mean(down)))


def _capacity(columns: Columns, crane: Crane, drive: FloatArray) -> float:
    if not crane.drive.hydraulic:
        return float(np.nanpercentile(np.abs(drive), 95.0))
    motors = sum(crane.groups[g] for g in groups_of(columns) if g in crane.groups)
    return motors * crane.max_displacement * _FULL_PRESSURE


def opposes_motion(columns: Columns, crane: Crane) -> float:
    """Standard errors by which friction opposes the motion as the signs stand: above +6 right, below -6 flipped.

    From a least squares fit of motors - load by the speed's sign, the acceleration and a constant; blocks of the record
    count once. 0 when the log does not tell.
    """
    drive, load = drive_torque(columns, crane), load_torque(columns, crane)
    if drive is None or "motor_speed" not in columns or "time" not in columns:
        return 0.0
    rest = drive - load if load is not None else drive - np.nanmedian(drive)
    step = max(1, len(rest) // _MOST)
    speed, time = columns["motor_speed"], columns["time"]
    width = max(1, int(0.2 / max(float(np.nanmedian(np.diff(time))), 1e-4)))
    width = min(width, len(speed))  # of a log of few rows all of them
    kernel = np.ones(width) / width
    smooth = np.convolve(np.nan_to_num(speed), kernel, mode="same")
    change = np.gradient(smooth, np.maximum(time - time[0], 0.0) + 1e-9 * np.arange(len(time)))
    threshold = 0.05 * np.nanpercentile(np.abs(speed), 95.0)
    usable = np.isfinite(rest) & np.isfinite(change) & (np.abs(speed) > threshold)
    usable[: 2 * width] = usable[len(usable) - 2 * width :] = False
    if usable.sum() < 50 or threshold <= 0.0:
        return 0.0
    return _t_value(rest[usable][::step], np.sign(speed[usable])[::step], change[usable][::step])


def _t_value(rest: FloatArray, sign: FloatArray, change: FloatArray) -> float:
    if abs(np.mean(sign)) > 0.98:
        return 0.0  # one direction only: friction cannot be told from load
    matrix = np.column_stack([sign, change / max(float(np.std(change)), 1e-12), np.ones(len(rest))])
    blocks = np.array_split(np.arange(len(rest)), 12)
    fits = np.array([
        np.linalg.lstsq(matrix[b], rest[b], rcond=None)[0][0]
        for b in blocks
        if len(b) > 8 and abs(sign[b].mean()) < 0.95
    ])  # fmt: skip
    if len(fits) < 3:
        fit = np.linalg.lstsq(matrix, rest, rcond=None)[0]
        scatter = float(np.std(rest - matrix @ fit)) / np.sqrt(len(rest) / 20.0)
        return float(fit[0] / max(scatter, 1e-9 * float(np.max(np.abs(rest))), 1e-300))
    spread = float(np.std(fits, ddof=1)) / np.sqrt(len(fits))
    return float(np.median(fits) / max(spread, 1e-9 * float(np.max(np.abs(fits))), 1e-300))


def told(t_value: float) -> bool:
    """Whether a sign is told beyond doubt."""
    return abs(t_value) >= _SURE
