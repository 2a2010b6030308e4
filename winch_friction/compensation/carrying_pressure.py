"""The torque as a pressure: p = T / (n D) goes with a displacement that somebody else moves, and that a broken feedback
shows, so that it has a bound and a rate of its own.
"""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from winch_friction.compensation.config import CompensatorConfig
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import Crane, pressure_feedforward
from winch_friction.physics.winch.operating_point import RATED_PRESSURE


class Carried(NamedTuple):
    """Pa on the carrying group per N m at the shaft, of which its displacement lets this share be fed forward."""

    per_torque: float = 0.0
    share: float = 1.0


def carried(sample: Sample, crane: Crane, config: CompensatorConfig) -> Carried:
    """What a torque is as a pressure; nothing for an electric drive or a group that is not there.

    Below the floor of the displacement it falls to nothing with it: a group that is swung out cannot carry friction,
    whose pressure would be without bound, and one that reads past centre would push the other way.
    """
    name = config.pressure_group if len(sample.groups) != 1 else next(iter(sample.groups))
    if not crane.drive.hydraulic or name not in sample.groups:
        return Carried()
    displacement, floor = sample.groups[name].displacement, config.min_displacement * crane.max_displacement
    if not displacement > 0.0:
        return Carried(0.0, 0.0)
    full = pressure_feedforward(1.0, crane.motor_count(name), max(displacement, floor))
    share = min(1.0, displacement / floor) if floor else 1.0
    return Carried(full * share, share)


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

    @classmethod
    def on(cls, crane: Crane, config: CompensatorConfig) -> "CarryingPressure":
        """Bounded by what was set, and never by more than the motors are rated for, however far they are swung out."""
        return cls(min(config.pressure_limit, crane.rated_pressure or RATED_PRESSURE))

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
