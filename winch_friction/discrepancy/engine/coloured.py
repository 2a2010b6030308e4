"""How much of a log's noise is left in windows less a parabola, where it goes from block to block.

A parabola takes of twelve blocks a share that is known where their noise is white. What a transducer filters over a
block and longer, or a winch makes so slowly, goes from one to the next, and a slow log has few samples in a block: its
torque is smoothed as its speed is, and a mean over three of them, as the difference of that is. That is a first-order
autoregression (Box and Jenkins, Time Series Analysis, chapter 3) behind weights that are known: how neighbours go
together in what is left tells its correlation, and that the share.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.thresholds import LIMITS

FEWEST_WINDOWS = 20  # fewer do not tell a correlation from none: then the kernel alone is known
MOST = 0.6  # correlation from block to block, 0.4 s: slower filters than that are no transducer's
DRAWS = 10_000  # windows: the shares to 1 %
TINY = 1e-300  # against a division by nothing


class Made(NamedTuple):
    """How a block is made: `samples` apart from the next, of samples around it by their weights; one of many samples
    counts as one."""

    samples: int
    weights: tuple[float, ...]


def seen_of(quick: FloatArray, projector: FloatArray, made: Made | None) -> float:
    """The share of a noise's deviation that quiet windows tell, beside that of white blocks.

    `quick` (windows, blocks) is what the `projector` (blocks, blocks) left of them; where nobody says how they are
    `made` they are white.
    """
    if made is None:
        return 1.0
    together, shares = _of_correlations(projector.tobytes(), len(projector), made)
    square = (quick**2).sum(axis=1)
    told = quick[square > TINY]
    if len(told) < FEWEST_WINDOWS:
        return float(shares[0])
    return float(np.interp(_neighbours(told), together, shares))


def _neighbours(left: FloatArray) -> float:
    """How neighbours go together in the quieter half of the windows: an effect or a ringing may fill the others."""
    square = (left**2).sum(axis=1)
    quiet = left[square <= np.median(square)]
    return float(np.mean((quiet[:, 1:] * quiet[:, :-1]).sum(axis=1) / (quiet**2).sum(axis=1)))


@lru_cache(maxsize=16)
def _of_correlations(projector: bytes, size: int, made: Made) -> tuple[FloatArray, FloatArray]:
    """For correlations from 0 on: how neighbours go together in quiet windows, and the share that these tell.

    Of the same draws for all: there is no formula, for what is left has fewer degrees of freedom the more is taken.
    """
    p = np.frombuffer(projector).reshape(size, size)
    drawn = np.random.default_rng(0).standard_normal((DRAWS, size))
    own = np.convolve(
        made.weights, made.weights
    )  # of the differences of two samples of two blocks, as far as both reach
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
