"""The proof: the repaired model's file, read back, against runs that nothing before has looked at.

Before and after are evaluated alike: the file's corrections taken out, the balance closed with its terms, nothing
fitted. What is claimed is what a user of the file gets.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc, chdtri

from winch_friction.discrepancy.answer import Side
from winch_friction.discrepancy.candidates.candidate import Estimates
from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Blocks, RunBlocks, Slot, joined, run_blocks, segment_length
from winch_friction.discrepancy.engine.chance import Size, chance_of_no_gain, rms, rms_with_interval
from winch_friction.discrepancy.engine.crossfit import on_their_own
from winch_friction.discrepancy.engine.noise import Made, alike, noise_of_run
from winch_friction.discrepancy.expansion import Given
from winch_friction.discrepancy.preparation.prepare import PreparedRun
from winch_friction.discrepancy.regressors import block_size, least_noise_of, timing_column
from winch_friction.discrepancy.repair import Repair
from winch_friction.discrepancy.search import Search
from winch_friction.discrepancy.thresholds import LIMITS
from winch_friction.physics.friction import FrictionModel
from winch_friction.records.model_file import model_from_text, model_to_text

SURE = 3.0  # standard deviations of an amount, in a file, that surely is one


@dataclass(frozen=True)
class Trial:
    """A repaired model as its file is read, and what it leaves of the gap."""

    search: Search
    repaired: Repair
    train: Side
    holdout: Side
    levels: str = ""  # what is said of load cells whose levels are not believed


def read_back(model: FrictionModel) -> FrictionModel:
    """The model as whoever loads its file gets it."""
    return model_from_text(model_to_text(model), f"repaired model of '{model.name}'")


def unproven(named: str, refit: Side, repaired: Side, rng: np.random.Generator) -> str:
    """Why the locked runs do not bear names out; empty where they do.

    Names stand if the locked gap falls below the interval that it had, by an amount that a balance of a winch can
    tell at all and by more than a mere refit of the base takes off, and no locked run gets significantly worse. Both
    sides start from the same given model.
    """
    before, after = repaired.size_before, repaired.size_after
    if not after.value < before.interval[0]:
        return f"{named}: the locked gap of {before.value:.3g} does not fall surely (to {after.value:.3g})"
    # the noise as the names leave it: a late signal in a quick sea looks like noise as long as it is there
    if refit.size_after.value <= repaired.noise_floor:
        return f"{named}: a mere refit of the model leaves the locked runs at their noise"
    removed = float(np.sqrt(before.value**2 - after.value**2))
    if removed < repaired.least_noise:
        return f"{named} takes {removed:.2g} off the locked gap, which is less than any balance closes"
    beside = _taken_off(refit, repaired)
    if beside < LIMITS.beside_a_refit * repaired.least_noise and at_the_floor(refit) and not slow_shows(refit):
        why = f"takes {beside:.2g} off what the model's own parameters leave once fitted anew: too little for an effect"
        return f"{named} {why}"
    share = left_beside_a_refit(refit, repaired)
    if share > LIMITS.left_beside_a_refit:
        kept = f"{100 * share:.0f} % of the square above the noise that a mere refit leaves"
        return f"{named} leaves {kept}: it is not what shows there"
    chance = chance_of_no_gain(*_common(refit, repaired), rng)
    if chance > LIMITS.proof_p:
        return f"{named} takes no more off the locked gap than a refit of the model does (p = {chance:.2g})"
    if worse := worse_runs(repaired, rng):
        return f"{named}: the gap of {', '.join(worse)} grows"
    return "" if len(repaired.blocks.y) else f"{named}: the locked runs have no usable block"


def may_be_none(slots: Sequence[Slot], full: Trial, refit: Trial) -> str:
    """Why a name is refused whose amounts are none of them sure, where a refit without it leaves the locked runs at
    their floor, and it takes less off what that leaves than a balance can tell: what it takes of the others is chance.
    """
    if not at_the_floor(refit.holdout) or _taken_off(refit.holdout, full.holdout) > full.holdout.least_noise:
        return ""
    for slot in on_their_own(slots):
        found, (candidate, shape) = full.repaired.parameters.get(slot.name, {}), slot.origin
        amounts = {p.name: found[p.name] for p in candidate.linear if p.name in found}
        unsure = all(abs(each.value) < SURE * each.std for each in amounts.values())
        if amounts and unsure and _surely_some(amounts, full.repaired.model, {*shape.values} & {*found}) < SURE:
            return f"{slot.name}: a refit without it leaves no more than noise, and its size may be none"
    return ""


def _surely_some(amounts: Estimates, file: FrictionModel, shapes: Collection[str]) -> float:
    """Standard deviations by which the amounts of a cause are some together, its `shapes` as they were found: of two
    that a file ties each may be none, and yet not both, and of a steeper law a smaller amount is as much, but none of
    it nothing. 0 where the file does not know how they are tied, as it does not of corrections."""
    names, covariance = file.parameter_names, file.covariance
    if covariance is None or not {*amounts, *shapes} <= {*names}:
        return 0.0
    at, given = ([names.index(name) for name in own] for own in (amounts, shapes))
    value, across = np.array([a.value for a in amounts.values()]), covariance[np.ix_(at, given)]
    own = covariance[np.ix_(at, at)] - across @ np.linalg.pinv(covariance[np.ix_(given, given)]) @ across.T
    return float(np.sqrt(chdtri(1, chdtrc(len(at), value @ np.linalg.solve(own, value)))))


def _taken_off(fewer: Side, more: Side) -> float:
    """What names take off the locked gap that fewer of them, or a mere refit, leave."""
    return float(np.sqrt(max(fewer.size_after.value**2 - more.size_after.value**2, 0.0)))


def adds(fewer: Side, more: Side, rng: np.random.Generator) -> bool:
    """Whether the names that `more` has beside those of `fewer` take something off the locked gap, surely and by an
    amount that a balance of a winch can tell."""
    removed = _taken_off(fewer, more)
    return bool(removed >= more.least_noise and chance_of_no_gain(*_common(fewer, more), rng) <= LIMITS.proof_p)


def is_minor(nameless: Side, fewer: Side, more: Side) -> bool:
    """Whether what `more` takes off the locked gap beside the names of `fewer` need not be another cause: it is as
    small, beside what all of them take off, as a law may be inexact, and the fewer leave little above the floor."""
    own = fewer.size_after.value**2 - more.size_after.value**2
    whole = nameless.size_after.value**2 - more.size_after.value**2
    near = fewer.size_after.value <= LIMITS.near_the_floor * fewer.floor
    return bool(near and own < LIMITS.law_accuracy**2 * whole)


def leaves_too_much(side: Side) -> str:
    """Why names do not answer for the locked gap although they make it smaller; empty where they do.

    The same share of the excess over the floor that a named effect may leave of the training runs.
    """
    return _left(side, "locked", LIMITS.left_over)


def leaves_most(side: Side) -> str:
    """Why names are not what shows in the training runs, of which a robust search may set aside those few that show it
    most; empty where they are."""
    return _left(side, "training", LIMITS.outdone)


def fits_only_its_own(train: Side, locked: Side) -> str:
    """Why names tell the training runs one by one instead of saying what all have; empty where the locked runs, each
    beside its floor, are left with no more than that."""
    own, others = (side.size_after.value / side.floor for side in (train, locked))
    if others <= LIMITS.chosen_on * max(own, 1.0):
        return ""
    left = (f"({side.size_after.value:.3g} left)" for side in (train, locked))
    return f"fits the runs that it was chosen on {next(left)} and not the locked ones {next(left)}"


def left_beside_a_refit(refit: Side, repaired: Side) -> float:
    """Share of the square above the noise that a mere refit leaves of the locked runs, which names or an equation leave
    as well; 0 where what these leave is noise."""
    if repaired.size_after.value <= LIMITS.several_leave * repaired.floor:
        return 0.0
    return _excess(repaired, repaired.floor) / max(_excess(refit, repaired.floor), 1e-12)


def _excess(side: Side, floor: float) -> float:
    """Square of what is left, above that of a floor."""
    return max(side.size_after.value**2 - floor**2, 0.0)


def share_left(side: Side) -> float:
    """Share of a gap's square above the noise that names leave."""
    return _excess(side, side.floor) / max(side.size_before.value**2 - side.floor**2, 1e-12)


