"""Whether the recent motion is rich enough to learn from."""

import math


class Excitation:
    """Range of the speed over the recent past, forgotten exponentially."""

    def __init__(self, time_constant: float) -> None:
        self._time_constant = time_constant
        self.reset()

    def reset(self) -> None:
        """Nothing was seen yet."""
        self.highest = -math.inf
        self.lowest = math.inf

    @property
    def range(self) -> float:
        """Highest minus lowest recent speed, rad/s."""
        return max(0.0, self.highest - self.lowest)

    def step(self, speed: float, dt: float) -> None:
        """Take a speed in rad/s, `dt` s after the last."""
        if self.highest >= self.lowest:
            keep = math.exp(-dt / self._time_constant)
            self.highest = speed + (self.highest - speed) * keep
            self.lowest = speed + (self.lowest - speed) * keep
        self.highest = max(self.highest, speed)
        self.lowest = min(self.lowest, speed)
