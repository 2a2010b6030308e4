"""Heave as it was measured on a ship: a file of times and heights, interpolated. Up positive; m, m/s, m/s^2."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray
from winch_friction.records.csv_file import parse_header
from winch_friction.records.strict_yaml import utf_8_text
from winch_friction.records.unit_names import conversion_to_si

SLOWEST = 2.0  # s between two heights; a wave of 6 s has three of them
LARGEST = 20.0  # m about the mean: no crane tip heaves more
COLUMNS = {"time": "s", "heave": "m"}


@dataclass(frozen=True)
class MeasuredHeave:
    """Heights about their mean over time, by a cubic spline; the record's first sample is at time 0."""

    spline: Any
    lasts: float  # s
    where: str
    start: float = 0.0  # s into the record

    def motion(self, time: FloatArray) -> FloatArray:
        """Height, speed and acceleration, shape (times, 3); raises `InputError` where the record ends before."""
        end = self.start + float(time[-1])
        if end > self.lasts + 1e-6:
            raise InputError(
                f"{self.where}: the measured motion lasts {self.lasts:.5g} s, the scenario goes to {end:.5g} s of it; "
                "shorten duration or start earlier"
            )
        at = self.start + time
        return np.column_stack([self.spline(at, order) for order in (0, 1, 2)])


def load_heave(path: Path, start: float = 0.0) -> MeasuredHeave:
    """A motion file: CSV with the columns `time [s]` and `heave [m]` (other units in the brackets, further columns
    ignored). Raises `InputError`, one line for all of it, for a file that gives no motion.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such motion file; a scenario names it beside itself or by its whole path")
    time, heave = _columns(path)
    problems = []
    steps = np.diff(time)
    if len(time) < 4 or not np.isfinite(time).all() or steps.min() <= 0.0:
        problems.append("time must increase over at least four samples")
    elif steps.max() > SLOWEST:
        row = int(np.argmax(steps)) + 3
        problems.append(f"line {row}: {steps.max():.3g} s without a height; at most {SLOWEST:g} s tell a wave")
    if not np.isfinite(heave).all():
        problems.append(f"line {int(np.argmin(np.isfinite(heave))) + 2}: heave is no number")
    elif np.abs(heave - heave.mean()).max() > LARGEST:
        far = float(np.abs(heave - heave.mean()).max())
        problems.append(f"heave goes {far:.4g} m from its mean, at most {LARGEST:g} m; is its unit right?")
    if problems:
        raise InputError(f"{path}: {'; '.join(problems)}")
    from scipy.interpolate import CubicSpline  # brings scipy.optimize, and few scenarios follow a measured heave

    own = time - time[0]
    return MeasuredHeave(CubicSpline(own, heave - heave.mean()), float(own[-1]), str(path), start)


def _columns(path: Path) -> tuple[FloatArray, FloatArray]:
    lines = utf_8_text(path).splitlines()
    headers = [parse_header(cell.strip()) for cell in (lines[0].split(",") if lines else [])]
    names = [header.name for header in headers]
    missing = [name for name in COLUMNS if name not in names]
    if missing:
        wanted = ", ".join(f"{name} [{COLUMNS[name]}]" for name in missing)
        raise InputError(f"{path}: no column {wanted}; found {', '.join(names) or 'nothing'}")
    rows = [line.split(",") for line in lines[1:] if line.strip()]
    found = []
    for name, unit in COLUMNS.items():
        at = names.index(name)
        scale, offset = conversion_to_si(headers[at].unit or unit, unit, f"{path}: {name}")
        found.append(np.array([_number(row, at) for row in rows]) * scale + offset)
    return found[0], found[1]


def _number(row: list[str], at: int) -> float:
    try:
        return float("nan" if "_" in row[at] else row[at])  # 1_000 is a number in Python alone
    except (ValueError, IndexError):
        return float("nan")
