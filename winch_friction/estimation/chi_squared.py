"""The distribution of chi squared for a whole number of degrees of freedom, in closed form.

The estimator asks for a few of its values in an hour. SciPy's, which a test compares these with, would cost every
node a fifth of a second of its start and twenty megabytes.
"""

import math

TOLERANCE = 1e-14  # of a quantile: a hundred times the rounding of a float
FARTHEST = 12.0  # of a Poisson distribution's deviations; a hundred thousand windows' terms are else a second's work


def survival(squares: float, count: int) -> float:
    """Probability that the sum of `count` >= 1 squares of standard normal numbers is at least `squares` >= 0.

    Abramowitz and Stegun, 26.4.4 (odd) and 26.4.5 (even): a finite sum of terms h^j exp(-h) / Gamma(j + 1) with
    h = squares / 2, here by their logarithms, so that none of them overflows.
    """
    if squares <= 0.0:
        return 1.0
    half, odd = 0.5 * squares, count % 2
    log_half = math.log(half)
    total = math.erfc(math.sqrt(half)) if odd else 0.0
    most = count // 2
    nearest = min(half, most)  # where the terms are largest; those far below are less than rounding
    for term in range(max(0, int(nearest - FARTHEST * math.sqrt(nearest) - FARTHEST)), most):
        j = term + 0.5 * odd
        total += math.exp(j * log_half - half - math.lgamma(j + 1.0))
    return min(total, 1.0)


def quantile(probability: float, count: int) -> float:
    """The sum of squares that is exceeded with 1 - `probability` (above 0, below 1), by halving an interval."""
    lower, upper = 0.0, float(count)
    while survival(upper, count) > 1.0 - probability:
        lower, upper = upper, 2.0 * upper
    while upper - lower > TOLERANCE * upper:
        middle = 0.5 * (lower + upper)
        if survival(middle, count) > 1.0 - probability:
            lower = middle
        else:
            upper = middle
    return 0.5 * (lower + upper)
