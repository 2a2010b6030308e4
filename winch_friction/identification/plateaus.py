"""Constant-speed plateaus in logged cycles: transients excluded, statistics per plateau (paper 2 section 2.2)."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from winch_friction.physics.channels import RPM
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run, held
from winch_friction.physics.winch import Crane
from winch_friction.physics.winch.crane import at_its_speeds, run_drum_torque


@dataclass(frozen=True)
class PlateauRule:
    """What counts as constant speed; s, rad/s, rad/s^2.

    The slope of the speed, averaged over `window`, stays below `slope` plus `relative_slope` times the speed. The
    first `settle` seconds are dropped, and what lies outside `band` around the final speed. What remains lasts
    `duration` at least, is faster than `standstill`, and drifts less than `drift`. Of slow motors (`Crane.speed_scale`)
    the speeds are in proportion, unless a rule is given.
    """

    window: float = 0.6
    slope: float = 12.0 * RPM
    relative_slope: float = 0.02
    drift: float = 3.0 * RPM
    relative_drift: float = 0.002
    band: float = 8.0 * RPM
    relative_band: float = 0.02
    settle: float = 1.0
    duration: float = 1.5
    standstill: float = 4.0 * RPM


@dataclass(frozen=True)
class Plateau:
    """Means over one stretch of constant speed; SI, speed signed (hoisting positive).

    `pressure_error` is the standard error of the mean pressure drop, from the means of four parts of the plateau, so
    that slow oscillation of the load counts. `drum_torque` is T_d of the hanging mass on the wire layer in use.
    """

    run: str
    start: float
    end: float
    samples: int
    speed: float
    speed_std: float
    pressure_drop: float
    pressure_error: float
    displacement: float
    drum_torque: float


def find_plateaus(run: Run, crane: Crane, rule: PlateauRule | None = None, group: str = "main") -> list[Plateau]:
    """The plateaus of a run in order of time; raises `InputError` for a missing column, NaN or too few samples."""
    rule = rule or at_its_speeds(PlateauRule(), crane, "slope", "drift", "band", "standstill")
    _check(run, group)
    pieces = _steady_pieces(run, rule, group)
    torque = run_drum_torque(run, crane)
    return [_statistics(run, group, torque, piece) for piece in pieces]


def _check(run: Run, group: str) -> None:
    needed = ("time", "motor_speed", f"{group}.pressure_a", f"{group}.pressure_b", f"{group}.displacement", "hook_load")
    refuse_gaps(run, needed)
    if len(run) < 20:
        raise InputError(f"{run.name}: {len(run)} samples are too few to find constant speed in")


def refuse_gaps(run: Run, columns: Iterable[str]) -> None:
    """Raise `InputError`, naming row and column, where one of these is missing or not a finite number throughout."""
    for column in columns:
        bad = ~np.isfinite(run[column])
        if bad.any():
            where = f"{run.name} row {int(bad.argmax()) + 2}: column '{column}'"
            raise InputError(f"{where} is not a finite number; cut the gap out or give the run without it")


def _steady_pieces(run: Run, rule: PlateauRule, group: str) -> Iterator[slice]:
    time, speed = run.time, run["motor_speed"]
    half = max(int(round(rule.window / np.median(np.diff(time)))), 2)
    mean = _moving_mean(speed, half)
    slope = np.full(len(time), np.inf)
    slope[half:-half] = (mean[2 * half :] - mean[: -2 * half]) / (time[2 * half :] - time[: -2 * half])
    steady = (np.abs(slope) < rule.slope + rule.relative_slope * np.abs(mean)) & (np.abs(mean) > rule.standstill)
    steady &= ~_changes(run[f"{group}.displacement"], half) & ~_steps(run.column("wire_layer"))
    for start, stop in _stretches(steady):
        first = max(int(np.searchsorted(time, time[start] + rule.settle)), _level_from(mean, start, stop, rule))
        if first < stop and time[stop - 1] - time[first] >= rule.duration:
            piece = slice(first, stop)
            drift = np.polyfit(time[piece] - time[first], speed[piece], 1)[0]
            if abs(drift) < rule.drift + rule.relative_drift * abs(mean[stop - 1]):
                yield piece


def _level_from(mean: FloatArray, start: int, stop: int, rule: PlateauRule) -> int:
    """Where the speed comes within the band around its final value and stays there."""
    final = mean[stop - 1]
    outside = np.flatnonzero(np.abs(mean[start:stop] - final) > rule.band + rule.relative_band * abs(final))
    return start + int(outside[-1]) + 1 if len(outside) else start


def _moving_mean(values: FloatArray, half: int) -> FloatArray:
    width = 2 * (half // 2) + 1
    padded = np.pad(values, width // 2, mode="edge")
    return np.convolve(padded, np.full(width, 1.0 / width), mode="valid")


def _changes(displacement: FloatArray, half: int) -> Any:
    """Where the displacement is on the move: more than 2 % over the window."""
    mean = _moving_mean(displacement, half)
    moved = np.zeros(len(mean), bool)
    moved[half:-half] = np.abs(mean[2 * half :] - mean[: -2 * half]) > 0.02 * np.abs(mean[half:-half])
    return moved


def _steps(layer: FloatArray) -> Any:
    layer = held(layer)
    return (np.diff(layer, prepend=layer[:1]) != 0.0) & np.isfinite(layer)


def _stretches(mask: Any) -> Iterator[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def _statistics(run: Run, group: str, drum_torque: FloatArray, piece: slice) -> Plateau:
    speed = run["motor_speed"][piece]
    drop = run[f"{group}.pressure_a"][piece] - run[f"{group}.pressure_b"][piece]
    quarters = np.array([part.mean() for part in np.array_split(drop, 4)])
    return Plateau(
        run=run.name,
        start=float(run.time[piece][0]),
        end=float(run.time[piece][-1]),
        samples=len(speed),
        speed=float(speed.mean()),
        speed_std=float(speed.std()),
        pressure_drop=float(drop.mean()),
        pressure_error=float(quarters.std(ddof=1) / 2.0),
        displacement=float(run[f"{group}.displacement"][piece].mean()),
        drum_torque=float(drum_torque[piece].mean()),
    )
