"""Where the constants of a proposed law may lie, looked at closer than a search for names needs.

A grid over quantiles is enough to see that some law does more than a name. A proposal is that law: its threshold lies
between the levels that runs were at, its hump between two quantiles.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.grammar import Factor, Grammar, Law, Scored
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.vocabulary import BY_NAME, FADES, WORDS, Word, covered, evaluated, signals, span_of
from winch_friction.discrepancy.waves import turns, waves

THRESHOLDS = ("step", "above", "below")
LEVEL = (0.05, 0.95)  # quantiles of a run's samples, between which its level lies
SAME = 1e-4  # of a signal: two runs at less than that from each other were set alike
HUMPED = ("motor_speed", "oil_temperature", "wire_out")  # what may be worst at one place
WIDTHS = (0.05, 0.12, 0.3)  # of the span: of humps, set side by side
STEPS = 40  # of a fit, per constant


def closer(grammar: Grammar, runs: Sequence[PreparedRun], most: int) -> Iterator[Factor]:
    """Factors with constants that no grid has."""
    for word in WORDS:
        seen = covered(word, runs)
        if len(seen):
            parts = [own[run.used] for run in runs if run.used.any() for own in signals(word, run)]
            yield from between_levels(word, parts)
            yield from side_by_side(word, seen)
    yield from (Factor("grow", "run_time", (("c", slow),)) for slow in FADES)
    places = [Factor("linear", name) for name in ("wire_out", "drum_angle") if len(covered(BY_NAME[name], runs))]
    for place, x in evaluated(places, runs, most).items():
        yield from turns(grammar, x[0]) if place.signal == "drum_angle" else waves(grammar, place.signal, x[0])


def between_levels(word: Word, parts: Sequence[FloatArray]) -> Iterator[Factor]:
    """Thresholds between the levels that a signal had in runs and groups, `parts`, where these do not overlap: of those
    that quantiles draw two may lie in one level, and none between it and the next."""
    levels = sorted(tuple(np.quantile(each, LEVEL)) for each in parts)
    ends = np.maximum.accumulate([high for _, high in levels])
    for below, (above, _) in zip(ends, levels[1:], strict=False):
        if above - below > SAME * abs(above):
            at = float(f"{0.5 * (below + above):.4g}")
            yield from (Factor(kind, word.name, (("c", at),)) for kind in THRESHOLDS if kind in word.kinds)


def side_by_side(word: Word, seen: FloatArray) -> Iterator[Factor]:
    """Humps as far from each other as they are wide, over all that was seen."""
    if word.name not in HUMPED or not (span := span_of(seen)):
        return
    for width in (share * span for share in WIDTHS):
        for at in np.arange(seen.min() + width, seen.max(), width):
            yield Factor("hump", word.name, (("c", float(f"{at:.4g}")), ("h", float(f"{width:.4g}"))))


def fitted(
    grammar: Grammar, scored: Scored, runs: Sequence[PreparedRun], most: int
) -> tuple[Scored, dict[Factor, FloatArray]]:
    """The law with all of its constants moved at once to where it fits best (Nelder and Mead 1965), judged, and its
    factors there: the beginning of a sector and its width move together or not at all."""
    law, best = scored.law, scored
    places = [
        (k, j) for k, factor in enumerate(law.factors) for j in range(len(factor.constants))
        if not BY_NAME[factor.signal].whole
    ]  # fmt: skip
    moved = [(law.factors[k], *law.factors[k].constants[j]) for k, j in places]
    first = np.array([value for _, _, value in moved])
    steps = np.array([_step(factor, name) for factor, name, _ in moved])
    low, high = np.array([_reach(factor, name, runs) for factor, name, _ in moved]).reshape(-1, 2).T

    def left(away: FloatArray) -> float:
        nonlocal best
        values = first + steps * away
        if (values * first <= 0.0).any() or (values < low).any() or (values > high).any():
            return float("inf")  # no width, memory or period is nothing or less
        trial = grammar.screened(own := _with(law, places, values), evaluated(own.factors, runs, most))
        best = trial if trial.inside < best.inside else best
        return trial.inside

    if places:
        corners = np.vstack([np.zeros(len(places)), np.eye(len(places))])
        options = {
            "initial_simplex": corners,
            "maxfev": STEPS * len(places),
            "xatol": 0.01,
            "fatol": 1e-4 * best.inside,
        }
        minimize(left, corners[0], method="Nelder-Mead", options=options)
    values = evaluated(best.law.factors, runs, most)
    return grammar.judged(best, values), values


def _with(law: Law, places: Sequence[tuple[int, int]], values: FloatArray) -> Law:
    """The law with these values for the constants at these places, of a factor and in it."""
    own = [list(factor.constants) for factor in law.factors]
    for (k, j), value in zip(places, values, strict=True):
        own[k][j] = (own[k][j][0], float(f"{value:.6g}"))
    return replace(law, factors=tuple(replace(f, constants=tuple(c)) for f, c in zip(law.factors, own, strict=True)))


def _reach(factor: Factor, name: str, runs: Sequence[PreparedRun]) -> tuple[float, float]:
    """Between what values a constant may be moved: what is worst at one place was seen there."""
    seen = covered(BY_NAME[factor.signal], runs) if (factor.kind, name) == ("hump", "c") else np.empty(0)
    return (float(seen.min()), float(seen.max())) if len(seen) else (-np.inf, np.inf)


def _step(factor: Factor, name: str) -> float:
    """How far a constant may well be from where a grid has it, in its unit."""
    at = dict(factor.constants)
    if factor.kind == "hump":
        return 0.5 * at["h"]
    if factor.kind == "wave":
        return at["c"] / 16.0 if name == "h" else 1e-3 * at["c"]
    return 0.1 * at[name]
