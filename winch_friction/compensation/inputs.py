"""Which inputs a feedforward needs, and how its torque becomes a pressure."""

import math
from collections.abc import Set

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.ranges import ChannelRanges
from winch_friction.physics.winch.torque_balance import pressure_feedforward


def missing_inputs(
    sample: Sample, ranges: ChannelRanges, reads: Set[str], source: str, load_known: bool
) -> tuple[str, ...]:
    """Columns that the feedforward needs and the sample does not have, or not within what the crane can show."""
    needed = {"speed_reference" if source == "reference" else "motor_speed"}
    if "oil_temperature" in reads:
        needed.add("oil_temperature")
    lost = [name for name in sorted(needed) if not ranges.plausible(name, getattr(sample, name))]
    if sample.hook_load == sample.hook_load and not ranges.plausible("hook_load", sample.hook_load):
        lost.append("hook_load")
    if not ranges.crane.drum.has(sample.wire_layer):
        lost.append("wire_layer")
    drive = ranges.crane.drive
    if drive.hydraulic:
        return (*lost, *drive.lacking(sample, ranges.plausible))
    from_balance = "drum_torque" in reads and not load_known and not math.isfinite(sample.hook_load)
    return (*lost, *drive.lacking(sample, ranges.plausible)) if from_balance else tuple(lost)


def pressure_per_torque(sample: Sample, crane: Crane, config: CompensatorConfig) -> float:
    """Pa on the carrying group per N m at the shaft; 0 for an electric drive or a group that is not there.

    The displacement has a floor: a group that is swung out cannot carry friction, and its pressure would be without
    bound.
    """
    name = config.pressure_group if len(sample.groups) != 1 else next(iter(sample.groups))
    if not crane.drive.hydraulic or name not in sample.groups:
        return 0.0
    displacement = max(sample.groups[name].displacement, config.min_displacement * crane.max_displacement)
    return pressure_feedforward(1.0, crane.motor_count(name), displacement)
