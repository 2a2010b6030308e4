"""The only bridge between winches and the engine: prepared runs and candidate effects become columns and blocks."""

from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from winch_friction.discrepancy.candidates.candidate import (
    OF_DRUM,
    OF_WINCH,
    REFERENCE_GEAR,
    REFERENCE_INERTIA,
    REFERENCE_LIFT,
    REFERENCE_MOTOR,
    REFERENCE_MOTORS,
    REFERENCE_PRESSURE,
    Candidate,
)
from winch_friction.discrepancy.candidates.families import bending
from winch_friction.discrepancy.candidates.friction import without_memory
from winch_friction.discrepancy.candidates.lateness import SMALL_DELAY, delay_columns
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import (
    Means,
    RunBlocks,
    Slot,
    on_disk,
    run_blocks,
    samples_of,
    scaled,
    segment_length,
    usable_blocks,
    usable_samples,
    without_column,
)
from winch_friction.discrepancy.engine.chance import rms
from winch_friction.discrepancy.engine.crossfit import Explanation
from winch_friction.discrepancy.engine.problem import Base, Layout, Problem, problem_of
from winch_friction.discrepancy.preparation.balance import SHOWS, SPARSEST, Accounted
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.preparation.suspended_load import COURSE
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.channels import GRAVITY
from winch_friction.physics.friction import FrictionModel
from winch_friction.physics.friction.correction import Correction
from winch_friction.physics.friction.terms.effects_motor import REFERENCE_SPEED

UNSURE = 15.0  # times the usual tolerance: how little a sparse log knows of its acceleration
SHORTEST_PERIOD = 0.02  # s; faster logs are no better in step than that of a usual PLC
MOST_KEPT = 100_000_000  # bytes of means in memory for a search that asks again; those of days of logs fill it
STEP = LIMITS.step * LIMITS.least_noise
SMALL = 0.1  # of the typical size: a value below it says nothing of how far off it may be
HELD = 1e-6  # of a tolerance: so little that it is none
# what every measurement is off by without being wrong: (name, one sigma, bounds), bounded like the parameters
TOLERANCES = (
    ("weight", 5e-4, -1e-3, 1e-3),  # relative: local gravity, a calibrated load cell
    ("inertia", 5e-3, -1e-2, 1e-2),  # relative
    ("timing", 0.3, -0.35, 0.6),  # samples that speed comes late: a counting encoder's mean is half a sample old
    # bar of the driving group's drop, and of the others': a step of a 12-bit transducer of 600 bar, or a coarser one's
    *((name, STEP / 3.0, -STEP, STEP) for name in ("zero", "passive zero")),
    ("tension", 0.5, 0.0, 1.0),  # share of the load's acceleration with which gears and drum lose as with its weight
)
LINE, PORT, CHURNING = "line_pressure_drop", "port_turbulence", "churning"
CHURNS, TOP = 1.9, 0.999  # exponent of churning at its typical value; share of the samples that are slower than the top
WITHIN = 6.0  # times a typical share of the drum's torque are plausible of it anywhere: up to there none is larger
SLOWEST_TOP = 20.0  # rad/s; a winch that runs no faster shows no churning


