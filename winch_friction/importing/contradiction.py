"""Logs in SI against the crane: what the commissioning check says of them, asked only where the drive is logged."""

from collections.abc import Mapping, Sequence

from winch_friction.commissioning.check import quick_check
from winch_friction.importing.balance import drive_torque, power_ratio
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane

LOSSES = 2.0  # power over load times speed: no winch loses half of it


def contradictions(logs: Mapping[str, Mapping[str, FloatArray]], crane: Crane) -> list[str]:
    """What in these logs (name -> columns in SI) cannot be this crane, the likeliest mistake first."""
    runs = [Run(name, columns) for name, columns in logs.items() if _is_complete(columns, crane)]
    return run_contradictions(runs, crane)


def run_contradictions(runs: Sequence[Run], crane: Crane) -> list[str]:
    """The same for runs.

    Of a hydraulic winch the commissioning check knows what friction is usual; of another drive only that its power is
    the load times the speed but for its losses.
    """
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
