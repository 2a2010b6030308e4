"""Which crane changed and when, and which is unlike the others.

Each crane's series of one trait, month by month, is a level with a slow drift (wear, running in) and, where something
was replaced or broke, a step. A step is looked for by the likelihood ratio over all dates against level and drift alone
(Quandt 1960); how large it gets by chance is simulated for series of the same length (Andrews 1993 for why it must be),
and shared among all cranes and traits (Holm 1979).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from winch_friction.physics.signals import FloatArray

FEWEST_MONTHS = 8
EDGE = 2  # months at either end in which a step cannot be told from noise
DRAWS = 20_000  # simulated null series: p-values down to 1e-4
SIGNIFICANCE = 0.02  # chance of one false step in a whole fleet
MOST_STEPS = 3
UNLIKE = 3.5  # robust standard deviations from the fleet's median (Iglewicz and Hoaglin 1993)


@dataclass(frozen=True)
class Series:
    """One trait of one crane by month: months since year 0, values and standard deviations in the trait's unit."""

    crane: str
    trait: str
    months: np.ndarray
    values: FloatArray
    stds: FloatArray


@dataclass(frozen=True)
class Step:
    """A sudden change: the first month after it, its size and the fleet-wise p-value."""

    crane: str
    trait: str
    month: int
    size: float
    p_value: float


@dataclass(frozen=True)
class Unlike:
    """A crane whose latest level is far from the fleet's, in robust standard deviations."""

    crane: str
    trait: str
    level: float
    fleet: float
    score: float


def month_of(time: float) -> int:
    """Months since year 0 of a Unix time in s."""
    date = np.datetime64(int(time), "s").astype("datetime64[M]")
    return int(date.astype(int)) + 1970 * 12


def month_text(month: int) -> str:
    """`2026-03`."""
    return f"{month // 12:04d}-{month % 12 + 1:02d}"


def find_steps(series: Sequence[Series]) -> list[Step]:
    """The significant steps of a fleet, each crane and trait searched again after each of its steps."""
    candidates = [step for each in series for step in _steps_of(each)]
    candidates.sort(key=lambda step: step.p_value)
    found = []
    for rank, step in enumerate(candidates):
        if step.p_value > SIGNIFICANCE / max(len(series) - rank, 1):
            break
        found.append(step)
    return sorted(found, key=lambda step: (step.crane, step.trait, step.month))


def find_unlike(series: Sequence[Series], latest: int = 6) -> list[Unlike]:
    """Cranes whose mean over the last months stands out from the fleet's."""
    found = []
    for trait in sorted({each.trait for each in series}):
        own = [each for each in series if each.trait == trait and len(each.values)]
        levels = np.array([float(np.mean(each.values[-latest:])) for each in own])
        if len(levels) < 4:
            continue
        middle = float(np.median(levels))
        spread = 1.4826 * float(np.median(np.abs(levels - middle))) or 1e-12
        for each, level in zip(own, levels.tolist(), strict=True):
            score = abs(level - middle) / spread
            if score > UNLIKE:
                found.append(Unlike(each.crane, trait, level, middle, score))
    return sorted(found, key=lambda each: -each.score)


def _steps_of(series: Series) -> list[Step]:
    """One crane's likeliest steps with p-values for one series; further ones with the found ones taken out."""
    if len(series.months) < FEWEST_MONTHS:
        return []
    found: list[int] = []
    steps: list[Step] = []
    for _ in range(MOST_STEPS):
        statistic, place = _likeliest(series, found)
        p_value = _chance(len(series.months), len(found), statistic)
        if p_value > SIGNIFICANCE:
            break
        found.append(place)
        steps.append(Step(series.crane, series.trait, int(series.months[place]), 0.0, p_value))
    sizes = _sizes(series, found)
    return [Step(s.crane, s.trait, s.month, size, s.p_value) for s, size in zip(steps, sizes, strict=True)]


