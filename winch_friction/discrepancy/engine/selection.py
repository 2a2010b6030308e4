"""Which effects are missing: forward by held-out loss, checked as a set, each with the rivals that do as well."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from winch_friction.discrepancy.engine import FloatArray
from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.chance import does_as_well, rivals_of
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation, far_less, flip_p_values, other_start
from winch_friction.discrepancy.engine.trials import candidate_trials, charged, fitted, heads, in_order
from winch_friction.discrepancy.thresholds import LIMITS

LEAST_GAIN = min(gain for gain, _ in LIMITS.significance)
TAKEN = "taken"
NO_BETTER = 1e-3  # of the held-out loss: a tenth of the least gain
EXCHANGES = 3  # rounds over a set, of four effects at most: what still improves then goes in circles


@dataclass(frozen=True)
class Considered:
    """One candidate at one stage: its gain in held-out RMSE, its family-wise p-value and why it was not taken."""

    name: str
    variant: str
    gain: float
    p_value: float
    stage: int
    verdict: str


@dataclass(frozen=True)
class Finding:
    """One missing effect, its rivals, and the evidence for it; `no_room`: more rivals than a set has room for."""

    slot: Slot
    rivals: tuple[Slot, ...]
    p_value: float
    gain: float
    selection_frequency: float
    no_room: tuple[str, ...] = ()


@dataclass(frozen=True)
class Selection:
    """What was found, what it was compared with, and the two fits that the proof is about."""

    base: Explanation
    final: Explanation
    found: tuple[Finding, ...]
    considered: tuple[Considered, ...] = field(default_factory=tuple)

    @property
    def untold(self) -> str:
        """Which names are not told from which, of a set that leaves out more than it has room for; empty without."""
        many = (f for f in self.found if len(f.no_room) > LIMITS.most_names)
        sets = ((f.slot.name, ", ".join([*(each.name for each in f.rivals), *f.no_room])) for f in many)
        return "; ".join(f"{name} is not told from {others}" for name, others in sets)


def select(
    cross: CrossFit, rng: np.random.Generator, most: int = LIMITS.most_effects, apart: bool = False
) -> Selection:
    """Add effects as long as one brings a significant and useful gain, then look for rivals of each; `apart`: without
    asking whether a second law of one cause would do in the place of another cause."""
    base = cross.explain(())
    considered: list[Considered] = []
    p_values: dict[str, float] = {}
    current = _whole(cross, _forward(cross, base, base, rng, most, considered, p_values), rng, apart)
    start = _plain_together(cross, base, rng)
    if start.slots:
        others: tuple[list[Considered], dict[str, float]] = ([], {})
        together = _whole(cross, _forward(cross, base, start, rng, most, *others), rng, apart)
        if _no_worse(together, current, rng):
            current = together
            considered, p_values = [*considered, *others[0]], p_values | others[1]
    if (own := other_start(cross, current)) is not None:
        others = ([], {})
        anew = _whole(cross, _forward(cross, base, own, rng, most, *others), rng, apart)
        if far_less(cross, anew, current):
            current, p_values = anew, p_values | others[1]
            considered += others[0]
    found = tuple(_found(cross, current, k, p_values, rng) for k in range(len(current.slots)))
    return Selection(base, current, _one_set_each(found), tuple(considered))


def with_fewer(cross: CrossFit, selection: Selection, slots: Sequence[Slot], rng: np.random.Generator) -> Selection:
    """The selection with these of its effects alone, each with the rivals that it has without the others: what took a
    part beside an effect may do as well in its place."""
    current = cross.explain(tuple(slots))
    p_values = {each.slot.name: each.p_value for each in selection.found}
    found = tuple(_found(cross, current, k, p_values, rng) for k in range(len(current.slots)))
    return replace(selection, final=current, found=_one_set_each(found))


def _one_set_each(found: Sequence[Finding]) -> tuple[Finding, ...]:
    """The findings; what could stand for the second law of a cause is no other name for it."""
    before = [{each.slot.name for each in found[:k]} for k in range(len(found))]
    return tuple(
        replace(f, rivals=(), no_room=()) if f.slot.name in b else f for f, b in zip(found, before, strict=True)
    )


def _forward(
    cross: CrossFit, base: Explanation, start: Explanation, rng: np.random.Generator, most: int,
    considered: list[Considered], p_values: dict[str, float],
) -> Explanation:  # fmt: skip
    """A set with more effects one by one, as long as one brings a significant and useful gain."""
    current = start
    for stage in range(len(start.slots), most):
        trials = candidate_trials(cross, current, current.names)
        if not trials:
            break
        gains = np.array([current.losses - each.losses for each in trials])
        p = _evidence(cross, trials, gains, rng)
        relative = np.array([cross.gain(current, each) for each in trials])
        worth = np.array([current.loss - each.loss for each in trials])
        least = LIMITS.least_share * (base.loss - current.loss)  # less is the first effect's own second order
        # what only steadies the fit of another effect when a run is left out is no effect itself
        inside = np.array([cross.inside_gain(current, each) for each in trials])
        worthy = (
            _significant(p, relative) & (relative >= LEAST_GAIN) & (inside >= LIMITS.least_inside) & (worth >= least)
        )
        order = _in_order(cross, current, trials)
        best = next((int(k) for k in order if worthy[k]), -1)
        considered += [_considered(trials[k], relative[k], inside[k], p[k], stage, worthy[k], k == best) for k in order]
        if not worthy.any():
            break
        p_values[trials[best].slots[-1].name] = float(p[best])
        current = _exchanged(cross, trials[best])
    return current


def _in_order(cross: CrossFit, current: Explanation, trials: Sequence[Explanation]) -> list[int]:
    """Trials by the charged loss of what each adds to the current set."""
    added = [each.slots[-1] for each in trials]
    losses = [charged(current.loss, each.loss, own) for each, own in zip(trials, added, strict=True)]
    return in_order(cross, losses, added)


def _plain_together(cross: CrossFit, base: Explanation, rng: np.random.Generator) -> Explanation:
    """What every machine has and a bare model lacks, all at once and then without what is not needed: inertia, Coulomb
    and viscous friction and a gain stand in for each other; one by one, the first takes what is two others'."""
    plain = [slot for slot in cross.problem.slots if slot.plain and not slot.brings]
    ways = {each.name: [slot for slot in plain if slot.name == each.name] for each in plain}
    # a shape is chosen beside what has but one: alone, a Stribeck curve wide enough is Coulomb friction
    one = tuple(own[0] for own in ways.values() if len(own) == 1)
    shaped = [min(own, key=lambda each: cross.train_loss((*one, each))[0]) for own in ways.values() if len(own) > 1]
    return _pruned(cross, cross.explain((*one, *shaped)), rng) if len(ways) > 1 else base


