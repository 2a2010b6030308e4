"""Torque balance at the motor shaft (docs/physics.md §1), summed over the motor groups:

sum_g n_g D_g dp_g = T_d / i + J domega/dt + T_friction

with T_friction = sgn(omega) (sum_g n_g T_fm,g + N T_fs) + torques of fixed direction. Electric drive: the left side is
N times the measured torque.
"""

from collections.abc import Iterable, Sequence
from typing import Any

from winch_friction.physics.signals import Run, Sample
from winch_friction.physics.winch.crane import Crane

DRIVING = ("active", "main")  # the groups that carry what the others leave, where they run


def driving_group(groups: Sequence[str]) -> str:
    """The motor group that closes the torque balance, of the names of those that run."""
    return next((name for name in DRIVING if name in groups), groups[0])


def sample_drive_torque(sample: Sample, crane: Crane) -> float:
    """Torque of all motors at the shaft in N m from one sample's pressures, or from its measured motor torque."""
    if crane.electric:
        return sample.motor_torque * crane.motor_total(())
    return float(
        hydraulic_torque(
            (crane.motor_count(name), group.displacement, group.pressure_a - group.pressure_b)
            for name, group in sample.groups.items()
        )
    )


def run_drive_torque(run: Run, crane: Crane) -> Any:
    """`sample_drive_torque` along a run, N m."""
    if crane.electric:
        return run["motor_torque"] * crane.motor_total(())
    return hydraulic_torque(
        (crane.motor_count(g), run[f"{g}.displacement"], run[f"{g}.pressure_a"] - run[f"{g}.pressure_b"])
        for g in run.groups
    )


def hydraulic_torque(groups: Iterable[tuple[float, Any, Any]]) -> Any:
    """Sum of n D dp in N m over groups of (motors, displacement m^3/rad, pressure drop Pa); floats or arrays alike."""
    return sum(count * displacement * drop for count, displacement, drop in groups)


def pressure_feedforward(friction_torque: float, motor_count: int, displacement: float) -> float:
    """Pressure in Pa by which the active group carries all the friction: T_f / (n_active D_active)."""
    return friction_torque / (motor_count * displacement)
