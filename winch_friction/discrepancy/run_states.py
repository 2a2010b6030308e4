"""States of a run: what some runs have and others have not, such as a brake that hangs or a transducer replaced.

Which runs those are is told by the first half of each, by levels of which there are two.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from winch_friction.discrepancy.candidates.candidate import Candidate, Estimates, Shape, Sides, Values
from winch_friction.discrepancy.candidates.friction import COULOMB, term_columns
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot, first_halves
from winch_friction.discrepancy.engine.problem import Problem
from winch_friction.discrepancy.logged_causes import told_by_a_signal
from winch_friction.discrepancy.preparation.grid import overlaps
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import Scope
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.table import Table, tabulated

BRAKE, WEAR, SOME_RUNS, SINCE, EACH_RUN = (
    "brake_drag",
    "wear_drift",
    "in some runs",
    "since a date",
    "by another amount in each run",
)
THEN = "_then"  # behind the name of a parameter that is there for a time
FEWEST_OF_A_LEVEL = 1.5  # runs as well known as most: two, of which one may be known less
SURELY_OF_ONE = 20.0  # deviations of a run between two levels: it is of the nearer one, however well others are known
MARGIN = 1.0  # s by which a window reaches beyond its runs, where no other run is nearer

Windows = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class State:
    """In which runs, in the order of their dates, and since then or for these alone."""

    windows: Windows
    count: int
    runs: int
    both: bool  # the other runs have some of it as well

    @property
    def law(self) -> str:
        """Its name among the laws of a cause."""
        return SINCE if self.windows[-1][1] == float("inf") else SOME_RUNS

    @property
    def label(self) -> str:
        """In words."""
        return f"{self.law}, {self.count} of {self.runs}" + (", and another size else" if self.both else "")


def in_some_runs(slot: Slot, runs: Sequence[PreparedRun], levels: FloatArray, there: np.ndarray) -> list[Candidate]:
    """Candidates for what is `there` in some runs, at these levels; none where a logged signal says as much, or the
    runs' clocks tell no order of those that have it and those that have not."""
    if told_by_a_signal(runs, there) or not _apart(runs, there):
        return []
    return _candidates(slot, _state(runs, levels, there))


def in_each_run(runs: Sequence[PreparedRun], levels: FloatArray) -> list[Candidate]:
    """Candidates for a drag by these amounts, one of each run: a brake, or what wears by whatever law of the date; none
    where the runs' clocks tell no order."""
    if not _in_turn(runs):
        return []
    order, begins, ends = _by_date(runs)
    windows = tuple(_window(begins, ends, [k], 1.0 / 3.0) for k in range(len(order)))  # those of neighbours never meet
    # a brake drives nothing: what all amounts have alike the model's own friction takes up
    own = levels - min(float(levels.min()), 0.0)
    weights = tuple(float(f"{own[k] / own.max():.4g}") for k in order)
    return [_drag(cause, windows, EACH_RUN, weights) for cause in (BRAKE, WEAR)]


def _candidates(slot: Slot, state: State) -> list[Candidate]:
    candidate, shape = slot.origin
    if candidate.name == BRAKE:
        # since a date it has a law of its own
        return [_drag(BRAKE, state.windows, SOME_RUNS)] if state.law == SOME_RUNS else []
    own = replace(shape, label=f"{shape.label}, {state.label}")
    linear = candidate.linear + tuple(replace(p, name=p.name + THEN) for p in candidate.linear if state.both)
    return [
        replace(
            candidate, law_name=state.law, linear=linear, columns=partial(_within, candidate, state),
            shapes=lambda _: [own], corrects=partial(_then, candidate, state), continuous=(),
        )
    ]  # fmt: skip


def _drag(cause: str, windows: Windows, law: str, weights: tuple[float, ...] = ()) -> Candidate:
    knots = tuple(itertools.chain.from_iterable(windows))
    table = Table(
        f"{cause}_{law.replace(' ', '_')}", (("time", knots),), scope=Scope.SYSTEM, shape="windows", typical=3.0,
        source=f"a brake that hangs, or what wears, {law}", weights=weights,
    )  # fmt: skip
    term = tabulated(table)
    return Candidate(
        cause, "", term.parameters, partial(term_columns, term), term=term, presumes=COULOMB, law_name=law,
    )  # fmt: skip


