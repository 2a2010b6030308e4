"""The regression that every question is put to: a gap on base parameters, held to their prior, and candidates.

Its weights are the independent noise of a record, from the data alone: a parabola over two seconds follows any
friction, load or wave, and what remains is sensor noise, whatever model is tried. No fit of candidates takes part,
because a rich fit that lacks the true law would whiten the effect away. Its solution is exact: an unconverged descent
would corrupt held-out losses.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from scipy.linalg.lapack import dposv

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks, Grams, RunBlocks, Slot, grams, joined
from winch_friction.discrepancy.engine.noise import noise_of_runs
from winch_friction.discrepancy.thresholds import LIMITS

# -- least squares inside a box, of many small problems at once: to begin one takes longer than to solve it
_TOLERANCE = 1e-10
_PATIENCE = 3  # rounds without progress after which one coefficient alone changes sides
_ROUNDS = 2  # per coefficient, and ten: fits of a search take three in all, those that rounding leads astray end there


def bounded_fit(
    h: FloatArray, g: FloatArray, lower: FloatArray, upper: FloatArray, start: FloatArray | None = None
) -> FloatArray:
    """Minimise b'Hb/2 - g'b for lower <= b <= upper; see `bounded_fits`, of which this is one."""
    return bounded_fits(h[None], g[None], lower, upper, start)[0]


def bounded_fits(
    h: FloatArray, g: FloatArray, lower: FloatArray, upper: FloatArray, start: FloatArray | None = None
) -> FloatArray:
    """Minimise b'Hb/2 - g'b for lower <= b <= upper, of k problems each by itself: shape (k, n).

    `h` (k, n, n) symmetric positive definite, `g` (k, n); bounds and `start` (n,) or (k, n). `start`: a guess, whose
    active bounds are tried first. Exact up to rounding, by block principal pivoting (Judice and Pires 1994): all
    coefficients that break a condition change sides at once. Where rounding leads it in circles, as columns that are
    all but tied do, BVLS takes over.
    """
    found, size = np.empty(g.shape), g.shape[1]
    lower, upper = np.broadcast_to(lower, g.shape), np.broadcast_to(upper, g.shape)
    low = np.zeros(g.shape, bool) if start is None else start <= lower
    high = np.zeros(g.shape, bool) if start is None else start >= upper
    own = np.arange(len(g))  # the problems that are not solved yet
    fewest, patience = np.full(len(g), size + 1), np.full(len(g), _PATIENCE)
    for _ in range(_ROUNDS * size + 10):
        beta, fixed = np.where(low, lower, np.where(high, upper, 0.0)), low | high
        beta = _at_optimum(h, g, beta, fixed)
        below, above = beta < lower, beta > upper
        wrong = below | above
        if fixed.any():
            gradient = np.einsum("kij,kj->ki", h, beta) - g
            limit = _TOLERANCE * (1.0 + np.abs(gradient).max(axis=1, keepdims=True))
            wrong |= (low & (gradient < -limit)) | (high & (gradient > limit))
        count = np.count_nonzero(wrong, axis=1)
        going = count > 0
        found[own[~going]] = beta[~going]
        if not going.any():
            return found
        better = count < fewest
        one = ~better & (patience == 0)
        patience = np.where(better, _PATIENCE, patience - ~one)
        fewest = np.where(better, count, fewest)
        for k in one.nonzero()[0]:
            wrong[k, : wrong[k].nonzero()[0][-1]] = False
        low, high = np.where(wrong, below, low), np.where(wrong, above, high)
        if not going.all():
            own, h, g, low, high, lower, upper, fewest, patience = (
                each[going] for each in (own, h, g, low, high, lower, upper, fewest, patience)
            )
    for k, each in zip(own, zip(h, g, lower, upper, strict=True), strict=True):
        found[k] = _slowly(*each)
    return found


def _at_optimum(h: FloatArray, g: FloatArray, beta: FloatArray, fixed: np.ndarray) -> FloatArray:
    """The coefficients with the free ones at their optimum beside the others, which are kept by equations of their
    own."""
    rights, lefts = g, h
    if fixed.any():
        pushed = g - np.einsum("kij,kj->ki", h, beta) if beta.any() else g  # the free ones are zero here
        rights = np.where(fixed, beta, pushed)
        lefts = np.where(fixed[:, :, None] | fixed[:, None, :], np.eye(g.shape[1]), h)
    for k, (left, right) in enumerate(zip(lefts, rights, strict=True)):
        _, solution, failed = dposv(left.T, right)  # at these sizes `np.linalg.solve` takes twice as long to begin
        beta[k] = np.linalg.solve(left, right) if failed else solution
    return beta


def _slowly(h: FloatArray, g: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """The same by BVLS on a square root of `h`, which halves the digits that tied columns cost."""
    from scipy.optimize import lsq_linear  # a fifth of a second, and few fits come here

    beta, wide = lower.astype(float), upper - lower >= _TOLERANCE
    values, vectors = np.linalg.eigh(h[np.ix_(wide, wide)])
    root = np.sqrt(np.maximum(values, np.finfo(float).eps * values[-1]))
    target = vectors.T @ (g[wide] - h[np.ix_(wide, ~wide)] @ lower[~wide]) / root
    box, most = (lower[wide], upper[wide]), 20 * len(g) + 20
    beta[wide] = lsq_linear(root[:, None] * vectors.T, target, box, method="bvls", tol=1e-14, max_iter=most).x
    return beta


# -- the regression
TINY = 1e-9  # numerical: keeps a column without any data out of singularity
RIDGE = 1e-6  # numerical: of a column's own sum of squares


@dataclass(frozen=True)
class Base:
    """The base model's parameters as regression columns in units of their prior standard deviation."""

    names: tuple[str, ...]
    parameters: int  # the first so many are the model's; what else may move within ordinary bounds follows
    scale: FloatArray
    shift: FloatArray  # expansion point minus seed, sigma
    lower: FloatArray
    upper: FloatArray
    skew: int | None = None  # column of what signals out of step leave, which is never taken for noise


