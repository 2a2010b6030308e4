"""The load on its elastic wire: the acceleration that the pressures feel, from the one that a rigid wire would give.

Stiffness k = EA / wire_out is known where the crane file and the log say so; the damping is nobody's datum and is
chosen by what leaves least swinging in the gap.
"""

from collections.abc import Callable, Iterable, Sequence
from copy import copy
from dataclasses import dataclass
from functools import partial

import numpy as np

from winch_friction.discrepancy.preparation.grid import smooth
from winch_friction.discrepancy.preparation.suspended_load import Hung, Mode, swinging_mass
from winch_friction.physics.signals import FloatArray

DAMPING_RATIOS = (0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.45, 0.65)
# m, tried where the log lacks it
WIRE_LENGTHS = (15.0, 22.0, 33.0, 50.0, 75.0, 110.0, 165.0, 250.0, 370.0, 550.0, 830.0, 1250.0)
FREQUENCY_STEPS = (1.1, 1.05, 1.025, 1.012, 1.006)
# of the stated stiffness, tried beside it: a rope's modulus is known to a tenth or two, `wire_out` does not count what
# hangs between drum and tip, and the crane itself gives. Taken where it leaves so much of what the stated one leaves
STIFFNESSES_NEARBY, CLEARLY_LESS = (0.42, 0.5, 0.6, 0.72, 0.85, 1.2, 1.4), 0.5
RATIOS_NEARBY = (0.035, 0.14, 0.3)  # damping ratios by which one of them is told from the others, at little cost
# down to what a mode of 3 % damping rings alike for; in all 5 %, as the stiffness follows a wire that is paid out by a
# tenth of its length: 1 % off in frequency left 0.7 bar where the noise was 0.18
TUNING_STEPS = (1.03, 1.015, 1.0075, 1.004, 1.002)
# a damping ratio's last step: over tabled ones, a third apart, the vertex is off by up to a tenth; 6 % left 0.5 bar of
# a soft rope's 3 where the noise was 0.2
NEARBY = 1.1
LENGTH_CHANGES = 0.01  # of its median: half a percent in frequency
LEAST_GAIN = 0.5  # of the swinging's variance, what a delay explains left out; below it the wire is taken for rigid
# no rope is damped more: a mode that is takes a motion sensor's noise out of the acceleration; and where the wire's
# length is unknown, a delay or a wrong inertia looks like a wire that is damped more or leaves more
MOST_DAMPED, MOST_LEFT = 0.5, 0.1
TURN = 2.0 * np.pi  # rad; a parabola over two periods of a mode follows what is slower than half of it
NOTHING_OWN = 1e-12  # of a column's size: what is left of it beside others is rounding
# rad a sample: a mode of four samples is still told from none, and one of six has its damping told
FOLLOWED, TOLD = 1.5, 1.0
# rad a sample: a mode is told by means over so many, which at its double are half a percent off; where short stretches
# count, by every sample, as means would keep less than this share of what counts
FINE, KEPT = 0.2, 0.5


@dataclass(frozen=True)
class Swing:
    """The wire's mode.

    `left` are the shares of the swinging that a mode of each of `DAMPING_RATIOS` would leave at its own or else at the
    stated frequency; empty where none is stated, or the samples cannot follow it. `variance` is that of all that may
    swing, (N m)^2. `noise`: what is faster than the stated mode in the load's acceleration is not in the gap, so that
    it tells of the sensors alone, and of no wire.
    """

    mode: Mode
    left: tuple[float, ...] = ()
    variance: float = 0.0
    noise: bool = False


