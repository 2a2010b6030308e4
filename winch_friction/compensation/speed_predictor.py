"""The speed at which the friction is taken: extrapolated by its acceleration and filtered jerk."""

import math
from typing import NamedTuple


class PredictedSpeed(NamedTuple):
    """Speed and acceleration `lead` seconds ahead, rad/s and rad/s^2."""

    speed: float
    acceleration: float


class SpeedPredictor:
    """Extrapolates a sampled speed: omega + a t + j t^2 / 2, with a and j from backward differences.

    A backward difference is the acceleration half a step ago; the jerk brings it up to date. The jerk is low-passed,
    for it is the second difference of what may be a quantised signal.
    """

    def __init__(self, lead: float, acceleration_filter: float, jerk_filter: float) -> None:
        self._lead = lead
        self._acceleration_filter = acceleration_filter
        self._jerk_filter = jerk_filter
        self.reset()

    def reset(self) -> None:
        """Forget the past; the next speed is taken as constant."""
        self._time = math.nan
        self._speed = 0.0
        self._acceleration = math.nan
        self._jerk = 0.0

    def step(self, time: float, speed: float) -> PredictedSpeed:
        """Take the speed in rad/s at `time` s; a time that does not advance leaves the derivatives as they are."""
        dt = time - self._time
        if dt > 0.0:
            self._differentiate(dt, (speed - self._speed) / dt)
        if not dt <= 0.0:
            self._time, self._speed = time, speed
        acceleration = 0.0 if math.isnan(self._acceleration) else self._acceleration
        age = self._lead + (0.5 * dt if dt > 0.0 else 0.0)
        ahead = acceleration + self._jerk * age
        mean = acceleration + self._jerk * (age - 0.5 * self._lead)
        return PredictedSpeed(speed + mean * self._lead, ahead)

    def _differentiate(self, dt: float, slope: float) -> None:
        if math.isnan(self._acceleration):
            self._acceleration = slope
            return
        acceleration = self._acceleration + (slope - self._acceleration) * dt / (dt + self._acceleration_filter)
        jerk = (acceleration - self._acceleration) / dt
        self._jerk += (jerk - self._jerk) * dt / (dt + self._jerk_filter)
        self._acceleration = acceleration
