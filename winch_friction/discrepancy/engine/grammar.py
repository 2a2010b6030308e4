"""A small grammar of laws, searched by held-out loss: what could a gap depend on, and how?

A law is an amount times one or two factors; a factor is a function of one signal with at most two constants. It opposes
the motion or acts one way. The caller evaluates factors as block means per member (motor group) of a record; the engine
multiplies, fits and compares. It knows nothing of winches.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.engine.problem import bounded_fit
from winch_friction.discrepancy.thresholds import LIMITS

AT_ONCE = 2_000_000  # values of a wave: some 50 MB
MOST_CONSTANTS = 3  # of a law that is to be read


@dataclass(frozen=True)
class Factor:
    """One function of one signal with its constants by name, in the signal's unit (a lag's and a decay's in s)."""

    kind: str
    signal: str
    constants: tuple[tuple[str, float], ...] = ()

    @property
    def weight(self) -> int:
        """How much there is to read."""
        return 1 + len(self.constants)


@dataclass(frozen=True)
class Law:
    """An amount times factors; `opposing` the motion, or acting one way; `each`: once per member, not once in all."""

    factors: tuple[Factor, ...]
    opposing: bool
    each: bool = False

    @property
    def weight(self) -> int:
        """Simplicity: the fewer factors and constants the simpler."""
        return sum(factor.weight for factor in self.factors) + (not self.opposing)

    @property
    def signals(self) -> tuple[str, ...]:
        """What it reads, each once."""
        return tuple(dict.fromkeys(factor.signal for factor in self.factors))


@dataclass(frozen=True)
class Scored:
    """A law with what it leaves: of the records it was fitted to, and held out (infinite where not yet judged)."""

    law: Law
    amount: float
    inside: float
    loss: float
    losses: FloatArray


@dataclass(frozen=True)
class _Part:
    """Which blocks, their weighted base columns and gaps, and the normal equations of the base, with room for one
    column more at the end."""

    chosen: np.ndarray | slice
    x: FloatArray
    y: FloatArray
    h: FloatArray
    g: FloatArray


# block means of a factor: (members, blocks), or (1, blocks) for what is the same for all
Values = Mapping[Factor, FloatArray]