def _no_worse(plain: Explanation, other: Explanation, rng: np.random.Generator) -> bool:
    """Whether plain effects do on held-out data what another set does, chance apart."""
    if plain.loss <= other.loss:
        return True
    same = len(plain.slots) <= len(other.slots) and not any(slot.free for slot in plain.slots)
    return same and bool(flip_p_values((plain.losses - other.losses)[None], rng)[0] > LIMITS.rival_p)


def _evidence(
    cross: CrossFit, trials: Sequence[Explanation], gains: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """Family-wise p-values of each trial's last effect: does it help most segments, or is its size the same whichever
    run is left out? Few segments may show an effect, but those of all runs then agree on how large it is.
    """
    steady = len(trials) * np.array([cross.jackknife_p_value(each) for each in trials])
    return np.minimum(flip_p_values(gains, rng), steady)


def _significant(p: FloatArray, gain: FloatArray) -> np.ndarray:
    """Whether a p-value is small enough for a gain; below the least gain any that would do for it."""
    enough = np.full(np.shape(gain), LIMITS.significance[-1][1])
    for least, level in reversed(LIMITS.significance):
        enough = np.where(gain >= least, level, enough)
    return np.asarray(p <= enough)


def _considered(
    trial: Explanation, gain: float, inside: float, p: float, stage: int, worthy: bool, best: bool
) -> Considered:
    own = trial.slots[-1]
    if best:
        verdict = TAKEN
    elif worthy:
        verdict = "significant and useful, but outdone in held-out loss by the one taken"
    elif not _significant(np.asarray(p), np.asarray(gain)):
        verdict = f"not significant on held-out segments (p = {p:.2g})"
    elif gain < LEAST_GAIN:
        verdict = f"gains only {100 * gain:.1f} % of the held-out error, less than {100 * LEAST_GAIN:g} %"
    elif inside < LIMITS.least_inside:
        verdict = "only steadies the fit of another effect: it explains next to nothing of the runs it is fitted to"
    else:
        verdict = f"explains less than {100 * LIMITS.least_share:g} % of what the first effect did: its second order"
    return Considered(own.name, own.label, float(gain), float(p), stage, verdict)


def _exchanged(cross: CrossFit, current: Explanation) -> Explanation:
    """The set in which no single effect can be swapped for a better one: an early choice may have stood in for two."""
    for _ in range(EXCHANGES):
        improved = False
        for k in range(len(current.slots)):
            rest = current.slots[:k] + current.slots[k + 1 :]
            without, own = cross.explain(rest), current.slots[k]
            trials = [cross.explain((*rest, slot)) for slot in fitted(cross, rest, {slot.name for slot in rest})]
            trials = heads(cross, without.loss, trials)
            least = charged(without.loss, current.loss, own) * (1.0 - NO_BETTER)
            best = min(trials, key=lambda each: charged(without.loss, each.loss, each.slots[-1]))
            new = best.slots[-1]
            curve = new.name == own.name and new.free and not own.free  # of its own cause, and leaves far less
            if curve or charged(without.loss, best.loss, new) < least:
                current, improved = cross.explain((*rest[:k], new, *rest[k:])), True
        if not improved:
            break
    return current


def _whole(cross: CrossFit, current: Explanation, rng: np.random.Generator, apart: bool) -> Explanation:
    """The set as it is answered: without what is superfluous, of as few causes as do it, with what its members bring
    along."""
    needed = _pruned(cross, current, rng)
    return _with_company(cross, needed if apart else _of_fewest_causes(cross, needed, rng))


def _of_fewest_causes(cross: CrossFit, current: Explanation, rng: np.random.Generator) -> Explanation:
    """The set with another law of one of its causes in the place of a second name, where that does as well and leaves
    no more than twice as much above the floor: a cause whose law is a mixture of two known ones is one cause, and so is
    one that is there twice, by a law each; but a share of a large effect may be all of a small one."""
    for own in reversed(current.slots):
        rest = tuple(slot for slot in current.slots if slot is not own)
        laws = {(slot.name, slot.law, slot.part) for slot in rest}
        if own.plain or own.name in {slot.name for slot in rest} or any(own.name in slot.brings for slot in rest):
            continue
        without, others = cross.explain(rest), {slot.name for slot in cross.problem.slots} - {s.name for s in rest}
        slots = fitted(cross, rest, others, by_part=True)
        trials = [cross.explain((*rest, slot)) for slot in slots if (slot.name, slot.law, slot.part) not in laws]
        enough = max(cross.excess(current), LIMITS.least_excess) / LIMITS.outdone
        trials = [t for t in trials if cross.excess(t) <= enough and does_as_well(t, current, without, rng)]
        if trials:
            best = min(trials, key=lambda each: charged(without.loss, each.loss, each.slots[-1]))
            current = cross.explain(tuple(best.slots[-1] if slot is own else slot for slot in current.slots))
    return current


def _pruned(cross: CrossFit, current: Explanation, rng: np.random.Generator) -> Explanation:
    """Drop what the rest of the set has made superfluous."""
    while len(current.slots) > 1:
        smaller = [cross.explain(current.slots[:k] + current.slots[k + 1 :]) for k in range(len(current.slots))]
        k = int(np.argmin([each.loss for each in smaller]))
        weakest, last = smaller[k], cross.explain((*smaller[k].slots, current.slots[k]))
        p = _evidence(cross, [last], (weakest.losses - current.losses)[None], rng)[0]
        gain = cross.gain(weakest, current)
        useful = min(gain, cross.inside_gain(weakest, current)) >= LEAST_GAIN
        if useful and _significant(np.asarray(p), np.asarray(gain)):
            break
        current = weakest
    return current


def _with_company(cross: CrossFit, current: Explanation) -> Explanation:
    """The set with the lower-order effects that its members bring along."""
    slots = list(current.slots)
    for slot in current.slots:
        for name in slot.brings:
            own = [each for each in cross.problem.slots if each.name == name]
            if own and name not in [each.name for each in slots]:
                slots.insert(slots.index(slot), own[0])
    return cross.explain(slots) if len(slots) > len(current.slots) else current


def _found(
    cross: CrossFit, current: Explanation, k: int, p_values: dict[str, float], rng: np.random.Generator
) -> Finding:
    own = current.slots[k]
    bringers = [each for each in current.slots if own.name in each.brings]
    if bringers:  # its own worth shows only before the higher order takes it over
        lower = tuple(each for each in current.slots if each not in bringers)
        current, k = cross.explain(lower), lower.index(own)
    rest = current.slots[:k] + current.slots[k + 1 :]
    without = cross.explain(rest)
    rivals, frequency = rivals_of(cross, current, without, k, rng, same=bool(bringers))
    p = p_values.get(own.name, float(flip_p_values((without.losses - current.losses)[None], rng)[0]))
    sets = rivals[: LIMITS.most_names - 1], tuple(slot.name for slot in rivals[LIMITS.most_names - 1 :])
    return Finding(own, sets[0], p, float(cross.gain(without, current)), frequency, sets[1])