def swinging_load(
    gap: FloatArray,
    counts: np.ndarray,
    rigid: FloatArray,
    dt: float,
    mass: float,
    lever: FloatArray,
    stiffnesses: Sequence[float],
    friction: FloatArray | None = None,
    hiding: FloatArray | None = None,
    length: FloatArray | None = None,
    share: float = 1.0,
) -> Swing:
    """The wire's mode that leaves least swinging in the gap.

    `gap` N m was made with the `rigid` acceleration m/s^2 of the load; `counts` marks the samples to judge by; `lever`
    m is drum radius over gear ratio, so that mass * lever * acceleration is a torque at the shaft. `friction`, shape
    (samples, columns), is what a missing effect may look like: its steps at reversals must not count as swinging.
    What is `hiding` a swing, columns as well, is beside it where nothing swings without. Where the wire's `length` m is
    known and changes, the stiffness follows it if that leaves less. Of the mass this `share` swings.
    """
    frequencies = tuple(_frequencies(stiffnesses, mass, dt))
    besides = [each for each in (friction, hiding) if each is not None]
    factor = int(FINE / (max(frequencies, default=np.inf) * dt))
    if factor > 1:
        whole = _over(factor, counts) == 1.0
        if whole.mean() >= KEPT * counts.mean():
            gap, rigid, lever, *besides = (_over(factor, each) for each in (gap, rigid, lever, *besides))
            length, dt = None if length is None else _over(factor, length), factor * dt
            counts = whole
    heavy = mass * lever

    def change(hung: Hung, frequency: float, ratio: float) -> FloatArray:
        return heavy * (rigid - hung.acceleration(frequency, ratio))

    judge = _Judge(gap, counts, partial(change, Hung(rigid, dt, None, share)), besides)
    first = min(len(besides), 1)
    if len(frequencies) == 1 and _changes(length):  # one that pays out twice its length swings by none in the middle
        followed = judge.of(partial(change, Hung(rigid, dt, length, share)))
        judge = min((judge, followed), key=lambda each: min(each.by_damping(first, frequencies[0])))
    for parts in range(first, len(besides) + 1):
        frequency, ratio = _mode(partial(judge.left, parts), frequencies)
        if ratio > 0.0:
            if len(frequencies) > 1:
                return Swing(Mode(frequency, ratio))
            lengths: list[FloatArray | None] = [None, *([length] if _changes(length) else [])]
            judges = [judge.of(partial(change, Hung(rigid, dt, own, share))) for own in lengths]
            tuned = [_tuned(partial(each.left, len(besides)), frequency, ratio) for each in judges]
            own = int(np.argmin([each.left(len(besides), *at) for each, at in zip(judges, tuned, strict=True)]))
            mode = Mode(*tuned[own], lengths[own] is not None if len(lengths) > 1 else None)
            return Swing(mode, judges[own].by_damping(first, mode.frequency), judge.swinging(first))
    variance = judge.swinging(first)
    if len(frequencies) != 1:
        return Swing(Mode(0.0, 0.0), (), variance)
    slow = smooth(rigid, int(2.0 * TURN / (frequencies[0] * dt)))
    noise = judge.swinging(first, heavy * (rigid - slow)) <= variance
    return Swing(Mode(0.0, 0.0), judge.by_damping(first, frequencies[0]), variance, noise)


def _over(samples: int, values: np.ndarray) -> FloatArray:
    """Means over so many samples each, without what is left at the end."""
    whole = len(values) // samples * samples
    return np.asarray(values[:whole].reshape(-1, samples, *values.shape[1:]).mean(axis=1))


def _mode(left: Callable[[float, float], float], frequencies: Sequence[float]) -> tuple[float, float]:
    """Frequency rad/s and damping ratio that leave least of the swinging; 0 and 0 where that is not little enough."""
    tried = [(*_best_ratio(partial(left, frequency)), frequency) for frequency in frequencies]
    value, ratio, frequency = min(tried, default=(1.0, 0.0, 0.0))
    if len(tried) == 1:
        value, ratio, frequency = _nearby(left, *tried[0])
    elif len(tried) > 1:
        inside = min(frequencies) < frequency < max(frequencies)
        frequency = _best_frequency(left, frequency, ratio)
        value, ratio = _best_ratio(partial(left, frequency))
        value = value if inside and ratio < MOST_DAMPED and value < MOST_LEFT else 1.0
    return (frequency, ratio) if value <= 1.0 - LEAST_GAIN else (0.0, 0.0)


