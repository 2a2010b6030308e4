"""Held-out losses per segment: coefficients from the other runs, judged on tens of seconds at a time.

And where else a search may begin when adding one effect after the other has led where more than noise is left.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot, first_halves
from winch_friction.discrepancy.engine.problem import Problem
from winch_friction.discrepancy.thresholds import LIMITS

AT_BOUND = 0.999  # of a bound: nearer to it the fit was stopped there


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
        folds = int(self.fold.max(initial=-1)) + 1
        self.sums_g, self.sums_b = np.empty((folds, *self.total_g.shape)), np.empty((folds, *self.total_b.shape))
        for k in range(folds):
            own_g, own_b = g.total(k)
            np.subtract(self.total_g, own_g, out=self.sums_g[k])
            np.subtract(self.total_b, own_b, out=self.sums_b[k])
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
        if columns not in self._fits and slots:
            self.fit_beside(slots[:-1], slots[-1:])
        elif columns not in self._fits:
            start = self.problem.layout.inside(columns)
            self._fits[columns] = self._with_loss(columns, self.problem.fit(self.total_g, self.total_b, columns, start))
        return self._fits[columns]

    def fit_beside(self, rest: Sequence[Slot], slots: Sequence[Slot]) -> None:
        """Fit every one of these beside the rest to all training runs, those of as many columns at once: what
        `train_loss` gives of them then is known. Most bounds of the rest are where they are without them."""
        first, start = self.problem.columns(rest), self.train_loss(rest)[1]
        new = dict.fromkeys(own.columns for own in slots if (*first, *own.columns) not in self._fits)
        for width in {len(columns) for columns in new}:
            others = [columns for columns in new if len(columns) == width]
            found = self.problem.fits_beside(self.total_g, self.total_b, first, others, start)
            for own, beta in zip(others, found, strict=True):
                self._fits[*first, *own] = self._with_loss((*first, *own), beta)

    def _with_loss(self, columns: Sequence[int], beta: FloatArray) -> tuple[float, FloatArray]:
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
        left_out = self.problem.fits(self.sums_g, self.sums_b, columns, beta)
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
