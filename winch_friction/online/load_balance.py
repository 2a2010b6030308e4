"""Whether the load that the estimator finds can be the one that is shown."""

import math

from winch_friction.compensation.safe_output import AGAINST_SPEED
from winch_friction.online.doubt import LEAST_KNOWN, Doubt, span
from winch_friction.physics.signals import Sample
from winch_friction.physics.winch.crane import sample_load
from winch_friction.physics.winch.operating_point import shown_by

# the load cell's load and the one that the balance of torques gives while it is learned from: a load cell, a
# displacement feedback and a tare of a few per cent each; a sea passes once in this time, a picked-up load settles
BALANCE_SHARE, BALANCE_TIME = 0.1, 10.0
# from here on it is said: five times what the shipped scenarios show, half of what stops the learning
SUSPECT_SHARE = 0.05


class LoadBalance:
    """Whether the load that the estimator finds is the one that the load cell shows.

    A load cell that drifts and a displacement (or both pressures) that drift look the same here: T = D dp is compared
    with m g r. It is not said which one is wrong, but that nothing may be learned from them. Nor is it before the winch
    has turned both ways, faster than `moving` rad/s: one way, friction that the seed does not know looks like load.
    """

    def __init__(self, moving: float = AGAINST_SPEED) -> None:
        self._doubt, self._time = Doubt(BALANCE_TIME, BALANCE_TIME), math.nan
        self._moving, self._hoisted, self._lowered = moving, 0.0, 0.0  # rad/s, s, s
        self._by, self._apart = "", math.nan  # the channel that showed the load last, and by how much it is off
        self._suspect = Doubt(BALANCE_TIME, BALANCE_TIME)

    def contradiction(self, apart: float, sample: Sample) -> str:
        """What does not fit, in words; `apart`: the share of the measured load that the balance adds, NaN unknown. A
        sample without a load contradicts nothing: what hangs there may be another one than was shown last."""
        dt, self._time = span(self._time, sample.time), sample.time
        self._hoisted += dt if sample.motor_speed > self._moving else 0.0
        self._lowered += dt if sample.motor_speed < -self._moving else 0.0
        wrong: bool | None = False
        suspect: bool | None = False
        if math.isfinite(sample_load(sample)):
            self._by, self._apart = shown_by(sample), apart
            wrong = abs(apart) > BALANCE_SHARE if apart == apart else None
            suspect = abs(apart) > SUSPECT_SHARE if apart == apart else None
        both_ways = min(self._hoisted, self._lowered) >= LEAST_KNOWN
        if not both_ways and wrong is False:
            self._doubt = Doubt(BALANCE_TIME, BALANCE_TIME)
        self._suspect.step(suspect if both_ways else False, dt)
        if not self._doubt.step(wrong, dt) or not both_ways:
            return ""
        return (
            f"{self._by} contradicts the balance of torques by {abs(apart):.0%}: load cell, displacement or pressures"
        )

    @property
    def suspicion(self) -> str:
        """What does not fit well, though it stops nothing, in words; '' for nothing."""
        if not self._suspect.stands or self._doubt.stands:
            return ""
        return (
            f"the balance of torques adds {self._apart:+.0%} to {self._by}: load cell, tare, displacement or pressures?"
        )

    @property
    def pending(self) -> bool:
        """Whether the two loads are apart, though it may not be said yet."""
        return self._doubt.pending