def _within(candidate: Candidate, state: State, run: PreparedRun, values: Values) -> FloatArray:
    own = candidate.columns(run, values)
    then = own * float(any(begin <= run.start <= end for begin, end in state.windows))
    return np.column_stack([own, then]) if state.both else then


def _then(candidate: Candidate, state: State, found: Estimates, shape: Shape, sides: Sides) -> list[Correction]:
    """Corrections for these times, and for always what the other runs have as well."""
    assert candidate.corrects is not None
    always = candidate.corrects(found, shape, sides) if state.both else []
    of_then = {name.removesuffix(THEN): each for name, each in found.items() if not state.both or name.endswith(THEN)}
    return always + [replace(each, during=state.windows) for each in candidate.corrects(of_then, shape, sides)]


def _state(runs: Sequence[PreparedRun], levels: FloatArray, there: np.ndarray) -> State:
    other = float(np.nanmean(levels[~there]))
    both = abs(other) > LIMITS.other_level * abs(float(np.nanmean(levels[there])) - other)
    order, begins, ends = _by_date(runs)
    inside = [bool(there[k]) for k in order]
    switches = sum(a != b for a, b in itertools.pairwise(inside))
    if switches == 1 and inside[-1]:
        at = inside.index(True)
        windows: Windows = ((0.5 * (ends[at - 1] + begins[at]), float("inf")),)
    else:
        windows = tuple(_window(begins, ends, list(group)) for on, group in _spells(inside) if on)
    return State(windows, sum(inside), len(inside), both)


def _by_date(runs: Sequence[PreparedRun]) -> tuple[list[int], list[float], list[float]]:
    """The runs' order, when each begins and when it and all before have ended: two records of one lift may overlap."""
    order = sorted(range(len(runs)), key=lambda k: runs[k].start)
    ends = itertools.accumulate((runs[k].start + float(runs[k].time[-1]) for k in order), max)
    return order, [float(runs[k].start) for k in order], list(ends)


def _in_turn(runs: Sequence[PreparedRun]) -> bool:
    """Whether each run begins after the one before has ended: the clocks of others begin anew with each."""
    _, begins, ends = _by_date(runs)
    return not overlaps(zip(begins, ends, strict=True))


def _apart(runs: Sequence[PreparedRun], there: np.ndarray) -> bool:
    """Whether none of the runs that have something begins while one goes on that has not, or the other way."""
    order, begins, ends = _by_date(runs)
    switches = [k for k, (a, b) in enumerate(itertools.pairwise(order), 1) if there[a] != there[b]]
    return all(begins[k] > ends[k - 1] for k in switches)


def _spells(inside: Sequence[bool]) -> list[tuple[bool, list[int]]]:
    return [(on, list(group)) for on, group in itertools.groupby(range(len(inside)), key=lambda k: inside[k])]


def _window(
    begins: Sequence[float], ends: Sequence[float], group: Sequence[int], share: float = 0.5
) -> tuple[float, float]:
    """From before these runs until after them, by no more than this share of what lies between them and the next."""
    first, last = group[0], group[-1]
    before = share * (begins[first] - ends[first - 1]) if first > 0 else MARGIN
    after = share * (begins[last + 1] - ends[last]) if last + 1 < len(begins) else MARGIN
    return begins[first] - min(before, MARGIN), ends[last] + min(after, MARGIN)


