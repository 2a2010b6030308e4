"""What the innovations say of the sensor errors that the filter considers and never estimates.

The filter carries what one of each error does to the measurement that it predicts. Of an error that is there the
innovations are that much off, so that they tell its size by weighted least squares: the second stage of Friedland
(1969), *Treatment of bias in recursive filtering*, without the feedback into the first. A speed that is later than
`speed_delay` says is told in this way; its share of the sigmas covers no more than what it is considered to be.
"""

from collections.abc import Sequence

import numpy as np

from winch_friction.physics.signals import FloatArray

OR_ELSE = "or the model lacks an effect, which gap would name"  # a loss of its pressures may look alike
# of the time between two samples: a lateness is told by samples that show it as sharply as what is considered for
# nothing (`speed_delay_std`); the first tenth of a second shows what the start itself does, as up to 17 samples' time
SHARP = 0.15
SURE = 3.0  # standard deviations of what is found, by which it must be beyond what is considered


class ConsideredErrors:
    """Information of all learned innovations about the errors, of which `std` are the considered deviations.

    `late`: the first error is the speed's lateness, a share of the time between two samples, taken as unknown.
    """

    def __init__(self, std: Sequence[float], late: bool) -> None:
        self._std, self._late = tuple(std), late
        self._matrix = [[0.0] * len(self._std) for _ in self._std]
        self._right = [0.0] * len(self._std)

    def step(self, shown: FloatArray, innovation: float, variance: float) -> None:
        """Take one innovation, rad/s, of this variance; `shown` (k,) is what one of each error makes of it."""
        seen = shown.tolist()
        for k, one in enumerate(seen):
            weight = one / variance
            self._right[k] += weight * innovation
            row = self._matrix[k]
            for j, other in enumerate(seen):
                row[j] += weight * other

    def anew(self) -> "ConsideredErrors":
        """The same errors, of which nothing is known yet."""
        return ConsideredErrors(self._std, self._late)

    @property
    def lateness(self) -> tuple[float, float]:
        """By which share of the time between two samples the speed is later than it is said to be, and the standard
        deviation of that; NaN where nothing is known."""
        if not self._late or not self._matrix[0][0] > 0.0:
            return float("nan"), float("nan")
        prior = [0.0, *(1.0 / each**2 for each in self._std[1:])]
        try:
            covariance = np.linalg.inv(np.array(self._matrix) + np.diag(prior))
        except np.linalg.LinAlgError:
            return float("nan"), float("nan")
        return float(covariance[0] @ self._right), float(max(covariance[0, 0], 0.0) ** 0.5)

    def status(self) -> dict[str, float | str]:
        """What is found, and in words where it is more than what is considered."""
        share, std = self.lateness
        return {"speed_late": share, "speed_late_std": std, "lateness": self._words(share, std)}

    def _words(self, share: float, std: float) -> str:
        if not (self._late and std < SHARP and abs(share) - SURE * std > self._std[0]):  # NaN as well
            return ""
        size = f"about {abs(share):.1f} of the time between two samples"
        if share > 0.0:
            return (
                f"motor_speed seems late by {size}: set speed_delay (half a scan where a PLC takes the difference of "
                f"two encoder angles), {OR_ELSE}"
            )
        return f"pressures or torque seem late by {size} beside motor_speed: stamp them when they are read, {OR_ELSE}"
