"""Torque balance at the motor shaft (docs/physics.md §1), summed over the motor groups:

sum_g n_g D_g dp_g = T_d / i + J domega/dt + T_friction

with T_friction = sgn(omega) (sum_g n_g T_fm,g + N T_fs) + torques of fixed direction. Electric drive: the left side is
N times the measured torque.
"""

from collections.abc import Sequence
from typing import Any

from winch_friction.physics.signals import Run, Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.drive import hydraulic_torque

__all__ = [
    "DRIVING", "driving_group", "hydraulic_torque", "pressure_feedforward", "run_drive_torque", "sample_drive_torque",
]  # fmt: skip

DRIVING = ("active", "main")  # the groups that carry what the others leave, where they run


def driving_group(groups: Sequence[str]) -> str:
    """The motor group that closes the torque balance, of the names of those that run."""
    return next((name for name in DRIVING if name in groups), groups[0])


def sample_drive_torque(sample: Sample, crane: Crane) -> float:
    """Torque of all motors at the shaft in N m from one sample, as the crane's drive makes it known."""
    return crane.drive.of_sample(sample, crane)


def run_drive_torque(run: Run, crane: Crane) -> Any:
    """`sample_drive_torque` along a run, N m."""
    return crane.drive.of_run(run, crane)


def pressure_feedforward(friction_torque: float, motor_count: int, displacement: float) -> float:
    """Pressure in Pa by which the active group carries all the friction: T_f / (n_active D_active)."""
    return friction_torque / (motor_count * displacement)
