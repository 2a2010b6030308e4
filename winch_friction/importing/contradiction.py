"""Logs in SI against the crane: what the commissioning check says of them, asked only where the drive is logged."""

from collections.abc import Mapping, Sequence

from winch_friction.commissioning.check import quick_check
from winch_friction.importing.balance import drive_torque
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch.crane import Crane

UNEXPLAINED = "unexplained"  # the check's cause where no single mistake would do


def contradictions(logs: Mapping[str, Mapping[str, FloatArray]], crane: Crane) -> list[str]:
    """What in these logs (name -> columns in SI) cannot be this crane, the likeliest mistake first."""
    runs = [Run(name, columns) for name, columns in logs.items() if _is_complete(columns, crane)]
    return run_contradictions(runs, crane)


def run_contradictions(runs: Sequence[Run], crane: Crane) -> list[str]:
    """The same for runs.

    What no single mistake explains counts for hydraulic winches alone: of other drives the usual friction is unknown.
    """
    found = [each for each in quick_check(runs, crane) if each.contradicts] if runs else []
    return [each.sentence for each in found if crane.drive.hydraulic or each.cause != UNEXPLAINED]


def _is_complete(columns: Mapping[str, FloatArray], crane: Crane) -> bool:
    return {"time", "motor_speed"} <= set(columns) and drive_torque(columns, crane) is not None