def _nearby(
    left: Callable[[float, float], float], value: float, ratio: float, stated: float
) -> tuple[float, float, float]:
    """What is left, damping ratio and frequency rad/s of a mode near the stated one, where it clearly leaves less."""
    around = [stated * float(np.sqrt(share)) for share in STIFFNESSES_NEARBY]
    some, first = min((min(left(frequency, each) for each in RATIOS_NEARBY), frequency) for frequency in around)
    if some >= value or not around[0] < first < around[-1]:
        return value, ratio, stated
    found = _best_frequency(left, first, _best_ratio(partial(left, first))[1])
    less, damped = _best_ratio(partial(left, found))
    return (less, damped, found) if less < CLEARLY_LESS * value and damped < MOST_DAMPED else (value, ratio, stated)


def _changes(length: FloatArray | None) -> bool:
    """Whether a wire of this length m changes by so much of it that its mode does."""
    if length is None or float(np.min(length)) <= 0.0:
        return False
    return bool(np.ptp(length) > LENGTH_CHANGES * np.median(length))


def _tuned(left: Callable[[float, float], float], frequency: float, ratio: float) -> tuple[float, float]:
    """Frequency rad/s and damping ratio nearby that leave least, beside an inertia that may be wrong."""
    for steps in (TUNING_STEPS, TUNING_STEPS[-2:]):  # a frequency that is off makes the damping look larger than it is
        for step in steps:
            frequency = min((frequency, frequency / step, frequency * step), key=lambda each: left(each, ratio))
        ratio = _between(partial(left, frequency), _best_ratio(partial(left, frequency))[1])
    return frequency, ratio


def _best_ratio(left: Callable[[float], float]) -> tuple[float, float]:
    """What is left and the damping ratio that leaves least: the vertex of a parabola over the logarithm, through the
    grid's best."""
    values = np.array([left(ratio) for ratio in DAMPING_RATIOS])
    k = int(np.argmin(values))
    if not 0 < k < len(values) - 1:
        return float(values[k]), DAMPING_RATIOS[k]
    at = np.log(DAMPING_RATIOS[k - 1 : k + 2])
    curve = np.polyfit(at, values[k - 1 : k + 2], 2)
    return float(values[k]), float(np.exp(-0.5 * curve[1] / curve[0]))


def least_left(left: Sequence[float]) -> float:
    """The least share that a damping between those tried would leave, of what each of these leaves: a load that swings
    so sharply leaves three times as much a step beside its own. Not below nothing."""
    k = int(np.argmin(left))
    if k in (0, len(left) - 1):
        return left[k]
    bend, slope, least = np.polyfit(
        np.log(np.array(DAMPING_RATIOS[k - 1 : k + 2]) / DAMPING_RATIOS[k]), left[k - 1 : k + 2], 2
    )
    return max(float(least - slope**2 / (4.0 * bend)), 0.0) if bend > 0.0 else left[k]


def _between(left: Callable[[float], float], ratio: float) -> float:
    """The damping ratio that leaves least about a first guess: the parabola's vertex once more, from so near that what
    is left is one, and no farther off than it was asked."""
    near = np.log(NEARBY) * np.array([-1.0, 0.0, 1.0])
    bend, slope, _ = np.polyfit(near, [left(ratio * float(np.exp(each))) for each in near], 2)
    return ratio * float(np.exp(np.clip(-0.5 * slope / bend, near[0], near[-1]))) if bend > 0.0 else ratio


def _best_frequency(left: Callable[[float, float], float], frequency: float, ratio: float) -> float:
    """The frequency near a first guess that leaves least, to half a percent."""
    for step in FREQUENCY_STEPS:
        frequency = min((frequency / step, frequency, frequency * step), key=lambda each: left(each, ratio))
    return frequency


