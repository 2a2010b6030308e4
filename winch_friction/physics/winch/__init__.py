"""The winch: motor groups, gear, drum layers and the torque balance at the motor shaft."""

from winch_friction.physics.winch.crane import Crane, Drive, Drum, group_roles
from winch_friction.physics.winch.operating_point import (
    group_point,
    operating_point,
    run_operating_points,
    sample_operating_point,
)

__all__ = [
    "Crane",
    "Drive",
    "Drum",
    "group_point",
    "group_roles",
    "operating_point",
    "run_operating_points",
    "sample_operating_point",
]
