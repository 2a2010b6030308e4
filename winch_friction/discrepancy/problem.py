"""The regression that every question is put to: the gap on base parameters, held to their prior, and candidate
effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from winch_friction.discrepancy.blocks import (
    BLOCK_SAMPLES,
    Blocks,
    Grams,
    RunBlocks,
    Slot,
    grams,
    run_blocks,
    segment_length,
)
from winch_friction.discrepancy.bounded_fit import bounded_fit
from winch_friction.discrepancy.candidates.candidate import Candidate
from winch_friction.discrepancy.candidates.signals import SMALL_DELAY, delay_columns
from winch_friction.discrepancy.noise import noise_of_run
from winch_friction.discrepancy.preparation.prepared_run import PreparedRun
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.signals import FloatArray
from winch_friction.physics.units import GRAVITY

PRIOR_BOUND = 2.0  # sigma; a base parameter beyond it is itself a finding
PRIOR_WEIGHT = 10.0  # correlated block noise makes the data count for less than their number
DEFAULT_RELATIVE_STD = 0.2  # for a model without covariance
LEAST_NOISE = 0.1  # bar; a 12-bit transducer of 600 bar steps by 0.15
LEAST_SHARE_OF_TORQUE = 1e-3  # of an electric drive's torque
TINY = 1e-9
UNBOUNDED = 1e9
BARE = 3  # parameters
PLAIN_TERMS = ("coulomb", "viscous", "torque_offset", "direction_asymmetry", "stribeck")
# what every measurement is off by without being wrong: (name, one sigma, bounds), bounded like the parameters
TOLERANCES = (
    ("weight", 5e-4, -1e-3, 1e-3),  # relative: local gravity, a calibrated load cell
    ("inertia", 5e-3, -1e-2, 1e-2),  # relative
    ("timing", 0.3, -0.35, 0.6),  # samples that speed comes late: a counting encoder's mean is half a sample old
)


@dataclass(frozen=True)
class Base:
    """The base model's parameters as regression columns in units of their prior standard deviation."""

    names: tuple[str, ...]
    parameters: int  # the first so many are the model's; tolerances of the measurement follow
    scale: FloatArray
    shift: FloatArray  # expansion point minus seed, sigma
    lower: FloatArray
    upper: FloatArray


@dataclass(frozen=True)
class Problem:
    """Gram matrices over the runs at hand with the column ranges and bounds of everything that may be fitted."""

    base: Base
    slots: tuple[Slot, ...]
    blocks: Blocks
    grams: Grams
    scales: FloatArray  # physical value of one unit of each column
    lower: FloatArray
    upper: FloatArray
    noise: dict[int, float]  # bar (N m) per run index
    run_names: tuple[str, ...]
    least_noise: FloatArray | None = None  # bar (N m) per run index; what is smaller matters to nobody

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

    def columns(self, slots: Sequence[Slot]) -> tuple[int, ...]:
        """Columns of the base and of these effects."""
        return self.base_columns + tuple(c for slot in slots for c in slot.columns)

    def fit(self, g: FloatArray, b: FloatArray, columns: Sequence[int]) -> FloatArray:
        """Coefficients within bounds, the base's prior included; `g`, `b` summed over the training segments."""
        index = np.asarray(columns)
        h, rhs = g[np.ix_(index, index)].copy(), b[index].copy()
        k = len(self.base.names)
        h[np.arange(k), np.arange(k)] += PRIOR_WEIGHT
        rhs[:k] -= PRIOR_WEIGHT * self.base.shift
        rest = np.arange(k, len(index))
        h[rest, rest] += 1e-6 * h[rest, rest] + TINY
        return bounded_fit(h, rhs, self.lower[index], self.upper[index])


