"""Logs in SI against the crane: what the commissioning check says of them, asked only where the drive is logged."""

from collections.abc import Mapping, Sequence

import numpy as np

from winch_friction.commissioning.check import quick_check
from winch_friction.importing.balance import drive_torque, power_ratio
from winch_friction.importing.summer_time import hour_back
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane

LOSSES = 2.0  # power over load times speed: no winch loses half of it


def contradictions(logs: Mapping[str, Mapping[str, FloatArray]], crane: Crane) -> list[str]:
    """What in these logs (name -> columns in SI) cannot be this crane, the likeliest mistake first."""
    said = [text for name, columns in logs.items() for text in _of_clock(name, columns)]
    timed = {name: _with_time(columns) for name, columns in logs.items()}
    return said or run_contradictions([Run(name, columns) for name, columns in timed.items()], crane)


def _of_clock(name: str, columns: Mapping[str, FloatArray]) -> list[str]:
    """A clock that goes back by more than a sample: two recordings in one file, of which no run can be made."""
    time = columns.get("time", np.zeros(0))
    steps = np.diff(time[np.isfinite(time)])
    if not len(steps) or steps.min() >= 0.0:
        return []
    back = int(np.argmin(steps))
    if hour_back(time[np.isfinite(time)]):
        return [
            f"{name}: time goes back by an hour after sample {back + 1}: the end of summer time? --set time.zone=ZONE, "
            "the log's (e.g. Europe/Oslo), takes it out; else cut the log there"
        ]
    times, first = int(np.sum(steps < 0.0)), int(np.argmax(steps < 0.0))
    return [
        f"{name}: time goes back {times} times, first after sample {first + 1} by {-float(steps[first]):.4g} s: "
        "several recordings in one file? cut it there"
    ]


def _with_time(columns: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """The rows that have a time."""
    known = np.isfinite(columns["time"]) if "time" in columns else np.ones(0, bool)
    return {name: values[known] if len(values) == len(known) else values for name, values in columns.items()}


def run_contradictions(runs: Sequence[Run], crane: Crane) -> list[str]:
    """The same for runs; one without a drive, such as a ship's motion, contradicts no crane.

    Of a hydraulic winch the commissioning check knows what friction is usual; of another drive only that its power is
    the load times the speed but for its losses.
    """
    runs = [run for run in runs if _is_complete(run.columns, crane)]
    if not runs:
        return []
    if crane.drive.hydraulic:
        return [each.sentence for each in quick_check(runs, crane) if each.contradicts]
    gains = {run.name: gain for run in runs if (gain := power_ratio(run.columns, crane)) is not None}
    return [
        f"{name}: mechanical_power is {gain:.3g} times load times speed: a unit or a sign of one of them is another"
        for name, gain in gains.items()
        if not 1.0 / LOSSES < gain < LOSSES
    ]


def _is_complete(columns: Mapping[str, FloatArray], crane: Crane) -> bool:
    return {"time", "motor_speed"} <= set(columns) and drive_torque(columns, crane) is not None