def machine_sizes(runs: Sequence[PreparedRun]) -> Mapping[str, float]:
    """How an amplitude of each unit grows with the machine, relative to the winch for which typical sizes are stated: a
    motor's torque with its displacement, that of all of them (`OF_WINCH`) also with their number, masses with what the
    winch lifts at one pressure, a resistance (also one stated at a fixed flow, under `LINE`) with the square of its
    flow. What is stated at a fixed speed is as much at a slow machine's top speed, under `CHURNING`; of `LINE`, `PORT`
    and a share of the drum's torque that each motor loses (`OF_DRUM`) counts what is beyond `WITHIN` times. Without
    pressures torques go with the largest that was given, an inertia with the drive's own, never below one motor's.
    """
    run, swept = runs[0], dict(runs[0].constants).get("max_displacement", 0.0)
    motors = max((sum(group.count for group in each.groups) for each in runs), default=0)
    if not swept or not motors:
        drives = [np.abs(each.drive_torque[each.used]) for each in runs if each.used.any()]
        given = [float(np.quantile(drive, TOP)) / (REFERENCE_MOTOR * REFERENCE_PRESSURE) for drive in drives]
        one, heavy = max([*given, 1.0]), max(run.inertia / REFERENCE_INERTIA, 1.0)
        all_of_them = dict.fromkeys(OF_WINCH, max(one / REFERENCE_MOTORS, 1.0))
        return {"N*m": one, "N*m*s/rad": one, "kg*m^2": heavy, **all_of_them}
    one, whole = swept / REFERENCE_MOTOR, motors * swept / (REFERENCE_MOTORS * REFERENCE_MOTOR)
    lift = whole * (run.gear_ratio / max(float(each.radius.max()) for each in runs)) / REFERENCE_LIFT
    torques = {**dict.fromkeys(("N*m", "N*m*s/rad", "m^3/rad", "m^5/N"), one), **dict.fromkeys(OF_WINCH, whole)}
    top = max(SLOWEST_TOP, *(float(np.quantile(np.abs(each.speed), TOP)) for each in runs))
    slow, far = max(REFERENCE_SPEED / top, 1.0), max((REFERENCE_SPEED / top) ** 2 / WITHIN, 1.0)
    carried = max(REFERENCE_GEAR * REFERENCE_MOTORS / (WITHIN * run.gear_ratio * motors), 1.0)
    stated_at = {LINE: far / whole**2, PORT: far * one, CHURNING: one * slow**CHURNS, OF_DRUM: carried}
    return {**torques, **stated_at, "kg": lift, "kg/m": lift, "kg*m^2": run.inertia / REFERENCE_INERTIA}


def base_of(
    model: FrictionModel, expanded: FrictionModel, loose: Mapping[str, float] | None = None, held: Collection[str] = ()
) -> Base:
    """Prior scale and box of the base parameters around the point of expansion, the measurement's tolerances, and what
    the model's corrections may be off by. `loose` gives parameters and corrections another deviation than the model's;
    the tolerances in `held` are left no room.
    """
    seed, at = np.array(model.values), np.array(expanded.values)
    std = np.array([(loose or {}).get(n, s) for n, s in zip(model.parameter_names, model.std, strict=True)])
    scale = np.where(std > 0.0, std, [_unstated_std(v, p.typical) for v, p in zip(seed, model.parameters, strict=True)])
    bounds = np.array([model.bounds_of(name) for name in model.parameter_names]).reshape(-1, 2)
    shift = (at - seed) / scale
    lower = np.maximum(-LIMITS.prior_bound - shift, (bounds[:, 0] - at) / scale)
    upper = np.minimum(LIMITS.prior_bound - shift, (bounds[:, 1] - at) / scale)
    more = [(std * (HELD if name in held else 1.0), low / std, high / std, 0.0) for name, std, low, high in TOLERANCES]
    claimed, most = {key_of(each): each.value for each in model.corrections}, LIMITS.prior_bound
    for each in expanded.corrections:  # around what the model says of it, as a parameter around its seed
        own_std = (loose or {}).get(key_of(each)) or correction_std(each)
        off = (each.value - claimed.get(key_of(each), each.value)) / own_std
        more.append((own_std, min(-most - off, 0.0), max(most - off, 0.0), off))
    own = np.array(more).reshape(-1, 4)
    return Base(
        names=model.parameter_names + tuple(name for name, *_ in TOLERANCES) + tuple(map(key_of, expanded.corrections)),
        parameters=len(seed),
        scale=np.concatenate([scale, own[:, 0]]),
        shift=np.concatenate([shift, own[:, 3]]),
        lower=np.concatenate([np.minimum(lower, 0.0), own[:, 1]]),
        upper=np.concatenate([np.maximum(upper, 0.0), own[:, 2]]),
        skew=len(seed) + [name for name, *_ in TOLERANCES].index("timing"),
    )


def key_of(correction: Correction) -> str:
    """A correction's name with what it is restricted to, unique in a model."""
    beyond = () if correction.beyond is None else (correction.beyond,)
    ties = [*correction.groups, *correction.layers, *correction.during, *beyond]
    return " ".join(map(str, [correction.name, *ties]))


def correction_std(correction: Correction) -> float:
    """Its standard deviation; where none is given, as uncertain as a parameter of which nothing is known."""
    return correction.std or _unstated_std(correction.value, correction.declared.parameter.typical)


def _unstated_std(value: float, typical: float) -> float:
    """The deviation of what states none: a share of its size, which is that of a small typical one at least."""
    return LIMITS.default_relative_std * max(abs(value), SMALL * abs(typical))