def _columns(months: np.ndarray, places: Sequence[int]) -> FloatArray:
    """Level, drift and the steps at hand."""
    own = (months - months[0]) / max(float(months[-1] - months[0]), 1.0)
    steps = [(np.arange(len(months)) >= place).astype(float) for place in places]
    return np.column_stack([np.ones(len(months)), own, *steps])


def _weights(series: Series) -> FloatArray:
    """Relative precision of each month; months do not differ by more than their own scatter tells."""
    usable = np.clip(series.stds, np.median(series.stds) * 0.5 + 1e-12, None)
    return np.asarray(1.0 / usable)


def _likeliest(series: Series, found: Sequence[int]) -> tuple[float, int]:
    """Largest F-like statistic over the dates of one more step, and its place."""
    weight = _weights(series)
    values = series.values * weight
    base = _columns(series.months, found) * weight[:, None]
    return _scan(values, base, weight, EDGE)


def _scan(values: FloatArray, base: FloatArray, weight: FloatArray, edge: int) -> tuple[float, int]:
    before = _left(values, base)
    best, place = 0.0, edge
    for k in range(edge, len(values) - edge + 1):
        step = (np.arange(len(values)) >= k) * weight
        after = _left(values, np.column_stack([base, step]))
        statistic = (before - after) / max(after / max(len(values) - base.shape[1] - 1, 1), 1e-300)
        if statistic > best:
            best, place = float(statistic), k
    return best, place


def _left(values: FloatArray, columns: FloatArray) -> float:
    fitted = columns @ np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(((values - fitted) ** 2).sum())


def _sizes(series: Series, found: Sequence[int]) -> list[float]:
    if not found:
        return []
    weight = _weights(series)
    columns = _columns(series.months, found) * weight[:, None]
    return [float(each) for each in np.linalg.lstsq(columns, series.values * weight, rcond=None)[0][2:]]


def _chance(length: int, steps: int, statistic: float) -> float:
    """How often a series without a further step gives as large a statistic."""
    null = _null(length, min(steps, MOST_STEPS - 1))
    return float((1 + np.sum(null >= statistic)) / (1 + len(null)))


@lru_cache(maxsize=64)
def _null(length: int, steps: int) -> FloatArray:
    """Statistics of white series on level, drift and evenly spaced steps."""
    places = [round(length * (k + 1) / (steps + 1)) for k in range(steps)]
    base = _columns(np.arange(length), places)
    own = np.linalg.qr(base)[0]
    noise = np.random.default_rng(length).standard_normal((length, DRAWS))
    noise -= own @ (own.T @ noise)
    total = (noise**2).sum(0)
    largest = np.zeros(DRAWS)
    for k in range(EDGE, length - EDGE + 1):
        step = (np.arange(length) >= k).astype(float)
        step -= own @ (own.T @ step)
        power = float(step @ step)
        if power > 1e-9:
            gain = (step @ noise) ** 2 / power
            largest = np.maximum(largest, gain / np.maximum((total - gain) / (length - base.shape[1] - 1), 1e-300))
    return largest


def monthly(rows: Mapping[tuple[str, str], Sequence[tuple[float, float, float]]]) -> list[Series]:
    """Rows (crane, trait) -> (Unix time, value, std) to one value per month, the mean of its recordings."""
    found = []
    for (crane, trait), entries in sorted(rows.items()):
        by_month: dict[int, list[tuple[float, float]]] = {}
        for time, value, std in entries:
            by_month.setdefault(month_of(time), []).append((value, std))
        months = np.array(sorted(by_month))
        values = np.array([np.mean([v for v, _ in by_month[m]]) for m in months.tolist()])
        stds = np.array([np.sqrt(np.mean([s**2 for _, s in by_month[m]]) / len(by_month[m])) for m in months.tolist()])
        found.append(Series(crane, trait, months, values, stds))
    return found
