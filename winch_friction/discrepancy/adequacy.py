"""Can these runs answer at all, in numbers, and which of them are locked? Asked before the search."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from winch_friction.discrepancy.engine.blocks import stretch
from winch_friction.discrepancy.expansion import Given, Split
from winch_friction.discrepancy.preparation.grid import HOLE
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.seen import at_one_speed
from winch_friction.discrepancy.preparation.suspended_load import FEWEST_MOVING, MOST_SETTLING
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.errors import InputError
from winch_friction.physics.signals import FloatArray, Run
from winch_friction.physics.winch import Crane
from winch_friction.records.runs import NO_RECORD, refuse_same_names, scattered

SWING = "longest record, of a load whose swing on its wire is not told"
TELLING = "runs that tell more effects apart"
HEAVE = "runs of heave compensation that log heave_velocity, without which the crane is taken to stand still"
MOVED = 0.5  # of a gap's variance, left where the load is taken to hang still: then the crane has moved
IN_TIME = 0.98  # of the rate that is asked for: clocks drift, and the first and last periods are cut
PARTS = " (first part)", " (last part)"  # after the name of a run that is divided: of few none is locked whole
DISTINCT = 0.1  # relative difference from which on two loads or displacements are two


@dataclass(frozen=True)
class Check:
    """One thing that a search needs: its value in these runs, and how much is needed."""

    what: str
    value: float
    needed: float
    unit: str
    met: bool

    @property
    def sentence(self) -> str:
        """What is lacking, in words."""
        if self.what.startswith(TELLING):
            return self.what  # there are some or there are none
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.what}: {told_apart(self.value, self.needed)}{unit}, needed {self.needed:g}{unit}"


def told_apart(value: float, needed: float) -> str:
    """A value to three digits, or to as many as tell that it falls short: 19.96 s of 20 s are not "20 s"."""
    shown = (f"{value:.{digits}g}" for digits in range(3, 18))
    return next((each for each in shown if (float(each) < needed) == (value < needed)), f"{value:g}")


def _at_least(what: str, value: float, needed: float, unit: str = "1") -> Check:
    return Check(what, float(value), needed, unit, bool(value >= needed))


def _rate(time: FloatArray) -> float:
    """Samples per second where there are any: a hole is no slow log."""
    steps = np.diff(time)
    known = steps[steps <= HOLE * np.median(steps)]
    return len(known) / float(known.sum()) if known.sum() > 0.0 else float("inf")


def long_enough(runs: Sequence[Run]) -> tuple[list[Run], list[str]]:
    """The records that can be looked at, and what is said of those that cannot: too short, or too sparse to tell a
    speed from its change. A record of less than a second is no record and raises `InputError`.
    """
    kept, notes = [], []
    for run in runs:
        time = run.time[np.isfinite(run.time)]
        lasts = float(time[-1] - time[0]) if len(time) > 1 else 0.0
        if lasts < NO_RECORD:
            raise InputError(f"{run.name}: lasts {lasts:.2g} s; that is no record of a winch at work")
        rate = _rate(time)
        if lasts < LIMITS.shortest_record:
            needed = LIMITS.shortest_record
            notes.append(f"{run.name} left out: it lasts {told_apart(lasts, needed)} s, needed {needed:g} s")
        elif rate < IN_TIME * LIMITS.lowest_rate and not _steady(run):
            notes.append(f"{run.name} left out: logged at {rate:.3g} Hz, needed {LIMITS.lowest_rate:g} Hz")
        elif stands_alone := scattered(run):
            notes.append(f"{run.name} left out: {stands_alone}")
        else:
            kept.append(run)
    return kept, notes


def _steady(run: Run) -> bool:
    """At one speed throughout there is no acceleration and no reversal that a slow log could miss."""
    return "motor_speed" in run and at_one_speed(run["motor_speed"][np.isfinite(run["motor_speed"])])


def of_records(runs: Sequence[Run], kept: Sequence[Run]) -> list[Check]:
    """What can be said before the balance is closed."""
    return [
        _at_least("longest record", max(np.ptp(run.time) for run in runs), LIMITS.shortest_record, "s"),
        _at_least("fastest log", max(_rate(run.time) for run in runs) / IN_TIME, LIMITS.lowest_rate, "Hz"),
        _at_least("records that can be used", sum(np.ptp(run.time) for run in kept), LIMITS.least_usable, "s"),
    ]


def of_prepared(given: Given, train: Sequence[str], holdout: Sequence[str]) -> list[Check]:
    """What the runs hold once the moving samples are known; numbers without a need are said for the reader."""
    own = [run for run in given.prepared if run.name in train]
    locked = [run for run in given.prepared if run.name in holdout]
    speed = _joined(own, lambda run: np.abs(run.speed))
    spread = float(np.percentile(speed, 90) / max(np.percentile(speed, 10), 1e-9)) if len(speed) else 0.0
    total = sum(float(run.time[-1]) for run in own)
    moving = _seconds(own)
    return [
        *_of_heave(given.prepared),
        _at_least("moving time", moving, LIMITS.least_moving, "s"),
        _at_least("hoisting", _seconds(own, 1.0), LIMITS.least_each_way, "s"),
        _at_least("lowering", _seconds(own, -1.0), LIMITS.least_each_way, "s"),
        _at_least("moving time of the locked runs", _seconds(locked), LIMITS.least_locked, "s"),
        _at_least("speeds, upper over lower decile", spread, LIMITS.least_speed_spread),
        _at_least("usable share of the samples", moving / max(total, 1e-9), LIMITS.least_share_moving),
        _at_least("reversals", sum(_reversals(run) for run in own), 0.0),
        _at_least("loads", _distinct([float(np.median(run.load)) for run in own]), 1.0),
        _at_least("displacements", _distinct([_driving(run) for run in own]), 1.0),
        _at_least("oil temperatures, span", _span(own, "oil_temperature"), 0.0, "K"),
    ]


def _of_heave(runs: Sequence[PreparedRun]) -> list[Check]:
    """Whether the runs of heave compensation say how the crane moved, where the gap of some that do not is mostly what
    a load would take that moves with the wire: their motors feel none of it. Nothing where all is well."""
    compensating = [run for run in runs if len(run.groups) > 1]
    silent = [run for run in compensating if "heave_velocity" not in run.channels and _hangs_still(run)]
    known = len(compensating) - len(silent)
    return [_at_least(HEAVE, known, len(compensating))] if silent else []


def _hangs_still(run: PreparedRun) -> bool:
    """Whether a run's gap is mostly the torque that its load would take if it moved with the wire."""
    way = run.direction[run.used]
    taken = (run.load * run.radius / run.gear_ratio * run.load_acceleration)[run.used]
    gap, still = ((own - _by_way(own, way)) for own in (run.gap[run.used], run.gap[run.used] + taken))
    return bool(len(gap) > 0 and np.sum(still**2) < MOVED * np.sum(gap**2))