def _left(side: Side, which: str, most: float) -> str:
    before, after, share = side.size_before.value, side.size_after, share_left(side)
    if after.value <= LIMITS.far_off_the_floor * side.floor or share <= most:
        return ""
    kept = f"is left ({before:.3g} to {after.value:.3g})"
    return f"{100 * share:.0f} % of the {which} gap's square above the noise {kept}"


def worse_runs(side: Side, rng: np.random.Generator) -> tuple[str, ...]:
    """Locked runs whose gap grows significantly, beyond what matters to anybody and what is nothing by itself: where an
    effect and what the base lacks cancelled, a run at its noise may stay at the floor and grow nevertheless."""
    found = []
    # no chance smaller than that can come out of so many draws
    least = max(LIMITS.worse_p / max(len(side.runs), 1), 2.0 / LIMITS.bootstrap_draws)
    for k, run in enumerate(side.runs):
        own = side.blocks.run == k
        before, after = side.before[own], side.after[own]
        ordinary = max(LIMITS.worse * np.hypot(rms(before), side.least_noise), LIMITS.at_the_floor * side.floor)
        if not own.any() or rms(after) <= ordinary:
            continue
        if chance_of_no_gain(after, before, side.blocks.segment[own], side.blocks.run[own], rng) <= least:
            found.append(run.name)
    return tuple(found)


def at_the_floor(side: Side) -> bool:
    """Whether what is left is noise, what no balance of a winch closes and a zero of its transducers, within its
    interval; a wide interval does not excuse what is plainly more."""
    return side.size_after.interval[0] <= LIMITS.at_the_floor * side.excused and not far_off(side)


def nobodys(side: Side) -> bool:
    """Whether what is left above noise and what no balance closes is less than anybody's effect."""
    return side.size_after.value**2 <= (1.0 + LIMITS.least_excess) * side.floor**2