def base_of(model: FrictionModel, expanded: FrictionModel) -> Base:
    """Prior scale and box of the base parameters around the point of expansion."""
    seed, at = np.array(model.values), np.array(expanded.values)
    std = model.std
    fallback = DEFAULT_RELATIVE_STD * np.maximum(np.abs(seed), [abs(p.typical) * 0.1 for p in model.parameters])
    scale = np.where(std > 0.0, std, fallback)
    bounds = np.array([model.bounds_of(name) for name in model.parameter_names]).reshape(-1, 2)
    shift = (at - seed) / scale
    lower = np.maximum(-PRIOR_BOUND - shift, (bounds[:, 0] - at) / scale)
    upper = np.minimum(PRIOR_BOUND - shift, (bounds[:, 1] - at) / scale)
    extra = len(TOLERANCES)
    return Base(
        names=model.parameter_names + tuple(name for name, *_ in TOLERANCES),
        parameters=len(seed),
        scale=np.concatenate([scale, [sigma for _, sigma, *_ in TOLERANCES]]),
        shift=np.concatenate([shift, np.zeros(extra)]),
        lower=np.concatenate([np.minimum(lower, 0.0), [low / sigma for _, sigma, low, _ in TOLERANCES]]),
        upper=np.concatenate([np.maximum(upper, 0.0), [high / sigma for _, sigma, _, high in TOLERANCES]]),
    )


def tolerance_columns(run: PreparedRun) -> FloatArray:
    """Torque in N m per unit of each tolerance, shape (samples, tolerances)."""
    weight = run.load * run.radius / run.gear_ratio * GRAVITY
    inertia = run.inertia * run.acceleration
    timing = delay_columns(run, SMALL_DELAY)[:, 0] * run.dt
    return np.column_stack([weight, inertia, timing])


@dataclass(frozen=True)
class Layout:
    """Columns of base and candidates: how to build them for a run, their scales and bounds."""

    base: Base
    slots: tuple[Slot, ...]
    scales: FloatArray
    lower: FloatArray
    upper: FloatArray

    def only(self, slots: Sequence[Slot]) -> "tuple[Layout, tuple[Slot, ...]]":
        """The layout of the base and of these effects alone, and the effects' places in it."""
        count = len(self.base.names)
        own = list(range(count)) + [c for slot in slots for c in slot.columns]
        placed, at = [], count
        for slot in slots:
            placed.append(replace(slot, columns=tuple(range(at, at + len(slot.columns)))))
            at += len(slot.columns)
        small = Layout(self.base, tuple(placed), self.scales[own], self.lower[own], self.upper[own])
        return small, tuple(placed)

    def slot_like(self, other: Slot) -> Slot:
        """The slot of the same effect and shape as one of another layout."""
        alike = (other.candidate.name, other.variant.label)
        return next(each for each in self.slots if (each.candidate.name, each.variant.label) == alike)

    def regressors(self, run: PreparedRun) -> FloatArray:
        """All scaled columns of one run, N m, shape (samples, columns)."""
        parts = [np.column_stack([run.jacobian, tolerance_columns(run)]) * self.base.scale]
        for slot in self.slots:
            columns = slot.candidate.columns(run, slot.variant.shape)
            parts.append(columns * self.scales[list(slot.columns)])
        return np.column_stack(parts)


def layout_of(base: Base, candidates: Sequence[Candidate], runs: Sequence[PreparedRun], model: FrictionModel) -> Layout:
    """Give every variant of every candidate its columns."""
    slots, scales = [], list(base.scale)
    lower, upper = list(base.lower), list(base.upper)
    for candidate in candidates:
        present = candidate.term is not None and candidate.term.name in model.term_names
        # in a bare model a plain term may be of any size: nothing is known about it yet
        bare = len(model.parameters) <= BARE
        most = UNBOUNDED if bare and candidate.name in PLAIN_TERMS and not present else candidate.plausible
        for variant in candidate.shapes(runs):
            columns = []
            for parameter in candidate.linear:
                columns.append(len(scales))
                scales.append(parameter.typical)
                low, high = variant.bounds or (-most if parameter.lower < 0.0 or present else 0.0, most)
                lower.append(low)
                upper.append(high)
            slots.append(Slot(candidate, variant, tuple(columns)))
    return Layout(base, tuple(slots), np.array(scales), np.array(lower), np.array(upper))


