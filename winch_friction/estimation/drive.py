"""What a sample says about the drive: its torque, its noise, and whether it is saturated or not usable."""

import math

from winch_friction.estimation.config import EstimatorConfig
from winch_friction.physics.plausible import plausible
from winch_friction.physics.signals import GROUP_CHANNELS, Sample
from winch_friction.physics.winch.crane import Crane


def usable(sample: Sample, crane: Crane) -> bool:
    """Whether the sample has a time, plausible speed and drive, and a wire layer that the drum has (or none)."""
    if not (math.isfinite(sample.time) and plausible("motor_speed", sample.motor_speed)):
        return False
    if not crane.drum.has(sample.wire_layer):
        return False
    if crane.electric:
        return plausible("motor_torque", sample.motor_torque)
    channels = [(channel, getattr(group, channel)) for group in sample.groups.values() for channel in GROUP_CHANNELS]
    return bool(channels) and all(plausible(channel, value) for channel, value in channels)


def saturated(sample: Sample, crane: Crane, config: EstimatorConfig) -> bool:
    """Whether the drive is at a limit, where what is measured is not what acts."""
    if crane.electric:
        return abs(sample.motor_torque) > config.saturation_torque
    limit = config.saturation_pressure
    return any(max(group.pressure_a, group.pressure_b) > limit for group in sample.groups.values())


def torque_variance(sample: Sample, crane: Crane, config: EstimatorConfig) -> float:
    """Variance of the drive torque in (N m)^2 from the noise of pressures and displacements, or of the motor torque."""
    if crane.electric:
        return (crane.motor_total(()) * config.torque_noise) ** 2
    total = 0.0
    for name, group in sample.groups.items():
        full = crane.motor_count(name) * group.displacement
        by_displacement = full * (group.pressure_a - group.pressure_b) * config.displacement_noise
        total += 2.0 * (full * config.pressure_noise) ** 2 + by_displacement**2
    return total
