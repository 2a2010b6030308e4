"""The noise of a record, from the data alone: what a parabola over two seconds leaves of them.

A parabola follows any friction, load or wave, and takes of twelve blocks a share that is known where their noise is
white. A slow log has few samples in a block: its torque is smoothed as its speed is, and a mean over three of them, as
the difference of that is; a transducer's filter, longer than a sample, joins more. That is a first-order autoregression
(Box and Jenkins, Time Series Analysis, chapter 3) behind weights that are known: how neighbours go together in what is
left tells its correlation, and that the share. Of a quick log the same was tried and is not done: what the parabola
leaves of an effect goes on as well, and of 150 drawn sets three lost their names for a floor 4 to 18 % higher.
"""

from collections.abc import Sequence
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import gammaincinv

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS

FEWEST_WINDOWS = 20  # fewer do not tell a correlation from none: then the kernel alone is known
MOST = 0.6  # correlation from sample to sample, 0.4 s at 5 Hz: slower filters than that are no transducer's
DRAWS = 10_000  # windows: the shares to 1 %
NOT_ZERO, TINY = 1e-300, 1e-200  # against a division by nothing, where nothing moves, and its square


class Made(NamedTuple):
    """How a block is made: `samples` apart from the next, of samples around it by their weights."""

    samples: int
    weights: tuple[float, ...]


def noise_of_run(
    values: FloatArray, position: np.ndarray, least: float = LIMITS.least_noise, skew: FloatArray | None = None,
    made: Made | None = None,
) -> float:  # fmt: skip
    """Standard deviation of the block noise, same unit as `values`; `position` numbers the blocks on their grid.

    A hundredth of what no balance closes better than, `least`, is as good as noise-free. `skew`, one column
    or several, is what signals out of step leave in the values: in a quick sea it turns within the windows, no noise.
    How blocks are `made` tells what the windows do not see of it; where nobody says they are white.
    """
    return noise_of_runs([values], [position], [least], [skew], [made])[0]


def noise_of_runs(
    values: Sequence[FloatArray], positions: Sequence[np.ndarray], least: Sequence[float] | FloatArray,
    skews: Sequence[FloatArray | None], made: Sequence[Made | None],
) -> list[float]:  # fmt: skip
    """The same of several runs. How noise goes from block to block is told of all whose blocks are made alike: forty
    seconds of one do not tell it, and its weight beside the others would be left to chance."""
    made = alike(made)
    quick = [_quick(*each) for each in zip(values, positions, skews, strict=True)]
    seen = {
        how: seen_of(np.concatenate([_levelled(q) for q, own in zip(quick, made, strict=True) if own == how]), how)
        for how in set(made)
    }
    return [
        max(_quiet(q) / seen[how] if len(q) else _of_neighbours(v), LIMITS.noise_floor * float(limit))
        for q, how, v, limit in zip(quick, made, values, least, strict=True)
    ]


def alike(made: Sequence[Made | None]) -> list[Made | None]:
    """How the blocks of runs that are weighed beside each other are made: of none where one is quick.

    A slow log's noise would be told whole and a quick one's, which goes on as well, in part: the runs at a creeping
    speed, which a drive logs at 4 Hz where it logs quick ones at 20, would be those that count less.
    """
    return [None] * len(made) if None in made else list(made)


def _quick(values: FloatArray, position: np.ndarray, skew: FloatArray | None) -> FloatArray:
    """What a parabola, and what is out of step, leave of windows of blocks that follow each other."""
    windows, projector = _windows(values, position), _projector()
    quick = windows @ projector
    if skew is None or not len(quick):
        return quick
    each = [_windows(column, position) @ projector for column in np.atleast_2d(skew.T)]
    along = np.column_stack([own.ravel() / max(float(np.abs(own).max()), NOT_ZERO) for own in each])
    return quick - (along @ np.linalg.lstsq(along, quick.ravel(), rcond=None)[0]).reshape(quick.shape)


def _quiet(quick: FloatArray) -> float:
    """Standard deviation of white blocks that leave so much: the quieter windows speak."""
    freedom = LIMITS.noise_window - LIMITS.noise_order - 1
    # that quantile of chi-squared, per degree of freedom
    expected = 2.0 * gammaincinv(0.5 * freedom, LIMITS.noise_quiet) / freedom
    return float(np.sqrt(np.quantile((quick**2).sum(axis=1) / freedom, LIMITS.noise_quiet) / expected))


def _of_neighbours(values: FloatArray) -> float:
    return float(np.std(np.diff(values)) / np.sqrt(2.0)) if len(values) > 2 else 0.0


def _levelled(quick: FloatArray) -> FloatArray:
    """Windows in terms of the run's own middle: a loud run's quiet windows are as quiet as a quiet one's."""
    return quick / max(float(np.sqrt(np.median((quick**2).sum(axis=1)))), NOT_ZERO) if len(quick) else quick


def _windows(values: FloatArray, position: np.ndarray) -> FloatArray:
    window = LIMITS.noise_window
    starts = range(0, len(values) - window + 1, window // 2)
    found = [values[k : k + window] for k in starts if position[k + window - 1] - position[k] == window - 1]
    return np.array(found).reshape(-1, window)


@cache
def _projector() -> FloatArray:
    """What takes a parabola out of a window."""
    grid = np.vander(np.linspace(-1.0, 1.0, LIMITS.noise_window), LIMITS.noise_order + 1)
    return np.asarray(np.eye(LIMITS.noise_window) - grid @ np.linalg.pinv(grid))


def seen_of(quick: FloatArray, made: Made | None) -> float:
    """The share of a noise's deviation that quiet windows tell, beside that of white blocks.

    `quick` (windows, blocks) is what a parabola left of them.
    """
    if made is None:
        return 1.0
    together, shares = _of_correlations(made)
    told = quick[(quick**2).sum(axis=1) > TINY]
    return float(np.interp(_neighbours(told), together, shares)) if len(told) >= FEWEST_WINDOWS else float(shares[0])


def _neighbours(left: FloatArray) -> float:
    """How neighbours go together in the quieter half of the windows: an effect or a ringing may fill the others."""
    square = (left**2).sum(axis=1)
    quiet = left[square <= np.median(square)]
    return float(np.mean((quiet[:, 1:] * quiet[:, :-1]).sum(axis=1) / (quiet**2).sum(axis=1)))


@lru_cache(maxsize=16)
def _of_correlations(made: Made) -> tuple[FloatArray, FloatArray]:
    """For correlations from 0 on: how neighbours go together in quiet windows, and the share that these tell.

    Of the same draws for all: there is no formula, for what is left has fewer degrees of freedom the more is taken.
    """
    p, size = _projector(), LIMITS.noise_window
    drawn = np.random.default_rng(0).standard_normal((DRAWS, size))
    # of the differences of two samples of two blocks, as far as both reach
    own = np.convolve(made.weights, made.weights)
    reach = np.arange(len(own)) - len(own) // 2
    apart = made.samples * np.abs(np.subtract.outer(np.arange(size), np.arange(size)))
    white = float(np.sqrt(np.quantile(((drawn @ p) ** 2).sum(axis=1), LIMITS.noise_quiet)))
    found = []
    for correlation in np.linspace(0.0, MOST, 13):
        covariance = (own * correlation ** np.abs(apart[..., None] + reach)).sum(axis=-1)
        left = drawn @ np.linalg.cholesky(covariance / covariance[0, 0]).T @ p
        quiet = float(np.sqrt(np.quantile((left**2).sum(axis=1), LIMITS.noise_quiet)))
        found.append((_neighbours(left), quiet / white))
    together, shares = np.array(found).T
    return together, shares
