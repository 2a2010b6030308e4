"""Held-out losses per segment: coefficients from the other runs, judged on tens of seconds at a time.

What a search puts to them: of each law its best variant and of each family its best law, and where else it may begin
when adding one effect after the other has led where more than noise is left.
"""

from collections.abc import Container, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot, first_halves
from winch_friction.discrepancy.engine.problem import Problem
from winch_friction.discrepancy.thresholds import LIMITS

AT_BOUND = 0.999  # of a bound: nearer to it the fit was stopped there
THE_SAME = 1e-5  # of the held-out loss: a thousand times its rounding; laws that are one over these runs


@dataclass(frozen=True)
class Explanation:
    """A set of effects with its held-out losses per segment and its fit to all training runs.

    `left_out` holds the coefficients of each fit that left one fold out, shape (folds, columns).
    """

    slots: tuple[Slot, ...]
    losses: FloatArray
    beta: FloatArray
    train_loss: float
    left_out: FloatArray

    @property
    def loss(self) -> float:
        """Summed held-out loss in units of the noise."""
        return float(self.losses.sum())

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects; one whose law is a mixture of two is one effect."""
        return tuple(dict.fromkeys(slot.name for slot in self.slots))


def on_their_own(slots: Sequence[Slot]) -> list[Slot]:
    """Those of a name of their own: not what a bare model lacks, nor what another of them always brings along."""
    return [own for own in slots if not own.plain and not any(own.name in each.brings for each in slots)]


class CrossFit:
    """Folds of a problem, with the sums that make each fit independent of the number of samples."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        g = problem.grams
        self.fold = g.fold
        self.total_g, self.total_b = g.total()
        self.total_y2 = float(g.y2.sum())
        self.unresolved = float(problem.unresolved.sum())
        self.sums = []
        for k in range(self.fold.max(initial=-1) + 1):
            own_g, own_b = g.total(k)
            self.sums.append((self.total_g - own_g, self.total_b - own_b))
        self.fold_of_block = g.of_segments(g.fold)
        # a search asks for most sets three times; each answer keeps its slots alive, so that an id stays one slot's
        self._fits: dict[tuple[int, ...], tuple[float, FloatArray]] = {}
        self._explained: dict[tuple[int, ...], Explanation] = {}

    @property
    def floor(self) -> float:
        """Loss of an explanation that leaves the noise and what matters to nobody."""
        return float(self.problem.grams.count.sum()) + self.unresolved

    def excess(self, explanation: "Explanation") -> float:
        """What an explanation leaves of held-out blocks above the noise and what matters to nobody, per noise
        variance."""
        return (explanation.loss - self.floor) / float(self.problem.grams.count.sum())

    def inside_excess(self, explanation: "Explanation", where: np.ndarray | slice = slice(None)) -> float:
        """The same of the blocks that it was fitted to, or of those of them that `where` chooses."""
        left = self.remainder(explanation)[where]
        return float(np.mean(left**2 - 1.0 - self.problem.unresolved[where]))

    def train_loss(self, slots: Sequence[Slot]) -> tuple[float, FloatArray]:
        """Loss and coefficients of a fit to all training runs."""
        columns = self.problem.columns(slots)
        if columns not in self._fits:
            # beside what the others are without the last: most of their bounds are found already
            rest = np.empty(0) if not slots else self.train_loss(slots[:-1])[1]
            self._fits[columns] = self._fit(columns, rest)
        return self._fits[columns]

    def _fit(self, columns: tuple[int, ...], rest: FloatArray) -> tuple[float, FloatArray]:
        start = np.concatenate([rest, self.problem.layout.inside(columns[len(rest) :])])
        beta = self.problem.fit(self.total_g, self.total_b, columns, start)
        index = np.asarray(columns)
        loss = self.total_y2 - 2.0 * self.total_b[index] @ beta + beta @ self.total_g[np.ix_(index, index)] @ beta
        beta.setflags(write=False)  # it is given out again
        return float(loss), beta

    def explain(self, slots: Sequence[Slot]) -> Explanation:
        """Held-out losses of a set of effects."""
        key = tuple(map(id, slots))
        if key not in self._explained:
            self._explained[key] = self._explain(slots)
        return self._explained[key]

    def _explain(self, slots: Sequence[Slot]) -> Explanation:
        columns = self.problem.columns(slots)
        loss, beta = self.train_loss(slots)
        fits = [self.problem.fit(sum_g, sum_b, columns, beta) for sum_g, sum_b in self.sums]
        left_out = np.reshape(fits, (-1, len(columns)))
        left = self._left(columns, left_out[self.fold_of_block])
        return Explanation(tuple(slots), self.problem.grams.by_segment(left**2), beta, loss, left_out)

    def _left(self, columns: Sequence[int], beta: FloatArray) -> FloatArray:
        """What coefficients of all blocks (c,), or of each its own (blocks, c), leave of it in units of the noise."""
        blocks = self.problem.blocks
        x = blocks.x[:, list(columns)]
        return np.asarray((blocks.y - np.einsum("bc,bc->b", x, np.broadcast_to(beta, x.shape))) * blocks.weight)

    def at_bound(self, explanation: Explanation, slot: Slot) -> bool:
        """Whether one of its effects would be larger than is believed, if it might."""
        columns, upper = list(self.problem.columns(explanation.slots)), self.problem.layout.upper
        most = [upper[c] if slot.plain else slot.most for c in slot.columns]
        sizes = [abs(explanation.beta[columns.index(c)]) for c in slot.columns]
        return any(size >= AT_BOUND * limit for size, limit in zip(sizes, most, strict=True))

    def size(self, explanation: Explanation, slot: Slot) -> float:
        """How large the first of an effect's amplitudes is in an explanation that has it, in its own unit."""
        at = list(self.problem.columns(explanation.slots)).index(slot.columns[0])
        return float(explanation.beta[at] * self.problem.layout.scales[slot.columns[0]])

    def covariance(self, explanation: Explanation) -> FloatArray:
        """Covariance of an explanation's coefficients, data and prior."""
        return self.problem.covariance(self.total_g, self.problem.columns(explanation.slots))

    def remainder(self, explanation: Explanation) -> FloatArray:
        """What an explanation leaves of the gap, block by block, in units of the noise."""
        return self._left(self.problem.columns(explanation.slots), explanation.beta)

    def gain(self, before: Explanation, after: Explanation) -> FloatArray:
        """Share of the held-out error that `after` saves, beside what matters to nobody."""
        return self._saved(before.loss, after.loss)

    def inside_gain(self, before: Explanation, after: Explanation) -> FloatArray:
        """The same on the runs that both were fitted to."""
        return self._saved(before.train_loss, after.train_loss)

    def _saved(self, before: float, after: float) -> FloatArray:
        return np.asarray(1.0 - np.sqrt((after + self.unresolved) / (before + self.unresolved)))

    def jackknife_p_value(self, explanation: Explanation) -> float:
        """Two-sided p-value of the last effect's amplitude, from how much it changes when a fold is left out.

        Student's t of the delete-one jackknife (Efron and Stein 1981). The amplitude of an effect with several columns
        is the projection of its torque on that of the fit to all runs. 1 for few runs, whose stretches are too alike.
        """
        if len(np.unique(self.problem.grams.run)) < LIMITS.fewest_runs:
            return 1.0
        own = list(explanation.slots[-1].columns)
        at = slice(-len(own), None)
        weights = self.total_g[np.ix_(own, own)] @ explanation.beta[at]
        amplitude = explanation.left_out[:, at] @ weights
        folds = len(amplitude)
        spread = float(np.sqrt((folds - 1) / folds * ((amplitude - amplitude.mean()) ** 2).sum()))
        if not spread > 0.0:
            return 1.0
        return float(2.0 * stdtr(folds - 1, -abs(amplitude.mean()) / spread))


