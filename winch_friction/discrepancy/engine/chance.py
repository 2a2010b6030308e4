"""What may be chance: the size of a residual, a gain, a rival's place behind what was found, and what is left.

What is left is asked of a flexible model of one signal at a time, for each direction of motion, which predicts the
remainder of runs that it was not fitted to: hat functions, or a straight line for signals of which each run has hardly
more than one value. It has no name to offer, so it only ever leads to 'unexplained'.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks, Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, flip_p_values
from winch_friction.discrepancy.engine.trials import candidate_trials, charged, fitted, heads, in_order
from winch_friction.discrepancy.thresholds import LIMITS


# -- how large a residual is
def rms(values: FloatArray) -> float:
    """Root mean square; 0 of nothing."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0


@dataclass(frozen=True)
class Size:
    """A root mean square with its 95 % interval over redrawn runs and segments."""

    value: float
    interval: tuple[float, float]


def rms_with_interval(residual: FloatArray, segment: np.ndarray, run: np.ndarray, rng: np.random.Generator) -> Size:
    """RMS of block residuals; the interval redraws runs, and in them whole segments, because neighbours are alike."""
    if not len(residual):
        return Size(0.0, (0.0, 0.0))
    sums, counts, of_run = _by_segment(residual**2, segment, run)
    weights = _redrawn(of_run, rng)
    draws = np.sqrt((weights @ sums) / np.maximum(weights @ counts, 1.0))
    low, high = np.quantile(draws, LIMITS.interval)
    value = float(np.sqrt(sums.sum() / counts.sum()))
    return Size(value, (min(float(low), value), max(float(high), value)))


def chance_of_no_gain(
    before: FloatArray, after: FloatArray, segment: np.ndarray, run: np.ndarray, rng: np.random.Generator
) -> float:
    """How often redrawn segments show no reduction of the sum of squares from `before` to `after`; paired, so that what
    both have in common does not blur the difference.
    """
    if not len(before):
        return 1.0
    gains, _, of_run = _by_segment(before**2 - after**2, segment, run)
    weights = _redrawn(of_run, rng)
    return float((1 + np.sum(weights @ gains <= 0.0)) / (1 + len(weights)))


def _by_segment(values: FloatArray, segment: np.ndarray, run: np.ndarray) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Sums and counts per segment, and the run that each belongs to."""
    _, first, index = np.unique(segment, return_index=True, return_inverse=True)
    sums, counts = np.bincount(index, weights=values), np.bincount(index)
    return np.asarray(sums, float), np.asarray(counts, float), run[first]


def _redrawn(of_run: np.ndarray, rng: np.random.Generator) -> FloatArray:
    """How often each segment is drawn, shape (draws, segments).

    Runs with replacement, then segments in each; of a few runs, unlike by plan, each stays in and only its segments are
    redrawn: an interval over three unlike runs would hold anything.
    """
    runs, draws = np.unique(of_run), LIMITS.bootstrap_draws
    times = np.ones((draws, len(runs)), int)
    if len(runs) >= LIMITS.runs_to_redraw:
        times = rng.multinomial(len(runs), np.full(len(runs), 1.0 / len(runs)), size=draws)
    weights = np.zeros((draws, len(of_run)))
    for k, number in enumerate(runs):
        own = np.flatnonzero(of_run == number)
        drawn = rng.multinomial(times[:, k] * len(own), np.full(len(own), 1.0 / len(own)))
        weights[:, own] = drawn
    return weights


# -- rivals of what was found
REDRAWS = 200  # of segments: how often an effect wins is known to 0.035, and only said


def rivals_of(
    cross: CrossFit, current: Explanation, without: Explanation, k: int, rng: np.random.Generator, same: bool = False
) -> tuple[tuple[Slot, ...], float]:
    """Effects that do as well in the place of the k-th, the best first and laws before curves; and how often it wins
    when segments are redrawn.

    With `same` only what is the same column in these runs, such as a tare at one load and a torque offset.
    """
    rest = current.slots[:k] + current.slots[k + 1 :]
    own = current.slots[k]
    slots = fitted(cross, rest, current.names)
    every = [cross.explain((*rest, slot)) for slot in slots]
    trials = heads(cross, without.loss, every)
    if own.free:  # of each cause the law that speaks for it, and a curve of its own that leaves less
        trials += [each for each in _closest(every) if all(each is not head for head in trials)]
    equal: list[tuple[float, Slot]] = []
    for trial in trials:
        alike = abs(trial.loss - current.loss) <= LIMITS.plain_first * (without.loss - current.loss)
        rival = does_as_well(trial, current, without, rng) or _near_curve(cross, trial, current, without, k)
        taken = trial.slots[-1].name in {slot.name for _, slot in equal}
        if not taken and (alike if same else rival):
            equal.append((charged(without.loss, trial.loss, trial.slots[-1]), trial.slots[-1]))
    frequency = 1.0 if same else _frequency(current.losses, [t.losses for t in trials], rng)
    order = in_order(cross, [loss for loss, _ in equal], [slot for _, slot in equal])
    return tuple(equal[k][1] for k in order if equal[k][1] is not own), frequency


def _closest(trials: Sequence[Explanation]) -> list[Explanation]:
    """Of each cause's laws the one that leaves least."""
    found: dict[str, Explanation] = {}
    for trial in sorted(trials, key=lambda each: each.loss):
        found.setdefault(trial.slots[-1].name, trial)
    return list(found.values())


