"""Candidates beside what is taken already: of each law its best variant, of each family its best law."""

from collections.abc import Container, Sequence

from winch_friction.discrepancy.engine.blocks import Slot
from winch_friction.discrepancy.engine.crossfit import CrossFit, Explanation
from winch_friction.discrepancy.thresholds import LIMITS

THE_SAME = 1e-5  # of the held-out loss: a thousand times its rounding; laws that are one over these runs


def candidate_trials(cross: CrossFit, current: Explanation, taken: Container[str]) -> list[Explanation]:
    """Every candidate that is not taken added to the set: of each law the variant that fits the training runs best, of
    each family the law that does best on held-out runs.
    """
    slots = fitted(cross, current.slots, taken)
    return heads(cross, current.loss, [cross.explain((*current.slots, slot)) for slot in slots])


def fitted(cross: CrossFit, rest: Sequence[Slot], taken: Container[str], by_part: bool = False) -> list[Slot]:
    """Of each law of each candidate, with `by_part` of each of the things that it may speak of, the variant that fits
    the training runs best beside the rest."""
    best: dict[tuple[str, str, str], tuple[float, Slot]] = {}
    open_to = [s for s in cross.problem.slots if s.name not in taken and not any(s is each for each in rest)]
    cross.fit_beside(rest, open_to)
    for slot in open_to:
        loss, _ = cross.train_loss((*rest, slot))
        key = (slot.name, slot.law, slot.part if by_part else "")
        if key not in best or loss < best[key][0]:
            best[key] = (loss, slot)
    return [slot for _, slot in best.values()]


def reshaped(cross: CrossFit, slots: Sequence[Slot]) -> tuple[Slot, ...]:
    """The same laws, each in the shape that fits the training runs best beside the others: the one that a law had may
    have been chosen beside an effect that is gone."""
    shaped = list(slots)
    for k, own in enumerate(slots):
        rest = [*shaped[:k], *shaped[k + 1 :]]
        law = own.name, own.law, own.part
        alike = [each for each in cross.problem.slots if (each.name, each.law, each.part) == law]
        cross.fit_beside(rest, alike)
        shaped[k] = min((own, *alike), key=lambda each: cross.train_loss((*rest, each))[0])
    return tuple(shaped)


def heads(cross: CrossFit, before: float, trials: Sequence[Explanation]) -> list[Explanation]:
    """The best member of each family by held-out loss; a free one only where no law does nearly as well."""
    families: dict[str, list[Explanation]] = {}
    for trial in sorted(trials, key=lambda each: charged(before, each.loss, each.slots[-1])):
        families.setdefault(trial.slots[-1].name, []).append(trial)
    return [_head(cross, members) for members in families.values()]


def _head(cross: CrossFit, members: Sequence[Explanation]) -> Explanation:
    """Of one cause's laws, the best first, that which speaks for it: the first, or the curve that leaves less than half
    of what that one leaves above the floor, if this is more than nothing.

    Between two causes flexibility costs a share of what is explained, for it imitates; within one it is how a law
    differs from the literature's, and what counts is what is left.
    """
    first = members[0]
    left = first.loss - cross.floor
    if first.slots[-1].free or left <= LIMITS.least_excess * float(cross.problem.grams.count.sum()):
        return first
    closer = min((each for each in members if each.slots[-1].free), key=lambda each: each.loss, default=first)
    return closer if closer.loss - cross.floor < LIMITS.outdone * left else first


def charged(before: float, after: float, own: Slot) -> float:
    """Held-out loss, of which a flexible member has to give back a share of what it saves, and whatever is not plain
    the least share that decides between two that do the same, for each of its parameters."""
    share = LIMITS.free_charge if own.free else 0.0 if own.plain else LIMITS.plain_first * len(own.columns)
    return after + share * max(before - after, 0.0)


def in_order(cross: CrossFit, losses: Sequence[float], slots: Sequence[Slot]) -> list[int]:
    """Effects from the least charged loss on; of those that come to the same the one that is listed first leads, which
    is a cause's own law before its others: rounding is no reason for a name, nor for a place in a set.
    """
    listed = {id(slot): k for k, slot in enumerate(cross.problem.slots)}
    first = [listed.get(id(slot), len(listed)) for slot in slots]
    ordered: list[int] = []
    left = sorted(range(len(slots)), key=lambda k: (losses[k], first[k]))
    while left:
        level = losses[left[0]] * (1.0 + THE_SAME)
        ties = [k for k in left if losses[k] <= level]
        ordered += sorted(ties, key=lambda k: first[k])
        left = left[len(ties) :]
    return ordered