def flip_p_values(gains: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Family-wise p-values of mean gain > 0 for rows of `gains` (candidates, segments), by sign flips and the
    largest t."""
    scale = np.sqrt((gains**2).sum(axis=1))
    scale = np.where(scale > 0.0, scale, 1.0)
    observed = gains.sum(axis=1) / scale
    signs = rng.choice([-1.0, 1.0], size=(LIMITS.flips, gains.shape[1]))
    largest = ((signs @ gains.T) / scale).max(axis=1)
    return (1.0 + (largest[:, None] >= observed).sum(axis=0)) / (1.0 + LIMITS.flips)


# -- candidates beside what is taken already
def candidate_trials(cross: CrossFit, current: Explanation, taken: Container[str]) -> list[Explanation]:
    """Every candidate that is not taken added to the set: of each law the variant that fits the training runs best, of
    each family the law that does best on held-out runs.
    """
    slots = fitted(cross, current.slots, taken)
    return heads(cross, current.loss, [cross.explain((*current.slots, slot)) for slot in slots])


def fitted(cross: CrossFit, rest: Sequence[Slot], taken: Container[str], by_part: bool = False) -> list[Slot]:
    """Of each law of each candidate, with `by_part` of each of the things that it may speak of, the variant that fits
    the training runs best beside the rest."""
    best: dict[tuple[str, str, str], tuple[float, Slot]] = {}
    for slot in cross.problem.slots:
        if slot.name in taken or any(slot is each for each in rest):
            continue
        loss, _ = cross.train_loss((*rest, slot))
        key = (slot.name, slot.law, slot.part if by_part else "")
        if key not in best or loss < best[key][0]:
            best[key] = (loss, slot)
    return [slot for _, slot in best.values()]


def reshaped(cross: CrossFit, slots: Sequence[Slot]) -> tuple[Slot, ...]:
    """The same laws, each in the shape that fits the training runs best beside the others: the one that a law had may
    have been chosen beside an effect that is gone."""
    shaped = list(slots)
    for k, own in enumerate(slots):
        rest = [*shaped[:k], *shaped[k + 1 :]]
        law = own.name, own.law, own.part
        alike = [each for each in cross.problem.slots if (each.name, each.law, each.part) == law]
        shaped[k] = min((own, *alike), key=lambda each: cross.train_loss((*rest, each))[0])
    return tuple(shaped)


def heads(cross: CrossFit, before: float, trials: Sequence[Explanation]) -> list[Explanation]:
    """The best member of each family by held-out loss; a free one only where no law does nearly as well."""
    families: dict[str, list[Explanation]] = {}
    for trial in sorted(trials, key=lambda each: charged(before, each.loss, each.slots[-1])):
        families.setdefault(trial.slots[-1].name, []).append(trial)
    return [_head(cross, members) for members in families.values()]


def _head(cross: CrossFit, members: Sequence[Explanation]) -> Explanation:
    """Of one cause's laws, the best first, that which speaks for it: the first, or the curve that leaves less than half
    of what that one leaves above the floor, if this is more than nothing.

    Between two causes flexibility costs a share of what is explained, for it imitates; within one it is how a law
    differs from the literature's, and what counts is what is left.
    """
    first = members[0]
    left = first.loss - cross.floor
    if first.slots[-1].free or left <= LIMITS.least_excess * float(cross.problem.grams.count.sum()):
        return first
    closer = min((each for each in members if each.slots[-1].free), key=lambda each: each.loss, default=first)
    return closer if closer.loss - cross.floor < LIMITS.outdone * left else first


def charged(before: float, after: float, own: Slot) -> float:
    """Held-out loss, of which a flexible member has to give back a share of what it saves, and whatever is not plain
    the least share that decides between two that do the same, for each of its parameters."""
    share = LIMITS.free_charge if own.free else 0.0 if own.plain else LIMITS.plain_first * len(own.columns)
    return after + share * max(before - after, 0.0)


def in_order(cross: CrossFit, losses: Sequence[float], slots: Sequence[Slot]) -> list[int]:
    """Effects from the least charged loss on; of those that come to the same the one that is listed first leads, which
    is a cause's own law before its others: rounding is no reason for a name, nor for a place in a set.
    """
    listed = {id(slot): k for k, slot in enumerate(cross.problem.slots)}
    first = [listed.get(id(slot), len(listed)) for slot in slots]
    ordered: list[int] = []
    left = sorted(range(len(slots)), key=lambda k: (losses[k], first[k]))
    while left:
        level = losses[left[0]] * (1.0 + THE_SAME)
        ties = [k for k in left if losses[k] <= level]
        ordered += sorted(ties, key=lambda k: first[k])
        left = left[len(ties) :]
    return ordered


# -- where else to begin
def other_start(cross: CrossFit, current: Explanation) -> Explanation | None:
    """The set to begin from once more, the own law of the catalogue for its first cause alone, where this has another
    law and more than noise is left: a bent law takes what belongs to a second effect, and no exchange of one for one
    finds back."""
    if not current.slots or not current.slots[0].law or cross.excess(current) <= LIMITS.least_excess:
        return None
    own = [slot for slot in cross.problem.slots if slot.name == current.slots[0].name]
    trials = [cross.explain((slot,)) for slot in own if not slot.law and not slot.plain]
    return min(trials, key=lambda each: each.loss, default=None)


def far_less(cross: CrossFit, anew: Explanation, current: Explanation) -> bool:
    """Whether a set of no more laws leaves half of what another does at most, or one of more leaves noise.

    Laws and not causes: around two laws of one cause that leave more than noise the next preparation is no better.
    """
    few = len(anew.slots) <= len(current.slots) or cross.excess(anew) <= LIMITS.least_excess
    return few and anew.loss - cross.floor <= LIMITS.outdone * (current.loss - cross.floor)


def same_columns(cross: CrossFit, slot: Slot) -> list[Slot]:
    """Other shapes of the same law whose columns are the same over the training runs."""
    x = cross.problem.blocks.x
    alike = [each for each in cross.problem.slots if (each.name, each.law) == (slot.name, slot.law)]
    own = x[:, slot.columns]
    return [each for each in alike if each.columns != slot.columns and np.array_equal(x[:, each.columns], own)]


def left_of_first_halves(locked: CrossFit, explanation: Explanation) -> float:
    """Sum of squares, in units of the noise, that an explanation of the training runs leaves of the first half of every
    locked run."""
    left = locked.remainder(explanation)
    return float((left[first_halves(locked.problem.blocks)] ** 2).sum())