class Grammar:
    """The search for one problem: `torque` and `direction` per block, `members` (members, blocks) their numbers."""

    def __init__(
        self, cross: CrossFit, base: Explanation, torque: FloatArray, direction: FloatArray, members: FloatArray
    ) -> None:
        blocks = cross.problem.blocks
        self.cross, self.base, self.members = cross, base, members
        self.own = list(cross.problem.columns(base.slots))
        self.x = blocks.x[:, self.own] * blocks.weight[:, None]
        self.y = blocks.y * blocks.weight
        self.unit = torque * blocks.weight
        self.direction = direction
        self.fold = cross.fold_of_block
        layout = cross.problem.layout
        self.lower, self.upper = np.append(layout.lower[self.own], -np.inf), np.append(layout.upper[self.own], np.inf)
        self.start = np.append(base.beta, 0.0)  # most of its bounds stay where they are
        self.parts: dict[int | None, _Part] = {None: self._part(slice(None))}
        self.parts |= {int(fold): self._part(self.fold != fold) for fold in np.unique(self.fold)}

    def _part(self, chosen: np.ndarray | slice) -> "_Part":
        """The base's own sums over some blocks, its prior included."""
        x, y, problem = self.x[chosen], self.y[chosen], self.cross.problem
        h, g, k = np.pad(x.T @ x, (0, 1)), np.append(x.T @ y, 0.0), len(problem.base.names)
        h[np.arange(k), np.arange(k)] += LIMITS.prior_weight
        g[:k] -= LIMITS.prior_weight * problem.base.shift
        return _Part(chosen, x, y, h, g)

    def column(self, law: Law, values: Values) -> FloatArray:
        """What one unit of a law adds to the gap, weighted."""
        product = values[law.factors[0]]
        for factor in law.factors[1:]:
            product = product * values[factor]
        if len(product) > 1:
            product = (product * (self.members if law.each else self.members > 0)).sum(axis=0, keepdims=True)
        z = product[0] * self.unit
        return np.asarray(z * self.direction if law.opposing else z)

    def screened(self, law: Law, values: Values) -> Scored:
        """A law fitted to all records at once."""
        z, scale = _unit(self.column(law, values))
        if scale <= 0.0:
            return Scored(law, 0.0, float("inf"), float("inf"), np.zeros(0))
        amount, beta = self._fit(z, None)
        left = self.y - self.x @ beta - amount * z
        return Scored(law, amount / scale, float(left @ left), float("inf"), np.zeros(0))

    def judged(self, scored: Scored, values: Values) -> Scored:
        """The same law with its held-out losses."""
        z, _ = _unit(self.column(scored.law, values))
        left = np.empty(len(self.y))
        for fold in np.unique(self.fold):
            own = self.fold == fold
            amount, beta = self._fit(z, int(fold))
            left[own] = self.y[own] - self.x[own] @ beta - amount * z[own]
        losses = self.cross.problem.grams.by_segment(left**2)
        return Scored(scored.law, scored.amount, scored.inside, float(losses.sum()), losses)

    def _fit(self, z: FloatArray, fold: int | None) -> tuple[float, FloatArray]:
        """Amount and the base's coefficients, these inside their bounds and held to their prior; `fold` left out."""
        part = self.parts[fold]
        own = z[part.chosen]
        h, g = part.h.copy(), part.g.copy()
        h[-1, :-1] = h[:-1, -1] = part.x.T @ own
        h[-1, -1], g[-1] = float(own @ own) * (1.0 + 1e-9) + 1e-9, own @ part.y
        beta = bounded_fit(h, g, self.lower, self.upper, self.start)
        return float(beta[-1]), beta[:-1]

    def periodic(
        self, x: FloatArray, frequencies: FloatArray, apart: bool
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What a sine and a cosine over a signal, opposing the motion, take off the remainder, and their amounts.

        `x` (blocks,) is the signal, `frequencies` one over its unit; each answer has their shape. Every record has a
        level of its own; `apart`: and a phase.
        """
        carrier = self.unit * self.direction
        left = self.y - self.x @ self.base.beta
        run = self.cross.problem.blocks.run
        # of each record and frequency: moments of the two about the record's own level
        parts = np.array_split(frequencies, len(frequencies) * len(x) // AT_ONCE + 1)
        moments = np.array([
            np.concatenate([self._moments(carrier[own], left[own], x[own], each) for each in parts])
            for own in (run == k for k in np.unique(run))
        ])  # fmt: skip
        ss, sc, cc, ys, yc = np.moveaxis(moments if apart else moments.sum(axis=0, keepdims=True), -1, 0)
        ridge = 1e-9 * (ss + cc) + 1e-9
        determinant = (ss + ridge) * (cc + ridge) - sc**2
        sine, cosine = ((cc + ridge) * ys - sc * yc) / determinant, ((ss + ridge) * yc - sc * ys) / determinant
        return (sine * ys + cosine * yc).sum(axis=0), sine[0], cosine[0]

    @staticmethod
    def _moments(carrier: FloatArray, left: FloatArray, x: FloatArray, frequencies: FloatArray) -> FloatArray:
        """Shape (frequencies, 5): of sine and cosine with themselves, each other and what is left."""
        phase = 2.0 * np.pi * np.outer(frequencies, x)
        level = carrier / max(float(np.sqrt(carrier @ carrier)), 1e-12)
        sine, cosine = np.sin(phase) * carrier, np.cos(phase) * carrier
        sine -= np.outer(sine @ level, level)
        cosine -= np.outer(cosine @ level, level)
        own = [(sine * sine).sum(1), (sine * cosine).sum(1), (cosine * cosine).sum(1), sine @ left, cosine @ left]
        return np.stack(own, axis=-1)

    def search(self, values: Values, fit: Callable[[Scored], tuple[Scored, Values]] | None = None) -> list[Scored]:
        """Laws by held-out loss, the best of each set of signals: one factor, then the best of these times any.

        With `fit`, which moves a law's constants and evaluates it there, the best single factors of each kind are moved
        before anything is multiplied with them.
        """
        factors = list(values)
        singles = [
            self.screened(law, values) for f in factors for law in _ways((f,), len(values[f]) > 1)
        ]  # fmt: skip
        if fit is not None:
            moved = [fit(each) for each in _best_of_each(singles, LIMITS.grammar_judged, kinds=True)]
            singles = [each for each, _ in moved]
            values = {**values, **{f: own for _, more in moved for f, own in more.items()}}
        heads = _best_of_each(singles, LIMITS.grammar_heads)
        pairs = []
        for head, other in itertools.product(heads, factors):
            first = head.law.factors[0]
            many = fit is not None and len(first.constants) + len(other.constants) > MOST_CONSTANTS
            if other.signal != first.signal and not many:
                both = tuple(sorted((first, other), key=lambda f: (f.signal, f.kind)))
                law = Law(both, head.law.opposing, head.law.each or len(values[other]) > 1)
                pairs.append(self.screened(law, values))
        alone = _best_of_each(singles, LIMITS.grammar_judged, kinds=fit is not None)
        chosen = [*alone, *_best_of_each(pairs, LIMITS.grammar_judged)]
        return sorted((self.judged(each, values) for each in chosen), key=lambda each: each.loss)


def _unit(z: FloatArray) -> tuple[FloatArray, float]:
    scale = float(np.sqrt(np.mean(z**2)))
    return (z / scale, scale) if np.isfinite(scale) and scale > 0.0 else (z, 0.0)


def _ways(factors: tuple[Factor, ...], several: bool) -> list[Law]:
    each = (True, False) if several else (False,)
    return [Law(factors, opposing, own) for opposing in (True, False) for own in each]


def _best_of_each(scored: Sequence[Scored], most: int, kinds: bool = False) -> list[Scored]:
    """The law that fits best of each set of signals and way of acting, and of `kinds` of factors; the best so many."""
    found: dict[tuple[frozenset[str], bool, tuple[str, ...]], Scored] = {}
    for each in sorted(scored, key=lambda one: one.inside):
        own = tuple(factor.kind for factor in each.law.factors) if kinds else ()
        found.setdefault((frozenset(each.law.signals), each.law.opposing, own), each)
    return list(found.values())[:most]
