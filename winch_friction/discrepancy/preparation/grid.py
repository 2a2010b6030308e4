"""A run's columns on one uniform grid of time: holes marked, channels smoothed without delay, spikes found.

Recursive filters over a whole record are banded triangular systems: `scipy.signal.lfilter` gives the same to rounding,
but importing it brings scipy.stats and scipy.optimize, half a second of every `gap`.
"""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.linalg.blas import dtbsv
from scipy.ndimage import convolve1d, maximum_filter1d, median_filter

from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import WORTH_SAYING, FloatArray, Run, layer_changes
from winch_friction.physics.winch import Crane

MIN_SAMPLES = 10  # below it not even a speed can be smoothed
# samples of one record, and of all that are searched together (twelve of 200 s at 100 Hz are 240 000); s, of 80 Hz
LONG_RECORD, MANY_SAMPLES, FASTEST_PERIOD = 60_000, 300_000, 0.0125
MOST_EMPTY = 5_000_000  # samples of a grid most of which nobody logged; a day of 50 Hz
HOLE = 5.0  # sampling periods without a sample
# the standard deviation of a normal variable over the median of its magnitude, and that of third differences of white
# noise, of weights 1, 3, 3, 1, over its own
OF_MEDIAN, THIRD_DIFFERENCE = 1.4826, float(np.sqrt(20.0))
FEWEST_FOR_NOISE = 8  # samples, five third differences
# of the second differences' deviation, that counts as noise at least: an encoder's steps may be so rare that the median
# of the third differences sees none
RARE_STEPS = 0.1
FEWEST_LEVELS = 50  # of a channel: of fewer that are spread by chance over 100 bar, two may lie 0.15 bar apart
SMOOTHING_TIME = 0.3  # s: short against a wave, long against an encoder's step
FEWEST_SMOOTHED = 5  # samples: a parabola through fewer smooths nothing
WIDE = 61  # samples of a window
USUAL_PERIOD = 0.02  # s, at which the widening for noise was found
MAX_WIDENING = 3.0  # times: 0.9 s, which takes a thousandth off a wave of four seconds
FINE_NOISE = 2e-3  # share of the largest speed that the shortest window copes with
FEEDBACK_RESOLUTION = 2e-4  # of its largest value; 0.04 bar at 200 bar are nobody's effect
STEPPED = 4.0  # times its noise, that a feedback may be off its smoothed value by chance, once in 16 000 samples
SPIKE, SPIKE_WINDOW, MOST_SPIKES = 12.0, 2.0, 0.01  # robust deviations, s, share of the moving samples
SPIKE_MARGIN = 0.1  # s left out on both sides
FEWEST_FOR_SPIKES = 100  # samples


@dataclass(frozen=True)
class Grid:
    """Columns over a uniform time from 0, the sampling period in s, and which samples were measured."""

    columns: dict[str, FloatArray]
    dt: float
    valid: np.ndarray

    @property
    def time(self) -> FloatArray:
        """Seconds from the first sample."""
        return self.columns["time"]


def uniform(run: Run, before: tuple[Run, Grid] | None = None) -> Grid:
    """The run between its samples linearly; raises `InputError` for a run that is too short or out of order. What it
    has in common with a run whose grid was made `before` is held once."""
    time = run.time - run.time[0]
    if len(time) < MIN_SAMPLES:
        raise InputError(f"{run.name}: only {len(time)} samples; at least {MIN_SAMPLES} are needed")
    steps = np.diff(time)
    if not np.isfinite(time).all() or steps.min() <= 0.0:
        raise InputError(f"{run.name}: column 'time' is not increasing; sort or repair the file")
    dt = float(np.median(steps))
    if time[-1] / dt > max(MOST_EMPTY, 10 * len(time)):
        leap = int(np.argmax(steps))
        raise InputError(
            f"{run.name}: column 'time' leaps by {steps[leap]:.4g} s at {run.time[leap]:.14g} s, and there are "
            f"{len(time)} samples of {time[-1]:.4g} s: split the file there"
        )
    told = before if before is not None and before[0].time is run.time else None
    old, known = ({}, {}) if told is None else (told[0].columns, told[1].columns)
    grid = known["time"] if known else np.arange(0.0, time[-1] + 0.5 * dt, dt)
    even = len(grid) == len(time) and np.abs(grid - time).max() < 1e-3 * dt
    valid = np.ones(len(grid), bool)
    columns: dict[str, FloatArray] = {"time": grid}
    for name, values in run.columns.items():
        good = np.isfinite(values)
        if name == "time" or not good.any():
            continue
        if name in known and old[name] is values:
            columns[name] = known[name]
        else:
            columns[name] = values if even and good.all() else np.interp(grid, time[good], values[good])
        if not good.all():
            valid &= np.interp(grid, time, (~good).astype(float)) < 0.5
    for k in np.flatnonzero(steps > HOLE * dt):
        valid &= ~((grid > time[k]) & (grid < time[k + 1]))
    return Grid(columns, dt, valid)