def _by_way(values: FloatArray, way: FloatArray) -> FloatArray:
    """Their mean of each direction, for each sample: what friction that is off adds."""
    found = np.zeros(len(values))
    for sign in (-1.0, 0.0, 1.0):
        own = way == sign
        found[own] = np.mean(values[own]) if own.any() else 0.0
    return found


def of_swing(crane: Crane, left: Sequence[tuple[PreparedRun, FloatArray]]) -> Check:
    """Whether records last long enough to tell how the load swings on its wire, where what nothing explains lies in
    such runs alone; met where it does not, or where the wire gives and that is known. `left` holds each run with what
    its blocks keep, in floors.
    """
    untold = [_untold(run, crane) for run, _ in left]
    lengths = [float(run.time[-1]) for (run, _), own in zip(left, untold, strict=True) if own]
    longest = max(lengths, default=LIMITS.swing_told)
    elsewhere = np.concatenate([np.empty(0), *(kept for (_, kept), own in zip(left, untold, strict=True) if not own)])
    if len(elsewhere) and float(np.sqrt(np.mean(elsewhere**2))) > LIMITS.far_off_the_floor:
        longest = max(longest, LIMITS.swing_told)
    return _at_least(SWING, longest, LIMITS.swing_told, "s")


def of_names(untold: str) -> Check:
    """That the runs do not tell names apart; `untold` says which."""
    return _at_least(f"{TELLING} ({untold})", 0.0, 1.0)


def _untold(run: PreparedRun, crane: Crane) -> bool:
    """Whether a run may hold a swing that it does not tell: none was found in heave compensation, one began with what
    has not died when its samples count, or they were too few to look for one on a wire that gives."""
    frequency, damping = run.wire_mode[:2]
    if frequency <= 0.0:
        return bool(np.isfinite(crane.wire_stiffness) and run.used.sum() < FEWEST_MOVING)
    if damping > 0.0:
        return len(run.groups) > 1 and run.wire_mode.settling_time > MOST_SETTLING * run.time[-1]
    return len(run.groups) > 1


def _joined(runs: Sequence[PreparedRun], values: Callable[[PreparedRun], FloatArray]) -> FloatArray:
    return np.concatenate([np.empty(0), *(values(run)[run.used] for run in runs)])


def _seconds(runs: Sequence[PreparedRun], direction: float = 0.0) -> float:
    counted = (run.used & (run.direction == direction) if direction else run.used for run in runs)
    return float(sum(used.sum() * run.dt for used, run in zip(counted, runs, strict=True)))


def _reversals(run: PreparedRun) -> int:
    ways = run.direction[run.used]
    return int(np.count_nonzero(np.diff(ways[ways != 0.0])))


def _distinct(values: Sequence[float]) -> float:
    """How many values differ by more than a tenth from the one before."""
    ordered = sorted(values)
    steps = [b > (1.0 + DISTINCT) * a + 1e-12 for a, b in zip(ordered, ordered[1:], strict=False)]
    return float(1 + sum(steps)) if ordered else 0.0


def _driving(run: PreparedRun) -> float:
    own = next((group for group in run.groups if group.balances), None)
    return float(np.median(own.displacement)) if own else 1.0


