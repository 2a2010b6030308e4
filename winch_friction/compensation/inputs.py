"""Which inputs a feedforward needs, and how its torque becomes a pressure."""

import math
from collections.abc import Set

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane
from winch_friction.physics.winch.ranges import ChannelRanges
from winch_friction.physics.winch.torque_balance import pressure_feedforward


class Needs:
    """What a feedforward needs to see.

    `reads` are the signals of its terms, `source` its velocity, `load_known` whether its configuration says the load.
    """

    def __init__(self, ranges: ChannelRanges, reads: Set[str], source: str, load_known: bool) -> None:
        self._ranges, self._crane = ranges, ranges.crane
        speed = "speed_reference" if source == "reference" else "motor_speed"
        self._scalars = (speed, "oil_temperature") if "oil_temperature" in reads else (speed,)
        self._balance_for_load = "drum_torque" in reads and not load_known

    def missing(self, sample: Sample) -> tuple[str, ...]:
        """Columns that the sample does not have, or not within what the crane can show."""
        plausible, drive = self._ranges.plausible, self._crane.drive
        lost = [name for name in self._scalars if not plausible(name, getattr(sample, name))]
        weight, force = sample.hook_load, sample.rope_force
        if weight == weight and not plausible("hook_load", weight):
            lost.append("hook_load")
        if force == force and not plausible("rope_force", force):
            lost.append("rope_force")
        if not self._crane.drum.has(sample.wire_layer):
            lost.append("wire_layer")
        if drive.hydraulic or (self._balance_for_load and not (math.isfinite(weight) or math.isfinite(force))):
            lost += drive.lacking(sample, plausible)
        return tuple(lost)


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
