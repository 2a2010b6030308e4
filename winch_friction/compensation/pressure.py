"""The feedforward as a pressure: what the published torque means on the motor group that carries it.

A torque that is bounded, slewed and ramped is none of that as a pressure: p = T / (n D) goes with a displacement that
somebody else moves, and that a broken feedback shows. So the pressure has a bound and a rate of its own.
"""

import math
from dataclasses import dataclass, field

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, pressure_feedforward
from winch_friction.physics.winch.operating_point import RATED_PRESSURE


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


def largest_pressure(crane: Crane, config: CompensatorConfig) -> float:
    """Pa: what was set, and never more than the motors are rated for, however far they are swung out."""
    return min(config.pressure_limit, crane.rated_pressure or RATED_PRESSURE)


@dataclass
class CarryingPressure:
    """The last published pressure, Pa, and the way from it to the next.

    It never means more torque than is published, and grows no faster than a slew limit of torque lets it at the
    present displacement; so it is over when the torque is, and falls as fast.
    """

    absolute: float
    value: float = field(default=0.0, init=False)
    clamps: int = field(default=0, init=False)
    _time: float = field(default=math.nan, init=False)

    def of(self, torque: float, per_torque: float, time: float, slew: float) -> float:
        """The pressure for a published torque in N m, at `per_torque` Pa per N m and stamp `time` s; `slew` N m/s."""
        wanted, grown = torque * per_torque, slew * per_torque * max(0.0, time - self._time)
        before = max(0.0, math.copysign(1.0, wanted) * self.value)  # of what has the same sign
        most = min(self.absolute, before + (grown if grown == grown else 0.0))
        self._time = time
        if abs(wanted) > most:
            self.clamps += 1
            wanted = math.copysign(most, wanted)
        self.value = wanted
        return wanted