def layout_of(base: Base, candidates: Sequence[Candidate], runs: Sequence[PreparedRun], model: FrictionModel) -> Layout:
    """Give every shape of every candidate its columns."""
    slots, scales = [], list(base.scale)
    curves = list(_curves_of(model, base.scale))
    known = model.as_dict()
    lower, upper = list(base.lower), list(base.upper)
    sizes = machine_sizes(runs)
    for candidate in candidates:
        present = candidate.term is not None and candidate.term.name in model.term_names
        most = candidate.most_in(model)
        for shape in candidate.shapes(runs):
            columns = tuple(range(len(scales), len(scales) + len(candidate.linear)))
            for parameter in candidate.linear:
                # what the model has already may change by as much as it is
                own = abs(known.get(parameter.name, 0.0)) if present else 0.0
                typical = candidate.scale(parameter, sizes)
                scales.append(max(own, abs(typical)) * np.sign(typical))
                # in typical sizes, which have the sign that a curve that may only fall asks for
                either = parameter.lower < 0.0 if parameter.typical > 0.0 else parameter.upper > 0.0
                low, high = shape.bounds or (-most if either or present else 0.0, most)
                if candidate.corrects is not None and parameter.unit == "1":  # a share means what it is declared for
                    low, high = max(low, parameter.lower / typical), min(high, parameter.upper / typical)
                lower.append(low)
                upper.append(high)
            if candidate.free and candidate.term is not None and candidate.term.table is not None:
                form = bending(candidate.term.table)
                # a level at the first knot has no slope
                curves += [] if form is None else [(columns[len(columns) - len(form) :], form)]
            slots.append(Slot(
                candidate.name, shape.label, columns, candidate.brings, candidate.plausible, (candidate, shape),
                candidate.law_name, candidate.free, candidate.plain_in(model), shape.part,
            ))  # fmt: skip
    whole = np.zeros((len(scales), len(scales))) if curves else None
    for columns, form in curves:
        assert whole is not None
        whole[np.ix_(columns, columns)] = form
    return Layout(base, tuple(slots), np.array(scales), np.array(lower), np.array(upper), whole)


def _curves_of(model: FrictionModel, scale: FloatArray) -> Iterator[tuple[tuple[int, ...], FloatArray]]:
    """Columns and bending of each curve that the model has already, whose places have each a `scale` of its own: a
    refit may bend it where it has been, and where no run comes it goes on as it went."""
    at = {name: column for column, name in enumerate(model.parameter_names)}
    for term in model.terms:
        form = None if term.table is None else bending(term.table)
        if form is not None:
            columns = tuple(at[p.name] for p in term.parameters[len(term.parameters) - len(form) :])
            own = scale[list(columns)] / np.median(scale[list(columns)])
            yield columns, form * np.outer(own, own)


def tolerance_columns(run: PreparedRun) -> FloatArray:
    """Torque in N m per unit of each tolerance and of each correction's error, shape (samples, columns)."""
    weight = run.load * run.radius / run.gear_ratio * GRAVITY
    inertia = run.inertia * run.acceleration * (UNSURE if run.dt > SPARSEST else 1.0)
    zeros = [
        sum((g.of_zero(STEP) for g in run.groups if g.balances is own), np.zeros(len(run.time)))
        for own in (True, False)
    ]
    if not run.groups:  # its torque is known from elsewhere, and steps by a share of the rated one
        zeros[0] = zeros[0] + LIMITS.least_share_of_torque * run.rated_torque / LIMITS.least_noise
    tension = run.load_friction * run.load_acceleration / GRAVITY
    return np.column_stack([weight, inertia, timing_column(run), *zeros, tension, run.corrections])


def timing_column(run: PreparedRun) -> FloatArray:
    """Torque in N m per sample that the speed comes late."""
    return delay_columns(run, SMALL_DELAY)[:, 0] * max(run.dt, SHORTEST_PERIOD)


def slot_columns(run: PreparedRun, slot: Slot) -> FloatArray:
    """Torque in N m per unit of each parameter of a candidate in one shape, shape (samples, parameters)."""
    candidate, shape = slot.origin
    return np.asarray(candidate.columns(run, shape.values))