def slow_shows(side: Side, most: float = LIMITS.slowest_left) -> bool:
    """Whether what the slowest blocks keep is somebody's, however little it is of all of them."""
    return side.slowest > most * side.floor


def far_off(side: Side) -> bool:
    """Whether what is left is plainly more than noise and what no balance closes, however few segments show it."""
    return side.size_after.value > LIMITS.far_off_the_floor * side.floor


def _common(refit: Side, repaired: Side) -> tuple[FloatArray, FloatArray, np.ndarray, np.ndarray]:
    """What either file leaves, over the blocks that both can use."""
    keys = [list(zip(s.blocks.run.tolist(), s.blocks.position.tolist(), strict=True)) for s in (refit, repaired)]
    places = {key: k for k, key in enumerate(keys[0])}
    pairs = np.array([(places[key], k) for k, key in enumerate(keys[1]) if key in places], int).reshape(-1, 2)
    first, second, own = *pairs.T, repaired.blocks
    return refit.after[first], repaired.after[second], own.segment[second], own.run[second]


TINY = 1e-300  # against a division by nothing


def _relative(residual: FloatArray, drive: FloatArray) -> float:
    """Norm of what is left over the norm of the measured drive."""
    return float(np.sqrt((residual**2).sum() / max(float((drive**2).sum()), TINY)))


def compare(before: Given, after: Given, names: Sequence[str], rng: np.random.Generator) -> Side:
    """The gap of these runs with either model, over the blocks that both can use, and its size with an interval."""
    return sized(beside(before, after, names), rng)


def sized(side: Side, rng: np.random.Generator) -> Side:
    """The side with intervals of its sizes, from redrawn segments."""
    segment, run = side.blocks.segment, side.blocks.run
    before, after = (rms_with_interval(each, segment, run, rng) for each in (side.before, side.after))
    return replace(side, size_before=before, size_after=after)


def beside(before: Given, after: Given, names: Sequence[str]) -> Side:
    """The gap of these runs with either model, over the blocks that both can use; its sizes are not known yet."""
    pairs = [(a, b) for a, b in zip(before.prepared, after.prepared, strict=True) if a.name in names]
    length = segment_length(sum(old.time[-1] for old, _ in pairs))
    tables = [_blocks(old, new, length) for old, new in pairs]
    blocks = joined(tables, dict.fromkeys(range(len(pairs)), 1.0))
    y_before, y_after, skew = blocks.y, *blocks.x.T
    least = np.array([least_noise_of(old) for old, _ in pairs])
    made = enumerate(alike([table.made for table in tables]))
    noise = np.array([_noise(y_after, skew, blocks, k, least[k], each) for k, each in made])
    floor, closes = (rms(each[blocks.run]) if len(pairs) else 0.0 for each in (noise, least))
    torque, untold = np.array([drive_of(old) for old, _ in pairs])[blocks.run], Size(np.nan, (np.nan, np.nan))
    return Side(
        runs=tuple(old for old, _ in pairs), blocks=blocks, before=y_before, after=y_after,
        size_before=untold, size_after=untold, noise_floor=floor, least_noise=closes,
        relative=(_relative(y_before, torque), _relative(y_after, torque)), slowest=_of_slowest(y_after, blocks),
    )  # fmt: skip


def _of_slowest(values: FloatArray, blocks: Blocks) -> float:
    """RMS over the slowest blocks, 0 where fewer than twice as many as these are known."""
    speed = np.abs(blocks.features.get("motor_speed", np.empty(0)))
    count = max(int(LIMITS.slowest * len(speed)), LIMITS.fewest_slowest)
    return rms(values[np.argsort(speed, kind="stable")[:count]]) if len(speed) >= 2 * count else 0.0


def _blocks(old: PreparedRun, new: PreparedRun, length: float) -> RunBlocks:
    """The gap of a run before, and in the columns the gap after it and what signals out of step leave, in its unit."""
    at = old.time + old.start
    own = new.time + new.start
    inside = (at >= own[0] - 1e-9) & (at <= own[-1] + 1e-9)
    used = old.used & inside & new.used_at(at)
    gap = np.interp(at, own, new.gap) / new.unit_torque
    columns = (np.column_stack([gap, timing_column(old) / old.unit_torque]),)
    own_gap, size = old.gap / old.unit_torque, block_size(old)
    return run_blocks(old.time, own_gap, columns, used, old.direction, old.channels, size, length, made=old.made(size))


def _noise(values: FloatArray, skew: FloatArray, blocks: Blocks, k: int, least: float, made: Made | None) -> float:
    """Independent noise of one run, whose blocks are `made` so, in the gap's unit."""
    own = blocks.run == k
    if not own.any():
        return 0.0
    # what is late by more than a little leaves the skew's own change as well
    late = np.column_stack([skew[own], np.gradient(skew[own])]) if own.sum() > 1 else skew[own]
    return noise_of_run(values[own], blocks.position[own], least, late, made)


def drive_of(run: PreparedRun) -> float:
    """RMS of a run's measured drive while moving, in the gap's unit."""
    return rms(run.drive_torque[run.used] / run.unit_torque)