def _near_curve(cross: CrossFit, trial: Explanation, current: Explanation, without: Explanation, k: int) -> bool:
    """Whether the k-th effect is a curve and a law of another cause leaves less than twice as much above the floor: a
    curve outdoes laws by its flexibility, of its own cause as well as of others.
    """
    if not current.slots[k].free or trial.slots[-1].free:
        return False
    if without.loss - trial.loss < LIMITS.rival_worth * (without.loss - current.loss):
        return False
    return LIMITS.outdone * (trial.loss - cross.floor) <= current.loss - cross.floor


def near(cross: CrossFit, current: Explanation) -> list[Slot]:
    """What stands in for one of a set's effects nearly as well: worth a closer look at its shape before it is said not
    to be a rival, and of the effect's own cause, where more than noise is left, before another law of it is said to be
    the worse one."""
    leaves = cross.excess(current) > LIMITS.least_excess
    found: list[Slot] = []
    for k, taken in enumerate(current.slots):
        if taken.plain:  # it comes first anyhow
            continue
        rest = current.slots[:k] + current.slots[k + 1 :]
        without = cross.explain(rest)
        worth = without.loss - current.loss
        trials = [cross.explain((*rest, slot)) for slot in fitted(cross, rest, {each.name for each in rest})]
        trials = [each for each in trials if without.loss - each.loss >= LIMITS.rival_worth * worth]
        as_good = [each.slots[-1] for each in sorted(trials, key=lambda one: one.loss)]
        own = [slot for slot in as_good if slot.name == taken.name and slot.law != taken.law and not slot.free]
        others = [slot for slot in as_good if slot.name != taken.name]
        found += own[: LIMITS.looked_at_closer] if leaves else []
        found += others[: LIMITS.looked_at_closer]
    return found


def most_of_it(cross: CrossFit, base: Explanation) -> Slot | None:
    """What takes more off a gap than anything else and a good part of it, though not surely: one size for what grows in
    every record is too much in its first half and too little in its second. None where nothing is missing."""
    if cross.excess(base) <= LIMITS.least_excess:
        return None
    best = min(candidate_trials(cross, base, set()), key=lambda each: each.loss, default=base)
    enough = base.loss - best.loss >= LIMITS.proposal_gain * (base.loss - cross.floor)
    return best.slots[-1] if enough else None


def does_as_well(trial: Explanation, current: Explanation, without: Explanation, rng: np.random.Generator) -> bool:
    """Whether another effect in the place of one, `without` neither, is no worse on held-out data."""
    worth = without.loss - current.loss
    worse = trial.losses - current.losses
    if without.loss - trial.loss < LIMITS.rival_worth * worth:
        return False
    return bool(flip_p_values(worse[None], rng)[0] > LIMITS.rival_p or worse.sum() < LIMITS.rival_share * worth)


def _frequency(own: FloatArray, others: Sequence[FloatArray], rng: np.random.Generator) -> float:
    """How often an effect leaves no more than the best of the others when segments are redrawn."""
    if not others:
        return 1.0
    weights = rng.multinomial(len(own), np.full(len(own), 1.0 / len(own)), size=REDRAWS)
    rival = (weights @ np.array(others).T).min(axis=1)
    return float(np.mean(weights @ own <= rival * (1.0 + 1e-12)))


# -- whether anything is left
@dataclass(frozen=True)
class Dependence:
    """How much of the remainder one signal predicts on held-out runs."""

    signal: str
    share: float  # of the remainder's sum of squares
    p_value: float
    size: float = float("inf")  # RMS of what it predicts, in the gap's unit