class _Judge:
    """How much of a gap swings beside what other causes may add, a level of its own in each stretch of motion left out.

    `change` makes the torque N m that a mode's frequency and damping ratio put into the gap. The causes come in parts
    of columns, one after the other: of what a mode leaves, its square and its components along the causes are kept, so
    that a part more costs nothing.
    """

    def __init__(
        self,
        gap: FloatArray,
        counts: np.ndarray,
        change: Callable[[float, float], FloatArray],
        besides: Sequence[FloatArray],
    ) -> None:
        self._samples = np.flatnonzero(counts)
        self._begins = np.flatnonzero(np.diff(self._samples, prepend=-2) > 1)
        self._sizes = np.diff(self._begins, append=len(self._samples))
        self._gap = self._levelled(gap)
        self._change = change
        self._widths = np.cumsum([0] + [each.shape[1] for each in besides])
        self._axes = self._orthonormal([column for each in besides for column in each.T])
        self._rigid = self._components(self._gap)
        self._whole = [self._variance(parts, self._rigid) for parts in range(len(self._widths))]
        self._seen: dict[tuple[float, float], tuple[float, FloatArray]] = {}

    def of(self, change: Callable[[float, float], FloatArray]) -> "_Judge":
        """The same samples and the same beside them, for another change that a mode makes."""
        other = copy(self)
        other._change, other._seen = change, {}
        return other

    def left(self, parts: int, frequency: float, ratio: float) -> float:
        """The share of the swinging's variance that a mode leaves beside the first so many parts."""
        if (frequency, ratio) not in self._seen:
            changed = self._gap + self._levelled(self._change(frequency, ratio))
            self._seen[frequency, ratio] = self._components(changed)
        return self._variance(parts, self._seen[frequency, ratio]) / self._whole[parts]

    def by_damping(self, parts: int, frequency: float) -> tuple[float, ...]:
        """The shares that a mode of each of `DAMPING_RATIOS` leaves."""
        return tuple(self.left(parts, frequency, ratio) for ratio in DAMPING_RATIOS)

    def swinging(self, parts: int, change: FloatArray | None = None) -> float:
        """The variance of which these are shares; with the `change` of a torque N m in the gap, if given."""
        own = self._rigid if change is None else self._components(self._gap + self._levelled(change))
        return self._variance(parts, own)

    def _variance(self, parts: int, components: tuple[float, FloatArray]) -> float:
        square, along = components
        return max(square - float(np.sum(along[: self._widths[parts]] ** 2)), 0.0) / len(self._samples) + 1e-12

    def _components(self, values: FloatArray) -> tuple[float, FloatArray]:
        return float(values @ values), self._axes @ values

    def _orthonormal(self, columns: Sequence[FloatArray]) -> FloatArray:
        """A unit axis for each column, at right angles to those before; nothing for one that they make up. (axes,
        samples)"""
        if not columns:
            return np.empty((0, len(self._samples)))
        levelled = np.column_stack([self._levelled(each) for each in columns])
        axes, upper = np.linalg.qr(levelled)
        sizes = np.array([np.linalg.norm(each[self._samples]) for each in columns])
        axes[:, np.abs(np.diag(upper)) <= NOTHING_OWN * sizes] = 0.0
        return np.ascontiguousarray(axes.T)

    def _levelled(self, values: FloatArray) -> FloatArray:
        own = values[self._samples]
        own -= np.repeat(np.add.reduceat(own, self._begins) / self._sizes, self._sizes)
        return own


def _frequencies(stiffnesses: Sequence[float], mass: float, dt: float) -> Iterable[float]:
    for stiffness in stiffnesses:
        frequency = float(np.sqrt(stiffness / mass)) if mass > 0.0 and np.isfinite(stiffness) else np.inf
        if frequency * dt < FOLLOWED:  # faster than the samples can follow is rigid to them
            yield frequency


def swing_share(hanging: float, wire: float) -> float:
    """Share of what hangs that swings, where `wire` kg of it are its own: the effective mass of the first mode (Clough
    and Penzien) of a wire stretched evenly. The load swings in full, a piece of the wire by how far down it hangs."""
    swinging = swinging_mass(hanging, wire)
    return (hanging - 0.5 * wire) ** 2 / (hanging * swinging) if swinging < hanging else 1.0


def wire_stiffnesses(elastic_modulus_area: float, wire_out: FloatArray | None) -> tuple[float, ...]:
    """Stiffness in N/m to try: from the wire paid out, or over usual lengths where the log lacks it."""
    if wire_out is not None:
        return (elastic_modulus_area / max(float(np.median(wire_out)), 1.0),)
    return tuple(elastic_modulus_area / length for length in WIRE_LENGTHS)
