"""Is the filter as sure as it should be: the normalised innovation squared over windows (Bar-Shalom, section 5.4)."""

from functools import lru_cache

from scipy.stats import chi2

CONFIDENCE = 0.95


@lru_cache(maxsize=32)
def nis_band(samples: int) -> tuple[float, float]:
    """The 95 % band of the mean of `samples` independent NIS values of one measurement."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    return chi2.ppf(tail, samples) / samples, chi2.ppf(1.0 - tail, samples) / samples


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