def _span(runs: Sequence[PreparedRun], channel: str) -> float:
    values = np.concatenate([np.empty(0), *(run.channels[channel] for run in runs if channel in run.channels)])
    return float(np.ptp(values)) if len(values) else 0.0


# -- which runs are locked: never learned from, and what every name and file is proven on


def refuse(runs: Sequence[Run], fraction: float, seed: int) -> None:
    """Raise `InputError` for what cannot be divided: no run, two of one name, a share or a seed that is none."""
    if not runs:
        raise InputError("no run given; name at least one run file")
    refuse_same_names(runs)
    if not 0.05 <= fraction <= 0.6:
        raise InputError(f"--holdout {fraction:g} is outside 0.05 ... 0.6")
    if seed < 0:
        raise InputError(f"seed {seed}: give a whole number, 0 or more")


def lock_holdout(runs: Sequence[Run], fraction: float, rng: np.random.Generator) -> Split:
    """Choose the locked runs by kind (their motor groups), so that each kind is on both sides where there are two of
    it.

    Of a number of draws the one whose locked runs reach least beyond what the others cover: a law that the data draw
    says nothing of loads, pressures, layers or dates that it has not seen, and a proof there would be one of luck. Of
    those that reach as little the one whose locked runs cover most: what is small in all of them proves nothing.
    """
    if len(runs) < LIMITS.fewest_to_lock_whole:
        return _divided(runs, fraction)
    kinds: dict[tuple[str, ...], list[int]] = {}
    for k, run in enumerate(runs):
        kinds.setdefault(run.groups, []).append(k)
    covered = {name: _covered(name, runs) for name in dict.fromkeys(c for run in runs for c in run.columns)}
    draws = [_drawn(list(kinds.values()), fraction, rng) for _ in range(LIMITS.lock_draws)]
    layers = [frozenset(np.rint(v[np.isfinite(v)])) for v in (run.column("wire_layer") for run in runs)]
    locked = min(draws, key=lambda each: _beyond(each, list(covered.values())) + _unseen(each, layers))
    names = tuple(run.name for k, run in enumerate(runs) if k in locked)
    return Split(tuple(runs), tuple(run.name for run in runs if run.name not in names), names)


def _drawn(kinds: Sequence[Sequence[int]], fraction: float, rng: np.random.Generator) -> frozenset[int]:
    """Runs to lock, of every kind its share."""
    locked: list[int] = []
    for own in kinds:
        count = min(max(round(fraction * len(own)), 1 if len(own) > 1 else 0), len(own) - 1)
        locked += [own[k] for k in rng.permutation(len(own))[:count]]
    return frozenset(locked)


def _covered(name: str, runs: Sequence[Run]) -> FloatArray:
    """The range of a column in each run without its rarest values, shape (runs, 2); nan where a run has none of it."""
    found = np.full((len(runs), 2), np.nan)
    for k, run in enumerate(runs):
        values = run.column(name)
        if np.isfinite(values).any():
            found[k] = np.quantile(values[np.isfinite(values)], LIMITS.lock_range)
    return found


def _beyond(locked: frozenset[int], covered: Sequence[FloatArray]) -> float:
    """How far the locked runs reach beyond the others, in ranges of all runs, summed over the columns; a small part of
    what they cover themselves is taken off."""
    far = 0.0
    own = np.zeros(len(covered[0]) if covered else 0, bool)
    own[list(locked)] = True
    for ranges in covered:
        known = np.isfinite(ranges[:, 0])
        here, there = ranges[own & known], ranges[~own & known]
        if not len(here) or not len(there):
            continue
        whole = max(float(np.nanmax(ranges) - np.nanmin(ranges)), 1e-12)
        low, high = there[:, 0].min() - here[:, 0].min(), here[:, 1].max() - there[:, 1].max()
        covers = float(here[:, 1].max() - here[:, 0].min())
        far += (max(float(low), 0.0) + max(float(high), 0.0) - LIMITS.lock_cover * covers) / whole
    return far


def _unseen(locked: frozenset[int], layers: Sequence[frozenset[float]]) -> int:
    """How many of the drum's layers only the locked runs are on: a radius is learned where it is met."""
    here, there = (set().union(*(layers[k] for k in some)) for some in (locked, set(range(len(layers))) - locked))
    return len(here - there)


def _divided(runs: Sequence[Run], fraction: float) -> Split:
    parts, train, locked = [], [], []
    for run in runs:
        time, border = run.time - run.time[0], (run.time[-1] - run.time[0]) * (1.0 - fraction)
        for label, keep in zip(PARTS, (time < border - LIMITS.guard_time, time >= border), strict=True):
            own = stretch(np.flatnonzero(keep))  # no copy: of a million rows a tenth of the peak
            columns = {name: values[own] for name, values in run.columns.items()}
            parts.append(Run(f"{run.name}{label}", columns, {}, run.warnings, run.metadata))
        train.append(parts[-2].name)
        locked.append(parts[-1].name)
    return Split(tuple(parts), tuple(train), tuple(locked))