def noise_level(values: FloatArray) -> float:
    """Standard deviation of the fast noise of a record, from its third differences (robust against steps)."""
    if len(values) < FEWEST_FOR_NOISE:
        return 0.0
    third = np.diff(values, 3)
    return float(OF_MEDIAN * np.median(np.abs(third - np.median(third))) / THIRD_DIFFERENCE)


def digit_of(values: FloatArray) -> float:
    """The step by which a channel is written, where its values stand there more than once; 0 where none can be told."""
    known = values[np.isfinite(values)]
    levels = np.unique(known)
    if len(levels) < FEWEST_LEVELS or 2 * len(levels) > len(known):
        return 0.0
    return float(np.diff(levels).min())


def overlaps(spans: Iterable[tuple[float, float]], share: float = 1.0) -> int:
    """How many of the runs that begin and end so, in s, begin before this share of the one before has passed."""
    pairs = itertools.pairwise(sorted(spans))
    return sum(later <= (1.0 - share) * began + share * ended for (began, ended), (later, _) in pairs)


def smooth(values: FloatArray, window: int, order: int = 2) -> FloatArray:
    """Savitzky-Golay over a uniform grid; records shorter than the window get a shorter one."""
    window = min(window, len(values) - (1 - len(values) % 2)) | 1
    inside, begin, end = _weights(window, min(order, window - 1))
    wide = window >= WIDE and len(values) >= window  # then a product of vectors is up to three times as fast
    smoothed = np.convolve(values, inside, "same") if wide else convolve1d(values, inside, mode="constant")
    half = window // 2
    smoothed[:half] = begin @ values[:window]
    smoothed[len(values) - half :] = end @ values[-window:]
    return smoothed


def smooth_between_steps(values: FloatArray, window: int, widest: int) -> FloatArray:
    """A set point's feedback over the widest window that still follows it: where it bends by more than its noise within
    the widest, over the narrower one, and where it steps within that, as it was logged."""
    noise = max(noise_level(values), FEEDBACK_RESOLUTION * float(np.abs(values).max()))
    found = values
    for samples in (window, widest):
        smoothed = smooth(values, samples)
        astray = np.abs(smoothed - values) > STEPPED * noise
        found = np.where(maximum_filter1d(astray, samples), found, smoothed)
    return found


SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0  # the mean over two periods that a slow log's torque is


def smoothing_of(window: int) -> FloatArray:
    """The weights of `smooth` inside a record, symmetric, (window,)."""
    return _weights(window | 1, min(2, window - 1))[0]


