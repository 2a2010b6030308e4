"""What is believed: which innovations, which motion teaches, and whether the filter is as sure as it should be."""

import math
from functools import lru_cache

from winch_friction.estimation import chi_squared
from winch_friction.estimation.config import EstimatorConfig

RESTART_AFTER = 10  # rejections in a row that mean the filter was wrong, not the sensor
CONFIDENCE = 0.95  # of the band of the consistency check
OUTLIER = 9.0  # NIS; a single sample counts no more for the noise factor: 3 sigma
SMALLEST_FACTOR, LARGEST_FACTOR = 0.05, 100.0  # of the noise variances: stated noises are wrong by tens at most
WIDE_GATE, WIDE_FOR = 3.0, 2.0  # the gate is so many times wider for so long, s, after it shut out a run of samples


class InnovationGate:
    """Admits innovations within so many sigma; counts those in a row that it did not admit."""

    def __init__(self, config: EstimatorConfig) -> None:
        self._config = config
        self._rejected_in_a_row = self._accepted_in_a_row = self._shut_out = 0
        self._wide_until = -math.inf

    @property
    def exhausted(self) -> bool:
        """Whether so many were rejected in a row that the speed must be taken as measured."""
        return self._rejected_in_a_row >= RESTART_AFTER

    @property
    def exhausted_again(self) -> bool:
        """Whether the wide gate after that admitted no run of samples either: it is not the speed that was wrong."""
        return self.exhausted and self._shut_out > 0

    def admits(self, time: float, innovation: float, variance: float) -> bool:
        """Whether an innovation in rad/s of this variance is believed at `time` s; NaN is not."""
        return variance > 0.0 and abs(innovation) <= self._width(time) * math.sqrt(variance)

    def _width(self, time: float) -> float:
        """How many sigma an innovation may have.

        A seed far outside its own sigma is first blamed on the load and then, at the first reversal, contradicted by
        every sample of that direction. A gate that goes on rejecting them would learn one direction for good.
        """
        wide = self._wide_until - WIDE_FOR <= time <= self._wide_until
        return self._config.gate * (WIDE_GATE if wide else 1.0)

    def rejected(self, innovation: float) -> None:
        """A sample was rejected; one without an innovation (NaN) says nothing about the filter."""
        self._rejected_in_a_row += math.isfinite(innovation)
        self._accepted_in_a_row = 0

    def accepted(self) -> None:
        """A sample was accepted."""
        self._rejected_in_a_row = 0
        self._accepted_in_a_row += 1
        if self._accepted_in_a_row >= RESTART_AFTER:  # what is taken anew may be so unsure that one passes
            self._shut_out = 0

    def restarted(self, time: float) -> None:
        """The speed was taken as measured at `time` s."""
        if self.exhausted:
            self._wide_until = time + WIDE_FOR
            self._shut_out += 1
        self._rejected_in_a_row = 0


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


@lru_cache(maxsize=32)
def nis_band(samples: int) -> tuple[float, float]:
    """The 95 % band of the mean of `samples` independent NIS values of one measurement."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    return chi_squared.quantile(tail, samples) / samples, chi_squared.quantile(1.0 - tail, samples) / samples


class VarianceFactor:
    """A common factor of all noise variances that follows what the innovations show (covariance matching, Mehra 1970).

    Noise figures are known to a factor at best; their ratios matter for the gain, their size for the sigmas. The
    check of
    the NIS then tells whether that factor is steady over windows shorter than its time constant, not how large it is.
    """

    def __init__(self, time_constant: float) -> None:
        self._time_constant = time_constant
        self.value = 1.0

    def step(self, nis: float, dt: float) -> None:
        """Take one NIS, `dt` s after the last; a single outlier counts no more than 3 sigma."""
        change = (min(nis, OUTLIER) - 1.0) * min(1.0, dt / self._time_constant)
        self.value = min(max(self.value * (1.0 + change), SMALLEST_FACTOR), LARGEST_FACTOR)


class Consistency:
    """Means of the NIS over consecutive windows, and the share of them inside the 95 % band."""

    def __init__(self, window: int) -> None:
        self.window = window
        self._sum = 0.0
        self._count = 0
        self.windows = 0
        self.inside = 0
        self.last_mean = 1.0
        self._band = nis_band(window)  # not when the first window closes: for the largest it takes a while

    def step(self, nis: float) -> None:
        """Take one value."""
        self._sum += nis
        self._count += 1
        if self._count == self.window:
            self._close()

    def _close(self) -> None:
        lower, upper = self._band
        self.last_mean = self._sum / self._count
        self.windows += 1
        self.inside += lower <= self.last_mean <= upper
        self._sum, self._count = 0.0, 0

    @property
    def share_inside(self) -> float:
        """Share of closed windows inside the band; 1 before the first."""
        return self.inside / self.windows if self.windows else 1.0
