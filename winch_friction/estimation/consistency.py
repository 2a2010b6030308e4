"""Is the filter as sure as it should be: the normalised innovation squared over windows (Bar-Shalom, section 5.4)."""

from functools import lru_cache

from scipy.stats import chi2

CONFIDENCE = 0.95
OUTLIER = 9.0
SMALLEST_FACTOR, LARGEST_FACTOR = 0.05, 100.0


@lru_cache(maxsize=32)
def nis_band(samples: int) -> tuple[float, float]:
    """The 95 % band of the mean of `samples` independent NIS values of one measurement."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    return chi2.ppf(tail, samples) / samples, chi2.ppf(1.0 - tail, samples) / samples


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

    def step(self, nis: float) -> None:
        """Take one value."""
        self._sum += nis
        self._count += 1
        if self._count == self.window:
            self._close()

    def _close(self) -> None:
        lower, upper = nis_band(self.window)
        self.last_mean = self._sum / self._count
        self.windows += 1
        self.inside += lower <= self.last_mean <= upper
        self._sum, self._count = 0.0, 0

    @property
    def share_inside(self) -> float:
        """Share of closed windows inside the band; 1 before the first."""
        return self.inside / self.windows if self.windows else 1.0
