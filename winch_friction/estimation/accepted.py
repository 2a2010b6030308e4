"""What an estimator keeps of the last sample that it accepted."""

import math
from dataclasses import dataclass

from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.torque_balance import sample_drive_torque


@dataclass(frozen=True, slots=True)
class Accepted:
    """Time s, drive torque N m, measured speed rad/s, heave velocity m/s, wire layer (NaN: not measured)."""

    time: float
    drive: float
    speed: float
    heave: float
    layer: float


def accepted(sample: Sample, crane: Crane) -> Accepted:
    """What is kept of this sample."""
    drive = sample_drive_torque(sample, crane)
    return Accepted(sample.time, drive, sample.motor_speed, heave_velocity(sample), sample.wire_layer)


def heave_velocity(sample: Sample) -> float:
    """Velocity of the crane tip, m/s; a crane that does not say stands still."""
    return sample.heave_velocity if math.isfinite(sample.heave_velocity) else 0.0