def regressors(run: PreparedRun, layout: Layout, size: int) -> Iterator[FloatArray | Means]:
    """The scaled columns of one run in the gap's unit, the base's first: (usable samples, some columns); or means."""
    own = usable_samples(run.used, size)
    there = run.at(own)
    base = np.column_stack([there.jacobian, samples_of(tolerance_columns(run), own)])
    yield from scaled(base, layout.base.scale, run.unit_torque)
    for slot in layout.slots:
        if (kept := run.means.get(_kept_as(slot, layout, size))) is not None:
            yield kept[1]
            continue
        # where much of a run stands, a law that remembers nothing is not reckoned there
        lasts = not without_memory(slot.origin[0])
        columns = samples_of(slot_columns(run, slot), own) if lasts else slot_columns(there, slot)
        yield from scaled(columns, layout.scales[list(slot.columns)], run.unit_torque)


def _kept_as(slot: Slot, layout: Layout, size: int) -> Hashable:
    """All that the means of a slot's columns hang on; the candidate, kept with them, keeps its id."""
    candidate, shape = slot.origin
    return id(candidate), tuple(shape.values.items()), layout.scales[list(slot.columns)].tobytes(), size


def block_size(run: PreparedRun) -> int:
    """Samples per block."""
    return max(round(LIMITS.block_time / run.dt), 1)


def build_problem(
    runs: Sequence[PreparedRun], layout: Layout, by_sample: bool = False, known: Sequence[Slot] = ()
) -> Problem:
    """The regression over usable samples, in the gap's unit: in blocks or, where time is short, one by one."""
    length = segment_length(sum(run.time[-1] for run in runs))
    sizes = [1 if by_sample else block_size(run) for run in runs]
    ends = np.cumsum([0] + [usable_blocks(run.used, size) for run, size in zip(runs, sizes, strict=True)])
    x = np.empty((len(layout.scales), ends[-1]))  # the second largest thing there is, and what all fits read
    own = zip(runs, sizes, pairwise(ends), strict=True)
    keep = not by_sample and x.nbytes <= MOST_KEPT  # of what just reversed nobody asks twice
    tables = [_blocks(run, layout, size, length, x[:, a:b], keep) for run, size, (a, b) in own]
    problem = problem_of(tables, layout, np.array([least_noise_of(run) for run in runs]), known, x.T)
    return problem if x.nbytes <= MOST_KEPT else replace(problem, blocks=on_disk(problem.blocks))


def _blocks(run: PreparedRun, layout: Layout, size: int, length: float, into: FloatArray, keep: bool) -> RunBlocks:
    table = run_blocks(
        run.time, run.gap / run.unit_torque, regressors(run, layout, size), run.used, run.direction, run.channels,
        size, length, into, run.made(size),
    )  # fmt: skip
    weighed = "hook_load" in run.present or not (run.groups or COURSE in run.present)
    first = weighed and not run.means  # who holds these runs holds the table as well, and nobody changes it
    for slot in layout.slots if keep else ():
        own = into[slot.columns[0] : slot.columns[-1] + 1]
        run.means.setdefault(_kept_as(slot, layout, size), (slot.origin[0], Means((own if first else own.copy()).T)))
    # where the load was never measured it is anything: what a constant weight could explain is taken out
    return table if weighed else without_column(table, layout.base.parameters)


def least_noise_of(run: PreparedRun) -> float:
    """What no balance of a winch closes better than, however quiet its sensors, bar (N m for an electric drive)."""
    if run.groups:  # of a slow log the samples that it follows to so much are used
        own = LIMITS.least_noise * (SHOWS if run.dt > SPARSEST else 1.0)
        # where a passive side carries the load, what a load cell is off by is many times as much of the driving side
        hangs = float(np.sqrt(np.mean(run.drum_torque**2))) / run.gear_ratio / run.unit_torque
        return float(np.hypot(own, LIMITS.least_share_of_load * hangs))
    return LIMITS.least_share_of_torque * max(rms(run.drive_torque), run.rated_torque) / run.unit_torque


def accounted(run: PreparedRun, layout: Layout, explanation: Explanation) -> Accounted:
    """What an explanation's effects add to what the driving motors carry, and to the passive side's signals; errors of
    the driving motors' own signals add nothing."""
    missing, error, of_stroke = (np.zeros(len(run.time)) for _ in range(3))
    at = len(layout.base.names)
    for slot in explanation.slots:
        width = len(slot.columns)
        candidate, shape = slot.origin
        if candidate.kind != "signal" or shape.carried:
            columns = np.ascontiguousarray(slot_columns(run, slot)) * layout.scales[list(slot.columns)]
            total = missing if not shape.carried else of_stroke if candidate.of_stroke else error
            total += columns @ explanation.beta[at : at + width]
        at += width
    return Accounted(missing, error, of_stroke)