@dataclass(frozen=True)
class Layout:
    """Columns of base and candidates: their scales and bounds."""

    base: Base
    slots: tuple[Slot, ...]
    scales: FloatArray  # physical value of one unit of each column
    lower: FloatArray
    upper: FloatArray
    bending: FloatArray | None = None  # of curves, shape (columns, columns); None: there is none

    def only(self, slots: Sequence[Slot]) -> "tuple[Layout, tuple[Slot, ...]]":
        """The layout of the base and of these candidates alone, and the candidates' places in it."""
        count = len(self.base.names)
        own = list(range(count)) + [c for slot in slots for c in slot.columns]
        placed, at = [], count
        for slot in slots:
            placed.append(replace(slot, columns=tuple(range(at, at + len(slot.columns)))))
            at += len(slot.columns)
        bending = None if self.bending is None else self.bending[np.ix_(own, own)]
        small = Layout(self.base, tuple(placed), self.scales[own], self.lower[own], self.upper[own], bending)
        return small, tuple(placed)

    def inside(self, columns: Sequence[int] | np.ndarray) -> FloatArray:
        """Coefficients of these columns that are next to nothing, but at none of their bounds, to start a fit from."""
        index = np.asarray(columns, int)
        lower, upper = self.lower[index], self.upper[index]
        off = RIDGE * np.minimum(upper - lower, 1.0)
        return np.clip(np.zeros(index.shape), lower + off, upper - off)

    def slot_like(self, other: Slot) -> Slot:
        """The slot of the same candidate and shape as one of another layout."""
        own = (other.name, other.law, other.label)
        return next(each for each in self.slots if (each.name, each.law, each.label) == own)