def build_problem(
    runs: Sequence[PreparedRun], layout: Layout, regime: str = "moving", known: Sequence[Slot] = ()
) -> Problem:
    """Blocks and Gram matrices of these runs; what effects that are `known` already explain is not taken for noise."""
    length = segment_length(runs)
    size = BLOCK_SAMPLES if regime == "moving" else 1
    tables: list[RunBlocks] = []
    for run in runs:
        table = run_blocks(run, layout.regressors(run), run.moving, size, length)
        tables.append(
            table if "hook_load" in run.present or not run.groups else _weightless(table, layout.base.parameters)
        )
    noise = {k: noise_of_run(t.y, t.contiguous) for k, t in enumerate(tables)}
    first = _problem(layout, tables, noise, runs)
    # once more without what the base's own freedom explains, such as half a sample of skew while the oil column rings
    columns = np.asarray(first.columns(known))
    beta = first.fit(first.grams.g.sum(axis=0), first.grams.b.sum(axis=0), first.columns(known))
    again = {k: min(noise[k], noise_of_run(t.y - t.x[:, columns] @ beta, t.contiguous)) for k, t in enumerate(tables)}
    least = np.array([_least_noise(run) for run in runs])
    return replace(_reweighted(first, again), least_noise=least)


def _least_noise(run: PreparedRun) -> float:
    """What no balance of a winch closes better than, however quiet its sensors, bar (N m for an electric drive)."""
    if run.groups:
        return LEAST_NOISE
    return LEAST_SHARE_OF_TORQUE * float(np.sqrt(np.mean((run.gap + run.predicted) ** 2))) / run.unit_torque


def _reweighted(problem: Problem, noise: dict[int, float]) -> Problem:
    """The same problem for another noise of each run."""
    ratio = np.array([problem.noise[k] / noise[k] for k in range(len(noise))])
    blocks = replace(problem.blocks, weight=problem.blocks.weight * ratio[problem.blocks.run])
    g = problem.grams
    factor = ratio[g.run] ** 2
    grams_again = Grams(g.g * factor[:, None, None], g.b * factor[:, None], g.y2 * factor, g.count, g.run)
    return replace(problem, blocks=blocks, grams=grams_again, noise=noise)


def _problem(
    layout: Layout, tables: Sequence[RunBlocks], noise: dict[int, float], runs: Sequence[PreparedRun]
) -> Problem:
    blocks = _joined(tables, noise)
    return Problem(
        layout.base, layout.slots, blocks, grams(blocks), layout.scales, layout.lower, layout.upper, noise,
        tuple(run.name for run in runs),
    )  # fmt: skip


def _weightless(table: RunBlocks, weight_column: int) -> RunBlocks:
    """Where the load was never measured it is anything: what a constant weight could explain is taken out
    everywhere."""
    weight = table.x[:, weight_column]
    scale = float(weight @ weight)
    if scale <= 0.0:
        return table
    x = table.x - np.outer(weight, weight @ table.x / scale)
    return replace(table, y=table.y - weight * (weight @ table.y / scale), x=x)


def _joined(tables: Sequence[RunBlocks], noise: dict[int, float]) -> Blocks:
    offsets = np.cumsum([0] + [int(t.segment.max(initial=0)) + 1 for t in tables])
    names = list(dict.fromkeys(name for t in tables for name in t.features))
    features = {
        name: np.concatenate([t.features.get(name, np.full(len(t.y), np.nan)) for t in tables]) for name in names
    }
    return Blocks(
        y=np.concatenate([t.y for t in tables]),
        x=np.concatenate([t.x for t in tables]),
        run=np.concatenate([np.full(len(t.y), k) for k, t in enumerate(tables)]),
        segment=np.concatenate([t.segment + o for t, o in zip(tables, offsets[:-1], strict=True)]),
        weight=np.concatenate([np.full(len(t.y), 1.0 / noise[k]) for k, t in enumerate(tables)]),
        features=features,
        direction=np.concatenate([t.direction for t in tables]),
        position=np.concatenate([t.contiguous for t in tables]),
    )