@lru_cache(maxsize=256)
def _weights(window: int, order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Of a parabola through the samples around one, and at both ends: `savgol_filter` makes them at each call."""
    powers = np.vander(np.linspace(-1.0, 1.0, window), order + 1)
    fitted = powers @ np.linalg.pinv(powers)
    return fitted[window // 2], fitted[: window // 2], fitted[window // 2 + 1 :]


def beside_climbs(runs: Sequence[Run], crane: Crane) -> tuple[list[Run], list[str]]:
    """The runs that have something to tell beside the places where a rope climbs onto another layer, and what is said
    of those that lose much or all to them."""
    kept, notes = [], []
    for run in runs:
        found = layer_changes(run, crane.gear_ratio, crane.speed_scale)
        left = (1.0 - found.near) * float(run.time[-1] - run.time[0])  # s
        if found.near < WORTH_SAYING:
            kept.append(run)
        elif left < LIMITS.shortest_record:
            notes.append(f"{found.lost(run.name)}; left out")
        else:
            notes.append(found.lost(run.name))
            kept.append(run)
    return kept, notes


def thinned(runs: Sequence[Run]) -> list[Run]:
    """Fast records, where one is long or all together are many samples, as means over an eightieth of a second at most:
    friction knows nothing faster."""
    many = sum(map(len, runs)) >= MANY_SAMPLES
    return [_thinned(run) if many or len(run) >= LONG_RECORD else run for run in runs]


def _thinned(run: Run) -> Run:
    count, steps = len(run), np.diff(run.time)
    if not count > 1 or not np.isfinite(steps).all() or steps.min() <= 0.0:
        return run
    factor = int(FASTEST_PERIOD / float(np.median(steps)) + 1e-6)
    if factor < 2:
        return run
    whole = count // factor * factor
    columns = {name: values[:whole].reshape(-1, factor).mean(axis=1) for name, values in run.columns.items()}
    return replace(run, columns=columns, aside={})


def samples_of(seconds: float, dt: float, fewest: int = FEWEST_SMOOTHED) -> int:
    """An odd number of samples that lasts about so long."""
    return max(int(seconds / dt + 1e-6), fewest) | 1


def speed_window(speed: FloatArray, dt: float) -> int:
    """Window for a speed record in samples: longer where the encoder is coarse."""
    scale = float(np.percentile(np.abs(speed), 99)) or 1.0
    noise = max(noise_level(speed), float(np.std(np.diff(speed, 2))) * RARE_STEPS if len(speed) > 3 else 0.0)
    relative = noise / scale * np.sqrt(dt / USUAL_PERIOD)  # the more samples a window holds, the more it averages out
    widening = min(max((relative / FINE_NOISE) ** (2.0 / 3.0), 1.0), MAX_WIDENING)
    return samples_of(SMOOTHING_TIME * widening, dt)


def dilated(mask: np.ndarray, samples: int) -> np.ndarray:
    """A mask that also covers `samples` neighbours on both sides."""
    if samples <= 0 or not mask.any():
        return mask
    count = np.convolve(mask.astype(float), np.ones(2 * samples + 1))[samples : samples + len(mask)]
    return count > 0.5


def spikes_of(gap: FloatArray, moving: np.ndarray, dt: float) -> np.ndarray:
    """Samples to leave out; none where there are so many that they are no spikes."""
    none = np.zeros(len(gap), bool)
    if moving.sum() < FEWEST_FOR_SPIKES:
        return none
    size = max(int(SPIKE_WINDOW / dt), 3) | 1
    coarse = max(size // 25, 1)  # a running median over every few samples is as good and much faster
    slow = np.interp(
        np.arange(len(gap)), np.arange(0, len(gap), coarse), median_filter(gap[::coarse], max(size // coarse, 3))
    )
    off = np.abs(gap - slow)
    spread = OF_MEDIAN * float(np.median(off[moving]))
    found = moving & (off > SPIKE * max(spread, 1e-12))
    return dilated(found, int(SPIKE_MARGIN / dt)) if 0 < found.sum() < MOST_SPIKES * moving.sum() else none


# -- recursive filters
def recursive(before: Sequence[FloatArray | float], driven: FloatArray) -> FloatArray:
    """y with y[k] + sum_i before_i y[k-i] = driven[k] from rest, shape (samples,), i from 1; `driven` is overwritten.

    Weights are numbers or another at every sample k, shape (samples,).
    """
    bands = np.zeros((len(driven), len(before) + 1)).T
    for i, weight in enumerate(before, 1):
        bands[i, : len(driven) - i] = weight[i:] if isinstance(weight, np.ndarray) else weight
    return np.asarray(dtbsv(len(before), bands, driven, lower=1, diag=1, overwrite_x=1))


def lagged(x: FloatArray, dt: float, time_constant: float) -> FloatArray:
    """First-order lag of samples `dt` apart, exact for values held over a step; settled before the first of them."""
    keep = float(np.exp(-dt / time_constant))
    return x[0] + recursive([-keep], (1.0 - keep) * (x - x[0]))