@dataclass(frozen=True)
class Problem:
    """Gram matrices over the records at hand with the columns of everything that may be fitted."""

    layout: Layout
    blocks: Blocks
    grams: Grams
    noise: dict[int, float]  # in the gap's unit, per record
    least_noise: FloatArray | None = None  # per record; what is smaller matters to nobody

    @property
    def base(self) -> Base:
        """The base's parameters."""
        return self.layout.base

    @property
    def slots(self) -> tuple[Slot, ...]:
        """Every candidate in every shape."""
        return self.layout.slots

    @property
    def base_columns(self) -> tuple[int, ...]:
        """Columns of the base parameters."""
        return tuple(range(len(self.base.names)))

    @property
    def unresolved(self) -> FloatArray:
        """Variance in units of the noise that each block's remainder may have beyond it without mattering."""
        if self.least_noise is None:
            return np.zeros(len(self.blocks.y))
        noise = np.array([self.noise[k] for k in range(len(self.noise))])
        return np.maximum((self.least_noise / noise) ** 2 - 1.0, 0.0)[self.blocks.run]

    @property
    def matters(self) -> float:
        """Size in the gap's unit below which what is left matters to nobody."""
        return 0.0 if self.least_noise is None else float(np.min(self.least_noise))

    def columns(self, slots: Sequence[Slot]) -> tuple[int, ...]:
        """Columns of the base and of these candidates."""
        return self.base_columns + tuple(c for slot in slots for c in slot.columns)

    def fit(self, g: FloatArray, b: FloatArray, columns: Sequence[int], start: FloatArray | None = None) -> FloatArray:
        """Coefficients within bounds, the base's prior included; `g`, `b` summed over the training segments. A `start`
        near the answer saves steps and changes nothing else."""
        index = np.asarray(columns)
        h, rhs = self._held(g[np.ix_(index, index)][None], b[index][None], index)
        return bounded_fits(h, rhs, self.layout.lower[index], self.layout.upper[index], start)[0]

    def fits(self, g: FloatArray, b: FloatArray, columns: Sequence[int], start: FloatArray) -> FloatArray:
        """The same of several sums at once, `g` (k, c, c) and `b` (k, c): (k, columns)."""
        index, size = np.asarray(columns), g.shape[1]
        places = (index[:, None] * size + index).ravel()  # `take` is three times as fast as an index of each axis
        own = g.reshape(len(g), -1).take(places, axis=1).reshape(len(g), len(index), -1)
        h, rhs = self._held(own, b.take(index, axis=1), index)
        return bounded_fits(h, rhs, self.layout.lower[index], self.layout.upper[index], start)

    def fits_beside(
        self, g: FloatArray, b: FloatArray, rest: Sequence[int], others: Sequence[Sequence[int]], start: FloatArray
    ) -> FloatArray:
        """The same of several sets of columns of one sum, each the `rest` and one of the `others`, which are equally
        many; `start` is of the rest: (others, columns)."""
        index = np.array([(*rest, *own) for own in others])
        first = np.hstack([np.tile(start, (len(index), 1)), self.layout.inside(index[:, len(start) :])])
        h, rhs = self._held(g[index[:, :, None], index[:, None, :]], b[index], index)
        return bounded_fits(h, rhs, self.layout.lower[index], self.layout.upper[index], first)

    def _held(self, h: FloatArray, rhs: FloatArray, index: np.ndarray) -> tuple[FloatArray, FloatArray]:
        """Normal equations (k, n, n) and (k, n) with the base's prior and what holds candidates; `index` of the
        columns is (n,), or of each its own (k, n). Both are changed where they stand."""
        k, diagonal = len(self.base.names), np.einsum("kii->ki", h)  # which is written to where it stands
        diagonal[:, :k] += LIMITS.prior_weight
        rhs[:, :k] -= LIMITS.prior_weight * self.base.shift
        diagonal[:, k:] += RIDGE * diagonal[:, k:] + TINY
        if (bending := self.layout.bending) is not None:
            for one, own in zip(h, np.broadcast_to(index, rhs.shape), strict=True):
                if (curved := bending[own, own] > 0.0).any():
                    stiff = LIMITS.stiffness * float(np.mean(np.diag(one)[curved]))
                    one += stiff * bending[np.ix_(own, own)]
        return h, rhs

    def covariance(self, g: FloatArray, columns: Sequence[int]) -> FloatArray:
        """Covariance of the coefficients: data, thinned for correlated noise, and prior; bounds do not count."""
        index = np.asarray(columns)
        base = len(self.base.names)
        h = g[np.ix_(index, index)] / LIMITS.prior_weight
        h[np.arange(base), np.arange(base)] += 1.0
        every = np.arange(len(index))
        h[every, every] += 1e-9 * (1.0 + np.diag(h))
        return np.asarray(np.linalg.inv(h))


def problem_of(
    tables: Sequence[RunBlocks], layout: Layout, least_noise: FloatArray, known: Sequence[Slot] = (),
    x: FloatArray | None = None,
) -> Problem:  # fmt: skip
    """Gram matrices of these records; what candidates that are `known` already explain is not taken for noise. `x`: the
    columns of all records, where these stand together."""
    skews = [None if layout.base.skew is None else t.x[:, layout.base.skew] for t in tables]
    noises = partial(noise_of_runs, positions=[t.position for t in tables], made=[t.made for t in tables], skews=skews)
    noise = dict(enumerate(noises([t.y for t in tables], least=least_noise)))
    blocks = joined(tables, noise, x)
    first = Problem(layout, blocks, grams(blocks), noise)
    # once more without what the base's own freedom explains, such as half a sample of skew while the oil column rings
    columns = np.asarray(first.columns(known))
    beta = first.fit(*first.grams.total(), first.columns(known))
    left = [t.y - np.ascontiguousarray(t.x[:, columns]) @ beta for t in tables]
    again = {k: min(noise[k], each) for k, each in enumerate(noises(left, least=least_noise))}
    return replace(_reweighted(first, again), least_noise=least_noise)


def _reweighted(problem: Problem, noise: dict[int, float]) -> Problem:
    """The same problem for another noise of each record; the Gram matrices, the largest thing there is, are changed."""
    ratio = np.array([problem.noise[k] / noise[k] for k in range(len(noise))])
    blocks = replace(problem.blocks, weight=problem.blocks.weight * ratio[problem.blocks.run])
    g = problem.grams
    factor = ratio[g.run] ** 2
    np.multiply(g.upper, factor[:, None], out=g.upper)
    again = replace(g, b=g.b * factor[:, None], y2=g.y2 * factor)
    return replace(problem, blocks=blocks, grams=again, noise=noise)


def of_base(problem: Problem, name: str) -> FloatArray | None:
    """What a unit of a base parameter adds to the gap, by block; None of one that the base has not, or that a run shows
    nothing of."""
    if name not in problem.base.names:
        return None
    at, run = problem.base.names.index(name), problem.blocks.run
    column = problem.blocks.x[:, at] / problem.base.scale[at]
    return column if all((column[run == own] != 0.0).any() for own in np.unique(run)) else None


def shares_by_run(values: FloatArray, whole: FloatArray, run: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """The share of a whole that values are in each run, and what they are beside it; all by block."""
    _, at = np.unique(run, return_inverse=True)
    shares = np.bincount(at, whole * values) / np.bincount(at, whole**2)
    return shares, values - shares[at] * whole