def dependences(cross: CrossFit, left: FloatArray, rng: np.random.Generator) -> list[Dependence]:
    """Every signal with what it predicts of the remainder on held-out runs, the best first; p-values are
    family-wise."""
    blocks = cross.problem.blocks
    names, gains = [], []
    for name, values in blocks.features.items():
        for design in _designs(values, blocks.direction):
            names.append(name)
            gains.append(_segment_gains(design, left, cross))
    if not names:
        return []
    table = np.array(gains)
    p = flip_p_values(table, rng)
    total = float((left**2).sum()) + cross.unresolved
    unit = float(np.mean(blocks.weight**-2.0)) / len(left)  # from noises to the gap's unit, squared
    found = [
        Dependence(n, float(row.sum() / total), float(q), float(np.sqrt(max(row.sum(), 0.0) * unit)))
        for n, row, q in zip(names, table, p, strict=True)
    ]
    better: dict[str, Dependence] = {}
    for each in sorted(found, key=lambda each: -each.share):
        better.setdefault(each.signal, each)
    return list(better.values())


def _designs(values: FloatArray, direction: FloatArray) -> list[FloatArray]:
    """Hats over the quantiles of a signal and a straight line, hoisting and lowering apart; where the signal is absent,
    nothing."""
    good = np.isfinite(values)
    if not varies(values[good], 1e-9):  # of its size: what varies by less is constant but for rounding
        return []
    line = np.column_stack([np.ones(len(values)), (values - values[good].mean()) / np.std(values[good])])
    knots = np.unique(np.quantile(values[good], np.linspace(0.0, 1.0, LIMITS.knots)))
    hats = [np.interp(np.where(good, values, knots[0]), knots, row) for row in np.eye(len(knots))]
    return [_by_direction(each, good, direction) for each in (line, np.column_stack(hats))]


def _by_direction(columns: FloatArray, good: np.ndarray, direction: FloatArray) -> FloatArray:
    known = np.where(good[:, None], columns, 0.0)
    return np.column_stack([known * (direction > 0)[:, None], known * (direction < 0)[:, None]])


def _segment_gains(design: FloatArray, left: FloatArray, cross: CrossFit) -> FloatArray:
    """Reduction of each segment's sum of squares by a ridge fit to the other folds."""
    weight, fold = cross.problem.blocks.weight, cross.fold_of_block
    weighted = design * weight[:, None]
    scale = np.sqrt(np.mean(weight**2))
    ridge = LIMITS.ridge * scale**2 * np.eye(design.shape[1])
    full_h, full_g = weighted.T @ weighted, weighted.T @ left
    predicted = np.zeros(len(left))
    for k in np.unique(fold):
        own = fold == k
        h = full_h - weighted[own].T @ weighted[own]
        g = full_g - weighted[own].T @ left[own]
        predicted[own] = weighted[own] @ np.linalg.solve(h + ridge, g)
    return cross.problem.grams.by_segment(left**2 - (left - predicted) ** 2)


def least_part(cross: CrossFit, every: Explanation, names: Iterable[str]) -> float:
    """Of the held-out loss that an explanation saves, the share that is lost without one of its names: the least."""
    saved = max(cross.explain(()).loss - every.loss, 1e-9)
    rests = [tuple(slot for slot in every.slots if slot.name != name) for name in names]
    return min((cross.explain(rest).loss - every.loss) / saved for rest in rests)


def levels_of_runs(left: FloatArray, blocks: Blocks) -> dict[int, float]:
    """By run, what it keeps whatever the motion: the middle of both ways, of which friction opposes either. None of a
    run of one way, where nobody tells a level from friction."""
    found = {}
    for k in np.unique(blocks.run):
        ways = [left[(blocks.run == k) & (blocks.direction == sign)] for sign in (1.0, -1.0)]
        if all(map(len, ways)):
            found[int(k)] = float(np.mean([each.mean() for each in ways]))
    return found


def chance_of_zero_mean(values: FloatArray) -> float:
    """Two-sided p-value of Student's test that independent values have no mean."""
    from scipy.stats import ttest_1samp  # a third of a second, for few runs come here

    return float(ttest_1samp(values, 0.0).pvalue)


def chance_of_order(one: FloatArray, other: FloatArray) -> float:
    """Two-sided p-value of Spearman's test that two signals, one pair of values by run, have no order in common; 1
    where either is the same in every run."""
    from scipy.stats import spearmanr  # a third of a second, for few runs come here

    if min(np.ptp(one), np.ptp(other)) <= 0.0:
        return 1.0
    return float(spearmanr(one, other).pvalue)


def sign_flip_p_value(gains: FloatArray) -> float:
    """Sign-flip p-value of a positive mean gain over segments."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(LIMITS.flips, len(gains)))
    return float((1 + (signs @ gains >= gains.sum()).sum()) / (1 + LIMITS.flips))


FEWEST_TOLD = 20  # blocks, four seconds of a signal


def varies(values: FloatArray, least: float) -> bool:
    """Whether a signal's known values are enough to tell of it, and differ by more than so much of their size."""
    return len(values) >= FEWEST_TOLD and bool(np.ptp(values) > least * (np.abs(values).max() + 1e-12))