# -- levels of runs
def levels_of(
    problem: Problem, slot: Slot, runs: int, whole: Sequence[bool] | None = None
) -> tuple[FloatArray, FloatArray]:
    """Size of a candidate in the first half of each run, or in all of it where it is `whole`, and its deviation from
    the others', in its units, the base fitted to all of them; NaN where a run has none of it."""
    blocks, base = problem.blocks, list(problem.base_columns)
    first = first_halves(blocks)
    first |= np.asarray(whole if whole is not None else [False] * runs)[blocks.run]
    weight, run = blocks.weight[first], blocks.run[first]
    own = blocks.x[first, slot.columns[0]] * weight
    columns = np.column_stack(
        [blocks.x[first][:, base] * weight[:, None], own[:, None] * (run[:, None] == range(runs))]
    )
    size = np.sqrt((columns**2).sum(axis=0))
    h = columns.T @ columns
    h[np.arange(len(base)), np.arange(len(base))] += LIMITS.prior_weight
    at = np.arange(len(base), len(h))
    has = size[at] > 1e-6 * max(float(size[at].max()), 1e-300)
    h[at, at] += np.where(has, 0.0, 1.0)
    inverse = np.linalg.pinv(h)
    beta = inverse @ (columns.T @ (blocks.y[first] * weight))
    left = blocks.y[first] * weight - columns @ beta
    # what the base does not know moves the levels of all runs alike, and nothing between them
    covariance = inverse[np.ix_(at, at)][np.ix_(has, has)]
    alike = np.eye(len(covariance)) - 1.0 / max(len(covariance), 1)
    deviations = np.ones(len(at))
    deviations[has] = np.sqrt(np.maximum(np.diag(alike @ covariance @ alike), 0.0))
    deviations *= np.sqrt(LIMITS.prior_weight * max(float(np.mean(left**2)), 1.0))
    return np.where(has, beta[at], np.nan), np.where(has, deviations, np.nan)


def two_levels(levels: FloatArray, deviations: FloatArray, loads: FloatArray | None = None) -> np.ndarray | None:
    """Which values (runs,) belong to the level that is further from zero, where they make two clear ones with at least
    two runs each; None where they do not. What is NaN belongs to neither and is not there.

    In either level the values may follow the runs' `loads` alike, as whatever the base model has wrong does. A value
    counts the less the larger its deviation is beside the usual one: of a light load little is known of a displacement.
    """
    known = np.flatnonzero(np.isfinite(levels))
    if len(known) < LIMITS.fewest_levels:
        return None
    order = known[np.argsort(levels[known])]
    load = np.zeros(len(levels)) if loads is None else loads - loads[known].mean()
    usual = float(np.median(deviations[known]))
    if usual <= 0.0:  # of columns that rounding alone fits
        return None
    weights = (usual / np.maximum(deviations, usual)) ** 2
    parts = [(order[:k], order[k:]) for k in range(2, len(order) - 1)]
    parts = [each for each in parts if _well_known(levels, deviations, usual, each) >= FEWEST_OF_A_LEVEL]
    fits = [(_two_lines(levels, load, weights, low, high), low, high) for low, high in parts]
    if not fits:
        return None
    (within, slope), low, high = min(fits, key=lambda fit: fit[0][0])
    within /= max(float(weights[order].sum()) - (2 if loads is None else 3), 1.0)
    spread = max(float(np.sqrt(within)), LIMITS.levels_surer * usual)
    centres = [float(np.average(levels[part] - slope * load[part], weights=weights[part])) for part in (low, high)]
    apart = next(least for runs, least in LIMITS.levels_apart if len(known) >= runs)
    if centres[1] - centres[0] < apart * spread:
        return None
    there = np.zeros(len(levels), bool)
    there[high if abs(centres[1]) >= abs(centres[0]) else low] = True
    return there


def _well_known(levels: FloatArray, deviations: FloatArray, usual: float, parts: Sequence[np.ndarray]) -> float:
    """How many runs of either level, of that which has fewer, are known as well as is usual; of three and more, or so
    well that they are of no other level: of levels that are apart by far the least known run is known well enough."""
    low, high = parts
    far = float(levels[high].mean() - levels[low].mean()) / SURELY_OF_ONE
    enough = [max(usual, far if len(part) > 2 else 0.0, 1e-300) for part in parts]
    return min(float(((e / np.maximum(deviations[p], e)) ** 2).sum()) for e, p in zip(enough, parts, strict=True))


def _two_lines(
    values: FloatArray, load: FloatArray, weights: FloatArray, low: np.ndarray, high: np.ndarray
) -> tuple[float, float]:
    """Weighted sum of squares about two levels that share a slope over the load, and that slope."""
    own, off = (
        np.concatenate([each[part] - np.average(each[part], weights=weights[part]) for part in (low, high)])
        for each in (load, values)
    )
    weight = weights[np.concatenate([low, high])]
    slope = float(own @ (weight * off)) / max(float(own @ (weight * own)), 1e-300)
    return float(weight @ (off - slope * own) ** 2), slope
